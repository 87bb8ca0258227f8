"""The index of ROS packages: which package lies in which folder.

Everything that looks a package up by its name asks this index: `course run`, the `ros2` verbs,
`ament_index_python`, `$(find …)` of launch and xacro, `package://` of displays, `load_robot` and
imports. Sources are found as colcon finds them (colcon-recursive-crawl): at any depth, by the
`<name>` of a `package.xml` whatever the folder is called, not below a folder with an ignore file,
and not inside of another package.
"""

import ast
import atexit
import os
import re
import shutil
import sys
import tempfile
from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from configparser import ConfigParser
from configparser import Error as ConfigError
from dataclasses import dataclass, field
from functools import cache, lru_cache
from importlib.metadata import distributions
from itertools import chain, islice
from pathlib import Path, PurePosixPath
from xml.etree import ElementTree

from course_lib.errors import CourseError, did_you_mean, location_of
from course_lib.ros.programs.missing_packages import how_to_clone, why_not_offered
from course_lib.ros.time import wall
from course_lib.third_party import parse_python

# Number of parent folders of a file in which a checkout, or a folder `src`, is looked for.
SRC_WITHIN = 4
MANIFEST = "package.xml"
IGNORED = frozenset({"COLCON_IGNORE", "AMENT_IGNORE", "CATKIN_IGNORE", "pyvenv.cfg"})
_NOT_SEARCHED = frozenset({"node_modules", "__pycache__", "site-packages"})
# A working folder can be a home directory: the search ends there, the nearest folders first.
_MOST_FOLDERS = 20_000
# How many duplicate names are reported in a line each, and how many more are listed.
_MOST_REPORTED, _MOST_NAMED = 3, 10
# A folder changed this recently may change again within one tick of the file system.
_FRESH_NS = 50_000_000
_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
_NAME = re.compile(r"<name>\s*([\w-]+)\s*</name>")
_reported: set[tuple[Path, ...]] = set()


@dataclass(frozen=True)
class _Crawl:
    """Packages below a folder as (name, folder), with the modification times [ns] of all files read."""

    packages: tuple[tuple[str, Path], ...]
    changed_ns: dict[str, int]
    read_ns: int

    def is_current(self) -> bool:
        """Return whether the folders and manifests are unchanged since they were read."""
        if any(self.read_ns - changed_at < _FRESH_NS for changed_at in self.changed_ns.values()):
            return False
        return all(_changed_ns(path) == changed_at for path, changed_at in self.changed_ns.items())


_crawls: dict[Path, _Crawl] = {}


def packages(*, in_working_folder: bool = True) -> dict[str, Path]:
    """Return the share folder, or the source folder, of each package by name.

    Packages installed under the prefixes on AMENT_PREFIX_PATH take precedence over sources in the
    folders on ROS_PACKAGE_PATH and in the workspace of the working folder. If two folders of a
    workspace have the same package name, this is reported on stderr, once.
    """
    folders_by_name: dict[str, Path] = {}
    for prefix in _paths_in_variable("AMENT_PREFIX_PATH"):
        for manifest in sorted(prefix.glob(f"share/*/{MANIFEST}")):
            if name := name_of(manifest):
                folders_by_name.setdefault(name, manifest.parent)
    for root in source_roots() if in_working_folder else _paths_in_variable("ROS_PACKAGE_PATH"):
        below = _folders_below(root)
        _report_duplicates({name: folders for name, folders in below.items() if name not in folders_by_name})
        for name, folders in below.items():
            folders_by_name.setdefault(name, folders[0])
    return dict(sorted(folders_by_name.items()))


def source_roots() -> list[Path]:
    """Return the folders in which sources of packages are searched."""
    working_folder = Path.cwd()
    workspace = workspace_of(working_folder)
    return list(
        dict.fromkeys(
            [*_paths_in_variable("ROS_PACKAGE_PATH"), *([workspace] if workspace else []), working_folder]
        )
    )


def packages_below(root: Path) -> dict[str, Path]:
    """Return the source folders below a folder, by package name."""
    below = _folders_below(root)
    _report_duplicates(below)
    return {name: folders[0] for name, folders in below.items()}


def _folders_below(root: Path) -> dict[str, list[Path]]:
    """Return all source folders below a folder, by package name.

    A name may have several folders.
    """
    crawl = _crawls.get(root)
    if crawl is None or not crawl.is_current():
        crawl = _crawls[root] = _crawl(root)
    folders_by_name: dict[str, list[Path]] = {}
    for name, folder in crawl.packages:
        folders_by_name.setdefault(name, []).append(folder)
    return folders_by_name


def name_of(manifest: Path) -> str | None:
    """Return the package name in a package.xml, or None."""
    try:
        text = manifest.read_text("utf-8", errors="replace")
    except OSError:
        return None
    name = _NAME.search(_COMMENT.sub("", text))
    return name and name[1]


