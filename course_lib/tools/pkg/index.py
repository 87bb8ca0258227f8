"""`ros2 pkg list|executables|prefix|xml`: the kit's packages and the student's own."""

from argparse import Namespace
from functools import partial
from pathlib import Path

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.packages import find_package, packages
from course_lib.ros.standin_path import STANDIN, provided
from course_lib.tools.executables import EXECUTABLES
from course_lib.tools.sources import Source
from course_lib.tools.verb import Verb, Write, flag, value


def list_all(source: Source, arguments: Namespace, write: Write) -> None:
    """Print the packages' names."""
    write("".join(f"{name}\n" for name in _names()))


def executables(source: Source, arguments: Namespace, write: Write) -> None:
    """Print the executables of a package, or of all; raises a CourseError if there is no such package."""
    asked = arguments.package_name
    if asked is not None and asked not in _names():
        raise CourseError(f"Package '{asked}' not found{did_you_mean(asked, _names())}")
    for package in _names() if asked is None else [asked]:
        found = find_package(package)
        names = {name for owner, name in EXECUTABLES if owner == package}
        for name in sorted(names | set(found.executables if found else ())):
            path = f"{_prefix(package)}/lib/{package}/{name}"
            write(f"{path}\n" if arguments.full_path else f"{package} {name}\n")


def prefix(source: Source, arguments: Namespace, write: Write) -> None:
    """Print where a package is; raises a CourseError if there is no such package."""
    where = _share(arguments.package_name) if arguments.share else _prefix(arguments.package_name)
    write(f"{where}\n")


def xml(source: Source, arguments: Namespace, write: Write) -> None:
    """Print a package's manifest, or one tag of it.

    Raises:
        CourseError: There is no such package, manifest or tag.
    """
    from xml.etree import ElementTree

    manifest = _share(arguments.package_name) / "package.xml"
    if not manifest.is_file():
        raise CourseError(
            f"Package XML manifest not found: {arguments.package_name} is a part of the kit, not a folder "
            "of yours."
        )
    root = ElementTree.parse(manifest).getroot()
    if arguments.tag is None:
        write(ElementTree.tostring(root, encoding="unicode").rstrip("\n") + "\n")
        return
    elements = root.findall(arguments.tag)
    if not elements:
        raise CourseError(f"XML tag not found{did_you_mean(arguments.tag, {child.tag for child in root})}")
    write("".join(f"{element.text}\n" for element in elements))


def _names() -> list[str]:
    return sorted({*provided(), *packages(), *(package for package, _ in EXECUTABLES)})


def _prefix(package: str) -> Path:
    share = _share(package)
    return share.parents[1] if share.parent.name == "share" else share.parent


def _share(package: str) -> Path:
    if package not in _names():
        raise CourseError(f"Package not found{did_you_mean(package, _names())}")
    return packages().get(package, STANDIN / package)


_PACKAGE = value("package_name", help="The package name")
_EXECUTABLES = (
    value("package_name", nargs="?", help="The package name"),
    flag("--full-path", help="Show full path of each executable"),
)
_PREFIX = (_PACKAGE, flag("--share", help="Show share directory for the package"))
_XML = (_PACKAGE, value("-t", "--tag", help="The XML tag to output (e.g. 'version')"))
_verb = partial(Verb, "pkg", looks=False)
PKG_VERBS = (
    _verb("list", "Output a list of available packages", (), list_all),
    _verb("executables", "Output a list of package specific executables", _EXECUTABLES, executables),
    _verb("prefix", "Output the prefix path of a package", _PREFIX, prefix),
    _verb("xml", "Output the XML of the package manifest or a specific tag", _XML, xml),
)
