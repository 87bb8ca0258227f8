"""`course demo`: the whole idea in 20 seconds, without a browser."""

from pathlib import Path

from rich.console import Console

from course_lib.errors import CourseError
from course_lib.ros import standin_path

SECONDS = 3.0  # [s] of robot time
PROGRAM = Path(__file__).with_name("red_cube.py")


def demo(out: Path) -> None:
    """Run a node, draw what it shows, check a right and a wrong answer.

    Args:
        out: Folder for the recording, the picture and the page.

    Raises:
        CourseError: If `out` is not a new or an empty folder.
    """
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise CourseError(f"{out} is there already. Remove it or name a new folder: course demo --out NAME")
    standin_path.install()
    console = Console(highlight=False, soft_wrap=True)
    out.mkdir(parents=True, exist_ok=True)
    _run_and_draw(out, console)
    _check_two_answers(console)
    console.print("\nNext: [bold]course lab[/bold] opens the lessons in JupyterLab.")


def _run_and_draw(out: Path, console: Console) -> None:
    from course_lib.displays.render import render_bag
    from course_lib.tools.run import run

    bag, size = out / "bag", (800, 600)  # [px]
    console.print(
        f"[bold]1. Run[/bold] {PROGRAM.name}, an ordinary rclpy program, for {SECONDS:g} s of robot time:"
    )
    run([PROGRAM], seconds=SECONDS, seed=0, bag=bag, args=(), real_time=False)
    console.print("\n[bold]2. Draw[/bold] what it published, as RViz would:")
    for files in ({"png": out / "red_cube.png", "html": None}, {"png": None, "html": out / "red_cube.html"}):
        report = render_bag(bag, rviz=None, at=None, size=size, **files)
        console.print(report.splitlines()[0], markup=False)


def _check_two_answers(console: Console) -> None:
    from course_lib.demo.red_cube import RedCubeNode
    from course_lib.demo.task import look

    class TooLow(RedCubeNode):
        height = 0.2  # [m] half in the ground

    console.print("\n[bold]3. Check[/bold] it as an exercise does: first right, then with the cube too low:")
    for answer in (RedCubeNode, TooLow):
        console.print(look(answer), markup=False)
