"""The files of a ROS 2 ament_python package, as templates with placeholders."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from course_lib.errors import CourseError
from course_lib.ros.programs.import_path import provided_packages

_HERE = Path(__file__).parent
_NAME = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")  # REP 144
_WHERE = {  # template -> file
    "package.xml": "package.xml",
    "setup.py": "setup.py",
    "setup.cfg": "setup.cfg",
    "readme.md": "README.md",
    "conftest.py": "test/conftest.py",
    "test_copyright.py": "test/test_copyright.py",
    "test_flake8.py": "test/test_flake8.py",
    "test_pep257.py": "test/test_pep257.py",
}


@dataclass(frozen=True)
class PackageText:
    """The contents of the files."""

    name: str
    maintainer: str
    email: str
    description: str
    license: str = "Apache-2.0"
    version: str = "1.0.0"
    executables: Mapping[str, str] = field(default_factory=dict)  # "module:function" by executable name
    depends: Sequence[str] = ()  # ROS packages that the code imports
    exec_depends: Sequence[str] = ()  # rosdep keys of further runtime dependencies
    about: Sequence[str] = ()  # a line for each node, for the README


def package_files(text: PackageText) -> dict[str, str]:
    """Return the files of the package, except nodes, launch files and layouts, by path."""
    files = {place: fill_template(template, text=text) for template, place in _WHERE.items()}
    return files | {f"resource/{text.name}": "", f"{text.name}/__init__.py": ""}


def fill_template(template: str, **values: object) -> str:
    """Fill in one of the templates next to this file."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined
    from markupsafe import escape

    environment = Environment(
        loader=FileSystemLoader(_HERE),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["xml"] = escape
    return environment.get_template(f"{template}.j2").render(values)


def check_package_name(name: str) -> None:
    """Raise a CourseError unless a package may have this name, by REP 144."""
    if not _NAME.fullmatch(name) or len(name) < 2:
        close = re.sub(r"_+", "_", re.sub(r"[^a-z0-9]+", "_", name.lower())).strip("_0123456789")
        raise CourseError(
            f"{name!r} is not a package name (REP 144): use lower-case letters, digits and single "
            "underscores, a letter first, at least two characters"
            f"{f', like {close!r}' if len(close) > 1 else ''}."
        )
    if name in provided_packages() or name in ("test", "launch", "course_lib"):
        raise CourseError(
            f"{name!r} is the name of an existing package; choose another one, like 'my_{name}'."
        )
