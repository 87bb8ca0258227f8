"""The nodes of lessons, exercises and solutions as programs, in the kit and under the real rclpy."""

import ast
import json
import re
import subprocess
import sys
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from course_lib.errors import CourseError
from course_lib.export.module import (
    Statement,
    collect_needed_statements,
    node_classes,
    read_cells,
    statements,
)
from course_lib.grading.inputs import personal_values
from course_lib.grading.task import shipped_catalog
from course_lib.real.check import CALL, MY_VALUES
from course_lib.real.environment import find_environment
from course_lib.real.process import RealProcesses, temporary_folder
from course_lib.ros.time import wall

ROOT = Path(__file__).parents[2]
EACH = Path(__file__).parent / "each_node.py"
STEP = 0.1  # [s]
TIME_LIMIT = 120.0  # [s]
# Packages without which a node cannot run on a robot, or in the environment of the real rclpy.
MISSING = {"course_lib", "ipywidgets", "PIL"}
# Arguments of classes that the notebooks never create from literals; None if they need a robot of
# course_lib.
ARGUMENTS: dict[str, tuple[str, ...]] = {
    "DashboardNode": ("'dashboard'",),
    "Tracker": ("'tracker'",),
    "Faulty": ("'frame'", "'alpha'", "'topic'"),
    "Dog": (),
    "Dancer": (),
}
Outcomes = dict[str, dict[str, Any]]


@cache
def programs() -> dict[str, str]:
    """Return the programs by notebook and class; a node that is there several times is returned once."""
    found: dict[str, str] = {}
    for folder in ("notebooks", "exercises", "solutions"):
        for path in sorted((ROOT / folder).glob("*.ipynb")):
            for call, text in _programs_of(path):
                imported = set(re.findall(r"^\s*(?:from|import) (\w+)", text, re.MULTILINE))
                if not MISSING & imported and text not in found.values():
                    found[f"{path.stem}: {call}"] = text
    return found


def _programs_of(notebook: Path) -> Iterator[tuple[str, str]]:
    code = statements(read_cells(notebook))
    try:
        classes = node_classes(code, ())
    except CourseError:
        # The notebook has no node.
        return
    for class_statement in classes:
        needed_texts = [
            needed.text
            for needed in collect_needed_statements(class_statement, code, [])
            if needed.text != MY_VALUES
        ]
        # As in a program for a robot, the student's own numbers are written out.
        text = CALL.sub(lambda task: repr(_own_values(task[1])), "\n\n".join(needed_texts))
        for call in _calls(class_statement, code):
            yield call, f"{text}\n\n\ndef create_node():\n    return {call}\n"


def _own_values(task: str) -> dict[str, Any]:
    return dict(personal_values(shipped_catalog().task(task), None))


def _calls(class_statement: Statement, code: Sequence[Statement]) -> list[str]:
    """Return the calls that create a node of a class."""
    assert isinstance(class_statement.node, ast.ClassDef)
    name = class_statement.node.name
    if name in ARGUMENTS:
        return [f"{name}({arguments})" for arguments in ARGUMENTS[name]]
    calls = [
        node
        for statement in code
        for node in ast.walk(statement.node)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == name
    ]
    literal = [ast.unparse(call) for call in calls if _has_literals_only(call)]
    return list(dict.fromkeys(literal)) or [f"{name}()"]


def _has_literals_only(call: ast.Call) -> bool:
    values = [*call.args, *(keyword.value for keyword in call.keywords)]
    return all(isinstance(value, ast.Constant) for value in values)


def outcomes_in_kit() -> Outcomes:
    """Return the outcome of each node in the kit."""
    with temporary_folder() as folder:
        nodes, outcomes = folder / "nodes.json", folder / "outcomes.json"
        nodes.write_text(json.dumps(programs()), encoding="utf-8")
        command = [
            sys.executable,
            "-m",
            "course_lib",
            "run",
            "--seconds",
            "10000",
            EACH,
            "--",
            nodes,
            outcomes,
        ]
        process = subprocess.run(
            [str(word) for word in command], capture_output=True, text=True, timeout=TIME_LIMIT, check=False
        )
        assert process.returncode == 0, process.stderr
        found: Outcomes = json.loads(outcomes.read_text(encoding="utf-8"))
    return found


def outcomes_on_ros(expected: Outcomes) -> Outcomes:
    """Return the outcome of each node under the real rclpy, run until it has published as expected."""
    lines: list[str] = []
    with temporary_folder() as folder:
        nodes, kits, outcomes = (folder / f"{name}.json" for name in ("nodes", "expected", "outcomes"))
        nodes.write_text(json.dumps(programs()), encoding="utf-8")
        kits.write_text(json.dumps(expected), encoding="utf-8")
        real = RealProcesses(find_environment(), folder, [EACH], lines.append)
        real.start(EACH, [str(path) for path in (nodes, outcomes, kits)])
        while real.are_running():
            wall.sleep(STEP)
        assert real.end(lambda: None) == 0, lines
        found: Outcomes = json.loads(outcomes.read_text(encoding="utf-8"))
    return found
