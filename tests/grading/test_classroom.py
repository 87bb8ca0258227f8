"""GitHub: the workflow, and clones of students' repositories as submissions."""

import csv
import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest
import yaml

from course_lib.course.material import solutions_dir
from course_lib.course.student_folder import prepare
from course_lib.errors import CourseError
from course_lib.grading.platforms.classroom import check_changed, collect_clones, write_workflow
from course_lib.grading.submissions.submission import UTC, Ledger, find_submissions
from tests.checkout import need_git
from tests.patience import PATIENCE

ROSTER = "identifier,github_username,name\nADA1,Ada-L,Ada\nbob2,l,Bob\ncleo3,cleo,Cleo\n"
WEEK, TIME = "week01", "2026-10-11T22:30:00Z"


def git(folder: Path, *words: str) -> str:
    """Run git as the student, whose clock is wrong by years."""
    identity = ("-c", "user.name=x", "-c", "user.email=x@x.org", "-c", "init.defaultBranch=main")
    clock = os.environ | {
        "GIT_AUTHOR_DATE": "2001-01-01T00:00:00Z",
        "GIT_COMMITTER_DATE": "2001-01-01T00:00:00Z",
    }
    process = subprocess.run(
        ["git", *identity, *words], cwd=folder, env=clock, capture_output=True, check=True, timeout=PATIENCE
    )
    return process.stdout.decode().strip()


def clone_of(clones: Path, login: str) -> Path:
    """A student's repository with a solved week 1, and all other exercises as released."""
    folder = clones / f"robotics-{login}"
    prepare(folder / "my_course")
    shutil.copy(solutions_dir() / f"{WEEK}_solution.ipynb", folder / "my_course" / f"{WEEK}_exercise.ipynb")
    (folder / "my_course/my_files/my.rviz").write_text("Panels: []\n")
    git(folder, "init", "-q")
    git(folder, "add", "-A")
    git(folder, "commit", "-qm", "week 1")
    return folder


def push(commit: str, time: str = TIME) -> dict[str, object]:
    """An entry of GitHub's activity of a repository."""
    return {"id": 1, "before": "0" * 40, "after": commit, "ref": "refs/heads/main", "timestamp": time}


@pytest.fixture
def clones(tmp_path: Path) -> Path:
    need_git()
    (tmp_path / "roster.csv").write_text(ROSTER)
    return tmp_path / "clones"


def test_clone_becomes_the_submission_of_its_login_at_push_time(tmp_path: Path, clones: Path) -> None:
    heads = {login: git(clone_of(clones, login), "rev-parse", "HEAD") for login in ("Ada-L", "l")}
    git(clones / "robotics-l", "pack-refs", "--all")
    later = push(heads["Ada-L"], "2027-01-01T00:00:00Z")  # the same commit, pushed again to a branch
    texts = [json.dumps([later, push(heads["Ada-L"])], indent=1), json.dumps([push(heads["l"])])]
    (tmp_path / "pushes.json").write_text("\n".join(texts))
    out = tmp_path / "submissions"
    lines = collect_clones(clones, out, tmp_path / "roster.csv", tmp_path / "pushes.json")
    assert lines == [f"Collected 2 students into {out}. Next: course grade {out} --out graded"]
    submissions = find_submissions(out)
    assert [(one.student, one.exercise) for one in submissions] == [
        ("ada1", f"{WEEK}_exercise"),
        ("bob2", f"{WEEK}_exercise"),
    ]
    assert {one.received.time.isoformat() for one in submissions if one.received.time} == {
        "2026-10-11T22:30:00+00:00"
    }
    assert all(one.received.is_trusted for one in submissions)
    assert (out / "ada1/my_files/my.rviz").is_file()
    rows = list(csv.DictReader((out / "received.csv").open()))
    assert {row["id_from"] for row in rows} == {"roster"}