def has_interfaces(folder: Path) -> bool:
    """Return whether a folder has interface files in its msg, srv or action folder."""
    return any(any(folder.glob(f"{kind}/*.{kind}")) for kind in ("msg", "srv", "action"))


def package_folder_of(path: Path) -> Path | None:
    """Return the folder of the package that contains a file or folder."""
    path = path.resolve()
    return next((folder for folder in (path, *path.parents) if (folder / MANIFEST).is_file()), None)


def workspace_of(path: Path) -> Path | None:
    """Return the source root of the workspace that contains a file or folder.

    It is the folder `src` above the package, otherwise the package's checkout, otherwise the
    package's parent folder. A file outside of any package belongs to a `src` above or next to it,
    or to a checkout with packages at its top level.
    """
    package = package_folder_of(path)
    if package is not None and package.parent.name == "share":
        return None
    base = package.parent if package is not None else path.resolve()
    above = (base, *base.parents)
    if package is not None:
        source = next((folder for folder in above if folder.name == "src"), None)
        return source or _checkout(above[: SRC_WITHIN - 1]) or base
    above = above[:SRC_WITHIN]
    checkout = _checkout(above)
    if checkout is not None and any(checkout.glob(f"*/{MANIFEST}")):
        return checkout
    for folder in above:
        for source in (folder, folder / "src"):
            if source.name == "src" and source.is_dir() and _folders_below(source):
                return source
    return None


def _checkout(folders: tuple[Path, ...]) -> Path | None:
    return next((folder for folder in folders if (folder / ".git").exists()), None)


def _paths_in_variable(variable: str) -> list[Path]:
    return [Path(entry) for entry in os.environ.get(variable, "").split(os.pathsep) if entry]


def _crawl(root: Path) -> _Crawl:
    """Search a folder level by level, so that the limit excludes the most distant folders."""
    read_ns, changed_ns = wall.time_ns(), dict[str, int]()
    manifests: list[tuple[str, Path]] = []
    visited, waiting = set[str](), deque([str(root)])
    while waiting and len(visited) < _MOST_FOLDERS:
        folder = waiting.popleft()
        real = os.path.realpath(folder)
        if real in visited:
            continue
        visited.add(real)
        try:
            with os.scandir(folder) as iterator:
                entries = list(iterator)
        except OSError:
            # The folder was deleted or is not readable, so no package of this user is in it.
            entries = []
        changed_ns[folder] = _changed_ns(folder)
        names = {entry.name for entry in entries}
        if names & IGNORED:
            continue
        if MANIFEST in names:
            manifest = os.path.join(folder, MANIFEST)
            changed_ns[manifest] = _changed_ns(manifest)
            if name := name_of(Path(manifest)):
                manifests.append((name, Path(folder)))
                continue
        waiting += sorted(entry.path for entry in entries if _is_searched(entry))
    return _Crawl(tuple(manifests), changed_ns, read_ns)


def _is_searched(entry: "os.DirEntry[str]") -> bool:
    if entry.name.startswith(".") or entry.name in _NOT_SEARCHED:
        return False
    try:
        return entry.is_dir()
    except OSError:
        return False


def _changed_ns(path: str) -> int:
    try:
        return os.stat(path).st_mtime_ns
    except OSError:
        return 0


def _report_duplicates(below: Mapping[str, list[Path]]) -> None:
    """Report package names with several folders, each once.

    Only the first few are reported in full, because a folder of many workspaces has many of them.
    """
    duplicates = {name: tuple(folders) for name, folders in below.items() if len(folders) > 1}
    new = {name: folders for name, folders in duplicates.items() if folders not in _reported}
    _reported.update(new.values())
    for name, folders in list(new.items())[:_MOST_REPORTED]:
        locations = " and ".join(map(str, folders[:_MOST_REPORTED]))
        more = f" and {len(folders) - _MOST_REPORTED} more" if len(folders) > _MOST_REPORTED else ""
        sys.stderr.write(
            f"warning: there are {len(folders)} packages named '{name}': {locations}{more}. The first one is "
            "used, and colcon refuses to build them. Change the <name> in one package.xml, or put an empty "
            "file COLCON_IGNORE into the folder that is not meant.\n"
        )
    if len(new) > _MOST_REPORTED:
        names = ", ".join(list(new)[_MOST_REPORTED:][:_MOST_NAMED])
        sys.stderr.write(
            f"warning: {len(new) - _MOST_REPORTED} more names are each used by several packages: {names}"
            f"{', …' if len(new) > _MOST_REPORTED + _MOST_NAMED else ''}. If the folder holds several "
            "workspaces, work in one of them.\n"
        )


