import os
import sys
import threading

import pytest

from course_lib.course.course_file import read_course_file
from course_lib.errors import CourseError
from course_lib.grading.inputs import personal_values
from course_lib.grading.store import Course
from course_lib.grading.task import load_catalog


def test_catalog_contains_tasks_points_and_hidden_scenarios(course: Course) -> None:
    catalog = load_catalog(course.exercises, course.solutions)
    assert [task.id for task in catalog.tasks_of_week("week01")] == [
        "week01.red_cube",
        "week01.half",
        "week01.answer",
    ]
    assert catalog.points(catalog.task("week01.red_cube")) == (60, False)
    assert catalog.points(catalog.task("week01.answer")) == (10, True)
    assert [scenario.name for scenario in catalog.hidden["week01.half"]] == ["other"]


def test_student_copy_has_no_hidden_scenarios(course: Course) -> None:
    assert not load_catalog(course.exercises).hidden


def test_unknown_task_error_suggests_similar_tasks(course: Course) -> None:
    with pytest.raises(CourseError, match=r"Did you mean week01\.red_cube"):
        load_catalog(course.exercises).task("week01.red_cub")


def test_task_hints_are_read_from_the_hint_file_of_its_week_if_present(course: Course) -> None:
    hints = {"a value has the wrong sign": "Half, not minus half."}
    assert load_catalog(course.exercises).task("week01.half").mistakes == hints
    (course.exercises / "mistakes/week01.toml").unlink()
    assert load_catalog(course.exercises).task("week01.half").mistakes == {}


def test_personal_values_depend_on_the_student_only(course: Course) -> None:
    task = load_catalog(course.exercises).task("week01.answer")
    assert personal_values(task, "20231234") == personal_values(task, "20231234")
    assert {personal_values(task, str(number))["n"] for number in range(50)} == {10, 20, 30}


# file: (original text, faulty text, reported message)
MALFORMED = {
    "exercises/course.toml": [
        ("= 60", "= 50", "course.toml line 7: weeks: week01: points: they sum to 90, expected 100"),
        (
            "red_cube",
            "blue_cube",
            "but course.toml has points for ['week01.answer', 'week01.blue_cube', 'week01.half']",
        ),
        ("Europe/Paris", "Mars/Base", "time_zone"),
        ("title =", "titel =", "line 2: titel: unknown key 'titel'"),
        ('"A course"', "7", "title: 7, expected a text"),
        ("2026-10-11T23:59:00", "2026-10-11T23:59:00Z", "expected local time"),
        ("answer = 10", "answer = -1", "line 14: weeks: week01: bonus: answer: -1, expected a number of"),
        ("[weeks.week01]", "[weeks.week01", "can't be read"),
        ('"Europe/Paris"', "[1]", "time_zone: [1], expected a name such as"),
        ("time_zone", "title = 3 #", "can't be read"),
        ('title = "A course"', "", "the key 'title' is missing"),
        ("weeks.week01", "weeks.week1", "week1, expected a name like week01"),
        ("cell_seconds = 30", "cell_seconds = 0", "0, expected a number above 0"),
    ],
    "exercises/checks/week01.py": [
        ("TASKS", "TASK", "TASKS: expected a tuple"),
        (
            "week01.answer",
            "week02.answer",
            "has the tasks ['week01.half', 'week01.red_cube', 'week02.answer']",
        ),
        ('"value"', '"values"', "kind 'values'"),
        ("TASKS = (", "TASKS = ((", "week01.py line 7: SyntaxError: '(' was never closed"),
        ("expect_marker(TOPIC, color", "expect_marker(TOPC, color", "line 11: NameError: name 'TOPC' is not"),
        ("expect_marker(TOPIC, color", "expect_marker(TOPC, color", "Did you mean TOPIC?"),
        (
            "expect_marker(TOPIC, color",
            "expect_marker(TOPIC, colour",
            "line 11: TypeError: expect_marker: got an unexpected keyword argument 'colour'",
        ),
        (
            "expect_marker(TOPIC, color",
            "expect_marker(7, color",
            "line 11: expect_marker: topic=7, expected a string",
        ),
        (
            "color=(1, 0, 0)",
            "color=(1, 0)",
            "line 11: expect_marker: color=(1, 0), expected 3 or 4 numbers (red",
        ),
        (
            'unit="m"',
            'unit="m", call=5',
            "expect_value: call=5, expected the index of a call, from 0 to 0: the scenario 'public' has 1",
        ),
        ('unit="m"', 'unit="m", call=-1', "expect_value: call=-1, expected the index of"),
        ("color=(1, 0, 0)", "at='1'", "line 11: expect_marker: at='1', expected a number"),
        ("seconds=3.0", "seconds='3'", "line 9: seconds: '3', expected a number of seconds"),
        ('"public", seconds', "3, seconds", "line 9: a scenario's name: 3, expected a string"),
        (
            "seconds=3.0",
            "seconds=3.0, seed='a'",
            "line 9: seed='a', expected an integer from 0 to 4294967295",
        ),
        ("seconds=3.0", "seconds=3.0, seed=10**30", "expected an integer from 0 to 4294967295"),
        (
            "seconds=3.0",
            "seconds=3.0, inputs=(Message('goal', 'std_msgs/msg/Int32', {}),)",
            "line 9: an input on 'goal', expected a full name of letters, digits and _, like '/goal_pose'",
        ),
        ("expect_text,", "expect_txt,", "line 3: ImportError: cannot import name 'expect_txt'"),
    ],
    "exercises/mistakes/week01.toml": [
        ("[half]", "[hlaf]", "week01.toml line 2: unknown task 'week01.hlaf'"),
        ('"Half', '"Half"', "week01.toml: "),
        ("=", "= 7 #", "week01.half: expected a table of kinds of mistakes"),
    ],
    "solutions/checks/week01.py": [
        ("week01.half", "week01.other", "week01.py line 7: HIDDEN: unknown task 'week01.other'"),
        ('"other"', '"public"', "two scenarios have the same name"),
        ("HIDDEN =", "HIDE =", "HIDDEN: expected a dict"),
    ],
}


