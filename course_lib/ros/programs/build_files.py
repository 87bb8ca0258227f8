"""The build files of a package: the executables and files that setup.py and CMakeLists.txt install.

Nothing is executed. Of setup.py the literal arguments are read, and of CMakeLists.txt the commands
that install files or register executables, with variables, loops, macros and functions.
"""

import ast
import os
import re
from collections import deque
from collections.abc import Iterable, Iterator
from configparser import ConfigParser
from configparser import Error as ConfigError
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import islice
from pathlib import Path, PurePosixPath

from course_lib.errors import CourseError
from course_lib.third_party import MOST_TEXT, check_regular, check_size, parse_python, read_bytes, read_text

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
        resources: Contents, or their files, of resources that a CMakeLists.txt adds to the ament
            index, by type and name.
    """

    executables: dict[str, Executable] = field(default_factory=dict)
    installed: list[tuple[str, Path]] = field(default_factory=list)
    package_folders: dict[str, Path] = field(default_factory=dict)
    compiled: set[str] = field(default_factory=set)
    resources: dict[tuple[str, str], str | Path] = field(default_factory=dict)


def read_build_files(name: str, sources: Path) -> BuildFiles:
    """Read a package's build files. Raise a CourseError for a syntax error in setup.py."""
    # The cache key contains the folders, because globs depend on them, and the files.
    with os.scandir(sources) as entries:
        # These functions return False for symbolic links that are broken or form a circle.
        watched = [
            entry
            for entry in entries
            if os.path.isdir(entry) or (entry.name in _FILES and os.path.isfile(entry))
        ]
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
        check_regular(file)
        with file.open("rb") as stream:
            first_line = stream.readline(200)
    except OSError:
        return False
    return not file.suffix and first_line.startswith(b"#!") and b"python" in first_line


def _tree_of(setup: Path) -> ast.Module | None:
    if not setup.is_file():
        return None
    try:
        check_size(setup, MOST_TEXT)
        # Bytes, because Python then follows a byte order mark and a declared encoding.
        return parse_python(read_bytes(setup))
    except SyntaxError as error:
        raise CourseError(f"{setup}, line {error.lineno}: {error.msg}.") from error
    except (ValueError, OSError) as error:
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

    Of variables, only lists are evaluated.
    """
    if not cmake.is_file():
        return
    try:
        text = re.sub(r"#.*", "", read_text(cmake, errors="replace"))
    except OSError as error:
        raise CourseError(f"{cmake}: {error}.") from error
    source_folder = cmake.parent
    variables = {
        "PROJECT_NAME": [name],
        "CMAKE_PROJECT_NAME": [name],
        "CMAKE_INSTALL_DATADIR": ["share"],
        **{variable: [str(source_folder)] for variable in _SOURCE_FOLDERS},
    }
    for command, arguments in _CMake(variables).run(_COMMAND.findall(text)):
        build_files.resources.update(_registered_by_cmake(name, source_folder, command, arguments))
        match command, arguments:
            case "set", [variable, *values]:
                variables[variable] = values
            case "list", ["APPEND", variable, *values]:
                variables[variable] = [*variables.get(variable, []), *values]
            case "file", ["GLOB" | "GLOB_RECURSE", variable, *patterns]:
                relative = [os.path.relpath(p, source_folder) if os.path.isabs(p) else p for p in patterns]
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


def _registered_by_cmake(
    name: str, source_folder: Path, command: str, arguments: list[str]
) -> dict[tuple[str, str], str | Path]:
    """Return the resources that a command adds to the ament index: their contents or files."""
    match command, arguments:
        case "ament_index_register_resource", [resource_type, *rest]:
            resource_name = "".join(_argument_after("PACKAGE_NAME", rest)) or name
            for file in _argument_after("CONTENT_FILE", rest):
                return {(resource_type, resource_name): source_folder / file}
            return {(resource_type, resource_name): "".join(_argument_after("CONTENT", rest))}
        case "pluginlib_export_plugin_description_file", [base_package, file, *_]:
            resource_type = f"{base_package}__pluginlib__plugin"
            return {(resource_type, name): f"share/{name}/{PurePosixPath(file).name}\n"}
    return {}


@dataclass(frozen=True)
class _CMakeMacro:
    """A macro or function that a CMakeLists.txt defines."""

    parameters: list[str]
    body: list[tuple[str, str]]


class _CMake:
    """Interprets loops, macros and functions of a CMakeLists.txt, up to a number of commands.

    Conditions are not evaluated, so all branches of an `if` are read.

    Attributes:
        variables: The lists that are known, by name.
    """

    def __init__(self, variables: dict[str, list[str]]) -> None:
        self.variables = variables
        self._macros: dict[str, _CMakeMacro] = {}
        self._budget = _MAX_FILES

    def run(self, commands: Iterable[tuple[str, str]]) -> Iterator[tuple[str, list[str]]]:
        """Yield lower-case commands with their arguments, including loops, macros and functions."""
        rest = deque(commands)
        while rest and self._budget > 0:
            self._budget -= 1
            command, inner = rest.popleft()
            words: list[str] = []
            for quoted, plain in _WORD.findall(inner):
                single_variable = _VARIABLE.fullmatch(plain)
                if single_variable is not None:
                    words += self.variables.get(single_variable[1], [])
                else:
                    replaced = _VARIABLE.sub(
                        lambda m: ";".join(self.variables.get(m[1], [])), quoted or plain
                    )
                    words.append(replaced)
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
    """Remove and return the commands up to the end of a block, such as `endmacro`."""
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
            yield from ((path.name, path) for path in sorted(file.iterdir())[:_MAX_FILES])


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
        if os.path.exists(file) and file.resolve().is_relative_to(source_folder.resolve()):
            yield os.path.normpath(os.path.join(destination, name)), file


def _sources_of_install(arguments: list[str]) -> list[str]:
    """Return the files and folders of one `install(…)`, which precede its other arguments."""
    end = next((at for at, word in enumerate(arguments) if word in _KINDS_OF_INSTALL), len(arguments))
    return arguments[:end]


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
