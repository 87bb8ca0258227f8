"""`course run` runs every lesson, and a solution, to its end."""

from pathlib import Path

import pytest

from course_lib.course.material import lessons_dir, solutions_dir
from course_lib.tools.run import run
from tests.export.conftest import write_notebook
from tests.once import Once
from tests.test_cli import course

LESSONS = sorted(lessons_dir().glob("*.ipynb"))
# nbmake runs all solutions strictly, too, and `course verify` all of their cells.
SOLUTION = solutions_dir() / "week05_solution.ipynb"
TIMED = [
    "%load_ext course_lib",
    "import rclpy\nrclpy.init()",
    "%timeout 1 ros2 topic hz /nothing",
    "%timeout 1 ros2 topic hz /nothing",
    "print('ok:', rclpy.ok())",
]


@pytest.mark.slow
@pytest.mark.parametrize("lesson", LESSONS, ids=lambda path: path.stem)
def test_lesson_runs_without_errors(lesson: Path, once: Once) -> None:
    assert once.run_lesson(lesson) == []


@pytest.mark.slow
def test_solution_runs_without_errors(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COURSE_STRICT", "1")
    copy = tmp_path / SOLUTION.name  # it writes files into its own folder
    copy.write_bytes(SOLUTION.read_bytes())
    code = run([copy], seconds=None, seed=0, bag=None, args=(), real_time=False)
    shown = capfd.readouterr()
    assert (code, "Traceback" in shown.out + shown.err) == (0, False), shown


def test_timeout_is_not_reported_as_ctrl_c_of_the_user(tmp_path: Path) -> None:
    write_notebook(tmp_path / "timed.ipynb", TIMED)
    done = course("run", "timed.ipynb", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.count("Stopped after 1.0 s of robot time.\n") == 2
    assert done.stdout.endswith("ok: True\n")


def test_notebook_runs_in_its_own_folder(tmp_path: Path) -> None:
    (tmp_path / "lessons").mkdir()
    write_notebook(tmp_path / "lessons" / "where.ipynb", ["from pathlib import Path\nprint(Path.cwd().name)"])
    assert course("run", "lessons/where.ipynb", cwd=tmp_path).stdout == "lessons\n"


def test_view_is_printed_and_its_picture_is_not_drawn(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("course_lib.viewer.renderer.draw", lambda *_: pytest.fail("it was drawn"))
    write_notebook(tmp_path / "view.ipynb", ["from course_lib import Viewer\nViewer()"])
    code = run([tmp_path / "view.ipynb"], seconds=None, seed=0, bag=None, args=(), real_time=False)
    assert (code, " objects\n" in capfd.readouterr().out) == (0, True)
