"""The build files of a package: the executables and files that setup.py and CMakeLists.txt install.

Nothing is executed. Of setup.py the literal arguments are read, and of CMakeLists.txt the commands
that install files or register executables, with variables, loops, macros and functions.

The kit starts programs from their sources and needs less than colcon. `build_faults` lists what colcon
or ros2 rejects, so that a package that runs here does not fail on a robot only.
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
from itertools import filterfalse, islice
from pathlib import Path, PurePosixPath
from xml.etree import ElementTree

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


@dataclass
class _CMake:
    """Interprets loops, macros and functions of a CMakeLists.txt, up to a number of commands.

    Conditions are not evaluated, so all branches of an `if` are read.

    Attributes:
        variables: The lists that are known, by name.
    """

    variables: dict[str, list[str]]
    _macros: dict[str, _CMakeMacro] = field(default_factory=dict)
    _budget: int = _MAX_FILES

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
                    items = [value for value in values if value not in ("IN", "ITEMS")]
                    if "LISTS" in values:
                        lists = values[values.index("LISTS") + 1 :]
                        items = [item for name in lists for item in self.variables.get(name, [])]
                    for item in items:
                        self._budget -= 1
                        yield from self._run_with({variable: [item]}, body)
                case name, _ if name in self._macros:
                    # The macro is undefined while its body runs, so that a recursion ends.
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


# Text of a CMakeLists.txt in which parentheses have no meaning: a bracket argument, a bracket
# comment, a comment, a quoted argument and an escaped character. Then the parentheses.
_CMAKE_TOKEN = re.compile(r'#?\[(=*)\[.*?\]\1\]|#[^\n]*|"(?:\\.|[^"\\])*"|\\.|([()"])', re.S)
_BUILT_BY = {"ament_python": "setup.py", "ament_cmake": "CMakeLists.txt", "cmake": "CMakeLists.txt"}
_ONCE_IN_MANIFEST = ("name", "version", "description")
_DEPENDENCIES = ("build_depend", "build_export_depend", "exec_depend")
_IN_MANIFEST = re.compile(
    "name|version|description|maintainer|license|url|author|export|conflict|replace|member_of_group|"
    "(build_|build_export_|buildtool_|buildtool_export_|exec_|doc_|test_|group_)?depend"
)


def build_faults(name: str, sources: Path) -> list[str]:
    """Return a sentence for each reason why a package in its sources does not start on a robot.

    Each rule was observed with colcon and CMake. The build fails, or it lacks the executable, the
    module or the entry of AMENT_PREFIX_PATH that `ros2 run` searches.
    """
    manifest = sources / "package.xml"
    try:
        root = ElementTree.fromstring(read_bytes(manifest))
    except (OSError, ElementTree.ParseError, ValueError, LookupError) as error:
        return [f"{manifest}: not XML: {error}. colcon does not build it as a ROS package."]
    declared = {(element.text or "").strip() for element in root.iterfind("export/build_type")}
    # The build type of ROS 1, if a package.xml states none.
    build_types = declared or {"catkin"}
    builders = [_BUILT_BY[build_type] for build_type in sorted(build_types) if build_type in _BUILT_BY]
    if not builders:
        other = "" if (sources / "CMakeLists.txt").exists() else "ament_python"
        expected = f"<export><build_type>{other or 'ament_cmake'}</build_type></export>"
        fault = f"{manifest}: the build type is {min(build_types)!r}, which Jazzy lacks. Write {expected}."
        return [fault, *_manifest_faults(manifest, root)]
    faults = [f"{sources / file}: missing, and the build type requires it." for file in builders]
    faults = [fault for fault, file in zip(faults, builders, strict=True) if not (sources / file).is_file()]
    faults += _manifest_faults(manifest, root)
    if "setup.py" in builders and (sources / "setup.py").is_file():
        faults += _setup_faults(name, sources)
    if "CMakeLists.txt" in builders and (sources / "CMakeLists.txt").is_file():
        faults += _cmake_faults(name, sources / "CMakeLists.txt", "ament_cmake" in build_types)
    # Executables of one module have the same fault.
    return list(dict.fromkeys(faults))


def _manifest_faults(manifest: Path, root: ElementTree.Element) -> Iterator[str]:
    """Yield faults of a package.xml with which colcon does not build it as a ROS package."""
    texts: dict[str, list[str]] = {}
    for element in root:
        texts.setdefault(element.tag, []).append("".join(element.itertext()).strip())
    for tag in _ONCE_IN_MANIFEST:
        if len(values := texts.get(tag, [])) != 1 or not values[0]:
            yield f"{manifest}: expected one <{tag}> with a text, found {len(list(filter(None, values)))}."
    if "maintainer" not in texts or not all(texts.get("license", [""])):
        yield f"{manifest}: expected <{'license' if 'maintainer' in texts else 'maintainer'}> with a text."
    if any(not element.get("email") for element in root.iterfind("maintainer")):
        yield f'{manifest}: <maintainer> has no address. Write <maintainer email="you@example.com">.'
    version = "".join(texts.get("version", ["0.0.0"]))
    if version and not re.fullmatch(r"\d+\.\d+\.\d+", version):
        yield f"{manifest}: the version is {version!r}, expected three numbers like 0.1.0."
    is_first_format = root.get("format", "1") == "1"
    if is_first_format and (newer := {"depend", "exec_depend"} & texts.keys()):
        yield f'{manifest}: <{max(newer)}> needs <package format="3">.'
    for tag in filterfalse(_IN_MANIFEST.fullmatch, texts):
        if not (is_first_format and tag == "run_depend"):
            yield f"{manifest}: the element <{tag}> does not belong there."
    for tag in _DEPENDENCIES:
        if twice := sorted({*texts.get("depend", [])} & {*texts.get(tag, [])}):
            yield f"{manifest}: {twice[0]} is in <depend> and in <{tag}>. Delete the second one."


def _setup_faults(name: str, sources: Path) -> Iterator[str]:
    """Yield faults of setup.py and setup.cfg with which the build or an executable fails."""
    setup, setup_cfg = sources / "setup.py", sources / "setup.cfg"
    tree = _tree_of(setup)
    assert tree is not None
    values = _Values(tree, sources)
    parser = ConfigParser(interpolation=None)
    try:
        parser.read(setup_cfg, encoding="utf-8-sig")
    except (ConfigError, UnicodeDecodeError) as error:
        yield f"{setup_cfg}: {str(error).splitlines()[0]} Write sections like [install]."
        return
    keywords = {node.arg: node.value for node in ast.walk(tree) if isinstance(node, ast.keyword)}
    for entry in getattr(keywords.get("data_files"), "elts", ()):
        # A search for "**" finds other files here than in setup.py.
        is_read = len(getattr(entry, "elts", ())) == 2 and "**" not in ast.unparse(entry)
        for file in values.texts(entry.elts[1]) if is_read else ():
            if not (sources / file).is_file() and not file.endswith("__pycache__"):
                kind = "a folder" if (sources / file).is_dir() else "missing"
                yield f"{setup}, line {entry.lineno}: the file {file} of data_files is {kind}."
    scripts = _console_scripts(tree, values)
    if not scripts:
        return
    words = [node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)]
    if not any("console_scripts" in word for word in words if isinstance(word, str)):
        yield f"{setup}: expected the key 'console_scripts' in entry_points."
    # Distutils reads a dash in the name of an option as an underscore.
    options = parser.items("install") if parser.has_section("install") else []
    folder = {key.replace("-", "_"): value for key, value in options}.get("install_scripts", "")
    if folder.rstrip("/") != f"$base/lib/{name}":
        found = f"has install_scripts={folder}" if folder else "has no install_scripts"
        yield f"{setup_cfg}: [install] {found}. ros2 run finds executables in $base/lib/{name} only."
    yield from _module_faults(setup, tree, values, scripts, parser)


def _module_faults(
    setup: Path,
    tree: ast.Module,
    values: _Values,
    scripts: dict[str, tuple[str, str]],
    parser: ConfigParser,
) -> Iterator[str]:
    """Yield the modules of executables that setup.py does not install."""
    keywords = {node.arg: node.value for node in ast.walk(tree) if isinstance(node, ast.keyword)}
    packages = keywords.get("packages")
    if packages is None:
        if not parser.has_option("options", "packages") and not keywords.keys() & {"py_modules", None}:
            yield f"{setup}: expected packages=[package_name] in setup()."
        return
    listed = values.texts(packages)
    is_search = isinstance(packages, ast.Call) and getattr(packages.func, "id", "") == "find_packages"
    for executable, (module, _) in scripts.items():
        parents = module.split(".")[:-1]
        paths = [".".join(parents[: depth + 1]) for depth in range(len(parents))]
        for path in paths if is_search else paths[-1:]:
            folder = setup.parent / path.replace(".", "/")
            if is_search and folder.is_dir() and not (folder / "__init__.py").is_file():
                yield f"{folder}: find_packages() of setup.py skips it, as it has no __init__.py."
            elif isinstance(packages, ast.List) and folder.is_dir() and path not in listed:
                yield f"{setup}: packages lacks {path!r}, the module of {executable}."


def _cmake_faults(name: str, cmake: Path, is_ament: bool) -> Iterator[str]:
    """Yield faults with which CMake stops, or ros2 does not find the package."""
    text = read_text(cmake, errors="replace")
    opened = list[int]()
    for token in _CMAKE_TOKEN.finditer(text):
        line = text.count("\n", 0, token.start()) + 1
        if token[2] == "(":
            opened.append(line)
        elif token[2] == '"' or (token[2] and not opened):
            place = "has no second quote" if token[2] == '"' else "closes no command"
            yield f"{cmake}, line {line}: {token[2]} {place}, so CMake stops there."
            return
        elif token[2]:
            opened.pop()
    if opened:
        yield f"{cmake}, line {opened[0]}: this command has no closing parenthesis, so CMake stops there."
        return
    code = _CMAKE_TOKEN.sub(lambda token: "" if token[0].startswith("#") else token[0], text)
    commands = {command.lower(): arguments.split() for command, arguments in _COMMAND.findall(code)}
    if is_ament and not commands.keys() & {"ament_package", "ament_auto_package"}:
        yield f"{cmake}: expected ament_package() as its last command; without it ros2 finds no package."
    project = "".join(commands.get("project", [name])[:1])
    if is_ament and project != name and "$" not in project:
        yield f"{cmake}: project({project}) is not the <name> of package.xml, {name}."
