"""The folders of packages. A package's source folder serves as its share folder."""

from pathlib import Path

from ament_index_python.resources import get_resources
from course_lib.ros.programs import packages
from course_lib.ros.programs.import_path import provided_packages
from course_lib.ros.programs.packages import INSTALLED, missing_share_folder, share_folder


class PackageNotFoundError(KeyError):
    """A package was not found."""

    def __str__(self) -> str:
        # KeyError would show the repr of its argument.
        return str(self.args[0])


def get_package_share_path(package_name: str, print_warning: bool = True) -> Path:
    """Return the folder with the package's launch/, config/ and rviz/.

    Packages of the kit without one, such as rclpy, have the folder that they have on a robot.

    Raises:
        PackageNotFoundError: There is no such package.
    """
    share = _share_folder(package_name)
    return share if share.parent.name == "share" else share_folder(package_name, share)


def get_package_share_directory(package_name: str, print_warning: bool = True) -> str:
    """Return the folder with the package's launch/, config/ and rviz/.

    Raises:
        PackageNotFoundError: There is no such package.
    """
    return str(get_package_share_path(package_name))


def get_package_prefix(package_name: str) -> str:
    """Return the installation prefix of a package, or the parent folder of its sources.

    Packages of the kit without a share folder have the prefix that they have on a robot.

    Raises:
        PackageNotFoundError: There is no such package.
    """
    return str(packages.prefix_of(_share_folder(package_name)))


def get_packages_with_prefixes() -> dict[str, str]:
    """Return all packages with their installation prefixes."""
    return get_resources("packages")


def _share_folder(name: str) -> Path:
    package = packages.find_package(name)
    if package is not None:
        return package.share
    if name in provided_packages():
        return INSTALLED / name
    reason = packages.not_found_reason(name)
    absent = missing_share_folder(name, reason)
    if absent is None:
        raise PackageNotFoundError(reason)
    return absent
