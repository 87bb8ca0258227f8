"""ROS packages on this machine: their sources, or what colcon has built of them."""

import ast
import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.metadata import distributions
from pathlib import Path

from course_lib.errors import CourseError
from course_lib.ros.not_offered import not_offered

SRC_WITHIN = 4  # folders up from a package, the workspace's src or the checkout is looked for
_OWN = Path(__file__).parent / "share"  # of packages whose executables the kit has
LAUNCH_IN_WORDS = (".xml", ".yaml", ".yml", ".launch")  # suffixes of launch files that are not Python
Executable = tuple[str, str] | Path  # a module and its function, or a script
_PROGRAMS = re.compile(r"install\s*\(\s*PROGRAMS\s+(.*?)\s+DESTINATION\s+[\"']?lib/", re.DOTALL)  # of CMake
_COMPILED = re.compile(
    r"add_executable\s*\(\s*([\w.-]+)|\bEXECUTABLE\s+([\w.-]+)"
)  # of CMake, components too
_SCRIPT = re.compile(r"\s*([\w.:-]+)\s*=\s*([\w.]+):(\w+)\s*")  # of console_scripts, components too


@dataclass(frozen=True)
class Package:
    """A package: the folder with its launch/, config/ and rviz/, where Python finds it, and its executables.

    `executables` gives (module, function) by name, or the file of a script; those whose name is a C++ name,
    `package::Class`, are the `components`.
    """

    name: str
    share: Path
    python: tuple[Path, ...]
    executables: Mapping[str, Executable]

    @property
    def components(self) -> dict[str, tuple[str, str]]:
        """The (module, class) of each component in Python."""
        return {name: at for name, at in self.executables.items() if "::" in name and isinstance(at, tuple)}


def find_package(name: str) -> Package | None:
    """Find a package by its name (see `packages`) or by its folder, whose path has a slash or is a dot."""
    if ("/" in name or name in (".", "..")) and (Path(name) / "package.xml").is_file():
        folder = Path(name).resolve()
        source(folder / "package.xml")
        return _package(_name(folder / "package.xml") or folder.name, folder)
    found = packages().get(name, _OWN / name)
    return _package(name, found) if (found / "package.xml").is_file() else None


def packages() -> dict[str, Path]:
    """Return the share folder of each package, by name.

    First what is installed under the prefixes on AMENT_PREFIX_PATH, then the sources in the folders on
    ROS_PACKAGE_PATH, in the working folder and in its src.
    """
    found: dict[str, Path] = {}
    for manifest in _manifests():
        name = _name(manifest)
        if name:
            found.setdefault(name, manifest.parent)
    return dict(sorted(found.items()))


def _name(manifest: Path) -> str | None:
    name = re.search(r"<name>\s*([\w-]+)\s*</name>", manifest.read_text("utf-8", errors="replace"))
    return name and name[1]


def why_not_found(name: str) -> str:
    """Explain that a package is missing, which ones there are, and how to add it."""
    if reason := not_offered(name):
        return f"package '{name}' not found: {reason}"
    there = ", ".join(packages()) or "none"
    return (
        f"package '{name}' not found, searching: {[str(root) for root in _roots()]}. There is: {there}. Put "
        f"the folder that holds it on ROS_PACKAGE_PATH, or make it: course export FILE --package {name} "
        "--out DIR"
    )


def source(file: Path) -> None:
    """Add the package that a file lies in, and its workspace's, to the paths, as `source setup.bash` does."""
    for folder in file.resolve().parents:
        if (folder / "package.xml").is_file():
            is_built = folder.parent.name == "share"
            prefixes = folder.parents[2].glob("*/share") if is_built else ()
            _put_first("AMENT_PREFIX_PATH", [path.parent for path in (folder.parent, *prefixes) if is_built])
            _put_first("ROS_PACKAGE_PATH", [] if is_built else _workspace(folder))
            return


def python_path(file: Path) -> list[str]:
    """List where a file in a package's sources finds its package, those of its workspace, and messages."""
    file = file.resolve()
    package = next((folder for folder in file.parents if (folder / "package.xml").is_file()), None)
    if package is not None and package.parent.name == "share":
        return []
    own = [] if package is None else [package]
    places = _beside_checked_out(file) if package is None else _workspace(package)
    packages = (path.parent for place in places for path in sorted(place.glob("*/package.xml")))
    return [str(place) for place in (*own, *packages, *places)]


