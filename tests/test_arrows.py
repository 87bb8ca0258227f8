import ast
from pathlib import Path

import pytest

COURSE_LIB = Path(__file__).parents[1] / "course_lib"
ALL = {"ros", "recording", "viewer", "displays", "robots", "sensors", "tools", "course", "export", "grading"}
# room -> the rooms it may import; `errors` and `arrays` are known to all
ARROWS = {
    "arrays": set[str](),
    "errors": set[str](),
    "ros": set[str](),
    "viewer": set[str](),
    "course": set[str](),
    "recording": {"ros"},
    "displays": {"ros", "viewer", "recording", "robots"},
    "robots": {"ros"},
    "sensors": {"ros"},
    "tools": {"ros", "recording", "displays", "robots"},  # robots: what launch files start
    "export": {"ros", "course"},
    "grading": ALL,
    "demo": ALL | {"demo"},
    "cli": ALL | {"demo", "cli_staff"},
    "cli_staff": ALL,
    "extension": ALL,
    "__main__": {"cli"},
    "__init__": ALL | {"extension"},
}


def imported_rooms(path: Path) -> set[str]:
    names = set[str]()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.module:
            names |= {f"{node.module}.{alias.name}" for alias in node.names}
        elif isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
    return {name.split(".")[1] for name in names if name.startswith("course_lib.")}


@pytest.mark.parametrize(
    "path", sorted(COURSE_LIB.rglob("*.py")), ids=lambda p: str(p.relative_to(COURSE_LIB))
)
def test_imports_follow_the_arrows(path: Path) -> None:
    room = path.relative_to(COURSE_LIB).parts[0].removesuffix(".py")
    assert imported_rooms(path) <= ARROWS[room] | {room, "arrays", "errors", "CourseError"}
