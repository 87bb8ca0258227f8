"""Gradescope's layout in a temporary root: source, submission, results and the metadata."""

import json
import os
import re
import subprocess
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from course_lib.course.course_file import read_course_file
from course_lib.errors import CourseError
from course_lib.grading.marks import MarkedResult
from course_lib.grading.platforms.gradescope import METADATA, grade_upload, results_of, write_autograder
from course_lib.grading.records import ReceiptTime, Result, Submission
from course_lib.grading.store import Course
from tests.grading.autograder_layout import graded_upload
from tests.grading.platforms import zipped
from tests.patience import PATIENCE

ROSTER = "id,name,email\nada1,Ada,ada@x.org\nbob2,Bob,bob@x.org\n"
SOLUTION = Path(__file__).parents[2] / "solutions" / "week01_solution.ipynb"
VISIBILITIES = {"hidden", "after_due_date", "after_published", "visible"}


def metadata(email: str = "ada@x.org", created: str = "2026-10-11T12:00:00.365935-07:00") -> str:
    user = {"email": email, "id": 1234, "name": "<b>Ada</b>"}
    return json.dumps({"created_at": created, "users": [user], "previous_submissions": []})


@pytest.fixture
def root(tmp_path: Path) -> Path:
    root = tmp_path / "autograder"
    (root / "submission").mkdir(parents=True)
    (root / METADATA).write_text(metadata())
    return root


Run = Callable[..., dict[str, Any]]


@pytest.fixture
def run(root: Path, course: Course) -> Run:
    """Grades the upload, and checks the result against Gradescope's documented format."""

    def do(roster: str = ROSTER, hidden: str = "after_published") -> dict[str, Any]:
        if roster:
            (course.solutions / "roster.csv").write_text(roster)
        path = grade_upload("week01", root, hidden=hidden, need="partial", course=course)
        assert path == root / "results/results.json"
        results: dict[str, Any] = json.loads(path.read_text())
        for test in results["tests"]:
            assert test["visibility"] in VISIBILITIES
            assert test.get("output_format", "text") == "text"
            assert 0 <= test.get("score", 0) <= test.get("max_score", 0)
        return results

    return do


def test_correct_answer_gets_all_points_in_visible_and_hidden_tests(
    root: Path, run: Run, right: str, write_notebook: Callable[..., Path]
) -> None:
    write_notebook(root / "submission/week01_exercise.ipynb", right, student="ada1")
    results = run()
    assert results["score"] == 110.0
    shown = {
        test["name"]: (test["score"], test["max_score"], test["visibility"]) for test in results["tests"]
    }
    assert shown == {
        "A red cube": (30.0, 30.0, "visible"),
        "A red cube, hidden checks": (30.0, 30.0, "after_published"),
        "Half of it": (20.0, 20.0, "visible"),
        "Half of it, hidden checks": (20.0, 20.0, "after_published"),
        "Your number (bonus)": (10.0, 10.0, "visible"),
    }
    assert results["execution_time"] > 0
    assert results["extra_data"]["status"] == "graded"


def test_partially_correct_answer_gets_partial_credit_and_reasons(
    root: Path, run: Run, right: str, write_notebook: Callable[..., Path]
) -> None:
    wrong = right.replace("return length / 2", "return abs(length) / 2").replace("z = 0.5", "z = 0.75")
    write_notebook(root / "submission/deep/week01_exercise.ipynb", wrong, student="ada1")
    results = run(hidden="after_due_date")
    tests = {test["name"]: test for test in results["tests"]}
    assert tests["A red cube"]["score"] == 15.0
    assert tests["A red cube"]["status"] == "failed"
    assert "0.25 m" in tests["A red cube"]["output"]
    half = tests["Half of it, hidden checks"]
    assert (half["score"], half["max_score"], half["visibility"]) == (0.0, 20.0, "after_due_date")
    assert "hidden check 1" in half["output"]
    assert "3.5" not in half["output"]
    assert results["score"] == pytest.approx(sum(test["score"] for test in results["tests"]))


def test_late_upload_is_reported_as_late_without_a_total(
    root: Path, run: Run, right: str, write_notebook: Callable[..., Path]
) -> None:
    (root / METADATA).write_text(metadata("BOB@x.org", "2026-10-12T12:00:00.000000+02:00"))
    write_notebook(root / "submission/week01_exercise.ipynb", right, student="bob2")
    (root / "submission/received.csv").write_text("file,received\nweek01_exercise.ipynb,2026-01-01T00:00Z\n")
    results = run()
    assert "1 started day late" in results["output"]
    assert not re.search("points|tasks|99", results["output"])
    assert results["score"] == pytest.approx(99.0)


def visible(results: dict[str, Any]) -> dict[str, Any]:
    """Return the results that Gradescope shows at upload, without the total while a test is hidden."""
    assert any(test["visibility"] != "visible" for test in results["tests"])
    shown = [test for test in results["tests"] if test["visibility"] == "visible"]
    return {"output": results["output"], "tests": [{**test, "number": ""} for test in shown]}


