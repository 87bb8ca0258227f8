import json
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import Typed
from tests.test_cli import course

Run = Callable[[str], str]

CELLS = """
%load_ext course_lib
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64
---
class Stub(Node):
    def __init__(self):
        super().__init__("stub")
        self.create_timer(1.0, self.tick)
    def tick(self):
        raise NotImplementedError("nothing is published yet")
from course_lib import spin_for
rclpy.init()
spin_for(2.0, Stub())
"""


@pytest.fixture
def run(tmp_path: Path, in_process: Callable[..., Typed]) -> Run:
    """Return the output of `course run` for failing cells."""

    def run(cells: str) -> str:
        notebook = tmp_path / "cells.ipynb"
        sources = [{"cell_type": "code", "source": source.strip()} for source in cells.split("---")]
        notebook.write_text(json.dumps({"nbformat": 4, "cells": sources}))
        process = in_process("run", notebook.name, cwd=tmp_path)
        assert process.returncode == 1
        return process.stdout + process.stderr

    return run


def test_error_in_a_message_constructor_shows_the_student_line_and_not_generated_code(
    run: Run,
) -> None:
    output = run("%load_ext course_lib\nfrom std_msgs.msg import String\n---\nString(dta='hello')")
    assert "String(dta='hello')" in output
    assert "Invalid arguments passed to constructor: dta" in output
    assert "in __init__" not in output


def test_callback_error_shows_student_lines_and_not_kit_lines(run: Run) -> None:
    output = run(CELLS)
    assert "NotImplementedError: nothing is published yet" in output
    assert 'raise NotImplementedError("nothing is published yet")' in output
    assert "spin_for(2.0, Stub())" in output
    assert "executors.py" not in output


def test_chained_exceptions_are_shown_without_kit_lines(run: Run) -> None:
    answer = (
        "import rclpy\nrclpy.init()\nnode = rclpy.create_node('stub')\n"
        "def tick():\n    raise KeyError('first')\nnode.create_timer(1.0, tick)\n"
        "try:\n    rclpy.spin(node)\nexcept KeyError as error:\n    raise ValueError('second') from error\n"
    )
    output = run(f"%load_ext course_lib\n---\n{answer}")
    assert "raise KeyError('first')" in output
    assert "raise ValueError('second') from error" in output
    assert "executor" not in output


def test_invalid_field_shows_the_text_of_ros_below_the_student_line(run: Run) -> None:
    output = run(CELLS.partition("---")[0] + "---\nFloat64().data = 1")
    assert "Float64().data = 1" in output
    assert "\nAssertionError: The 'data' field must be of type 'float'\nhint: write the number with" in output
    assert "messages" not in output


@pytest.mark.slow
def test_endless_recursion_is_abbreviated_in_every_traceback(run: Run, tmp_path: Path) -> None:
    endless = "def a(n):\n    return b(n + 1)\ndef b(n):\n    return a(n)\na(0)\n"
    program = tmp_path / "program.py"
    program.write_text(endless)
    process = course("run", program.name, cwd=tmp_path)
    assert "more frames of the same lines …" in process.stderr
    start = CELLS.partition("---")[0] + "---\n"
    one_line = "def a(n): return b(n + 1)\ndef b(n): return a(n)\na(0)\n"  # which IPython does not fold
    for shown in (process.stderr, run(start + endless), run(start + one_line)):
        assert shown.count("return b(n + 1)") < 12
        assert "RecursionError: maximum recursion depth exceeded" in shown
        assert "calls a again, endlessly: leave one of these calls out" in shown


def test_display_property_set_as_an_attribute_gets_a_hint(run: Run) -> None:
    cells = (
        CELLS.partition("---")[0] + "from course_lib import Viewer\n---\nViewer().add('TF').enabled = False"
    )
    assert 'hint: write `display["Enabled"] = True`, or `False`.' in run(cells)


def test_syntax_error_keeps_its_caret(run: Run) -> None:
    assert "^" in run(CELLS.partition("---")[0] + "---\ndef f(:")


def test_course_errors_and_interrupts_have_no_traceback(run: Run) -> None:
    start = CELLS.partition("---")[0] + "from course_lib import spin_for\n---\n"
    assert run(start + "spin_for('2')").startswith("CourseError: spin_for('2', …): pass the")
    stopped = "KeyboardInterrupt: the cell was stopped in cell In[1], line 1: raise KeyboardInterrupt.\n"
    assert run(start + "raise KeyboardInterrupt") == stopped
