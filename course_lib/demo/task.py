"""The task of the demo, which does not belong to a course."""

from typing import Any

from course_lib.grading import Scenario, Task, expect_frame, expect_marker, expect_rate
from course_lib.grading.advice import Advice
from course_lib.grading.check import table_of
from course_lib.grading.judge import judge_task
from course_lib.grading.records import Run
from course_lib.grading.run.scenario import run_in_this_process

TOPIC = "/visualization_marker"
SHAPE = expect_marker(TOPIC, type="CUBE", scale=(1.0, 1.0, 1.0)).titled("a cube with 1 m edges")
TASK = Task(
    "week00.red_cube",
    title="A red cube on the ground",
    kind="node",
    name="RedCubeNode",
    hints=(
        "Which fields does a marker need to be visible?",
        "The cube's edge is 1 m, so its centre is half an edge above the ground.",
        "Set pose.position.z = 0.5.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=6.0,  # [s]
            checks=(
                SHAPE,
                expect_marker(TOPIC, position=(0.0, 0.0, 0.5)).titled("above the origin, on the ground"),
                expect_marker(TOPIC, color=(1.0, 0.0, 0.0, 0.8)).titled("red, alpha 0.8"),
                expect_frame(TOPIC, "map").requiring(SHAPE).titled("in the frame map"),
                expect_rate(TOPIC, 1.0).requiring(SHAPE).titled("once a second"),
            ),
        ),
    ),
)


def check_answer(answer: Any) -> str:
    """Check an answer and return the table of results that a student sees."""
    runs = [Run(scenario, run_in_this_process(TASK, scenario, answer, {})) for scenario in TASK.scenarios]
    result = judge_task(TASK, 100.0, False, runs)
    return str(table_of(TASK, result, [run.evidence for run in runs], None, Advice()))