HIDDEN_FAULTS = {  # of half(), which the public check does not find
    "wrong": "return length / 2 if length == 4 else 7.0",
    "raises": "return length / 2 if length == 4 else 1 / 0",
    "endless": "return length / 2 if length == 4 else max(iter(int, 1))",
}


@pytest.mark.sample(1)
@pytest.mark.parametrize("fault", HIDDEN_FAULTS)
def test_upload_page_is_independent_of_hidden_checks(
    root: Path, run: Run, right: str, course: Course, write_notebook: Callable[..., Path], fault: str
) -> None:
    settings = course.exercises / "course.toml"
    settings.write_text(settings.read_text().replace("scenario_seconds = 30", "scenario_seconds = 2"))
    (root / METADATA).write_text(
        metadata(created="2026-10-14T12:00:00Z")
    )  # late, so that points are taken off
    path = root / "submission/week01_exercise.ipynb"
    write_notebook(path, right, student="ada1")
    good = run()
    write_notebook(path, right.replace("return length / 2", HIDDEN_FAULTS[fault]), student="ada1")
    bad = run()
    assert bad["score"] < good["score"]
    assert visible(bad) == visible(good)


def test_total_is_shown_on_upload_if_requested(
    root: Path, right: str, course: Course, write_notebook: Callable[..., Path]
) -> None:
    (root / METADATA).write_text(metadata(created="2026-10-12T12:00:00Z"))
    write_notebook(root / "submission/week01_exercise.ipynb", right, student="ada1")
    path = grade_upload("week01", root, hidden="hidden", need="partial", show_total=True, course=course)
    output = json.loads(path.read_text())["output"]
    assert "3 of 3 tasks have full marks" in output
    assert "Total: 110 - 11 = 99 of 100 points" in output


def test_file_of_another_student_gets_no_points_with_the_reason(
    root: Path, run: Run, right: str, write_notebook: Callable[..., Path]
) -> None:
    (root / METADATA).write_text(metadata("bob@x.org"))
    write_notebook(root / "submission/week01_exercise.ipynb", right, student="ada1")
    results = run()
    assert results["score"] == 0
    assert sum(test.get("score", 0) for test in results["tests"]) == 0
    assert "No points: the file has the ID ada1, but bob2 submitted it" in results["output"]


@pytest.mark.parametrize("claimed", ["ada1", "eve3", None])
@pytest.mark.parametrize(("email", "named"), [("eve@x.org", "eve@x.org"), ("", "no address")])
def test_unknown_address_gets_all_points_except_for_personal_values(
    root: Path, run: Run, right: str, write_notebook: Callable[..., Path], email: str, named: str,
    claimed: str | None,
) -> None:  # fmt: skip
    (root / METADATA).write_text(metadata(email))
    names = {"student": claimed} if claimed else {}
    write_notebook(root / "submission/week01_exercise.ipynb", right, **names)
    results = run()
    scores = {test["name"]: test["score"] for test in results["tests"]}
    assert scores == {
        "A red cube": 30.0,
        "A red cube, hidden checks": 30.0,
        "Half of it": 20.0,
        "Half of it, hidden checks": 20.0,
        "Your number (bonus)": 0.0,
    }
    assert results["score"] == 100.0
    assert f"Your address on Gradescope ({named}) is not in the class list" in results["output"]
    assert "10 points are pending in Your number" in results["output"]
    number = next(test for test in results["tests"] if test["name"].startswith("Your number"))
    assert "counts once your address is in the class list" in number["output"]


def test_total_of_an_unknown_address_excludes_pending_points(
    root: Path, right: str, course: Course, write_notebook: Callable[..., Path]
) -> None:
    (root / METADATA).write_text(metadata("eve@x.org", created="2026-10-12T12:00:00Z"))
    (course.solutions / "roster.csv").write_text(ROSTER)
    write_notebook(root / "submission/week01_exercise.ipynb", right, student="ada1")
    path = grade_upload("week01", root, hidden="hidden", need="partial", show_total=True, course=course)
    results = json.loads(path.read_text())
    assert "2 of 3 tasks have full marks" in results["output"]
    assert "Total: 100 - 10 = 90 of 100 points" in results["output"]
    assert results["score"] == 90.0


def test_show_total_option_is_passed_to_the_autograder_zip(tmp_path: Path) -> None:
    options = {"hidden": "hidden", "need": "partial", "roster": None, "show_total": True}
    write_autograder("week03", tmp_path / "a.zip", **options)  # type: ignore[arg-type]
    with zipfile.ZipFile(tmp_path / "a.zip") as archive:
        script = archive.read("run_autograder").decode()
    assert 'gradescope week03 --run "$root" --hidden hidden --show-total\n' in script


def test_id_in_the_file_selects_the_personal_values_without_a_roster(
    root: Path, run: Run, right: str, write_notebook: Callable[..., Path]
) -> None:
    write_notebook(root / "submission/week01_exercise.ipynb", right, student="anybody")
    (root / METADATA).unlink()
    assert run(roster="")["score"] == 110.0