# A module and a function in it, or a script.
Executable = tuple[str, str] | Path
_FILES = ("setup.cfg", "setup.py", "CMakeLists.txt")
_SOURCE_FOLDERS = ("CMAKE_CURRENT_SOURCE_DIR", "CMAKE_SOURCE_DIR", "PROJECT_SOURCE_DIR")
# Limit on the files of one package.
_MAX_FILES = 10_000
# An entry of console_scripts, or of a component.
# As in Python's entry points, the function may be an attribute of a class, and extras may follow.
_SCRIPT = re.compile(r"\s*([\w.:-]+)\s*=\s*([\w.]+)\s*:\s*(\w+(?:\.\w+)*)\s*(?:\[[^\]]*\]\s*)?")
# A command of CMake.
_COMMAND = re.compile(r"(\w+)\s*\(([^()]*)\)")
# An argument of a command.
_WORD = re.compile(r"\"([^\"]*)\"|([^\s\";]+)")
_VARIABLE = re.compile(r"\$\{(\w+)\}")
_KINDS_OF_INSTALL = ("DESTINATION", "RENAME", "PERMISSIONS", "USE_SOURCE_PERMISSIONS", "PATTERN", "OPTIONAL")


@dataclass
class BuildFiles:
    """The information read from a package's build files.

    Args:
        executables: Executables by name, as `ros2 run` finds them.
        installed: Installed paths, like share/arm/arm.urdf, with the files in the sources.
        package_folders: Folders of Python packages by name; "" is the folder of all others.
        compiled: Names of executables and components that are built from C++.
    """

    executables: dict[str, Executable] = field(default_factory=dict)
    installed: list[tuple[str, Path]] = field(default_factory=list)
    package_folders: dict[str, Path] = field(default_factory=dict)
    compiled: set[str] = field(default_factory=set)


def read_build_files(name: str, sources: Path) -> BuildFiles:
    """Read a package's build files. Raise a CourseError for a syntax error in setup.py."""
    # The cache key contains the folders, because globs depend on them, and the files.
    with os.scandir(sources) as entries:
        watched = [entry for entry in entries if entry.is_dir() or entry.name in _FILES]
        times = {entry.name: entry.stat().st_mtime_ns for entry in watched}
    return _read(name, sources, tuple(sorted(times.items())))


@lru_cache(maxsize=1000)
def _read(name: str, sources: Path, changed_ns: tuple[tuple[str, int], ...]) -> BuildFiles:
    build_files = BuildFiles()
    setup_cfg, setup_py, cmake = (sources / file for file in _FILES)
    _read_setup_cfg(setup_cfg, build_files)
    _read_setup_py(name, setup_py, build_files)
    _read_cmake(name, cmake, build_files)
    catkin_like = sources / "src" / name / "__init__.py"
    if not build_files.package_folders and catkin_like.is_file() and not (sources / name).is_dir():
        build_files.package_folders[""] = sources / "src"
    return build_files


def executables_of(setup: Path) -> dict[str, tuple[str, str]]:
    """Read {executable: (module, function)} from a setup.py.

    Raise a CourseError for a syntax error.
    """
    tree = _tree_of(setup)
    return {} if tree is None else _console_scripts(tree, _Values(tree, setup.parent))


def is_python(file: Path) -> bool:
    """Return whether a file is a Python script, judging by its suffix or its first line."""
    if file.suffix == ".py":
        return True
    try:
        with file.open("rb") as stream:
            first_line = stream.readline(200)
    except OSError:
        return False
    return not file.suffix and first_line.startswith(b"#!") and b"python" in first_line


def _tree_of(setup: Path) -> ast.Module | None:
    if not setup.is_file():
        return None
    try:
        return parse_python(setup.read_text(encoding="utf-8"))
    except SyntaxError as error:
        raise CourseError(f"{setup}, line {error.lineno}: {error.msg}.") from error
    except ValueError as error:
        raise CourseError(f"{setup}: {error}.") from error


def _read_setup_py(name: str, setup: Path, build_files: BuildFiles) -> None:
    tree = _tree_of(setup)
    if tree is None:
        return
    values = _Values(tree, setup.parent)
    build_files.executables.update(_console_scripts(tree, values))
    for node in (node for node in ast.walk(tree) if isinstance(node, ast.keyword)):
        if node.arg == "package_dir" and isinstance(node.value, ast.Dict):
            for key, value in zip(node.value.keys, node.value.values, strict=True):
                for package, folder in zip(values.texts(key), values.texts(value), strict=False):
                    build_files.package_folders[package] = setup.parent / folder
        elif node.arg == "scripts":
            _add_scripts(
                build_files, ((Path(file).name, setup.parent / file) for file in values.texts(node.value))
            )
        elif node.arg == "data_files":
            build_files.installed += _installed_files(node.value, values, setup.parent)
    in_lib = [
        pair for pair in build_files.installed if PurePosixPath(pair[0]).parent == PurePosixPath("lib", name)
    ]
    _add_scripts(build_files, ((PurePosixPath(path).name, file) for path, file in in_lib))


