"""Records and settings that something has damaged: each is refused by name, none ends in a traceback."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from course_lib.course.course_file import read_course_file
from course_lib.errors import CourseError
from course_lib.grading.handin.roster import read_times
from course_lib.grading.marks.mark import read_result
from course_lib.grading.marks.marks import read_marks
from course_lib.grading.marks.requests import read_requests
from course_lib.grading.reports.items import check_times, scenario_times
from course_lib.grading.run.run import read_usage
from tests.grading.test_platform_times import PARIS

DEEP = "[" * 100_000


@pytest.mark.parametrize("read", [read_marks, read_requests, read_result, read_course_file])
def test_a_file_that_is_too_deep_is_refused_by_its_name(tmp_path: Path, read: Callable[[Path], Any]) -> None:
    path = tmp_path / "student" / "week01_exercise.json"
    path.parent.mkdir()
    path.write_text(f"x = {DEEP}" if read is read_course_file else DEEP)
    with pytest.raises(CourseError, match=r"week01_exercise\.json can't be read"):
        read(path)


def test_times_that_are_too_deep_are_left_out(tmp_path: Path) -> None:
    (tmp_path / "evidence").mkdir()
    (tmp_path / "evidence/key.checks.json").write_text(DEEP)
    assert check_times(tmp_path, ["key"]) == {}


@pytest.mark.parametrize(
    "text", [DEEP, "[]", '{"scenarios": []}', '{"scenarios": {"a/b": "x"}}', '{"cpu_seconds": "x"}']
)
def test_damaged_usage_is_left_out(tmp_path: Path, text: str) -> None:
    (tmp_path / "evidence").mkdir()
    (tmp_path / "evidence/key.usage.json").write_text(text)
    assert read_usage(tmp_path, "key") is None
    assert scenario_times(tmp_path, ["key"]) == {}


@pytest.mark.parametrize("attachments", [1, "x", {"id": 1}, [None, 1, {"name": "x"}]])
def test_attachments_of_another_form_do_not_hide_the_time(tmp_path: Path, attachments: object) -> None:
    entry = {"user_id": 7, "submitted_at": "2026-03-08T22:59:00Z", "attachments": attachments}
    (tmp_path / "api.json").write_text(json.dumps([entry]))
    times = read_times(tmp_path / "api.json", PARIS, ["7"])
    assert times is not None
    assert set(times.by_number) == {"7"}