@pytest.mark.parametrize(
    "files",
    [{}, {"essay.pdf": b"%PDF"}, {"week02_exercise.ipynb": b"{}"}, {"\x1b[31m<script>.exe": b"MZ"}],
    ids=["nothing", "another file", "another week", "a strange name"],
)
def test_missing_exercise_gets_zero_points_and_the_expected_file_is_reported(
    root: Path, run: Run, files: dict[str, bytes]
) -> None:
    for name, data in files.items():
        (root / "submission" / name).write_bytes(data)
    results = run()
    assert results["score"] == 0
    assert "week01_exercise.ipynb is missing" in results["output"]
    assert "\x1b" not in results["output"]


@pytest.mark.slow
def test_hostile_files_are_rejected_and_the_exercise_is_graded(
    root: Path, run: Run, right: str, course: Course, write_notebook: Callable[..., Path]
) -> None:
    spy = right + f"# next cell\nprint(open({str(course.solutions / 'checks/week01.py')!r}).read())\n"
    write_notebook(root / "submission/week01_exercise.ipynb", spy, student="ada1")
    (root / "submission/link.ipynb").symlink_to(course.solutions / "checks/week01.py")
    os.mkfifo(root / "submission/pipe.ipynb")
    (root / "submission/bomb.zip").write_bytes(zipped({"../../week01_exercise.ipynb": b"{}"}))
    results = run()
    assert results["score"] == 110.0
    assert "HIDDEN" not in json.dumps(results)
    assert "Error" in results["output"]  # of the cell that would read the checks


def test_grader_error_writes_no_results_instead_of_zero_points(root: Path, run: Run, course: Course) -> None:
    (root / "results").mkdir()
    (root / "results/results.json").write_text("{}")
    (root / METADATA).write_text('{"users": []')
    with pytest.raises(CourseError, match=r"submission_metadata\.json can't be read"):
        run()
    assert not (root / "results/results.json").exists()
    submission = Submission("a", "week01_exercise", Path("x"), ReceiptTime(None, ""))
    failed = MarkedResult(Result(submission, "grader_error", "OSError", "disk"))
    with pytest.raises(CourseError, match="not the student's fault: OSError disk"):
        results_of(failed, "hidden")


@pytest.mark.slow
def test_autograder_zip_has_top_level_scripts_and_answers_of_one_week(tmp_path: Path) -> None:
    (tmp_path / "roster.csv").write_text(ROSTER)
    made = {"hidden": "hidden", "need": "full", "roster": tmp_path / "roster.csv"}
    write_autograder("week03", tmp_path / "a.zip", **made)  # type: ignore[arg-type]
    with zipfile.ZipFile(tmp_path / "a.zip") as archive:
        modes = {info.filename: info.external_attr >> 16 for info in archive.infolist()}
        archive.extractall(tmp_path / "source")
    assert modes["setup.sh"] == modes["run_autograder"] == 0o755
    answers = {name for name in modes if name.startswith("course/solutions/")}
    assert answers == {
        f"course/solutions/{n}" for n in ("week03_solution.ipynb", "checks/week03.py", "roster.csv")
    }
    assert not [name for name in modes if "tests/" in name or "__pycache__" in name]
    assert list(read_course_file(tmp_path / "source/course/exercises/course.toml").weeks) == ["week03"]
    script = (tmp_path / "source/run_autograder").read_text()
    assert 'gradescope week03 --run "$root" --hidden hidden --require-sandbox\n' in script
    for name in ("setup.sh", "run_autograder"):
        subprocess.run(["bash", "-n", tmp_path / "source" / name], check=True, timeout=PATIENCE)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"week": "week99"}, "no exercise of 'week99'; weeks with an exercise: week01, week02"),
        ({"week": "week0\n"}, "no exercise of"),
        ({"hidden": "never"}, "--hidden never: expected one of after_published"),
        ({"roster": "id,name\nada1,Ada\n"}, "has no column 'email'"),
        ({"roster": "id,email\nada1,a@x\nADA1,b@x\n"}, "id 'ada1' occurs 2 times"),
        ({"out": "roster.csv/a.zip"}, "can't be written: File exists. Choose another file: --out FILE"),
    ],
)
def test_invalid_autograder_request_is_an_error_with_the_reason(
    tmp_path: Path, change: dict[str, str], message: str
) -> None:
    roster = None
    if "roster" in change:
        roster = tmp_path / "roster.csv"
        roster.write_text(change["roster"])
    out = tmp_path / change.get("out", "a.zip")
    week, hidden = change.get("week", "week01"), change.get("hidden", "hidden")
    (tmp_path / "roster.csv").touch()
    with pytest.raises(CourseError, match=re.escape(message)):
        write_autograder(week, out, hidden=hidden, need="partial", roster=roster)


@pytest.mark.slow
def test_setup_and_run_scripts_work_in_the_gradescope_layout(tmp_path: Path) -> None:
    write_autograder("week01", tmp_path / "a.zip", hidden="hidden", need="partial", roster=None)
    assert graded_upload(tmp_path / "a.zip", SOLUTION, tmp_path / "autograder")["score"] == 110.0
