"""The folders of packages, and the resources that packages register, by type and name.

A package's source folder serves as its share folder.
"""

from contextlib import suppress
from pathlib import Path
from typing import Literal

from course_lib.errors import CourseError
from course_lib.ros.messages import definitions
from course_lib.ros.programs import packages
from course_lib.ros.programs.build_files import read_build_files
from course_lib.ros.programs.import_path import provided_packages
from course_lib.ros.programs.packages import INSTALLED, missing_share_folder, share_folder
from course_lib.third_party import read_text

_INDEX = Path("share", "ament_index", "resource_index")
_INTERFACES = "rosidl_interfaces"


class InvalidResourceTypeNameError(ValueError):
    """A type of resources contains a slash."""


class InvalidResourceNameError(ValueError):
    """The name of a resource contains a slash."""


def get_resource_types() -> set[str]:
    """Return the types of all resources."""
    return set(_read_index())


def get_resources(resource_type: str) -> dict[str, str]:
    """Return all resources of a type as a dictionary of name to prefix."""
    _check_type(resource_type)
    return {name: str(prefix) for name, (prefix, _) in _read_index().get(resource_type, {}).items()}


def has_resource(resource_type: str, resource_name: str) -> str | Literal[False]:
    """Return the prefix of a resource, or False if there is none."""
    _check_name(resource_type, resource_name)
    return get_resources(resource_type).get(resource_name, False)


def get_resource(resource_type: str, resource_name: str) -> tuple[str, str]:
    """Return the content of a resource and its prefix.

    Raises:
        LookupError: There is no such resource.
        OSError: The file of the resource cannot be read.
    """
    _check_name(resource_type, resource_name)
    resources = _read_index().get(resource_type, {})
    if resource_name not in resources:
        raise LookupError(f"Could not find the resource '{resource_name}' of type '{resource_type}'")
    prefix, content = resources[resource_name]
    if isinstance(content, str):
        return content, str(prefix)
    try:
        return read_text(content), str(prefix)
    except OSError as error:
        raise OSError(
            f"Could not open the resource '{resource_name}' of type '{resource_type}':\n{error}"
        ) from error


def _check_type(resource_type: str) -> None:
    assert resource_type, "The resource type must not be empty"
    if "/" in resource_type or "\\" in resource_type:
        raise InvalidResourceTypeNameError(f"Resource type '{resource_type}' is invalid")


def _check_name(resource_type: str, resource_name: str) -> None:
    _check_type(resource_type)
    assert resource_name, "The resource name must not be empty"
    if "/" in resource_name or "\\" in resource_name:
        raise InvalidResourceNameError(f"Resource name '{resource_name}' is invalid")


def _read_index() -> dict[str, dict[str, tuple[Path, str | Path]]]:
    """Return the prefix and the content, or its file, of each resource by type and name.

    Resources of an installed package are files below its prefix. A source package has those that
    its setup.py or CMakeLists.txt installs, and the kit's packages have the prefix that they have
    on a robot.
    """
    index: dict[str, dict[str, tuple[Path, str | Path]]] = {"packages": {}}
    prefixes = dict[str, Path]()
    for name, share in packages.packages().items():
        prefix = prefixes[name] = packages.prefix_of(share)
        if share.parent.name == "share":
            resources: dict[tuple[str, str], str | Path] = {
                (file.parent.name, file.name): file for file in (prefix / _INDEX).glob(f"*/{name}")
            }
        else:
            resources = {}
            # The syntax error in setup.py is reported where one of the executables is started.
            with suppress(CourseError):
                build_files = read_build_files(name, share)
                places = ((Path(place), file) for place, file in build_files.installed)
                resources |= {
                    (place.parent.name, place.name): file
                    for place, file in places
                    if place.parent.parent == _INDEX and file.is_file()
                }
                resources |= build_files.resources
        for (resource_type, resource_name), content in {("packages", name): "", **resources}.items():
            index.setdefault(resource_type, {}).setdefault(resource_name, (prefix, content))
    for name in provided_packages():
        index["packages"].setdefault(name, (INSTALLED.parent, ""))
    # An invalid file of the workspace is reported when its package is imported.
    definitions.find_workspace_packages()
    lines = dict[str, list[str]]()
    for kind in ("msg", "srv", "action"):
        for type_name in definitions.interfaces(kind):
            package, _, interface = type_name.partition("/")
            lines.setdefault(package, []).extend((f"{interface}.idl", f"{interface}.{kind}"))
    interfaces = index.setdefault(_INTERFACES, {})
    for package, files in lines.items():
        content = "\n".join(sorted(files))
        interfaces.setdefault(package, (prefixes.get(package, INSTALLED.parent), content))
    return {resource_type: dict(sorted(resources.items())) for resource_type, resources in index.items()}


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