def _installed_files(
    data_files: ast.expr,
    values: "_Values",
    folder: Path,
) -> Iterator[tuple[str, Path]]:
    """Yield each installed path of `data_files` with its file, if both are inside the package."""
    file_list = values.names.get(data_files.id) if isinstance(data_files, ast.Name) else data_files
    for entry in file_list.elts if isinstance(file_list, ast.List | ast.Tuple) else ():
        if not isinstance(entry, ast.Tuple) or len(entry.elts) != 2:
            continue
        destinations, files = (values.texts(element) for element in entry.elts)
        for file in files[:_MAX_FILES] if len(destinations) == 1 else ():
            installed_path = os.path.normpath(os.path.join(destinations[0], os.path.basename(file)))
            inside = (folder / file).resolve().is_relative_to(folder.resolve())
            if inside and (folder / file).exists():
                yield installed_path, folder / file


def _console_scripts(tree: ast.Module, values: "_Values") -> dict[str, tuple[str, str]]:
    texts = [
        text
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant | ast.JoinedStr | ast.BinOp)
        for text in values.texts(node)
    ]
    scripts = filter(None, map(_SCRIPT.fullmatch, texts))
    return {script[1]: (script[2], script[3]) for script in scripts}


def malformed_script(setup: Path) -> str:
    """Describe the first malformed entry of console_scripts in a setup.py, or return ""."""
    tree = _tree_of(setup)
    values = None if tree is None else _Values(tree, setup.parent)
    for node in ast.walk(tree) if tree is not None else ():
        if not isinstance(node, ast.Dict) or values is None:
            continue
        for key, value in zip(node.keys, node.values, strict=True):
            if values.texts(key) != ["console_scripts"] or not isinstance(value, ast.List):
                continue
            for entry in value.elts:
                text = "".join(values.texts(entry))
                if text and not _SCRIPT.fullmatch(text):
                    return (
                        f" {setup}, line {entry.lineno}: {text!r} is not of the form "
                        "'NAME = MODULE:FUNCTION'. Is a comma missing between two entries?"
                    )
    return ""


def _read_setup_cfg(setup: Path, build_files: BuildFiles) -> None:
    parser = ConfigParser(interpolation=None)
    try:
        parser.read(setup, encoding="utf-8")
    except (ConfigError, UnicodeDecodeError):
        # setuptools reports the error when the package is built. Without it, nothing is known from
        # this file.
        return
    scripts = map(
        _SCRIPT.fullmatch, parser.get("options.entry_points", "console_scripts", fallback="").splitlines()
    )
    build_files.executables.update({script[1]: (script[2], script[3]) for script in filter(None, scripts)})
    for line in parser.get("options", "package_dir", fallback="").splitlines():
        package, equals, folder = line.partition("=")
        if equals:
            build_files.package_folders[package.strip()] = setup.parent / folder.strip()
    files = parser.get("options", "scripts", fallback="").split()
    _add_scripts(build_files, ((Path(file).name, setup.parent / file) for file in files))


def _add_scripts(build_files: BuildFiles, scripts: Iterator[tuple[str, Path]]) -> None:
    build_files.executables.update(
        {name: file for name, file in scripts if file.is_file() and is_python(file)}
    )


class _Values:
    """Evaluates expressions in a setup.py that consist of strings, lists, join and glob."""

    def __init__(self, tree: ast.Module, folder: Path) -> None:
        assigned = (node for node in ast.walk(tree) if isinstance(node, ast.Assign))
        self.names = {
            node.targets[0].id: node.value for node in assigned if isinstance(node.targets[0], ast.Name)
        }
        self._folder = folder

    def texts(self, node: ast.expr | None) -> list[str]:
        """Return a string, or the strings of a list; [] for any other expression."""
        try:
            return self._evaluate(node)
        except (ValueError, RecursionError):
            return []

    def _evaluate(self, node: ast.expr | None) -> list[str]:
        match node:
            case ast.Constant(value=str(text)):
                return [text]
            case ast.Name(id=name):
                return self._evaluate(self.names.get(name))
            case ast.List(elts=elements):
                return [text for element in elements for text in self._evaluate(element)]
            case ast.BinOp(left=left, op=ast.Add(), right=right):
                first, second = self._evaluate(left), self._evaluate(right)
                lists = isinstance(left, ast.List | ast.Call) and isinstance(right, ast.List | ast.Call)
                return [*first, *second] if lists else ["".join([*first, *second])]
            case ast.JoinedStr(values=parts):
                texts = [part.value if isinstance(part, ast.FormattedValue) else part for part in parts]
                return ["".join(text for part in texts for text in self._evaluate(part))]
            case ast.Call(func=ast.Attribute(attr=name) | ast.Name(id=name), args=arguments):
                argument_texts = [text for argument in arguments for text in self._evaluate(argument)]
                if argument_texts and name == "join":
                    return [os.path.join(*argument_texts)]
                is_glob = bool(argument_texts) and name in ("glob", "iglob")
                if is_glob and not os.path.isabs(argument_texts[0]) and ".." not in argument_texts[0]:
                    return [
                        str(path.relative_to(self._folder)) for path in _glob(self._folder, argument_texts[0])
                    ]
        raise ValueError("neither a string nor a list of strings")