@pytest.mark.parametrize(
    ("file", "old", "new", "message"), [(file, *row) for file, rows in MALFORMED.items() for row in rows]
)
def test_malformed_course_file_is_reported_with_its_path(
    course: Course, file: str, old: str, new: str, message: str
) -> None:
    path = course.exercises.parent / file
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(CourseError) as refusal:
        load_catalog(course.exercises, course.solutions).tasks_of_week("week01")
    assert message in str(refusal.value)
    assert path.name in str(refusal.value)


def test_encoding_of_the_course_file_is_utf8_with_or_without_a_byte_order_mark(course: Course) -> None:
    path = course.exercises / "course.toml"
    text = path.read_text()
    path.write_text(text, encoding="utf-8-sig")
    assert read_course_file(path).weeks
    path.write_text(text, encoding="utf-16")
    with pytest.raises(CourseError, match=r"course\.toml can't be read: it is not text in UTF-8: save it"):
        read_course_file(path)


def test_faulty_week_does_not_affect_other_weeks(course: Course) -> None:
    path = course.exercises / "course.toml"
    path.write_text(path.read_text() + '[weeks.week02]\ntitle = "Two"\n[weeks.week02.points]\nx = 100\n')
    (course.exercises / "checks/week02.py").write_text("TASKS = (Tsk(),)\n")
    catalog = load_catalog(course.exercises, course.solutions)
    assert len(catalog.tasks_of_week("week01")) == 3
    for look in (lambda: catalog.tasks_of_week("week02"), lambda: catalog.task("week02.x")):
        with pytest.raises(CourseError, match=r"week02\.py line 1: NameError: name 'Tsk' is not defined"):
            look()


def test_week_missing_in_course_toml_is_reported_with_the_entry_to_write(course: Course) -> None:
    (course.exercises / "checks/week07.py").write_text("TASKS = ()\n")
    with pytest.raises(CourseError, match=r"course\.toml has no points for week07.*add \[weeks\.week07\]"):
        load_catalog(course.exercises).tasks_of_week("week07")


def test_extension_applies_to_every_spelling_of_an_id(course: Course) -> None:
    path = course.exercises / "course.toml"
    path.write_text(path.read_text() + "[weeks.week01.extensions]\nAda_1 = 2026-10-13T12:00:00\n")
    course_file = read_course_file(path).deadline("week01", "ada_1")
    assert course_file is not None
    assert course_file.isoformat() == "2026-10-13T12:00:00+02:00"


