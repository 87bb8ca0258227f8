"""A class is graded only if the solution gets full marks and the stub gets none."""

import shutil
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from typing import Any

import pytest

import course_lib
from course_lib.errors import CourseError
from course_lib.grading.executors import InlineExecutor
from course_lib.grading.grade import grade, installed_kit, run_preflight
from course_lib.grading.marks import results_in
from course_lib.grading.store import Course
from tests.grading.conftest import FAULTY_CHECK, RIGHT
from tests.grading.test_class import change, count_runs
from tests.patience import PATIENCE

SOLVED = RIGHT.replace(
    "    return length / 2\n", "    # solution: half of it\n    return length / 2\n    # end of solution\n"
).replace(
    "        marker = Marker(type=Marker.CUBE)\n",
    "        # solution: the cube\n        marker = Marker(type=Marker.CUBE)\n        # end of solution\n",
)
SOLVED = SOLVED.replace("answer = 2", "# solution: your number\nanswer = 2").replace(
    'check("week01.answer"', '# end of solution\ncheck("week01.answer"'
)
WriteNotebook = Callable[..., Path]


@pytest.fixture
def solve(course: Course, write_notebook: WriteNotebook, tmp_path: Path) -> Callable[[str], Path]:
    """Writes the course's solution, and hands in one submission."""
    path = write_notebook(tmp_path / "in/ada/week01_exercise.ipynb", RIGHT, student="ada")
    path.with_name("timestamp.txt").write_text("2026-10-11 12:00:00 UTC")

    def write(code: str) -> Path:
        return write_notebook(course.solutions / "week01_solution.ipynb", code, exercise="week01_exercise")

    return write


@pytest.mark.slow
def test_class_is_graded_after_solution_and_stub_get_their_expected_marks(
    course: Course,
    solve: Callable[[str], Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    solve(SOLVED)
    runs = count_runs(monkeypatch)
    assert grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    assert "Solution and stub of week01_exercise: full marks and no marks" in capsys.readouterr().out
    assert [one.row.cells["final"] for one in results_in(tmp_path / "out")] == [110]
    assert len(runs) == 3
    for again in ("resume", "rejudge", ""):
        runs.clear()
        flags = {"resume": again == "resume", "rejudge": again == "rejudge"}
        grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course, **flags)  # type: ignore[arg-type]  # bools
        assert len(runs) == (not again)  # the submission only, and only where that is asked for


@pytest.mark.slow
def test_solution_without_full_marks_stops_grading_and_is_run_again_next_time(
    course: Course, solve: Callable[[str], Path], tmp_path: Path
) -> None:
    path = solve(SOLVED.replace("length / 2", "length / 4"))
    for _ in range(2):
        with pytest.raises(CourseError) as refused:
            grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
        for said in (
            f"nothing is graded: the solution {path} gets 70 of 110 points, expected all",
            "week01.half: 0 of 40; public, 'the value is right': the value is 1.00 m, expected 2.00 m",
            f"Run `course check {path}` to see more",
            str(Path(course_lib.__file__).parent),
        ):
            assert said in str(refused.value)
    assert not (tmp_path / "out/results").exists()
    solve(SOLVED)
    assert grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)


def test_empty_stub_stops_grading_with_the_command_that_generates_it(
    course: Course, solve: Callable[[str], Path], tmp_path: Path
) -> None:
    solve(SOLVED)
    (course.exercises / "week01_exercise.ipynb").write_text("")
    with pytest.raises(CourseError, match=r"it is empty.*from .*: python -m course_lib\.course\.exercise$"):
        grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)


def test_stub_with_points_stops_grading(course: Course, solve: Callable[[str], Path], tmp_path: Path) -> None:
    half = "    # solution: half of it\n    return length / 2\n    # end of solution\n"
    solve(SOLVED.replace(half, "    return length / 2\n"))
    with pytest.raises(CourseError, match=r"the stub .* gets 40 of 110 points, expected none\. week01\.half"):
        grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)


@pytest.mark.slow
def test_check_raising_for_the_solution_stops_grading(
    course: Course, solve: Callable[[str], Path], tmp_path: Path
) -> None:
    solve(SOLVED)
    change(course.solutions / "checks/week01.py", "expect_value(-3.5)", FAULTY_CHECK)
    with pytest.raises(CourseError, match=r"the solution .* 90 of 110 .*week01\.py line 7: IndexError"):
        grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)


def test_exercise_without_a_solution_is_reported(
    course: Course, solve: Callable[[str], Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    solve(SOLVED).unlink()
    assert grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    assert "Not tested: week01_exercise, because" in capsys.readouterr().out


KIT = Path(course_lib.__file__).parent


class Elsewhere(InlineExecutor):
    """Runs submissions with another version of the kit, in a folder."""

    def __init__(self, folder: str) -> None:
        super().__init__()
        self._folder = folder

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> "Future[Any]":
        future: Future[Any] = Future()
        future.set_result((self._folder, "0" * 64))
        return future if fn is installed_kit else super().submit(fn, *args, **kwargs)


@pytest.mark.parametrize(
    ("folder", "message"),
    [
        ("/another/course_lib", f"/another/course_lib, which is not the version in {KIT}"),
        (str(KIT), f"the kit in {KIT} changed while this command ran. Give .* again with --resume"),
    ],
)
def test_kit_version_mismatch_on_a_worker_is_reported_with_each_path_once(
    course: Course, solve: Callable[[str], Path], tmp_path: Path, folder: str, message: str
) -> None:
    solve(SOLVED)
    with pytest.raises(CourseError, match=message):
        run_preflight(
            ["week01_exercise"], course, tmp_path, Elsewhere(folder), InlineExecutor(), may_run=True
        )


PRINT_KIT = """
from contextlib import closing
from course_lib.course.course_file import Limits
from course_lib.grading.run.submission_run import SubmissionRun
from course_lib.grading.task import Scenario, Task
task = Task("week01.kit", "Kit", "value", "kit", ("a", "b", "c"), (Scenario("public"),))
cells = ["import course_lib; kit = course_lib.__file__"]
with closing(SubmissionRun(cells, {task.id: {}}, Limits())) as running:
    print(running.run(task, task.scenarios[0]).returns[0])
"""


@pytest.mark.slow
def test_submissions_run_with_the_grading_kit_instead_of_the_installed_kit(tmp_path: Path) -> None:
    kit = tmp_path / "checkout" / "course_lib"
    shutil.copytree(Path(course_lib.__file__).parent, kit, ignore=shutil.ignore_patterns("__pycache__"))
    tmp_path.chmod(0o755)  # the submissions' user is another one
    command = [sys.executable, "-c", PRINT_KIT]
    process = subprocess.run(
        command, cwd=kit.parent, capture_output=True, text=True, check=False, timeout=PATIENCE
    )
    assert process.stdout.strip() == str(kit / "__init__.py"), process.stderr