def _read_cmake(name: str, cmake: Path, build_files: BuildFiles) -> None:
    """Read the executables, Python packages and installed files of a CMakeLists.txt.

    Only variables that are lists are known.
    """
    if not cmake.is_file():
        return
    text = re.sub(r"#.*", "", cmake.read_text("utf-8", errors="replace"))
    source_folder = cmake.parent
    variables = {
        "PROJECT_NAME": [name],
        "CMAKE_PROJECT_NAME": [name],
        "CMAKE_INSTALL_DATADIR": ["share"],
        **{variable: [str(source_folder)] for variable in _SOURCE_FOLDERS},
    }
    for command, arguments in _CMake(variables).run(_COMMAND.findall(text)):
        match command, arguments:
            case "set", [variable, *values]:
                variables[variable] = values
            case "list", ["APPEND", variable, *values]:
                variables[variable] = [*variables.get(variable, []), *values]
            case "file", ["GLOB" | "GLOB_RECURSE", variable, *patterns]:
                relative = [
                    os.path.relpath(one, source_folder) if os.path.isabs(one) else one for one in patterns
                ]
                inside = [pattern for pattern in relative if not pattern.startswith("..")]
                variables[variable] = [
                    str(path) for pattern in inside for path in _glob(source_folder, pattern)
                ]
            case (("add_executable" | "rclcpp_components_register_node"), [first, *rest]):
                build_files.compiled.update(
                    (first, *_argument_after("EXECUTABLE", rest), *_argument_after("PLUGIN", rest))
                )
            case "set_target_properties", words:
                build_files.compiled.update(_argument_after("OUTPUT_NAME", words))
            case "ament_python_install_package", [package, *rest]:
                for folder in _argument_after("PACKAGE_DIR", rest):
                    build_files.package_folders[package] = source_folder / folder
            case "install", ["PROGRAMS" | "FILES" | "DIRECTORY" as kind, *rest]:
                destination = "".join(_argument_after("DESTINATION", rest)).lstrip("/")
                if PurePosixPath(destination) == PurePosixPath("lib", name):
                    _add_scripts(build_files, _installed_by_cmake(source_folder, kind, rest))
                else:
                    build_files.installed += _placed_by_cmake(source_folder, kind, rest, destination)
            case "ament_auto_package", words if "INSTALL_TO_SHARE" in words:
                folders = words[words.index("INSTALL_TO_SHARE") + 1 :]
                build_files.installed += _placed_by_cmake(
                    source_folder, "DIRECTORY", folders, f"share/{name}"
                )


@dataclass(frozen=True)
class _CMakeMacro:
    """A macro or function that a CMakeLists.txt defines."""

    parameters: list[str]
    body: list[tuple[str, str]]


class _CMake:
    """Runs the commands of a CMakeLists.txt that decide which others run, up to a limit.

    Conditions are not evaluated, so all branches of an `if` are read.

    Attributes:
        variables: The lists that are known, by name.
    """

    def __init__(self, variables: dict[str, list[str]]) -> None:
        self.variables = variables
        self._macros: dict[str, _CMakeMacro] = {}
        self._budget = _MAX_FILES

    def run(self, commands: Iterable[tuple[str, str]]) -> Iterator[tuple[str, list[str]]]:
        """Yield commands in lower case with their arguments, also those of loops, macros and functions."""
        rest = deque(commands)
        while rest and self._budget > 0:
            self._budget -= 1
            command, inner = rest.popleft()
            words = _words(inner, self.variables)
            match command.lower(), words:
                case (("macro" | "function") as kind, [name, *parameters]):
                    self._macros[name.lower()] = _CMakeMacro(parameters, _body(rest, kind))
                case "foreach", [variable, *values]:
                    body = _body(rest, "foreach")
                    for item in self._items(values):
                        self._budget -= 1
                        yield from self._run_with({variable: [item]}, body)
                case name, _ if name in self._macros:
                    # While it runs, the name is unknown, so that a recursion ends.
                    macro = self._macros.pop(name)
                    pairs = zip(macro.parameters, words, strict=False)
                    arguments = {parameter: [word] for parameter, word in pairs}
                    yield from self._run_with(arguments | {"ARGN": words[len(arguments) :]}, macro.body)
                    self._macros[name] = macro
                case name, _:
                    yield name, words

    def _run_with(
        self, values: dict[str, list[str]], body: Iterable[tuple[str, str]]
    ) -> Iterator[tuple[str, list[str]]]:
        outer_values = {name: self.variables[name] for name in values if name in self.variables}
        self.variables.update(values)
        if self._budget > 0:
            yield from self.run(body)
        self.variables.update(outer_values)

    def _items(self, values: list[str]) -> list[str]:
        """Return the items of `foreach(variable values…)`."""
        if "LISTS" in values:
            lists = values[values.index("LISTS") + 1 :]
            return [item for name in lists for item in self.variables.get(name, [])]
        return [value for value in values if value not in ("IN", "ITEMS")]


