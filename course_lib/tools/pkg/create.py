"""`ros2 pkg create`, for Python packages."""

import getpass
from argparse import Namespace
from pathlib import Path

from course_lib.errors import CourseError
from course_lib.ros.package_template import PackageText, check_package_name, package_files
from course_lib.tools.sources import Source
from course_lib.tools.verb import Verb, Write, value

_LICENSES = (  # what ament_copyright knows, by SPDX identifier
    "Apache-2.0", "BSL-1.0", "BSD-2.0", "BSD-2-Clause", "BSD-3-Clause",
    "GPL-3.0-only", "LGPL-3.0-only", "MIT", "MIT-0",
)  # fmt: skip
_NO_LICENSE = "TODO: License declaration"
_SETUP = ("setup.py", "setup.cfg")
_TESTS = ("test/test_copyright.py", "test/test_flake8.py", "test/test_pep257.py")
_MAIN = "def main():\n    print('Hi from {package}.')\n\n\nif __name__ == '__main__':\n    main()\n"


def create(source: Source, arguments: Namespace, write: Write) -> None:
    """Write a package, and say each step as ros2cli does.

    Raises:
        CourseError: No Python package is asked for, its name is not allowed, or the folder is there.
    """
    if arguments.license == "?":
        write("Supported licenses:\n" + "\n".join(_LICENSES) + "\n")
        return
    _check(arguments)
    text = _text(arguments)
    write("going to create a new package\n")
    for what, said in (
        ("package name", text.name),
        ("destination directory", Path(arguments.destination_directory).absolute()),
        ("package format", 3),
        ("version", text.version),
        ("description", text.description),
        ("maintainer", [f"{text.maintainer} <{text.email}>"]),
        ("licenses", [text.license]),
        ("build type", "ament_python"),
        ("dependencies", text.depends),
        *([("node_name", arguments.node_name)] if arguments.node_name else []),
    ):
        write(f"{what}: {said}\n")
    _write_files(text, arguments, write)
    if text.license not in _LICENSES:
        known = "\n".join(_LICENSES)
        write(
            f"\n[WARNING]: Unknown license '{text.license}'.  This has been set in the package.xml, but no "
            "LICENSE file has been created.\n"
            f"It is recommended to use one of the ament license identifiers:\n{known}\n"
        )


def _text(arguments: Namespace) -> PackageText:
    node, maintainer = arguments.node_name, arguments.maintainer_name or _user()
    return PackageText(
        arguments.package_name,
        maintainer=maintainer,
        email=arguments.maintainer_email or f"{maintainer}@todo.todo",
        description=arguments.description,
        license=arguments.license,
        version="0.0.0",
        executables={node: f"{node}:main"} if node else {},
        depends=arguments.dependencies,
    )


def _user() -> str:
    try:
        return getpass.getuser()
    except (KeyError, OSError) as error:  # on hubs where users are numbers
        raise CourseError("This machine has no name for you: add --maintainer-name NAME.") from error


def _check(arguments: Namespace) -> None:
    name, kind = arguments.package_name, arguments.build_type
    if kind != "ament_python":
        raise CourseError(
            f"{kind} packages hold C++, which ROS itself builds. Write: "
            f"ros2 pkg create --build-type ament_python {name}"
        )
    if name == "test":
        raise CourseError(
            "Aborted since 'ament_python' packages can't be named 'test'. "
            "Please choose a different package name."
        )
    check_package_name(name)
    folder = Path(arguments.destination_directory, name)
    if folder.exists():
        raise CourseError(
            f"\nAborted!\nThe directory already exists: {_shown(arguments, name)}\nEither remove the "
            "directory or choose a different destination directory or package name"
        )


def _write_files(text: PackageText, arguments: Namespace, write: Write) -> None:
    """Write the files that ros2cli writes, in its order; what ends in a slash is a folder."""
    name, files = text.name, package_files(text)
    code = [f"{name}/{node}.py" for node in text.executables]
    files |= dict.fromkeys(code, _MAIN.format(package=name))
    for path in ("", "package.xml", f"{name}/", *_SETUP, "resource/", f"resource/{name}",
                 f"{name}/__init__.py", "test/", *_TESTS, *code):  # fmt: skip
        if path == f"{name}/":
            write("creating source folder\n")
        what = "creating" if path in files else "creating folder"
        write(f"{what} {_shown(arguments, f'{name}/{path}'.rstrip('/'))}\n")
        target = Path(arguments.destination_directory, name, path)
        if path in files:
            target.write_text(files[path], encoding="utf-8")
        else:
            target.mkdir(parents=True)


def _shown(arguments: Namespace, path: str) -> str:
    """Write a path as os.path.join does, a dot before it if that was the destination."""
    return f"{arguments.destination_directory.rstrip('/')}/{path}"


_OPTIONS = (
    value("package_name", help="The package name"),
    value("--package-format", type=int, choices=(3,), default=3, help="The package.xml format"),
    value("--description", default="TODO: Package description", help="The description of the package"),
    value("--license", default=_NO_LICENSE, help="The license; '?' lists those that are known"),
    value("--destination-directory", default=".", help="Directory where to create the package directory"),
    value(
        "--build-type",
        choices=("cmake", "ament_cmake", "ament_python"),
        default="ament_cmake",
        help="The build type; here ament_python",
    ),
    value("--dependencies", nargs="+", default=[], help="list of dependencies"),
    value("--maintainer-email", help="email address of the maintainer of this package"),
    value("--maintainer-name", help="name of the maintainer of this package"),
    value("--node-name", help="name of the empty executable"),
)
PKG_CREATE = Verb("pkg", "create", "Create a new ROS 2 package", _OPTIONS, create, looks=False)
