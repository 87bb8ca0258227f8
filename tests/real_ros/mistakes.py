"""The table of students' mistakes under the real rclpy."""

import json
import re
from pathlib import Path

from course_lib.real.environment import find_environment
from course_lib.real.process import RealProcesses, temporary_folder
from course_lib.ros.time import wall
from tests.ros.rclpy.test_mistakes import MISTAKES, PROGRAM

EACH = Path(__file__).parent / "each_mistake.py"
STEP = 0.1  # [s]
PROGRAMS = [program for program, _, _ in MISTAKES if "course_lib" not in program]


def outcomes_of_mistakes() -> dict[str, str]:
    """Return the standard error of each program under the real rclpy, by its source.

    Programs that import the kit are left out: it is not there on a robot.
    """
    lines: list[str] = []
    with temporary_folder() as folder:
        prelude, programs, outcomes = (folder / name for name in ("prelude.py", "in.json", "out.json"))
        prelude.write_text(PROGRAM, encoding="utf-8")
        programs.write_text(json.dumps(PROGRAMS), encoding="utf-8")
        real = RealProcesses(find_environment(), folder, [EACH], lines.append)
        real.start(EACH, [str(path) for path in (prelude, programs, outcomes)])
        while real.are_running():
            wall.sleep(STEP)
        assert real.end(lambda: None) == 0, lines
        texts: dict[str, str] = json.loads(outcomes.read_text(encoding="utf-8"))
    return {program: _plain(text) for program, text in texts.items()}


def without_modules(text: str) -> str:
    """Return a text without the modules of exceptions: rclpy's are in a private one."""
    return re.sub(
        r"\b[\w.]+\.(?=\w+(Error|Exception|InvalidHandle)\b)|\brclpy[\w.]*\.(?=InvalidHandle)", "", text
    )


def _plain(text: str) -> str:
    """Return an outcome without times, places and addresses, which differ from run to run."""
    text = without_modules(text)
    text = re.sub(r"\[\d{9,}\.\d+\] ", "", text)
    text = re.sub(r" \((/[^)]*|unknown location)\)|, at [^ ,|'\"]*\.(c|h|cpp|hpp):\d+", "", text)
    text = re.sub(r"'/[^']*/program\.py'", "'program.py'", text)
    text = re.sub(r"/\S*/site-packages/", "", text)
    text = re.sub(r"Goal ID: \[[\d\s]*\]", "Goal ID: []", text)
    return re.sub(r"0x[0-9a-f]+", "0x", text)