def _body(commands: "deque[tuple[str, str]]", kind: str) -> list[tuple[str, str]]:
    """Remove and return the commands up to the end of a block: `endmacro`, `endfunction` or `endforeach`."""
    body: list[tuple[str, str]] = []
    depth = 1
    while commands:
        command, inner = commands.popleft()
        depth += {kind: 1, f"end{kind}": -1}.get(command.lower(), 0)
        if depth == 0:
            break
        body.append((command, inner))
    return body


def _installed_by_cmake(
    source_folder: Path,
    kind: str,
    arguments: list[str],
) -> Iterator[tuple[str, Path]]:
    """Yield the names and files of one `install(…)`."""
    renamed = _argument_after("RENAME", arguments)
    for word in _sources_of_install(arguments):
        file = source_folder / word
        if kind != "DIRECTORY":
            yield (renamed[0] if renamed else file.name), file
        elif file.is_dir():
            yield from ((one.name, one) for one in sorted(file.iterdir())[:_MAX_FILES])


def _placed_by_cmake(
    source_folder: Path,
    kind: str,
    arguments: list[str],
    destination: str,
) -> Iterator[tuple[str, Path]]:
    """Yield each installed path of one `install(…)` with its file or folder, if both are inside the package.

    `DIRECTORY urdf` installs a folder urdf, and `DIRECTORY urdf/` the content of the folder.
    """
    renamed = _argument_after("RENAME", arguments)
    for word in _sources_of_install(arguments):
        file = source_folder / word
        is_content = kind == "DIRECTORY" and word.endswith("/")
        name = "" if is_content else renamed[0] if renamed else file.name
        if file.exists() and file.resolve().is_relative_to(source_folder.resolve()):
            yield os.path.normpath(os.path.join(destination, name)), file


def _sources_of_install(arguments: list[str]) -> list[str]:
    """Return the files and folders of one `install(…)`, which stand before its other arguments."""
    end = next((at for at, word in enumerate(arguments) if word in _KINDS_OF_INSTALL), len(arguments))
    return arguments[:end]


def _words(inner: str, variables: Mapping[str, list[str]]) -> list[str]:
    """Split the arguments of a CMake command and substitute its variables."""
    arguments: list[str] = []
    for quoted, plain in _WORD.findall(inner):
        single_variable = _VARIABLE.fullmatch(plain)
        if single_variable is not None:
            arguments += variables.get(single_variable[1], [])
        else:
            replaced = _VARIABLE.sub(lambda one: ";".join(variables.get(one[1], [])), quoted or plain)
            arguments.append(replaced)
    return arguments


def _glob(folder: Path, pattern: str) -> list[Path]:
    """Return the sorted paths that match a pattern of a build file; [] for a malformed pattern."""
    if os.path.normpath(pattern) == "." or "\0" in pattern:
        return []
    try:
        return sorted(islice(folder.glob(pattern), _MAX_FILES))
    except (ValueError, NotImplementedError, OSError):
        # pathlib rejects some patterns that CMake and the glob module accept, such as "**.py".
        return []


def _argument_after(keyword: str, arguments: list[str]) -> list[str]:
    """Return a list with the argument after a keyword, or [] without the keyword."""
    return arguments[arguments.index(keyword) + 1 :][:1] if keyword in arguments else []


# Share folders of packages whose executables the kit provides.
_OWN = Path(__file__).parents[1] / "share"
# Suffixes of launch files that are not Python.
LAUNCH_IN_WORDS = (".xml", ".yaml", ".yml", ".launch")
# Limit on the names in a message.
_MOST_NAMES = 12


