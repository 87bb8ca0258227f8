"""The command line against outputs of ros2cli 0.32.2 (Jazzy) over the same nodes."""

import json

import pytest
import rclpy

from course_lib.errors import CourseError
from course_lib.ros.time.driving import running_nodes
from tests.tools.conftest import Run
from tests.tools.ros2cli_verbs import COMMANDS, FILE, make_nodes, without_ids

# Where the kit explains what ros2cli reports as an error of Python.
EXPLAINED = {"interface proto std_msgs/msg/Nothing": "Could not find the interface"}


def test_commands_print_and_fail_as_in_ros2cli(run: Run, capsys: pytest.CaptureFixture[str]) -> None:
    rclpy.init()
    running_nodes().extend(make_nodes())
    outcomes = json.loads(FILE.read_text("utf-8"))["outcomes"]
    assert [command for command, _ in outcomes] == COMMANDS
    capsys.readouterr()
    for command, expected in outcomes:
        error = ""
        try:
            run(command)
        except CourseError as raised:
            error = str(raised)
        stdout, stderr = without_ids(run.written), capsys.readouterr().err  # type: ignore[attr-defined]
        assert (command, stdout) == (command, expected["stdout"])
        hints = [line for line in stderr.splitlines(keepends=True) if not line.startswith("hint: ")]
        assert (command, "".join(hints)) == (command, expected["stderr"])
        # The kit's errors begin with those of ros2cli and continue with advice.
        text = EXPLAINED.get(command, expected["error"].partition(": ")[0])
        assert (command, bool(error), error.startswith(text)) == (command, bool(text), True), error