def test_hostile_and_unknown_clones_are_reported_and_other_clones_collected(
    tmp_path: Path, clones: Path
) -> None:
    clone_of(clones, "ada-l")
    eve = clone_of(clones, "eve")
    link = clones / "robotics-ada-l/my_course/week02_exercise.ipynb"
    link.unlink()
    link.symlink_to("/etc/passwd")
    (clones / "robotics-ada-l/my_course/received.csv").write_text("file,received\n*,2001-01-01T00:00Z\n")
    shutil.copytree(eve, clones / "other-ada-l")
    prepare(clones / "robotics-cleo/my_course")
    (clones / "robotics-cleo/.git").mkdir()
    (clones / "robotics-cleo/my_course/week03_exercise.ipynb").write_text("[" * 100_000)
    out = tmp_path / "submissions"
    text = "\n".join(collect_clones(clones, out, tmp_path / "roster.csv", None))
    assert "rejected: robotics-eve: its name does not end with a login from the class list" in text
    assert "rejected: robotics-ada-l: ada1 has two clones" in text
    assert "2 students without the time of the push" in text
    by_student = {(one.student, one.exercise, bool(one.problem)) for one in find_submissions(out)}
    assert by_student == {("ada1", f"{WEEK}_exercise", False), ("cleo3", "week03_exercise", True)}
    assert Ledger.read(out, UTC).receipt_time(out / "ada1/week01_exercise.ipynb", {}).time is None


def test_unchanged_clone_is_not_a_submission(tmp_path: Path, clones: Path) -> None:
    prepare(clones / "robotics-ada-l/my_course")
    (clones / "robotics-ada-l/.git").mkdir()
    prepare(clones / "robotics-l/work")  # not where GitHub's checks and the grader look
    (clones / "robotics-l/.git").mkdir()
    lines = collect_clones(clones, tmp_path / "submissions", tmp_path / "roster.csv", None)
    assert lines[:2] == [
        f"ada1: no exercise in {clones / 'robotics-ada-l' / 'my_course'} differs from the released one",
        f"bob2: no exercise in {clones / 'robotics-l'} differs from the released one",
    ]
    assert "Collected 0 students" in lines[-1]


@pytest.mark.parametrize(
    ("roster", "pushes", "message"),
    [
        ("id,name\nada1,Ada\n", "[]", "needs a column 'login'"),
        (ROSTER, "[]", "has no push with 'after' and 'timestamp'"),
        (ROSTER, "<html>", "can't be read"),
        (ROSTER, "[" * 100_000, "can't be read"),
        (ROSTER, '[{"after": "../x", "timestamp": "now"}, 7]', "has no push"),
        (ROSTER, "", "has no push"),
    ],
)
def test_invalid_roster_or_push_file_is_reported(
    tmp_path: Path, roster: str, pushes: str, message: str
) -> None:
    (tmp_path / "roster.csv").write_text(roster)
    (tmp_path / "pushes.json").write_text(pushes)
    with pytest.raises(CourseError, match=message):
        collect_clones(tmp_path, tmp_path / "out", tmp_path / "roster.csv", tmp_path / "pushes.json")


def test_folder_without_clones_is_an_error_with_the_clone_command(tmp_path: Path, clones: Path) -> None:
    with pytest.raises(CourseError, match="gh classroom clone student-repos"):
        collect_clones(tmp_path, tmp_path / "out", tmp_path / "roster.csv", None)


def test_workflow_is_written_only_into_the_student_copy(tmp_path: Path) -> None:
    with pytest.raises(CourseError, match="is not a students' copy"):
        write_workflow(tmp_path)
    (tmp_path / "exercises").mkdir()
    (tmp_path / "pyproject.toml").touch()
    write_workflow(tmp_path)
    workflow = yaml.load((tmp_path / ".github/workflows/public_checks.yml").read_text(), yaml.BaseLoader)
    assert workflow["on"] == ["push", "workflow_dispatch"]
    steps = [step.get("run", "") for step in workflow["jobs"]["check"]["steps"]]
    assert "pip install -e ." in steps
    subprocess.run(["bash", "-n", "-c", steps[-1]], check=True, timeout=PATIENCE)
    (tmp_path / "solutions").mkdir()
    with pytest.raises(CourseError, match="contains solutions"):
        write_workflow(tmp_path)


@pytest.mark.slow
def test_push_checks_only_the_changed_exercises(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "my_course"
    prepare(folder)
    assert check_changed(folder)
    assert capsys.readouterr().out == ""
    shutil.copy(solutions_dir() / f"{WEEK}_solution.ipynb", folder / f"{WEEK}_exercise.ipynb")
    assert check_changed(folder)
    assert "all public checks passed" in capsys.readouterr().out
    path = folder / f"{WEEK}_exercise.ipynb"
    path.write_text(path.read_text().replace("marker.type = ", "marker.type = 1 + "))
    path.write_text(path.read_text().replace("Marker.CUBE", "Marker.SPHERE"))
    assert not check_changed(folder)
    with pytest.raises(CourseError, match="is missing: course lab creates it"):
        check_changed(tmp_path / "nowhere")