@dataclass(frozen=True)
class Package:
    """A package: its share folder, the folders in which Python finds it, and its executables.

    `executables` has (module, function) by name, or the file of a script. Names of the form
    `package::Class` are `components`. `modules` are folders of Python packages that have a
    different name, and `compiled` has the names that are built from C++.
    """

    name: str
    share: Path
    python: tuple[Path, ...]
    executables: Mapping[str, Executable]
    modules: Mapping[str, Path] = field(default_factory=dict)
    compiled: frozenset[str] = frozenset()

    @property
    def components(self) -> dict[str, tuple[str, str]]:
        """The (module, class) of each Python component."""
        return {name: at for name, at in self.executables.items() if "::" in name and isinstance(at, tuple)}


def find_package(name: str) -> Package | None:
    """Find a package by its name (see `packages`) or by its folder, which is "." or contains a slash."""
    if ("/" in name or name in (".", "..")) and (Path(name) / MANIFEST).is_file():
        folder = Path(name).resolve()
        source(folder / MANIFEST)
        return _package(name_of(folder / MANIFEST) or folder.name, folder)
    package_folder = packages().get(name, _OWN / name)
    return _package(name, package_folder) if (package_folder / MANIFEST).is_file() else None


def why_not_found(name: str) -> str:
    """Explain that a package is missing, which packages there are, and how to add it."""
    if reason := why_not_offered(name):
        return f"package '{name}' not found: {reason}"
    if reason := _why_skipped(name):
        return f"package '{name}' not found: {reason}"
    if reason := how_to_clone(name):
        return f"package '{name}' not found: {reason}."
    names = list(packages())
    suggestion = did_you_mean(name, names) or "."
    more = f" and {len(names) - _MOST_NAMES} more (ros2 pkg list)" if len(names) > _MOST_NAMES else ""
    searched = list(dict.fromkeys(map(str, [*_paths_in_variable("AMENT_PREFIX_PATH"), *source_roots()])))
    return (
        f"package '{name}' not found, searching: {searched}{suggestion} There is: "
        f"{', '.join(names[:_MOST_NAMES]) or 'none'}{more}. Put its folder, with its package.xml, "
        f"into the workspace's src, or make it: course export FILE --package {name} --out DIR"
    )


def _why_skipped(name: str) -> str:
    """Explain why a folder of the workspace that has a package's manifest is not searched; "" if none has."""
    roots = [root.resolve() for root in source_roots()]
    walks = (os.walk(root) for root in roots)
    for path, folders, files in islice(chain.from_iterable(walks), _MOST_FOLDERS):
        folders[:] = [f for f in folders if not f.startswith(".") and f not in _NOT_SEARCHED]
        if "pyvenv.cfg" in files:
            folders.clear()
        manifest_name = name_of(Path(path, MANIFEST)) if MANIFEST in files else ""
        folder = Path(path)
        if manifest_name is None and folder.name == name:
            return _error_of_manifest(folder / MANIFEST)
        if manifest_name != name:
            continue
        if folder.parent.name == "share":
            prefix = folder.parents[1]
            return (
                f"it is installed in {prefix}, which is not in use. Set AMENT_PREFIX_PATH={prefix}, as "
                "source install/setup.bash does, or put its sources into the workspace's src."
            )
        for above in (folder, *folder.parents):
            if marker := next((above / mark for mark in sorted(IGNORED) if (above / mark).exists()), None):
                return f"its folder {folder} is ignored because of the file {marker}. Remove that file."
            if above != folder and name_of(above / MANIFEST):
                return (
                    f"its folder {folder} is inside of the package in {above}, where colcon does not search. "
                    "Move it next to that package."
                )
    return ""


def _error_of_manifest(manifest: Path) -> str:
    """Explain why no package name can be read from a package.xml."""
    try:
        ElementTree.parse(manifest)
    except ElementTree.ParseError as error:
        return f"{manifest}: not XML: {error.msg}."
    except OSError as error:
        # After `colcon build --symlink-install`, a workspace that was moved has links to nothing.
        link = f" is a link to {os.readlink(manifest)}" if manifest.is_symlink() else ""
        return f"{manifest}{link}: {error.strerror}. Put the sources of the package into the workspace's src."
    line = location_of(manifest, "<name").removeprefix(str(manifest)).replace(" line", ", line")
    return f"{manifest}{line}: expected the element <name>{manifest.parent.name}</name>."


def source(file: Path) -> None:
    """Add the package and workspace of a file to the paths, as `source setup.bash` does."""
    package = package_folder_of(file)
    if package is not None and package.parent.name == "share":
        prefixes = (package.parent, *package.parents[2].glob("*/share"))
        _prepend_paths("AMENT_PREFIX_PATH", [path.parent for path in prefixes])
    elif root := workspace_of(file):
        _prepend_paths("ROS_PACKAGE_PATH", [root])


