"""The folders of packages; a package's sources count as its share folder."""

from pathlib import Path

from course_lib.ros import packages
from course_lib.ros.share_folder import share_folder


class PackageNotFoundError(KeyError):
    """A package was not found."""

    def __str__(self) -> str:
        return str(self.args[0])  # KeyError would show its repr


def get_package_share_path(package_name: str, print_warning: bool = True) -> Path:
    """Return the folder with the package's launch/, config/ and rviz/; raises PackageNotFoundError."""
    found = _found(package_name)
    return found.share if found.share.parent.name == "share" else share_folder(found.name, found.share)


def get_package_share_directory(package_name: str, print_warning: bool = True) -> str:
    """Return the folder with the package's launch/, config/ and rviz/; raises PackageNotFoundError."""
    return str(get_package_share_path(package_name))


def get_package_prefix(package_name: str) -> str:
    """Return the folder that the package is installed under, or else the folder above its sources."""
    share = _found(package_name).share
    return str(share.parent.parent if share.parent.name == "share" else share.parent)


def get_packages_with_prefixes() -> dict[str, str]:
    """Return all packages with the folders that they are installed under."""
    return {name: get_package_prefix(name) for name in packages.packages()}


def _found(name: str) -> packages.Package:
    found = packages.find_package(name)
    if found is None:
        raise PackageNotFoundError(packages.why_not_found(name))
    return found
