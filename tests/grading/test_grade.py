"""The grader on tiny submissions: each its right mark, the others untouched."""

import csv
import json
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from course_lib.errors import CourseError
from course_lib.grading.grade import grade
from course_lib.grading.jail.filters import LAYERS
from course_lib.grading.jail.launch import TemplateProcess
from course_lib.grading.marking.by_hand import mark_by_hand
from course_lib.grading.marks import read_result
from course_lib.grading.run.scenario import run_in_this_process
from course_lib.grading.store import Course, catalog_of, rules_of
from tests.grading.conftest import COURSE, FAULTY_CHECK, write_course

WriteNotebook = Callable[..., Path]
IN_TIME = "2026-10-11 12:00:00 UTC"

ENDLESS_CELL = "while True: pass\n"
SECOND_TICK = "        if self.get_clock().now().nanoseconds > 1_700_000_001 * 10**9: "
FLOOD = "import sys\nfor _ in range(100): sys.stdout.write('x' * 10**6)\n"


def variants(right: str) -> dict[str, str]:
    publish = "        self.publisher.publish(marker)\n"
    return {
        "right": right,
        "wrong_color": right.replace("marker.color.r = marker.color.a", "marker.color.g = marker.color.a"),
        "crashes": right.replace(publish, "        marker.nothing = 1\n"),
        "endless_cell": right.replace("# next cell\n", f"# next cell\n{ENDLESS_CELL}# next cell\n", 1),
        "endless_node": right.replace(publish, SECOND_TICK + "exec('while True: pass')\n" + publish),
        "flood": right.replace("# next cell\n", f"# next cell\n{FLOOD}# next cell\n", 1),
        "exits": right.replace(publish, SECOND_TICK + "import os; os._exit(0)\n" + publish),
        "stub": "def half(length):\n    raise NotImplementedError('half is empty')\n",
        "rebinds": right + "\ncheck('week01.half', lambda length: length / 2)\ndel half\n",
    }


def rows(out: Path) -> dict[str, dict[str, str]]:
    with (out / "gradebook.csv").open(newline="") as file:
        return {row["student"]: row for row in csv.DictReader(file)}


def result(out: Path, student: str) -> Any:
    return json.loads((out / "results" / student / "week01_exercise.json").read_text())


@pytest.fixture
def hand_in(tmp_path: Path, write_notebook: WriteNotebook) -> Callable[..., Path]:
    def write(codes: dict[str, str]) -> Path:
        for student, code in codes.items():
            path = write_notebook(tmp_path / "in" / student / "week01_exercise.ipynb", code, student=student)
            path.with_name("timestamp.txt").write_text(IN_TIME)
        return tmp_path / "in"

    return write


@pytest.fixture
def impatient(tmp_path: Path) -> Course:
    """The course, with limits that an endless loop reaches soon."""
    return write_course(tmp_path / "course", COURSE.replace("seconds = 30", "seconds = 2"))


def test_each_sample_submission_gets_its_expected_mark(
    impatient: Course, right: str, hand_in: Callable[..., Path], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    assert grade(hand_in(variants(right)), out, jobs=2, course=impatient)
    marks = {
        student: (float(row["final"]), row["status"], row["reason"]) for student, row in rows(out).items()
    }
    assert marks == {
        "right": (110, "graded", ""),
        "wrong_color": (95, "graded", ""),
        "crashes": (50, "graded", ""),
        "endless_cell": (110, "limit", "time"),
        "endless_node": (80, "limit", "time"),  # a cube was published before the loop, but not repeatedly
        "flood": (110, "graded", ""),
        "exits": (80, "graded", ""),
        "stub": (0, "graded", ""),
        "rebinds": (110, "graded", ""),
    }
    assert len(result(out, "flood")["judgement"]["output"]) < 1_100_000
    assert "nothing" in result(out, "crashes")["judgement"]["tasks"][0]["errors"][0]
    assert "cell 2 was stopped after 2 s" in result(out, "endless_cell")["judgement"]["cell_errors"]


@pytest.mark.slow
def test_kernel_and_worker_give_equal_recording_digests(
    impatient: Course, right: str, hand_in: Callable[..., Path], tmp_path: Path
) -> None:
    names = ("right", "wrong_color", "crashes", "endless_node", "flood")
    codes = {name: variants(right)[name] for name in names}
    grade(hand_in(codes), tmp_path / "out", jobs=1, course=impatient)
    task = catalog_of(impatient).task("week01.red_cube")
    for student, code in codes.items():
        made: dict[str, Any] = {}
        exec(code.split("# next cell")[0].replace("%load_ext course_lib", ""), made)
        here = run_in_this_process(task, task.scenarios[0], made["RedCubeNode"], {}, wall_limit=1.0)
        digests = result(tmp_path / "out", student)["judgement"]["digests"]
        assert digests["week01.red_cube/public"] == here.recording.digest()


@pytest.mark.slow
def test_regrading_a_submission_gives_identical_files(
    course: Course, right: str, hand_in: Callable[..., Path], tmp_path: Path
) -> None:
    submissions = hand_in({"right": right, "crashes": variants(right)["crashes"]})
    for out, jobs in {"one": 1, "two": 2}.items():
        grade(submissions, tmp_path / out, jobs=jobs, course=course)
    files = [path.relative_to(tmp_path / "one") for path in (tmp_path / "one").rglob("*.*") if path.is_file()]
    differ = ("index.html", "items.html", ".lock")  # both pages state CPU time and memory
    times = (".usage.json", ".checks.json")
    files = [path for path in files if not path.name.endswith((*times, *differ))]
    assert len(files) == 12
    for file in files:
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "two" / file).read_bytes()


