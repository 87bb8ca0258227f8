"""Typical mistakes in the cells of lessons without an exercise: week 0, the reviews and the extra lesson."""

import io
import linecache
import re
import tomllib
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from course_lib.course.exercise import read_notebook, source
from course_lib.course.material import lessons_dir
from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.ros.time.time_lock import time_lock
from course_lib.ros.tracebacks import print_error

PRELUDE = """
import math
import rclpy
from course_lib import Viewer, check, load_robot, predict, quiz, run_live, spin_for
from rclpy.node import Node
from visualization_msgs.msg import Marker
from course_lib.tools.notebook import ros2_magic as ros2, rviz2_magic as rviz2
rclpy.init(args=[])
viewer = Viewer()
people = viewer.add("Marker", "/people", name="People")
node = Node("dog")
publisher = node.create_publisher(Marker, "/people", 10)
"""
# (description, cell); ros2("...") stands for the line %ros2 ... of a cell
CELLS = [
    ("misspells Viewer", "Viewr()"),
    ("misspells run_live", "run_liv(node)"),
    ("misspells a variable", "viwer"),
    ("forgets the first cell", "spin(node)"),
    ("writes true as in other languages", "viewer.use_sim_time = true"),
    ("imports ROS 1", "import rospy"),
    ("imports the viewer from RViz", "import rviz2"),
    ("misspells a package of messages", "from visualization_msg.msg import Marker"),
    ("misspells a message", "from visualization_msgs.msg import Markr"),
    ("imports Node from rclpy", "from rclpy import Node"),
    ("misspells an attribute of the viewer", 'viewer.fixedframe = "world"'),
    ("writes an attribute in capitals", 'viewer.Fixed_Frame = "world"'),
    ("sets a property as an attribute", 'people.topic = "/detections"'),
    ("reads a property as an attribute", "people.topic"),
    ("unticks a display by an attribute", "people.enabled = False"),
    ("misspells a display's name", 'viewer["Peple"]'),
    ("misspells a property", 'people["Topik"] = "/people"'),
    ("gives a property a wrong value", 'people["Enabled"] = 3'),
    ("misspells a class of displays", 'viewer.add("Markr", "/people")'),
    ("gives the message's class to add", "viewer.add(Marker, topic='/people')"),
    ("calls show as in other libraries", "viewer.show()"),
    ("sets the fixed frame like an item", 'viewer["Fixed Frame"] = "map"'),
    ("gives spin_for a text", 'spin_for("2", node)'),
    ("gives spin_for the node first", "spin_for(node, 2.0)"),
    ("runs the class instead of a node", "run_live(Node)"),
    ("runs nothing", "run_live()"),
    ("misspells a quiz", 'quiz("wek00")'),
    ("misspells a prediction", 'predict("week00.grond")'),
    ("checks without an object", 'check("week01.red_cube")'),
    ("checks a task that does not exist", 'check("week01.red_cub", Node)'),
    ("checks an object without the task", "check(Node)"),
    ("checks an object that no cell has defined", 'check("week07.report", dashboard_report)'),
    ("misspells a robot", 'load_robot("ur11")'),
    ("misspells a verb of ros2", 'ros2("topic lst")'),
    ("misspells a command of ros2", 'ros2("topik list")'),
    ("echoes a misspelt topic", 'ros2("topic echo /peple --once")'),
    ("forgets the topic", 'ros2("topic echo")'),
    ("asks for an interface that does not exist", 'ros2("interface show visualization_msgs/msg/Markr")'),
    ("starts RViz2", 'rviz2("-d patrol.rviz")'),
    ("opens a layout that is not there", 'Viewer.from_rviz("patrol.rviz")'),
    ("publishes the class", "publisher.publish(Marker)"),
    ("writes an int", "Marker().scale.x = 1"),
    ("inits twice", "rclpy.init()"),
]


