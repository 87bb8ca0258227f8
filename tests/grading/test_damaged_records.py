"""Damaged records and settings are rejected with their file name and without a traceback."""

import json
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest

from course_lib.course.course_file import read_course_file
from course_lib.errors import CourseError
from course_lib.grading.marks import read_marks, read_result, stored_result
from course_lib.grading.records import Mark
from course_lib.grading.reports.tables import check_times, scenario_times
from course_lib.grading.run.run import read_usage
from course_lib.grading.store import result_path
from course_lib.grading.submissions.roster import read_times
from tests.grading.test_platform_times import PARIS

DEEP = "[" * 100_000


@pytest.mark.parametrize("read", [read_marks, read_result, read_course_file])
def test_too_deeply_nested_file_is_rejected_with_its_name(
    tmp_path: Path, read: Callable[[Path], Any]
) -> None:
    path = tmp_path / "student" / "week01_exercise.json"
    path.parent.mkdir()
    path.write_text(f"x = {DEEP}" if read is read_course_file else DEEP)
    with pytest.raises(CourseError, match=r"week01_exercise\.json can't be read"):
        read(path)


OLD_CHECK = {
    "title": "its value", "scenario": "public", "hidden": False, "weight": 1.0, "score": 0.5,
    "message": "close", "mistake": "a value", "broken": "",
}  # fmt: skip
OLD_TASK = {
    "task": "week01.half", "title": "Half", "points": 100.0, "bonus": False, "checks": [OLD_CHECK],
    "errors": [], "stopped": "", "manual": None, "comments": [], "rubric": [], "is_current": True,
    "score": 50.0,
}  # fmt: skip
OLD_RESULT: dict[str, Any] = {
    "student": "ada", "exercise": "week01_exercise", "claimed": "ada", "sha256": "5e", "problem": "",
    "key": "k", "twins": [], "values_of": "ada", "id_flag": "", "id_note": "",
    "file": "ada/week01_exercise.ipynb", "received": "2026-10-13T10:00:00+02:00",
    "received_from": "received.csv", "late": None, "receipt_time": None, "handed_in_as": "Ada/w.ipynb",
    "status": "graded", "reason": "", "message": "", "days_late": 2, "percent_per_day": 10.0,
    "notes": ["a note"], "remark": "", "rules": "r", "digest": "d", "tasks": [OLD_TASK], "isolation": "full",
    "attempts": [{"key": "k", "received": "{}", "id_flag": "", "final": 40.0}], "cell_errors": [],
    "output": "hi", "digests": {}, "limit": "",
}  # fmt: skip


def write_old_result(out: Path, **changed: Any) -> Path:
    path = result_path(out, "ada", "week01_exercise")
    path.parent.mkdir(parents=True)
    path.write_text(json.dumps({**OLD_RESULT, **changed}))
    return path


def test_result_of_version_0_3_is_read(tmp_path: Path) -> None:
    result = read_result(write_old_result(tmp_path))
    assert result.row.mark == Mark(50.0, 100.0, 2, 10.0, 40.0)
    assert result.result.submission.received.time == datetime(2026, 10, 13, 8, tzinfo=UTC)
    assert result.result.submission.path == Path("ada/week01_exercise.ipynb")
    assert (result.result.isolation, result.result.attempts[0].final) == ("full", 40.0)


def test_result_of_version_2_is_read(tmp_path: Path) -> None:
    """Its fields are those of the current version, but some have other names."""
    result = read_result(write_old_result(tmp_path / "old")).result
    result.write(tmp_path / "new")
    path = result_path(tmp_path / "new", "ada", "week01_exercise")
    content = json.loads(path.read_text())
    names = {"claimed_id": "claimed", "relative_path": "named", "rejected_files": "refused"}
    submission = content["submission"].items()
    content["submission"] = {names.get(name, name): value for name, value in submission}
    for task in content["judgement"]["tasks"]:
        task["bonus"] = task.pop("is_bonus")
        for check in task["checks"]:
            check["hidden"] = check.pop("is_hidden")
    path.write_text(json.dumps({**content, "version": 2}))
    assert replace(read_result(path).result, version=result.version) == result


def test_result_is_unchanged_after_writing_and_reading(tmp_path: Path) -> None:
    result = read_result(write_old_result(tmp_path / "old")).result
    result.write(tmp_path / "new")
    assert stored_result(tmp_path / "new", "ada", "week01_exercise").result == result


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"days_late": "two"}, "days_late"),
        ({"status": "excellent"}, "status"),
        ({"tasks": [{**OLD_TASK, "checks": 3}]}, r"judgement\.tasks\[0\]\.checks"),
        ({"received": "yesterday"}, r"attempts\[0\]\.received\.time"),
    ],
)
def test_damaged_result_field_is_reported_by_name(tmp_path: Path, change: dict[str, Any], named: str) -> None:
    path = write_old_result(tmp_path, **change)
    with pytest.raises(CourseError, match=rf"can't be read: .*\$\.{named}"):
        read_result(path)


def test_too_deeply_nested_times_are_ignored(tmp_path: Path) -> None:
    (tmp_path / "evidence").mkdir()
    (tmp_path / "evidence/key.checks.json").write_text(DEEP)
    assert check_times(tmp_path, ["key"]) == {}


@pytest.mark.parametrize(
    "text", [DEEP, "[]", '{"scenarios": []}', '{"scenarios": {"a/b": "x"}}', '{"cpu_seconds": "x"}']
)
def test_damaged_resource_usage_is_ignored(tmp_path: Path, text: str) -> None:
    (tmp_path / "evidence").mkdir()
    (tmp_path / "evidence/key.usage.json").write_text(text)
    assert read_usage(tmp_path, "key") is None
    assert scenario_times(tmp_path, ["key"]) == {}


@pytest.mark.parametrize("attachments", [1, "x", {"id": 1}, [None, 1, {"name": "x"}]])
def test_malformed_attachments_do_not_hide_the_submission_time(tmp_path: Path, attachments: object) -> None:
    entry = {"user_id": 7, "submitted_at": "2026-03-08T22:59:00Z", "attachments": attachments}
    (tmp_path / "api.json").write_text(json.dumps([entry]))
    times = read_times(tmp_path / "api.json", PARIS, ["7"])
    assert times is not None
    assert set(times.by_number) == {"7"}
