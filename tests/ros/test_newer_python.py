"""Programs for the Python of Jazzy, run by an older one."""

import ast
import sys
from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.ros.programs.process import Program
from course_lib.ros.syntax_hints import newer_python_hint

PROGRAMS = [
    'print(f"value {\n    names[\\"a\\"]} m")',
    "print(f'{names['a']}')",
    'print(f"{chr(10).join(["a"])} {"\\n"}")',
    "type Point = tuple[float, float]",
    "def first[T](items: list[T]) -> T: ...",
    "class Box[T]: ...",
]


@pytest.mark.skipif(sys.version_info >= (3, 12), reason="this Python reads the programs")
@pytest.mark.parametrize("program", PROGRAMS)
def test_python_3_12_syntax_gets_a_hint(program: str, tmp_path: Path) -> None:
    (tmp_path / "p.py").write_text(program)
    with pytest.raises(CourseError, match=r"line 1: (?s:.)*\nhint: in Python 3\.12, which ROS 2 Jazzy has,"):
        Program(tmp_path / "p.py", ())


@pytest.mark.parametrize(
    "program",
    [
        "x = (1, 2",
        "def report(x):\nprint(f'x is {x}')",
        "x = 1\n    print(f'x is {x}')",
        "if x == 1 print(f'x is {x}')",
        "print(f'x is {x}' x)",
        "print(f'x is {x)",
        "print(f'x is {x y}')",
        "print(f'x is {x)}')",
    ],
)
def test_other_syntax_errors_get_no_hint(program: str) -> None:
    with pytest.raises(SyntaxError) as error:
        ast.parse(program)
    assert newer_python_hint(error.value) == ""
