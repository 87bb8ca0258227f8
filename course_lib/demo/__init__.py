"""`course demo`: run, draw and check a node in 20 seconds, without a browser."""

from pathlib import Path

from rich.console import Console

from course_lib.errors import CourseError
from course_lib.ros.programs import import_path

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
    from course_lib.demo.task import check_answer
    from course_lib.displays.render import render_bag
    from course_lib.tools.run import run

    console = Console(highlight=False, soft_wrap=True)
    out.mkdir(parents=True, exist_ok=True)

    bag, size = out / "bag", (800, 600)
    console.print(
        f"[bold]1. Run[/bold] {PROGRAM.name}, an ordinary rclpy program, for {SECONDS:g} s of robot time:"
    )
    run([PROGRAM], seconds=SECONDS, seed=0, bag=bag, args=(), real_time=False)
    console.print("\n[bold]2. Draw[/bold] what it published, as RViz would:")
    for files in ({"png": out / "red_cube.png", "html": None}, {"png": None, "html": out / "red_cube.html"}):
        report = render_bag(bag, rviz=None, at=None, size=size, **files)
        console.print(report.splitlines()[0], markup=False)

    class TooLow(RedCubeNode):
        # In [m]; part of the cube is below the ground plane.
        height = 0.2

    console.print("\n[bold]3. Check[/bold] it as an exercise does: first right, then with the cube too low:")
    for answer in (RedCubeNode, TooLow):
        console.print(check_answer(answer), markup=False)
    console.print("\nNext: [bold]course lab[/bold] opens the lessons in JupyterLab.")