def python_package(file: Path) -> str | None:
    """Return the Python package of a file in a package's sources: console scripts import relative to it."""
    names: list[str] = []
    for folder in file.resolve().parents:
        if (folder / "package.xml").is_file():
            return ".".join(reversed(names)) or None
        if not (folder / "__init__.py").is_file():
            return None
        names.append(folder.name)
    return None


def _workspace(package: Path) -> list[Path]:
    """List the folders that hold packages: the package's own, and those of its workspace.

    A workspace is the folder `src` that a package lies in, else its checkout.
    """
    above = package.parents[:SRC_WITHIN]
    root = next((folder for folder in above if folder.name == "src"), None) or _checkout(package)
    deeper = _holders(root) if root else ()
    return list(dict.fromkeys((package.parent, *([root] if root else ()), *deeper)))


def _beside_checked_out(file: Path) -> list[Path]:
    """List the folders that hold packages, for a file in none, in a checkout with packages at its top."""
    root = _checkout(file)
    return [root, *_holders(root)] if root and any(root.glob("*/package.xml")) else []


def _checkout(path: Path) -> Path | None:
    return next((folder for folder in path.parents[:SRC_WITHIN] if (folder / ".git").exists()), None)


def _holders(root: Path) -> list[Path]:
    """List the folders below a workspace's top that hold packages, to two levels."""
    return sorted(
        {path.parents[1] for path in (*root.glob("*/*/package.xml"), *root.glob("*/*/*/package.xml"))}
    )


def _put_first(variable: str, paths: list[Path]) -> None:
    words = [str(path) for path in paths] + os.environ.get(variable, "").split(os.pathsep)
    os.environ[variable] = os.pathsep.join(dict.fromkeys(filter(None, words)))


def _listed(variable: str) -> list[Path]:
    return [Path(word) for word in os.environ.get(variable, "").split(os.pathsep) if word]


def _roots() -> list[Path]:
    return [*_listed("AMENT_PREFIX_PATH"), *_listed("ROS_PACKAGE_PATH"), Path.cwd(), Path.cwd() / "src"]


def _manifests() -> Iterator[Path]:
    for prefix in _listed("AMENT_PREFIX_PATH"):
        yield from sorted(prefix.glob("share/*/package.xml"))
    for root in _roots()[len(_listed("AMENT_PREFIX_PATH")) :]:
        yield from sorted([*root.glob("package.xml"), *root.glob("*/package.xml")])


def _package(name: str, share: Path) -> Package:
    if share.parent.name != "share":
        executables: dict[str, Executable] = {**executables_of(share / "setup.py")}
        return Package(name, share, (share,), executables | _programs(share / "CMakeLists.txt"))
    scripts = {file.name: file for file in sorted((share.parents[1] / "lib" / name).glob("*.py"))}
    python = tuple(share.parents[1].glob("lib/python*/site-packages"))
    built = distributions(name=name, path=[str(path) for path in python])
    points = [point for one in built for point in one.entry_points if point.group == "console_scripts"]
    return Package(name, share, python, {**scripts, **{p.name: (p.module, p.attr) for p in points}})


def executables_of(setup: Path) -> dict[str, tuple[str, str]]:
    """Return (module, function) by executable from a setup.py, not run; a CourseError for a syntax error."""
    if not setup.is_file():
        return {}
    try:
        tree = ast.parse(setup.read_text(encoding="utf-8"))
    except SyntaxError as error:
        raise CourseError(f"{setup}, line {error.lineno}: {error.msg}.") from error
    texts = [str(node.value) for node in ast.walk(tree) if isinstance(node, ast.Constant)]
    scripts = filter(None, map(_SCRIPT.fullmatch, texts))
    return {script[1]: (script[2], script[3]) for script in scripts}


def is_compiled(package: Package, executable: str) -> bool:
    """Return whether the CMakeLists.txt of a package's sources builds an executable, as of C++."""
    cmake = package.share / "CMakeLists.txt"
    text = re.sub(r"#.*", "", cmake.read_text("utf-8", errors="replace")) if cmake.is_file() else ""
    return any(executable in names for names in _COMPILED.findall(text))


def _programs(cmake: Path) -> dict[str, Executable]:
    """Return the Python scripts that a CMakeLists.txt installs as executables, by name."""
    if not cmake.is_file():
        return {}
    words = " ".join(
        _PROGRAMS.findall(re.sub(r"#.*", "", cmake.read_text("utf-8", errors="replace")))
    ).split()
    files = [cmake.parent / word.strip("\"'") for word in words]
    return {file.name: file for file in files if file.suffix == ".py" and file.is_file()}
