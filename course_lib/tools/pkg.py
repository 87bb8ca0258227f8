"""`ros2 pkg`, for the kit's packages, the user's packages and new Python packages."""

from argparse import Namespace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.package_template import PackageText, check_package_name, package_files
from course_lib.ros.programs.import_path import STANDIN, provided_packages
from course_lib.ros.programs.packages import find_package, packages
from course_lib.tools.sources import Source
from course_lib.tools.verb import Verb, Write, flag, value

if TYPE_CHECKING:
    from course_lib.ros.programs.package_programs import Executables

# The SPDX identifiers that ament_copyright accepts.
_LICENSES = (
    "Apache-2.0", "BSL-1.0", "BSD-2.0", "BSD-2-Clause", "BSD-3-Clause",
    "GPL-3.0-only", "LGPL-3.0-only", "MIT", "MIT-0",
)  # fmt: skip
_NO_LICENSE = "TODO: License declaration"
_BUILD_TYPES = ("cmake", "ament_cmake", "ament_python")
_SETUP = ("setup.py", "setup.cfg")
_TESTS = ("test/test_copyright.py", "test/test_flake8.py", "test/test_pep257.py")
_MAIN = "def main():\n    print('Hi from {package}.')\n\n\nif __name__ == '__main__':\n    main()\n"


def pkg_verbs(executables: "Executables") -> tuple[Verb, ...]:
    """Return the verbs of `ros2 pkg`, which also list these executables."""
    verb = partial(Verb, "pkg", needs_nodes=False)
    return (
        verb("create", "Create a new ROS 2 package", _CREATE, _create),
        verb("list", "Output a list of available packages", (), partial(_list, executables)),
        verb(
            "executables",
            "Output a list of package specific executables",
            _EXECUTABLES,
            partial(_list_executables, executables),
        ),
        verb("prefix", "Output the prefix path of a package", _PREFIX, partial(_prefix, executables)),
        verb(
            "xml",
            "Output the XML of the package manifest or a specific tag",
            _XML,
            partial(_xml, executables),
        ),
    )


def _list(executables: "Executables", source: Source, arguments: Namespace, write: Write) -> None:
    write("".join(f"{name}\n" for name in _names(executables)))


def _list_executables(
    executables: "Executables",
    source: Source,
    arguments: Namespace,
    write: Write,
) -> None:
    package_name, package_names = arguments.package_name, _names(executables)
    if package_name is not None and package_name not in package_names:
        raise CourseError(f"Package '{package_name}' not found{did_you_mean(package_name, package_names)}")
    for package in package_names if package_name is None else [package_name]:
        package_found = find_package(package)
        names = {name for owner, name in executables if owner == package}
        for name in sorted(names | set(package_found.executables if package_found else ())):
            path = f"{_prefix_of(executables, package)}/lib/{package}/{name}"
            write(f"{path}\n" if arguments.full_path else f"{package} {name}\n")


def _prefix(executables: "Executables", source: Source, arguments: Namespace, write: Write) -> None:
    folder = (_share_folder if arguments.share else _prefix_of)(executables, arguments.package_name)
    write(f"{folder}\n")


def _xml(executables: "Executables", source: Source, arguments: Namespace, write: Write) -> None:
    from xml.etree import ElementTree

    manifest = _share_folder(executables, arguments.package_name) / "package.xml"
    if not manifest.is_file():
        raise CourseError(
            f"Package XML manifest not found: {arguments.package_name} is part of the kit, not a "
            "folder of yours."
        )
    root = ElementTree.parse(manifest).getroot()
    if arguments.tag is None:
        write(ElementTree.tostring(root, encoding="unicode").rstrip("\n") + "\n")
        return
    elements = root.findall(arguments.tag)
    if not elements:
        raise CourseError(f"XML tag not found{did_you_mean(arguments.tag, {child.tag for child in root})}")
    write("".join(f"{element.text}\n" for element in elements))


def _names(executables: "Executables") -> list[str]:
    return sorted({*provided_packages(), *packages(), *(package for package, _ in executables)})


def _prefix_of(executables: "Executables", package: str) -> Path:
    share = _share_folder(executables, package)
    return share.parents[1] if share.parent.name == "share" else share.parent


