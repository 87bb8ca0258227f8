"""The index of ROS packages: which package lies in which folder.

Everything that looks up a package by its name uses this index: `course run`, the `ros2` verbs,
`ament_index_python`, `$(find …)` of launch and xacro, `package://` of displays, `load_robot` and
imports. Sources are found as colcon finds them (colcon-recursive-crawl): at any depth, by the
`<name>` of a `package.xml` whatever the folder is called, not below a folder with an ignore file,
and not inside of another package.

A launch file continues without packages that are not installed here. Most public launch files start
a simulator, drivers or controllers along with programs that can run here. While a launch file is
read, the share folder of a missing package is the path that it has on a robot. An action that then
uses the path is skipped with one line in the log, and all other actions start.
"""

import atexit
import os
import re
import shutil
import sys
import tempfile
import tomllib
from collections import deque
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from functools import cache
from itertools import chain, islice
from pathlib import Path, PurePosixPath
from xml.etree import ElementTree

from course_lib.errors import CourseError, did_you_mean, location_of
from course_lib.ros.programs.build_files import Executable, is_python, read_build_files
from course_lib.ros.time import wall
from course_lib.third_party import read_bytes, read_text

INSTALLED = Path("/opt/ros/jazzy/share")
_absent: ContextVar[dict[str, str] | None] = ContextVar("absent", default=None)


class NotAvailableError(CourseError):
    """A part of ROS cannot run here, because a package is missing or a program is compiled."""


@contextmanager
def tolerate_missing(absent: dict[str, str] | None) -> Iterator[None]:
    """Tolerate missing packages within a `with` block and add their names and reasons to `absent`.

    With None, missing packages are errors.
    """
    token = _absent.set(absent)
    try:
        yield
    finally:
        _absent.reset(token)


def is_tolerant() -> bool:
    """Return whether missing packages are tolerated."""
    return _absent.get() is not None


def missing_share_folder(package: str, reason: str) -> Path | None:
    """Return the share folder that a missing package has on a robot, or None if it is an error."""
    absent = _absent.get()
    if absent is None:
        return None
    absent[package] = reason
    return INSTALLED / package


def reason_in(text: str) -> str:
    """Return the reason for the first missing package whose path occurs in a string, or ""."""
    for name in re.findall(rf"{INSTALLED}/([\w.-]+)", text):
        reason = (_absent.get() or {}).get(name)
        if reason:
            return reason
    return ""


_ELSEWHERE = "or run it on a computer with ROS 2 and link to that: course run FILE --robot dds/HOST"
_TABLE = Path(__file__).parents[1] / "not_offered.toml"
_ENTRIES = tomllib.loads(_TABLE.read_text(encoding="utf-8"))
_PROJECTS, _SOURCES = _ENTRIES["project"], _ENTRIES["source"]


def unavailable_reason(package: str) -> str:
    """Return why a package is not available, with an alternative; "" for all other packages."""
    for project in _PROJECTS:
        if re.fullmatch(project["names"], package):
            return f"{project['reason']}, which pip can't install. Here {project['instead']}; {_ELSEWHERE}."
    return ""


def clone_instructions(package: str) -> str:
    """Return instructions to clone a Python package that is not on PyPI, or ""."""
    if package not in _SOURCES:
        return ""
    return f"it is a source package: clone it into the workspace's src, with git clone {_SOURCES[package]}"


# Number of parent folders of a file in which a checkout, or a folder `src`, is looked for.
SRC_WITHIN = 4
MANIFEST = "package.xml"
IGNORED = frozenset({"COLCON_IGNORE", "AMENT_IGNORE", "CATKIN_IGNORE", "pyvenv.cfg"})
_NOT_SEARCHED = frozenset({"node_modules", "__pycache__", "site-packages"})
# A working folder can be a home directory: the search ends there, the nearest folders first.
_MOST_FOLDERS = 20_000
# Number of duplicate names that are reported in a line each, and number of further names that are
# listed.
_MOST_REPORTED, _MOST_NAMED = 3, 10
# A folder changed this recently may change again within one tick of the file system.
_FRESH_NS = 50_000_000
_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
_NAME = re.compile(r"<name>\s*([\w-]+)\s*</name>")
_reported: set[tuple[Path, ...]] = set()


