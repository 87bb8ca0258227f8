"""`course demo`: run, draw and check a node in 20 seconds, without a browser."""

from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

from course_lib.errors import CourseError
from course_lib.ros.programs import import_path

if TYPE_CHECKING:
    from course_lib.grading import Task

# Robot time [s].
SECONDS = 3.0
PROGRAM = Path(__file__).with_name("red_cube.py")


def demo(out: Path) -> None:
    """Run a node, draw its marker, and check a correct and a wrong answer.

    Args:
        out: Folder for the recording, the picture and the page.

    Raises:
        CourseError: `out` exists and is not an empty folder.
    """
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise CourseError(f"{out} already exists. Remove it or choose a new folder: course demo --out NAME")
    import_path.install()
    from course_lib.demo.red_cube import RedCubeNode
    from course_lib.displays.render import render_bag
    from course_lib.grading.advice import Advice
    from course_lib.grading.check import table_of
    from course_lib.grading.judge import judge_task
    from course_lib.grading.records import Run
    from course_lib.grading.run.scenario import run_in_this_process
    from course_lib.tools.run import run

    console = Console(highlight=False, soft_wrap=True)
    out.mkdir(parents=True, exist_ok=True)

    bag, size = out / "bag", (800, 600)
    console.print(
        f"[bold]1. Run[/bold] {PROGRAM.name}, an ordinary rclpy program, for {SECONDS:g} s of robot time:"
    )
    run([PROGRAM], seconds=SECONDS, seed=0, bag=bag, args=(), real_time=False)
    console.print("\n[bold]2. Draw[/bold] its message, as RViz would:")
    for files in ({"png": out / "red_cube.png", "html": None}, {"png": None, "html": out / "red_cube.html"}):
        report = render_bag(bag, rviz=None, at=None, size=size, **files)
        console.print(report.splitlines()[0], markup=False)

    class TooLow(RedCubeNode):
        # In [m]; part of the cube is below the ground plane.
        height = 0.2

    console.print("\n[bold]3. Check[/bold] it as an exercise does: first right, then with the cube too low:")
    task = red_cube_task()
    for answer in (RedCubeNode, TooLow):
        runs = [Run(scenario, run_in_this_process(task, scenario, answer, {})) for scenario in task.scenarios]
        result = judge_task(task, 100.0, False, runs)
        # The table of results that a student sees.
        results = table_of(task, result, [run.evidence for run in runs], None, Advice())
        console.print(str(results), markup=False)
    console.print("\nNext: [bold]course lab[/bold] opens the lessons in JupyterLab.")


def red_cube_task() -> "Task":
    """Return the task of the demo, which does not belong to a course."""
    from course_lib.grading import Scenario, Task, expect_frame, expect_marker, expect_rate

    topic = "/visualization_marker"
    shape = expect_marker(topic, type="CUBE", scale=(1.0, 1.0, 1.0)).titled("a cube with 1 m edges")
    checks = (
        shape,
        expect_marker(topic, position=(0.0, 0.0, 0.5)).titled("above the origin, on the ground"),
        expect_marker(topic, color=(1.0, 0.0, 0.0, 0.8)).titled("red, alpha 0.8"),
        expect_frame(topic, "map").requiring(shape).titled("in the frame map"),
        expect_rate(topic, 1.0).requiring(shape).titled("once a second"),
    )
    return Task(
        "week00.red_cube",
        title="A red cube on the ground",
        kind="node",
        name="RedCubeNode",
        hints=(
            "Which fields does a marker need to be visible?",
            "The cube's edge is 1 m, so its centre is half an edge above the ground.",
            "Set pose.position.z = 0.5.",
        ),
        scenarios=(Scenario("public", seconds=6.0, checks=checks),),
    )