def _share_folder(executables: "Executables", package: str) -> Path:
    names = _names(executables)
    if package not in names:
        raise CourseError(f"Package not found{did_you_mean(package, names)}")
    return packages().get(package, STANDIN / package)


def _create(source: Source, arguments: Namespace, write: Write) -> None:
    if arguments.license == "?":
        write("Supported licenses:\n" + "\n".join(_LICENSES) + "\n")
        return
    _check(arguments)
    node, maintainer = arguments.node_name, arguments.maintainer_name
    if not maintainer:
        import getpass

        try:
            maintainer = getpass.getuser()
        # On some hubs, users have a numeric ID but no name.
        except (KeyError, OSError) as error:
            raise CourseError(
                "Your name is not configured on this machine: add --maintainer-name NAME."
            ) from error
    text = PackageText(
        arguments.package_name,
        maintainer=maintainer,
        email=arguments.maintainer_email or f"{maintainer}@todo.todo",
        description=arguments.description,
        license=arguments.license,
        version="0.0.0",
        executables={node: f"{node}:main"} if node else {},
        depends=arguments.dependencies,
    )
    write("going to create a new package\n")
    for label, content in (
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
        write(f"{label}: {content}\n")
    _write_files(text, arguments, write)
    if text.license not in _LICENSES:
        licenses = "\n".join(_LICENSES)
        write(
            f"\n[WARNING]: Unknown license '{text.license}'.  This has been set in the package.xml, but no "
            "LICENSE file has been created.\n"
            f"It is recommended to use one of the ament license identifiers:\n{licenses}\n"
        )


def _check(arguments: Namespace) -> None:
    name, kind = arguments.package_name, arguments.build_type
    if kind != "ament_python":
        raise CourseError(
            f"{kind} packages contain C++, which only ROS builds. Use: "
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
            f"\nAborted!\nThe directory already exists: {_join_path(arguments, name)}\nEither remove the "
            "directory or choose a different destination directory or package name"
        )


def _write_files(text: PackageText, arguments: Namespace, write: Write) -> None:
    """Write the files of ros2cli's template in its order.

    A path that ends with a slash is a folder.
    """
    name, files = text.name, package_files(text)
    code = [f"{name}/{node}.py" for node in text.executables]
    files |= dict.fromkeys(code, _MAIN.format(package=name))
    for path in ("", "package.xml", f"{name}/", *_SETUP, "resource/", f"resource/{name}",
                 f"{name}/__init__.py", "test/", *_TESTS, *code):  # fmt: skip
        if path == f"{name}/":
            write("creating source folder\n")
        action = "creating" if path in files else "creating folder"
        write(f"{action} {_join_path(arguments, f'{name}/{path}'.rstrip('/'))}\n")
        target = Path(arguments.destination_directory, name, path)
        if path in files:
            target.write_text(files[path], encoding="utf-8")
        else:
            target.mkdir(parents=True)


def _join_path(arguments: Namespace, path: str) -> str:
    """Join the destination and a path as os.path.join does, which keeps a leading dot."""
    return f"{arguments.destination_directory.rstrip('/')}/{path}"


_CREATE = (
    value("package_name", help="The package name"),
    value("--package-format", type=int, choices=(3,), default=3, help="The package.xml format"),
    value("--description", default="TODO: Package description", help="The description of the package"),
    value("--license", default=_NO_LICENSE, help="The license; '?' lists those that are known"),
    value("--destination-directory", default=".", help="Directory where to create the package directory"),
    value(
        "--build-type", choices=_BUILD_TYPES, default="ament_cmake", help="The build type; here ament_python"
    ),
    value("--dependencies", nargs="+", default=[], help="list of dependencies"),
    value("--maintainer-email", help="email address of the maintainer of this package"),
    value("--maintainer-name", help="name of the maintainer of this package"),
    value("--node-name", help="name of the empty executable"),
)
_PACKAGE = value("package_name", help="The package name")
_EXECUTABLES = (
    value("package_name", nargs="?", help="The package name"),
    flag("--full-path", help="Show full path of each executable"),
)
_PREFIX = (_PACKAGE, flag("--share", help="Show share directory for the package"))
_XML = (_PACKAGE, value("-t", "--tag", help="The XML tag to output (e.g. 'version')"))
