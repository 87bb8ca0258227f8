from dataclasses import replace
from datetime import UTC, datetime, timedelta
from io import StringIO
from pathlib import Path
from zoneinfo import ZoneInfo

import pytest
from rich.console import Console

from course_lib.course import progress
from course_lib.course.course_file import shipped_course_file
from course_lib.course.progress import _due, contents_page, read_weeks
from course_lib.course.state import State
from course_lib.errors import CourseError


@pytest.fixture
def state(tmp_path: Path) -> State:
    state = State(tmp_path)
    state.put("identity", "student", "s1")
    return state


def printed(folder: Path) -> str:
    console = Console(width=200, file=StringIO(), record=True)
    console.print(*progress.status(folder))
    return console.export_text()


def finish(state: State, name: str) -> None:
    week = next(week for week in read_weeks() if week.name == name)
    for task, points in week.settings.points.items():
        state.put("progress", f"{name}.{task}", {"score": points, "of": points})


def test_next_step_of_a_new_student_is_the_first_task(state: State, tmp_path: Path) -> None:
    assert "Next: begin with red_cube in week01_exercise.ipynb" in printed(tmp_path)


def test_passed_tasks_are_counted_and_submitting_is_the_next_step(state: State, tmp_path: Path) -> None:
    state.put("progress", "week01.red_cube", {"score": 20.0, "of": 20.0})
    said = printed(tmp_path)
    assert "1 of 5 tasks" in said
    assert "20 of 100" in said
    assert "Next: go on with blue_cylinder" in said
    finish(state, "week01")
    assert "Next: hand in week01: course submit week01_exercise.ipynb" in printed(tmp_path)
    state.put("packed", "week01_exercise", "2027-03-01T10:00:00+00:00")
    assert "Next: begin with joint_wave" in printed(tmp_path)


def test_status_reports_when_everything_is_packed(state: State, tmp_path: Path) -> None:
    for week in read_weeks():
        finish(state, week.name)
        state.put("packed", f"{week.name}_exercise", "2027-03-01T10:00:00+00:00")
    assert "All exercises are done and packed." in printed(tmp_path)


@pytest.mark.parametrize(
    ("remaining", "told"), [(-1, "over"), (5, "5 h left"), (71, "71 h left"), (24 * 9 + 1, "9 days left")]
)
def test_deadline_is_in_course_time_with_the_remaining_time(remaining: float, told: str) -> None:
    zone, deadline = ZoneInfo("Asia/Amman"), datetime(2027, 3, 7, 23, 59)
    now = (deadline.replace(tzinfo=zone) - timedelta(hours=remaining)).astimezone(UTC)
    assert _due(deadline, now, zone) == f"07 Mar 23:59, {told}"


def test_faulty_week_table_makes_only_its_deadline_unknown(
    state: State, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    course = shipped_course_file()
    weeks = {week: settings for week, settings in course.weeks.items() if week != "week02"}
    faulty = replace(course, weeks=weeks, faults={"week02": "course.toml line 41: weeks: week02: 7"})
    monkeypatch.setattr(progress, "shipped_course_file", lambda: faulty)
    for lines in (printed(tmp_path).splitlines(), contents_page(state).splitlines()):
        (row,) = [line for line in lines if "unknown, as course.toml has a fault" in line]
        assert "Joint states" in row
        assert sum("of 4 tasks" in line for line in lines) > 1


def test_status_outside_a_folder_prints_the_command_to_use(tmp_path: Path) -> None:
    with pytest.raises(CourseError, match="run course lab first"):
        progress.status(tmp_path)
    assert progress.progress(read_weeks()[0], State(None)).task_count == ""