@dataclass(frozen=True)
class _Crawl:
    """Packages below a folder as (name, folder), and the modification times [ns] of read files."""

    packages: tuple[tuple[str, Path], ...]
    changed_ns: dict[str, int]
    read_ns: int

    def is_current(self) -> bool:
        """Return whether the folders and manifests are unchanged since they were read."""
        if any(self.read_ns - changed_at < _FRESH_NS for changed_at in self.changed_ns.values()):
            return False
        return all(_modified_ns(path) == changed_at for path, changed_at in self.changed_ns.items())


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
        text = read_text(manifest, errors="replace")
    except OSError:
        return None
    name = _NAME.search(_COMMENT.sub("", text))
    return name and name[1]


def interface_paths(folder: Path, kind: str) -> Iterator[Path]:
    """Yield a package's interface files of one kind: msg, srv or action.

    They are in the folder of this name, or in another folder if CMakeLists.txt lists them. An .idl
    file next to a file of the same name was created from it by a build, so it is left out.
    """
    yield from folder.glob(f"{kind}/**/*.{kind}")
    for path in folder.glob(f"{kind}/**/*.idl"):
        if not path.with_suffix(f".{kind}").is_file():
            yield path
    for name in listed_interfaces(folder) or ():
        if name.endswith(f".{kind}") and not name.startswith(f"{kind}/") and (folder / name).is_file():
            yield folder / name


def listed_interfaces(folder: Path) -> set[str] | None:
    """Return the interface files that CMakeLists.txt lists; None if it lists none or uses a search."""
    try:
        text = read_text(folder / "CMakeLists.txt", errors="replace")
    except OSError:
        return None
    text = re.sub("#.*", "", text)
    names = set(re.findall(r"[\w./-]+\.(?:msg|srv|action|idl)\b", text))
    return None if "rosidl_generate_interfaces" not in text or "GLOB" in text else names or None


def has_interfaces(folder: Path) -> bool:
    """Return whether a folder has interface files in its msg, srv or action folder."""
    return any(True for kind in ("msg", "srv", "action") for _ in interface_paths(folder, kind))


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
    near = above[: SRC_WITHIN if package is None else SRC_WITHIN - 1]
    checkout = next((folder for folder in near if (folder / ".git").exists()), None)
    if package is not None:
        source = next((folder for folder in above if folder.name == "src"), None)
        return source or checkout or base
    if checkout is not None and any(checkout.glob(f"*/{MANIFEST}")):
        return checkout
    for folder in near:
        for source in (folder, folder / "src"):
            if source.name == "src" and source.is_dir() and _folders_below(source):
                return source
    return None


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
        changed_ns[folder] = _modified_ns(folder)
        names = {entry.name for entry in entries}
        if names & IGNORED:
            continue
        if MANIFEST in names:
            manifest = os.path.join(folder, MANIFEST)
            changed_ns[manifest] = _modified_ns(manifest)
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


def _modified_ns(path: str) -> int:
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
            "used, and colcon does not build them. Change the <name> in one package.xml, or put "
            "an empty file COLCON_IGNORE into the folder that is not meant.\n"
        )
    if len(new) > _MOST_REPORTED:
        names = ", ".join(list(new)[_MOST_REPORTED:][:_MOST_NAMED])
        sys.stderr.write(
            f"warning: {len(new) - _MOST_REPORTED} more names are each used by several packages: {names}"
            f"{', …' if len(new) > _MOST_REPORTED + _MOST_NAMED else ''}. If the folder holds several "
            "workspaces, work in one of them.\n"
        )


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
    """Find a package by name (see `packages`) or by folder, which is "." or contains a slash."""
    if ("/" in name or name in (".", "..")) and (Path(name) / MANIFEST).is_file():
        folder = Path(name).resolve()
        source(folder / MANIFEST)
        return _package(name_of(folder / MANIFEST) or folder.name, folder)
    package_folder = packages().get(name, _OWN / name)
    # Unlike Path.is_file, this function returns False for a name that is too long for a file.
    return _package(name, package_folder) if os.path.isfile(package_folder / MANIFEST) else None


def prefix_of(share: Path) -> Path:
    """Return the installation prefix of a share folder, or the parent of a package's sources."""
    return share.parent.parent if share.parent.name == "share" else share.parent