def test_missing_course_file_is_reported(course: Course) -> None:
    (course.exercises / "checks/week01.py").unlink()
    with pytest.raises(CourseError, match=r"week01\.py is missing"):
        load_catalog(course.exercises).tasks_of_week("week01")
    with pytest.raises(CourseError, match="can't be read"):
        read_course_file(course.exercises / "nothing.toml")


@pytest.mark.parametrize(
    ("statement", "message"),
    [
        ("while True: pass", "TimeoutError: it takes more than 0.5 s"),
        ("import time; time.sleep(1000)", "TimeoutError: it waits for something"),
        ("input()", "EOFError: "),
        ("import os; os._exit(0)", r"RuntimeError: os\._exit would end or duplicate the grader"),
        ("import os; os.fork()", r"RuntimeError: os\.fork would end"),
        ("import os; os.kill(os.getpid(), 9)", r"RuntimeError: os\.kill\(\d+, 9\) would end"),
        ("import signal; signal.raise_signal(9)", r"RuntimeError: signal\.raise_signal would end"),
        ("import ctypes; ctypes.string_at(0)", "it ends the process with SIGSEGV"),
        ("import os; import posix; posix.kill(os.getpid(), 11)", "it ends the process with SIGSEGV"),
        ("import numpy; numpy.ones(2 * 10**9)", "MemoryError"),
    ],
)
@pytest.mark.parametrize("folder", ["exercises", "solutions"])
def test_check_file_that_stops_the_grader_is_reported_with_its_line(
    course: Course, folder: str, statement: str, message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("course_lib.grading.task.LOAD_SECONDS", 0.5)
    if "sleep" in statement:  # a loop also waits on a busy machine
        monkeypatch.setattr("course_lib.grading.task.WAIT_SECONDS", 0.5)
    path = course.exercises.parent / folder / "checks/week01.py"
    path.write_text(f"\n{statement}\n{path.read_text()}")
    calls = os._exit, os.fork, os.kill, threading.Thread.start, sys.stdin
    with pytest.raises(CourseError, match=rf"{folder}/checks/week01\.py line 2: .*{message}"):
        load_catalog(course.exercises, course.solutions).tasks_of_week("week01")
    assert (os._exit, os.fork, os.kill, threading.Thread.start, sys.stdin) == calls


def test_check_file_may_end_a_program_that_it_runs(course: Course) -> None:
    path = course.exercises / "checks/week01.py"
    path.write_text(
        "import subprocess, sys\nsleeper = subprocess.Popen([sys.executable, '-c', 'input()'], stdin=-1)\n"
        f"sleeper.kill(); sleeper.communicate(timeout=60)\n{path.read_text()}"
    )
    assert load_catalog(course.exercises, course.solutions).tasks_of_week("week01")


def test_thread_of_a_check_file_does_not_delay_the_end_of_the_grader(course: Course) -> None:
    path = course.exercises / "checks/week01.py"
    start = "import threading\nthreading.Thread(target=threading.Event().wait, name='left').start()\n"
    path.write_text(start + path.read_text())
    assert load_catalog(course.exercises, course.solutions).tasks_of_week("week01")
    assert {thread.daemon for thread in threading.enumerate() if thread.name == "left"} == {True}


def test_check_file_that_ends_the_program_is_reported(course: Course) -> None:
    path = course.exercises / "checks/week01.py"
    path.write_text(path.read_text() + "import sys\nsys.exit(0)\n")
    with pytest.raises(CourseError, match=r"week01\.py line \d+: SystemExit: 0"):
        load_catalog(course.exercises).tasks_of_week("week01")


@pytest.mark.parametrize(
    ("time", "reason"),
    [
        ("2026-03-29T02:30:00", "does not exist in Europe/Paris"),
        ("2026-10-25T02:30:00", "occurs twice in Europe/Paris"),
        ("2026-10-25T03:00:00", ""),
        ("2026-03-29T01:59:59", ""),
    ],
)
def test_deadline_that_the_clocks_skip_or_repeat_is_rejected(course: Course, time: str, reason: str) -> None:
    path = course.exercises / "course.toml"
    path.write_text(path.read_text().replace("2026-10-11T23:59:00", time))
    fault = read_course_file(path).faults.get("week01", "")
    assert fault.startswith(f"{path} line 9: weeks: week01: deadline: {time} {reason}") == bool(reason)
    assert bool(fault) == bool(reason)
    if reason:
        assert fault.endswith(
            f"because the clocks change. Write {time[:11]}23:59:00, or another time of that day"
        )
