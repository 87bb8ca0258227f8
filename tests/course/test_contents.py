from pathlib import Path

from course_lib.course.progress import contents_page, read_weeks, write_contents
from course_lib.course.state import State
from course_lib.course.student_folder import shipped_files


def test_every_lesson_is_listed_with_minutes_and_a_link(tmp_path: Path) -> None:
    page = write_contents(tmp_path).read_text()
    for week in read_weeks():
        assert f"[{week.title}]({week.lesson}) | {week.minutes} |" in page


def test_progress_counts_tasks_with_full_score() -> None:
    state = State(None)
    assert "| 0 of 4 tasks |" in contents_page(state)
    state.put("progress", "week01.red_cube", {"score": 20.0, "of": 20.0})
    state.put("progress", "week01.traffic_light", {"score": 10.0, "of": 25.0})
    assert "| 1 of 5 tasks |" in contents_page(state)


def test_review_is_listed_after_the_last_of_its_weeks(tmp_path: Path) -> None:
    rows = contents_page(State(tmp_path)).splitlines()
    (place,) = (number for number, row in enumerate(rows) if "(week04_your_review.ipynb)" in row)
    assert "(week04_transforms" in rows[place - 1]
    assert "(week05_" in rows[place + 1]
    assert "| 25 |" in rows[place]


def test_review_file_names_sort_after_lesson_and_exercise_of_their_week() -> None:
    names = sorted(shipped_files())
    for week in ("week04", "week08"):
        assert [name for name in names if name.startswith(week)][-1] == f"{week}_your_review.ipynb"