def not_found_reason(name: str, others: Collection[str] = ()) -> str:
    """Explain that a package is missing, list the available packages, and explain how to add it.

    `others` are packages of which the kit has executables.
    """
    if reason := unavailable_reason(name):
        return f"package '{name}' not found: {reason}"
    if reason := skipped_folder_reason(name):
        return f"package '{name}' not found: {reason}"
    if reason := clone_instructions(name):
        return f"package '{name}' not found: {reason}."
    names = list(packages())
    suggestion = did_you_mean(name, [*names, *others]) or "."
    more = f" and {len(names) - _MOST_NAMES} more (ros2 pkg list)" if len(names) > _MOST_NAMES else ""
    searched = list(dict.fromkeys(map(str, [*_paths_in_variable("AMENT_PREFIX_PATH"), *source_roots()])))
    return (
        f"package '{name}' not found, searching: {searched}{suggestion} There is: "
        f"{', '.join(names[:_MOST_NAMES]) or 'none'}{more}. Put its folder, with its package.xml, "
        f"into the workspace's src, or make it: course export FILE --package {name} --out DIR"
    )


def skipped_folder_reason(name: str) -> str:
    """Explain why a package's folder in the workspace is not used, like an empty one, or return ""."""
    roots = [root.resolve() for root in source_roots()]
    walks = (os.walk(root) for root in roots)
    for path, folders, files in islice(chain.from_iterable(walks), _MOST_FOLDERS):
        folders[:] = [f for f in folders if not f.startswith(".") and f not in _NOT_SEARCHED]
        if "pyvenv.cfg" in files:
            folders.clear()
        manifest_name = name_of(Path(path, MANIFEST)) if MANIFEST in files else ""
        folder = Path(path)
        if folder.name == name and not folders and not files:
            return (
                f"its folder {folder} is empty. A submodule of git is empty after a clone: run "
                "git submodule update --init --recursive there."
            )
        if manifest_name is None and folder.name == name:
            return _error_of_manifest(folder / MANIFEST)
        if manifest_name != name:
            continue
        if folder.parent.name == "share":
            prefix = folder.parents[1]
            return (
                f"it is installed in {prefix}, which is not in use. Set "
                f"AMENT_PREFIX_PATH={prefix}, as source install/setup.bash does, or put its "
                "sources into the workspace's src."
            )
        for above in (folder, *folder.parents):
            if marker := next((above / mark for mark in sorted(IGNORED) if (above / mark).exists()), None):
                return f"its folder {folder} is ignored because of the file {marker}. Remove that file."
            if above != folder and name_of(above / MANIFEST):
                return (
                    f"its folder {folder} is inside of the package in {above}, where colcon does "
                    "not search. Move it next to that package."
                )
    return ""


def _error_of_manifest(manifest: Path) -> str:
    """Explain why no package name can be read from a package.xml."""
    try:
        ElementTree.fromstring(read_bytes(manifest))
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
        prepend_paths("AMENT_PREFIX_PATH", [path.parent for path in prefixes])
    elif root := workspace_of(file):
        prepend_paths("ROS_PACKAGE_PATH", [root])


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


def prepend_paths(variable: str, paths: list[Path]) -> None:
    """Put folders first in an environment variable that lists folders, such as PATH."""
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
    # Imported here: it imports email and socket, 5 % of the start of a program.
    from importlib.metadata import distributions

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
    relocated = tuple(
        (place, file) for place, file in places if not _is_at_source_path(file, sources / place)
    )
    return _create_links(sources, relocated) if relocated else sources


def _is_at_source_path(file: Path, place: Path) -> bool:
    """Return whether an installed file, or all files of a folder, have their paths in the sources."""
    if place.exists() and (place.samefile(file) or not place.is_dir() or not file.is_dir()):
        return True
    return file.is_dir() and place.is_dir() and all((place / f.name).exists() for f in file.iterdir())


@cache
def _create_links(sources: Path, relocated: tuple[tuple[str, Path], ...]) -> Path:
    """Create a folder of links to sources, and to files and folders at their installed paths."""
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
    """Create a link to a file or folder.

    In a folder that already exists, links to the new files are added.
    """
    if not place.exists():
        place.symlink_to(file.resolve())
    elif place.is_dir() and file.is_dir() and not place.samefile(file):
        _open_folder(place)
        for path in file.iterdir():
            _link(place / path.name, path)


def _open_folder(place: Path) -> None:
    """Make a folder.

    A link to a folder of the sources becomes one of links, so that these stay unchanged.
    """
    if place.is_symlink():
        inner = place.resolve()
        place.unlink()
        place.mkdir()
        _link_all(inner, place)
    place.mkdir(exist_ok=True)


def _link_all(source: Path, target: Path) -> None:
    for path in source.iterdir():
        (target / path.name).symlink_to(path.resolve())
