"""The rule that an answer uses only names that a lesson of its week, or an earlier one, has shown."""

import ast
import importlib
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path

from course_lib.course.exercise import BEGIN, END, code_cells, read_notebook, source

OURS = re.compile(r"(rclpy|tf2_\w+|\w+_msgs|launch\w*|course_lib|ament_index_python|rcl_interfaces)(\.|$)")


def untaught(solution: Path, lessons: Sequence[Path]) -> Iterator[str]:
    """Yield each name of ROS or the kit that an answer uses, and that none of these lessons shows."""
    taught = "\n".join(source(cell) for path in lessons for cell in read_notebook(path)["cells"])
    for name in dict.fromkeys(used_in_answers(code_of(solution))):
        if not re.search(rf"\b{re.escape(name)}\b", taught):
            yield f"an answer uses {name}, which no lesson up to this week shows"


def code_of(path: Path) -> str:
    """Return the code without cells that only the solution has: they do by code what students do by hand."""
    cells = (cell for _, cell in code_cells(read_notebook(path)))
    kept = (source(cell) for cell in cells if "solution" not in cell.get("metadata", {}).get("tags", []))
    return "\n".join(re.sub(r"^([%!])", r"# \1", cell, flags=re.MULTILINE) for cell in kept)


def used_in_answers(code: str) -> Iterator[str]:
    """Yield imported names of ROS and the kit, and members of theirs, that stand in an answer."""
    tree, lines = ast.parse(code), lines_of_answers(code)
    imported = dict[str, object]()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module and OURS.match(node.module):
            with suppress(ImportError):  # the run of the solution names it
                module = importlib.import_module(node.module)
                imported |= {a.name: getattr(module, a.name) for a in node.names if hasattr(module, a.name)}
    members = {name for thing in imported.values() for name in dir(thing) if not name.startswith("_")}
    for node in ast.walk(tree):
        match node:
            case ast.Attribute(attr=name) if node.lineno in lines and name in members:
                yield name
            case ast.Name(id=name) if node.lineno in lines and name in imported:
                yield name


def lines_of_answers(code: str) -> set[int]:
    """Return the numbers of the lines between `# solution:` and its end."""
    found, inside = set[int](), False
    for number, line in enumerate(code.splitlines(), 1):
        inside = (inside or bool(BEGIN.match(line))) and END not in line
        found |= {number} if inside else set()
    return found