def seen_in_cell(code: str) -> list[str]:
    """Return the last lines of a cell's error or output."""
    written = io.StringIO()
    with use_graph(Graph(notebook=True)), redirect_stdout(written), redirect_stderr(written):
        names: dict[str, object] = {"__name__": "__main__"}
        with time_lock.hold():
            exec(PRELUDE, names)
            # As in a kernel: hints read the line.
            linecache.cache["cell"] = (len(code), None, code.splitlines(True), "cell")
            try:
                exec(compile(code, "cell", "exec"), names)
            except Exception as error:
                print_error(error)
    return _lines(written.getvalue())[-3:]


def _lines(written: str) -> list[str]:
    """Return the output of a cell, without tracebacks and text that differs between runs."""
    # Paths and memory addresses differ between machines.
    text = re.sub(r"0x[0-9a-f]+", "0x…", re.sub(r"\(/[^)]*\)", "(…)", written))
    lines = [line for line in text.splitlines() if line.strip()]
    return [line for line in lines if not line.startswith(("Traceback", "  "))]


# The notebook of each table of lessons/.
LESSONS = {path.stem: path for path in sorted((Path(__file__).parent / "lessons").glob("*.toml"))}
# Statements of the first cells of every lesson, except imports.
_FIRST = "from course_lib.tools.notebook import ros2_magic as ros2"


@dataclass(frozen=True)
class LessonTable:
    """The mistakes in one lesson.

    Args:
        rows: What the student does, and changes of one of the lesson's cells, or a whole new last cell.
        instead: Code that is run instead of the cell that contains a text, because the cell starts processes.
    """

    rows: list[list[Any]]
    instead: dict[str, str]


def lesson_mistakes(lesson: str) -> list[tuple[str, str, list[str]]]:
    """Return each mistake of a lesson: description, changed code, and displayed lines."""
    table = tomllib.loads(LESSONS[lesson].read_text(encoding="utf-8"))
    found = LessonTable(table["rows"], table.get("instead", {}))
    return [(what, *_seen_in_lesson(lesson, found, changes)) for what, *changes in found.rows]


@cache
def _code_cells(lesson: str) -> list[str]:
    notebook = read_notebook(lessons_dir() / f"{lesson}.ipynb")
    return [source(cell) for cell in notebook["cells"] if cell["cell_type"] == "code"]


def _seen_in_lesson(lesson: str, table: LessonTable, changes: list[Any]) -> tuple[str, list[str]]:
    """Return the changed code, and the lines that only the changed lesson shows, from that cell on."""
    cells = _code_cells(lesson)
    if isinstance(changes[0], str):
        return changes[0], _run(table, [*cells, changes[0]], len(cells))
    first = next((n for n, cell in enumerate(cells) if changes[0][0] in cell), None)
    if first is None:
        raise ValueError(f"{lesson}: no cell contains {changes[0][0]!r}")
    new = cells[first]
    for old, put in changes:
        if old not in new:
            raise ValueError(f"{lesson}: the cell does not contain {old!r}")
        new = new.replace(old, put, 1)
    usual = _run(table, cells, first)
    shown = _run(table, [*cells[:first], new, *cells[first + 1 :]], first, changed=first)
    return " … ".join(put.strip() for _, put in changes), [line for line in shown if line not in usual][-3:]


def _run(table: LessonTable, cells: list[str], first: int, changed: int = -1) -> list[str]:
    """Run cells until one fails, and return the output from cell `first` on."""
    written, before = io.StringIO(), io.StringIO()
    with use_graph(Graph(notebook=True)), time_lock.hold():
        names: dict[str, object] = {"__name__": "__main__"}
        exec(_FIRST, names)
        for number, cell in enumerate(cells):
            code = next((put for text, put in table.instead.items() if text in cell), cell)
            code = cell if number == changed else code
            code = re.sub(r"^%load_ext.*", "", code, flags=re.MULTILINE)
            code = re.sub(r"^%ros2 (.*)", lambda line: f"ros2({line[1]!r})", code, flags=re.MULTILINE)
            target = written if number >= first else before
            with redirect_stdout(target), redirect_stderr(target):
                try:
                    exec(compile(code, "cell", "exec"), names)
                except Exception as error:
                    print_error(error)
                    break
    return _lines(written.getvalue())