def python_path(file: Path) -> list[str]:
    """List the folders from which a file of a package imports modules and messages."""
    root = workspace_of(file)
    if root is None:
        return []
    package = package_folder_of(file)
    folders = packages_below(root)
    own_folder = [] if package is None else [package]
    ordered = dict.fromkeys([*own_folder, *folders.values()])
    names = {folder: name for name, folder in folders.items()}
    roots = [path for folder in ordered for path in python_folders(names.get(folder, folder.name), folder)]
    holders = ([package.parent] if package else []) + [root, *(folder.parent for folder in folders.values())]
    return [str(path) for path in dict.fromkeys([*roots, *holders])]


def python_folders(name: str, sources: Path) -> list[Path]:
    """Return the folders in which Python finds the packages of a ROS package's sources."""
    try:
        root_folder = read_build_files(name, sources).package_folders.get("")
    except CourseError:
        # The syntax error in setup.py is reported where one of the executables is started.
        return [sources]
    return [sources] if root_folder is None else [root_folder, sources]


def python_package(file: Path) -> str | None:
    """Return the Python package of a file, because console scripts may use relative imports."""
    if package_folder_of(file) is None:
        return None
    names: list[str] = []
    for folder in file.resolve().parents:
        if (folder / MANIFEST).is_file() or not (folder / "__init__.py").is_file():
            break
        names.append(folder.name)
    return ".".join(reversed(names)) or None


def _prepend_paths(variable: str, paths: list[Path]) -> None:
    entries = [str(path) for path in paths] + os.environ.get(variable, "").split(os.pathsep)
    os.environ[variable] = os.pathsep.join(dict.fromkeys(filter(None, entries)))


def _package(name: str, share: Path) -> Package:
    if share.parent.name != "share":
        build = read_build_files(name, share)
        modules = {module: folder for module, folder in build.package_folders.items() if module}
        return Package(
            name,
            share,
            tuple(python_folders(name, share)),
            build.executables,
            modules,
            frozenset(build.compiled),
        )
    files = sorted((share.parents[1] / "lib" / name).glob("*"))
    scripts = {file.name: file for file in files if file.is_file() and is_python(file)}
    python = tuple(share.parents[1].glob("lib/python*/site-packages"))
    installed = distributions(name=name, path=[str(path) for path in python])
    entry_points = [point for distribution in installed for point in distribution.entry_points]
    console_scripts = {p.name: (p.module, p.attr) for p in entry_points if p.group == "console_scripts"}
    return Package(name, share, python, {**scripts, **console_scripts})


def share_folder(name: str, sources: Path) -> Path:
    """Return a folder in which the files of a package have the paths of their installation."""
    share = PurePosixPath("share", name)
    installed = [(PurePosixPath(place), file) for place, file in read_build_files(name, sources).installed]
    places = dict.fromkeys(
        (str(at.relative_to(share)), file) for at, file in installed if at.is_relative_to(share)
    )
    relocated = tuple((place, file) for place, file in places if not _is_in_place(file, sources / place))
    return _create_links(sources, relocated) if relocated else sources


def _is_in_place(file: Path, place: Path) -> bool:
    """Return whether the sources have an installed file at its place, or a folder's files in theirs."""
    if place.exists() and (place.samefile(file) or not place.is_dir() or not file.is_dir()):
        return True
    return file.is_dir() and place.is_dir() and all((place / one.name).exists() for one in file.iterdir())


@cache
def _create_links(sources: Path, relocated: tuple[tuple[str, Path], ...]) -> Path:
    """Create a folder of links to the sources, and to files and folders at their installed paths."""
    folder = Path(tempfile.mkdtemp(prefix="share_"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    _link_all(sources, folder)
    for place, file in relocated:
        at = folder
        for part in PurePosixPath(place).parts[:-1]:
            at /= part
            _open_folder(at)
        _link(folder / place, file)
    return folder


def _link(place: Path, file: Path) -> None:
    """Create a link to a file or folder. A folder that is there already gets links to the new files."""
    if not place.exists():
        place.symlink_to(file.resolve())
    elif place.is_dir() and file.is_dir() and not place.samefile(file):
        _open_folder(place)
        for one in file.iterdir():
            _link(place / one.name, one)


def _open_folder(place: Path) -> None:
    """Make a folder. A link to a folder of the sources becomes one of links, so that these stay unchanged."""
    if place.is_symlink():
        inner = place.resolve()
        place.unlink()
        place.mkdir()
        _link_all(inner, place)
    place.mkdir(exist_ok=True)


def _link_all(source: Path, target: Path) -> None:
    for path in source.iterdir():
        (target / path.name).symlink_to(path.resolve())
