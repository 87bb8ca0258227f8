import json
from pathlib import Path

from tests.test_cli import course

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


def run(cells: str, folder: Path) -> str:
    notebook = folder / "cells.ipynb"
    sources = [{"cell_type": "code", "source": source.strip()} for source in cells.split("---")]
    notebook.write_text(json.dumps({"nbformat": 4, "cells": sources}))
    done = course("run", notebook.name, cwd=folder)
    assert done.returncode == 1
    return done.stdout + done.stderr


def test_an_error_of_a_message_s_constructor_shows_the_student_s_line_and_not_the_generated_one(
    tmp_path: Path,
) -> None:
    shown = run("%load_ext course_lib\nfrom std_msgs.msg import String\n---\nString(dta='hello')", tmp_path)
    assert "String(dta='hello')" in shown
    assert "Invalid arguments passed to constructor: dta" in shown
    assert "in __init__" not in shown


def test_a_callbacks_error_shows_the_students_lines_and_not_the_kits(tmp_path: Path) -> None:
    shown = run(CELLS, tmp_path)
    assert "NotImplementedError: nothing is published yet" in shown
    assert 'raise NotImplementedError("nothing is published yet")' in shown
    assert "spin_for(2.0, Stub())" in shown
    assert "executors.py" not in shown


def test_an_error_in_the_answer_to_an_error_shows_both_without_the_kit(tmp_path: Path) -> None:
    answer = (
        "import rclpy\nrclpy.init()\nnode = rclpy.create_node('stub')\n"
        "def tick():\n    raise KeyError('first')\nnode.create_timer(1.0, tick)\n"
        "try:\n    rclpy.spin(node)\nexcept KeyError as error:\n    raise ValueError('second') from error\n"
    )
    shown = run(f"%load_ext course_lib\n---\n{answer}", tmp_path)
    assert "raise KeyError('first')" in shown
    assert "raise ValueError('second') from error" in shown
    assert "executor" not in shown


def test_a_wrong_field_shows_ross_text_below_the_students_line(tmp_path: Path) -> None:
    shown = run(CELLS.partition("---")[0] + "---\nFloat64().data = 1", tmp_path)
    assert "Float64().data = 1" in shown
    assert "\nAssertionError: The 'data' field must be of type 'float'\nhint: write the number with" in shown
    assert "messages" not in shown


def test_an_endless_recursion_is_folded_wherever_it_is_shown(tmp_path: Path) -> None:
    endless = "def a(n):\n    return b(n + 1)\ndef b(n):\n    return a(n)\na(0)\n"
    program = tmp_path / "program.py"
    program.write_text(endless)
    done = course("run", program.name, cwd=tmp_path)
    assert "more frames of the same lines …" in done.stderr
    start = CELLS.partition("---")[0] + "---\n"
    one_line = "def a(n): return b(n + 1)\ndef b(n): return a(n)\na(0)\n"  # which IPython does not fold
    for shown in (done.stderr, run(start + endless, tmp_path), run(start + one_line, tmp_path)):
        assert shown.count("return b(n + 1)") < 12
        assert "RecursionError: maximum recursion depth exceeded" in shown
        assert "hint: a function calls itself" in shown


def test_a_property_of_a_display_that_is_set_as_an_attribute_gets_a_hint(tmp_path: Path) -> None:
    cells = (
        CELLS.partition("---")[0] + "from course_lib import Viewer\n---\nViewer().add('TF').enabled = False"
    )
    assert 'hint: write display["Enabled"] = False.' in run(cells, tmp_path)


def test_a_syntax_error_keeps_its_caret(tmp_path: Path) -> None:
    assert "^" in run(CELLS.partition("---")[0] + "---\ndef f(:", tmp_path)


def test_what_the_kit_says_and_an_interrupt_need_no_traceback(tmp_path: Path) -> None:
    start = CELLS.partition("---")[0] + "from course_lib import spin_for\n---\n"
    assert run(start + "spin_for('2')", tmp_path).startswith("CourseError: spin_for('2', …): give the")
    stopped = "KeyboardInterrupt: the cell was stopped in cell In[1], line 1: raise KeyboardInterrupt.\n"
    assert run(start + "raise KeyboardInterrupt", tmp_path) == stopped