def test_student_id_mismatch_in_a_file_is_reported_to_staff(
    course: Course,
    right: str,
    hand_in: Callable[..., Path],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    submissions = hand_in({"ada": right})
    (submissions / "ada").rename(submissions / "mallory")
    grade(submissions, tmp_path / "out", jobs=1, course=course)
    expected = "mallory  week01_exercise  note: the file has the ID ada, but mallory submitted it"
    assert expected in capsys.readouterr().out


def test_note_that_many_submissions_have_is_printed_for_the_first_ones_only(
    course: Course,
    right: str,
    hand_in: Callable[..., Path],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    submissions = hand_in(dict.fromkeys("abcdefg", right))
    for name in "abcdefg":
        file = next((submissions / name).rglob("*.ipynb"))
        file.write_bytes(next((submissions / "a").rglob("*.ipynb")).read_bytes())
    grade(submissions, tmp_path / "out", jobs=1, course=course)
    lines = [line for line in capsys.readouterr().out.splitlines() if "the same file as" in line]
    assert [line[0] for line in lines[:-1]] == list("abcde")
    kind = "the same file as that of another student"
    assert lines[-1] == f"note of 2 other submissions: {kind}. reports/index.html has all notes"


def test_each_late_day_reduces_the_mark_by_ten_percent(
    course: Course, right: str, hand_in: Callable[..., Path], tmp_path: Path
) -> None:
    submissions = hand_in({"late": right})
    (submissions / "late/timestamp.txt").write_text("2026-10-13 10:00:00 UTC")
    grade(submissions, tmp_path / "out", jobs=1, course=course)
    row = rows(tmp_path / "out")["late"]
    assert (row["days_late"], row["penalty"], row["final"]) == ("2", "22.0", "88.0")


def test_invalid_exercise_is_rejected_and_the_rest_is_graded(
    course: Course, right: str, hand_in: Callable[..., Path], tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    submissions = hand_in({"right": right, "broken": right})
    (submissions / "broken/week01_exercise.ipynb").write_text("<html>Please log in</html>")
    write_notebook(submissions / "other/homework.ipynb", right)
    write_notebook(submissions / "week9/week09_exercise.ipynb", right)
    assert not grade(submissions, tmp_path / "out", jobs=1, course=course)
    status = {student: (row["status"], row["reason"]) for student, row in rows(tmp_path / "out").items()}
    assert status == {
        "right": ("graded", ""),
        "broken": ("rejected", "unreadable"),
        "other": ("rejected", "wrong exercise"),
        "week9": ("rejected", "wrong exercise"),
    }
    assert "it looks like a web page" in rows(tmp_path / "out")["broken"]["message"]
    page = (tmp_path / "out/reports/broken/week01_exercise.html").read_text()
    assert "Not marked (rejected)" in page


def test_broken_check_scores_zero_and_is_reported_to_staff_only(
    course: Course,
    right: str,
    hand_in: Callable[..., Path],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    hidden, out = course.solutions / "checks/week01.py", tmp_path / "out"
    hidden.write_text(hidden.read_text().replace("expect_value(-3.5)", FAULTY_CHECK))
    assert grade(hand_in({"right": right}), out, jobs=1, course=course)
    row = rows(out)["right"]
    assert (row["status"], row["final"]) == ("needs_marking", "90.0")
    broken = "week01.half, other, 'the value is right': solutions/checks/week01.py line 7: IndexError"
    shown = broken.replace("solutions/", f"{course.solutions}/")
    assert f"A check could not judge right: {shown}" in capsys.readouterr().out
    assert broken in (out / "reports/index.html").read_text().replace("&#39;", "'")
    page = (out / "reports/right/week01_exercise.html").read_text()
    assert "a fault in the course" in page
    assert "IndexError" not in page
    message = mark_by_hand(out, "right", "week01_exercise", "week01.half", "40", course=course)
    assert message.endswith("now 110, graded")


def test_folder_of_another_course_than_the_installed_one_is_reported(
    course: Course,
    hand_in: Callable[..., Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    submissions = hand_in({"ada": "x = 1"})
    for folder, is_reported in ((course.exercises.parent, False), (tmp_path / "other", True)):
        (folder / "exercises").mkdir(parents=True, exist_ok=True)
        (folder / "exercises/course.toml").touch()
        monkeypatch.chdir(folder)
        monkeypatch.setattr("course_lib.grading.store.this_course", lambda: course)
        with pytest.raises(CourseError, match="matches no submission"):
            grade(submissions, tmp_path / "out", only="nobody/*")
        shown = f"warning: graded by the course in {course.exercises.parent}, which is installed"
        assert (shown in capsys.readouterr().out) == is_reported


def test_selection_pattern_without_matches_is_rejected(
    course: Course, right: str, hand_in: Callable[..., Path], tmp_path: Path
) -> None:
    with pytest.raises(CourseError, match=r"matches no submission: .* one submission is ada/week01_exercise"):
        grade(hand_in({"ada": right}), tmp_path / "out", only="bob/*", course=course)


def test_resume_and_only_grade_the_requested_submissions(
    course: Course, right: str, hand_in: Callable[..., Path], tmp_path: Path
) -> None:
    submissions, out = hand_in({"ada": right, "bob": right}), tmp_path / "out"
    grade(submissions, out, jobs=1, only="ada/*", course=course)
    assert rows(out).keys() == {"ada"}
    first = (out / "results/ada/week01_exercise.json").stat().st_mtime_ns
    grade(submissions, out, jobs=1, resume=True, course=course)
    assert rows(out).keys() == {"ada", "bob"}
    assert (out / "results/ada/week01_exercise.json").stat().st_mtime_ns == first


def test_resume_rejudges_results_of_changed_checks(
    course: Course, right: str, hand_in: Callable[..., Path], tmp_path: Path
) -> None:
    submissions, out = hand_in({"ada": right}), tmp_path / "out"
    grade(submissions, out, jobs=1, course=course)
    evidence = next((out / "evidence").glob("*.gz"))
    made = evidence.stat().st_mtime_ns
    stored_result = read_result(out / "results/ada/week01_exercise.json").result.digest
    check_file = course.exercises / "checks/week01.py"
    check_file.write_text(check_file.read_text() + "# another hint\n")
    rules_of.cache_clear()  # as in a new grader process
    grade(submissions, out, jobs=1, resume=True, course=course)
    result = read_result(out / "results/ada/week01_exercise.json")
    assert result.result.digest not in ("", stored_result)
    assert evidence.stat().st_mtime_ns == made


@pytest.mark.parametrize("name", ["missing", "empty", "file.txt"])
def test_folder_without_submissions_is_rejected(course: Course, tmp_path: Path, name: str) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "file.txt").write_text("")
    with pytest.raises(CourseError, match=r"not a folder|no submission"):
        grade(tmp_path / name, tmp_path / "out", course=course)


def test_out_folder_inside_the_submissions_is_rejected(course: Course, tmp_path: Path) -> None:
    submissions = tmp_path / "in"
    (submissions / "ada").mkdir(parents=True)
    for out in (submissions, submissions / "graded", submissions / "ada/../graded"):
        with pytest.raises(CourseError, match=r"is inside .*Choose another folder: --out DIR"):
            grade(submissions, out, jobs=1, course=course)
    assert [path.name for path in submissions.iterdir()] == ["ada"]


def test_unwritable_out_folder_is_reported_before_grading(
    course: Course, right: str, hand_in: Callable[..., Path], tmp_path: Path
) -> None:
    (tmp_path / "out").write_text("a file")
    with pytest.raises(CourseError, match="can't be written"):
        grade(hand_in({"right": right}), tmp_path / "out", course=course)


@pytest.mark.slow
def test_submissions_run_without_a_sandbox_only_if_trusted(
    course: Course,
    right: str,
    hand_in: Callable[..., Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    submissions, out = hand_in({"right": right}), tmp_path / "out"
    with closing(TemplateProcess(off=LAYERS)) as template:
        monkeypatch.setattr("course_lib.grading.run.run.shared_template", lambda _: template)
        for need in ("full", "partial"):
            with pytest.raises(CourseError, match=r"--require-sandbox|--i-trust-these-submissions"):
                grade(submissions, out, jobs=1, course=course, need=need)
        assert not (out / "results").exists()
        assert grade(submissions, out, jobs=1, course=course, need="any")
    assert rows(out)["right"]["final"] == "110.0"
    assert result(out, "right")["judgement"]["isolation"].startswith("no sandbox (lacks")
    assert "Isolation of 1 submission: no sandbox (lacks" in capsys.readouterr().out
    assert "Ran with isolation: no sandbox" in (out / "reports/right/week01_exercise.html").read_text()
