import ast
from collections.abc import Iterator, Mapping
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

ROOT = Path(__file__).parents[1]
COURSE_LIB = ROOT / "course_lib"
STANDIN = "course_lib.ros.standin."
ROOMS = {
    "ros",
    "recording",
    "viewer",
    "controls",
    "displays",
    "robots",
    "sensors",
    "tools",
    "course",
    "export",
    "grading",
}
ALL = ROOMS | {"gateway", "authoring", "book", "real"}
EVERYWHERE = {"arrays", "errors", "files", "third_party", "host", "CourseError"}
# room -> the rooms it may import; `arrays`, `errors`, `files`, `third_party` and `host` are known
# to all
ARROWS = {
    "arrays": set[str](),
    "errors": set[str](),
    "third_party": set[str](),
    "files": set[str](),
    "host": set[str](),
    "ros": set[str](),
    "viewer": set[str](),
    "controls": set[str](),
    "course": set[str](),
    "recording": {"ros"},
    "rosbag2_py": {"ros", "recording"},  # of the stand-in, but made of the room of bags
    "displays": {"ros", "viewer", "recording", "robots"},
    "robots": {"ros", "viewer", "controls"},  # viewer: its reader of meshes
    "sensors": {"ros"},
    "tools": {"ros", "recording", "displays", "robots", "controls"},  # robots: nodes that launch files start
    "export": {"ros", "course"},
    "gateway": {"ros", "grading", "tools", "real"},  # grading: platforms' rosters
    "grading": ROOMS,
    "authoring": {"course", "grading", "ros"},
    "book": {"course", "displays", "ros", "viewer"},
    "real": {"ros", "recording", "displays", "grading", "course", "export"},
    "demo": ALL | {"demo"},
    "usual_commands": {"tools"},
    "cli": ALL | {"demo", "usual_commands"},
    "extension": ALL,
    "__main__": {"cli", "usual_commands"},
    "__init__": ALL | {"extension"},
}
# The modules of ros above the stand-in, which run nodes, programs and launch files; the others are
# below it.
ABOVE_THE_STANDIN = {
    "course_lib.ros.programs.launch_program",
    "course_lib.ros.programs.package_programs",
    "course_lib.ros.programs.program",
    "course_lib.ros.robot.connect",
    "course_lib.ros.time.driving",
}


def room_of(path: Path) -> str:
    """Return the room of a file: its folder, or a package of the stand-in that lies above another room."""
    parts = path.relative_to(COURSE_LIB).parts
    above = parts[:2] == ("ros", "standin") and parts[2] in ARROWS
    return parts[2] if above else parts[0].removesuffix(".py")


def module_name(path: Path) -> str:
    """Return a module's full name; a package is named without its __init__."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def modules() -> dict[str, Path]:
    """Return all modules of course_lib by name, without launch files."""
    files = (path for path in sorted(COURSE_LIB.rglob("*.py")) if not path.name.endswith(".launch.py"))
    return {module_name(path): path for path in files if "_course" not in path.parts}


STANDIN_NAMES = {path.name for path in (COURSE_LIB / "ros" / "standin").iterdir()}


@cache
def written_imports(path: Path) -> frozenset[str]:
    """Return all names that a file imports; the stand-in's by their location in course_lib."""
    return frozenset(_imports_of(path))


def _imports_of(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom):
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        else:
            continue
        yield from (f"{STANDIN}{name}" if name.split(".")[0] in STANDIN_NAMES else name for name in names)


@cache
def import_graph() -> dict[str, set[str]]:
    """Return the modules of course_lib that each of them imports, also lazily or for types only.

    A module's own packages do not count: they are imported before it, whatever it writes.
    """
    known = modules()
    graph: dict[str, set[str]] = {}
    for name, path in known.items():
        graph[name] = set()
        for imported in written_imports(path):
            while imported:  # with the packages that it lies in, which Python imports first
                if imported in known and not f"{name}.".startswith(f"{imported}."):
                    graph[name].add(imported)
                imported = imported.rpartition(".")[0]
    return graph


def circles(graph: Mapping[str, set[str]]) -> list[set[str]]:
    """Return the cycles of a graph, each removed before the next is searched."""
    left = {name: set(others) for name, others in graph.items()}
    found: list[set[str]] = []
    while True:
        try:
            TopologicalSorter(left).prepare()
            return found
        except CycleError as error:
            circle = error.args[1]
            found.append(set(circle))
            left[circle[1]].discard(circle[0])


def test_imports_follow_the_documented_dependencies() -> None:
    against_arrows: dict[str, set[str]] = {}
    for path in sorted(COURSE_LIB.rglob("*.py")):
        room = room_of(path)
        rooms = {name.split(".")[1] for name in written_imports(path) if name.startswith("course_lib.")}
        if others := rooms - ARROWS[room] - {room, *EVERYWHERE}:
            against_arrows[str(path.relative_to(COURSE_LIB))] = others
    assert against_arrows == {}


def test_modules_have_no_import_cycles() -> None:
    assert circles(import_graph()) == []


def test_ros_core_does_not_import_the_standin() -> None:
    graph = import_graph()
    core = {name for name in graph if name.startswith("course_lib.ros.") and not name.startswith(STANDIN)}
    knowing = {name for name in core if any(other.startswith(STANDIN) for other in graph[name])}
    above = {name for name in core if graph[name] & ABOVE_THE_STANDIN}
    assert knowing | above <= ABOVE_THE_STANDIN
