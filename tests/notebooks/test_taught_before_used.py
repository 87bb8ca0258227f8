"""Every name of ROS or the kit that an answer uses occurs in a lesson of that week or before."""

import ast
import importlib
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from course_lib.course.exercise import BEGIN, END, read_notebook, source
from course_lib.course.installation import lessons, solutions_dir

SOLUTIONS = sorted(solutions_dir().glob("week*_solution.ipynb"))
OURS = re.compile(r"(rclpy|tf2_\w+|\w+_msgs|launch\w*|course_lib|ament_index_python|rcl_interfaces)(\.|$)")


def text_of_lessons_up_to(week: str) -> str:
    known = [path for path in lessons() if path.stem[:6] <= week]
    return "\n".join(source(cell) for path in known for cell in read_notebook(path)["cells"])


def code_of(path: Path) -> str:
    """The code without cells that only the solution has: they do by code what students do with tools."""
    cells = (cell for cell in read_notebook(path)["cells"] if cell["cell_type"] == "code")
    kept = (source(cell) for cell in cells if "solution" not in cell["metadata"].get("tags", []))
    return "\n".join(re.sub(r"^([%!])", r"# \1", cell, flags=re.MULTILINE) for cell in kept)


def lines_of_answers(code: str) -> set[int]:
    found, inside = set[int](), False
    for number, line in enumerate(code.splitlines(), 1):
        inside = (inside or bool(BEGIN.match(line))) and END not in line
        found |= {number} if inside else set()
    return found


def used_in_answers(code: str) -> Iterator[str]:
    """Yield imported names of ROS and the kit, and members of theirs, that stand in an answer."""
    tree, lines = ast.parse(code), lines_of_answers(code)
    imported = dict[str, object]()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module and OURS.match(node.module):
            module = importlib.import_module(node.module)
            imported |= {alias.name: getattr(module, alias.name) for alias in node.names}
    members = {name for thing in imported.values() for name in dir(thing) if not name.startswith("_")}
    for node in ast.walk(tree):
        match node:
            case ast.Attribute(attr=name) if node.lineno in lines and name in members:
                yield name
            case ast.Name(id=name) if node.lineno in lines and name in imported:
                yield name


@pytest.mark.parametrize("path", SOLUTIONS, ids=lambda path: path.stem[:6])
def test_what_an_answer_uses_was_taught(path: Path) -> None:
    taught = text_of_lessons_up_to(path.stem[:6])
    names = dict.fromkeys(used_in_answers(code_of(path)))
    assert len(names) > 3
    assert [name for name in names if not re.search(rf"\b{re.escape(name)}\b", taught)] == []


def test_a_name_of_an_answer_is_found_and_one_of_given_code_is_not() -> None:
    code = "from rclpy.node import Node\nclass A(Node):\n    def f(self):\n        self.get_name()\n"
    answer = (
        "        # solution: missing\n        self.create_timer(1.0, self.f)\n        # end of solution\n"
    )
    assert list(used_in_answers(code + answer)) == ["create_timer"]
