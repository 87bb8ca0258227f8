"""Every rule of `course verify` finds its flaws and reports their location."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest

from course_lib.authoring.deletions import Code, find_false_passes
from course_lib.authoring.edits import make_edits, operators, read_answers
from course_lib.authoring.new import new_week, template_picture
from course_lib.authoring.rehearsal import cells_of
from course_lib.authoring.rules import Flaw
from course_lib.authoring.verify import WeekReport, lines, reject_broken, verify
from course_lib.errors import CourseError
from course_lib.grading.store import Course, catalog_of
from course_lib.grading.task import Task
from tests.authoring.conftest import Break, empty_course, write

TOML = "exercises/course.toml"
PUBLIC, HIDDEN = "exercises/checks/week09.py", "solutions/checks/week09.py"
SOLUTION, LESSON = "solutions/week09_solution.ipynb", "notebooks/week09_occupancy_maps.ipynb"
EXERCISE = "exercises/week09_exercise.ipynb"
ANSWERS, QUIZ = "solutions/answers/week09.toml", "exercises/quizzes/week09.toml"
SHAPE = 'scale=(0.2, 0.2, my("height"))).titled('
FORMAL = "*with_formal([check.requiring(always) for check in content], *formal)"
HEIGHT = 'my_values(\\"week09.post\\")[\\"height\\"]'
BLUE = "expect_marker(TOPIC, color=(0.0, 0.0, 1.0, 1.0))"
INPUT = '            seed=1,\n            inputs=(Message("/a", "std_msgs/msg/Bool", {"dta": 1}),),\n'
GRADING = "from course_lib.grading import ("

CRASH = "lambda evidence: passed('yes') if evidence.messages(TOPIC) else ctypes.string_at(0)"

# aspect; file, original text, faulty text; reported message and location
Row = tuple[str, list[tuple[str, str, str]], str, str]
RUN: list[Row] = [
    ("solution", [(HIDDEN, "times=0.5", "times=0.6")], "hidden 'longer'", "checks/week09.py line 18"),
    (
        "solution",
        [(SOLUTION, f"height = {HEIGHT}", "height = 0.6")],
        "the solution with {'height': 0.8} has",
        PUBLIC,
    ),
    (
        "stub",
        [(EXERCISE, "raise NotImplementedError", "print")],
        "the stub does not raise NotImplementedError",
        SOLUTION,
    ),
    (
        "empty",
        [
            (
                PUBLIC,
                "*with_formal([check.requiring(always) for check in content], *formal)",
                "*content, *formal",
            )
        ],
        "headers only: ",
        PUBLIC,
    ),
    ("second", [(ANSWERS, "color.b = 1.0\\n", "color.r = 1.0\\n")], "another name: ", ANSWERS),
    (
        "solution",
        [(SOLUTION, 'check(\\"week09.post', 'check(\\"week09.pst')],
        ".pst', …): there is no such task. Did you mean week",
        SOLUTION,
    ),
    (
        "solution",
        [(SOLUTION, 'check(\\"week09.post', 'print(\\"week09.post')],
        "no cell calls check",
        SOLUTION,
    ),
    ("wrong", [(ANSWERS, '"too low"', '"too high"')], "expected a message with 'too high'", ANSWERS),
    ("wrong", [(ANSWERS, "Marker.CUBE", "Marker.CUBES")], "a box: the code raises", ANSWERS),
    (
        "wrong",
        [(HIDDEN, 'FORMAL = (expect_frame(TOPIC, "map"), ', "FORMAL = (")],
        "mutant 'frame': the hidden checks pass it",
        ANSWERS,
    ),
    ("wrong", [(PUBLIC, "(0.6, 0.8, 1.2, 1.4)}", "(1.0, 1.0)}")], "the height of the lesson: ", ANSWERS),
    (
        "can fail",
        [
            (HIDDEN, "CONTENT = (", "CONTENT = (\n    Check('own', lambda evidence: passed('yes')),"),
            (HIDDEN, GRADING, f"from course_lib.grading import Check, passed\n{GRADING}"),
        ],
        "'own': no answer fails it",
        PUBLIC,
    ),
    (
        "wrong",
        [
            (HIDDEN, "CONTENT = (", f"CONTENT = (\n    Check('own', {CRASH}),"),
            (HIDDEN, GRADING, f"import ctypes\nfrom course_lib.grading import Check, passed\n{GRADING}"),
        ],
        "a check fails with an error on an answer (the stub): solutions/checks/week",
        PUBLIC,
    ),
    (
        "fields",
        [
            (
                PUBLIC,
                "expect_marker(TOPIC, color=(0.0, 0.0, 1.0, 1.0))",
                'expect_message(TOPIC, {"color.bleu": 1.0})',
            ),
            (PUBLIC, "    expect_marker,\n", "    expect_marker,\n    expect_message,\n"),
        ],
        "std_msgs/msg/ColorRGBA has no field 'bleu' ('color.bleu')",
        "checks/week09.py line 53",
    ),
    (
        "wrong",
        [
            (SOLUTION, "check, my_values, spin_for", "check, my_values, run_live, spin_for"),
            (
                SOLUTION,
                f"{HEIGHT}  # [m] students",
                f"{HEIGHT} if rclpy.ok() else run_live()  # [m] students",
            ),
        ],
        "without import of run_live the solution crashes (name 'run_live' is not defined)",
        SOLUTION,
    ),
]


@pytest.fixture
def _nothing_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("course_lib.authoring.verify.WeekRehearsals.flaws", lambda _: iter(()))


GENERAL = operators(Path())  # the default of courses without their own
MUTANTS = tuple(operator for operator in GENERAL if operator.name == "frame")
WEEKS = [f"week{number:02}" for number in range(9, 9 + len(RUN))]  # each fault of RUN is in a separate week


def find_in_last_week(
    code: Code, tasks: Sequence[Task], week: str, run: Any
) -> Iterator[tuple[str, str, str]]:
    """Delete the statements of one solution only, as they are the same in all others."""
    return find_false_passes(code, tasks, week, run) if week == WEEKS[-1] else iter(())


@pytest.fixture(scope="module")
def reports(tmp_path_factory: pytest.TempPathFactory) -> dict[str, WeekReport]:
    """All faults of RUN, verified at once with one mutant each: a week of the template has 13.

    The last one is found by deletions, of which a week has 28.
    """
    course = empty_course(tmp_path_factory.mktemp("faults"))
    for week, (_, changes, _, _) in zip(WEEKS, RUN, strict=True):
        new_week(week, "Occupancy maps", course)
        for name, old, new in changes:
            write(course, *(part.replace("week09", week) for part in (name, old, new)))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("course_lib.authoring.verify.operators", lambda _: MUTANTS)
        patch.setattr("course_lib.authoring.verify.find_false_passes", find_in_last_week)
        return {report.week: report for report in verify(course, WEEKS, jobs=2)}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("week", "aspect", "text", "place"),
    [(week, aspect, text, place) for week, (aspect, _, text, place) in zip(WEEKS, RUN, strict=True)],
    ids=[f"{aspect}-{text[:40]}" for aspect, _, text, _ in RUN],
)
def test_fault_visible_when_answers_run_is_reported(
    reports: dict[str, WeekReport], week: str, aspect: str, text: str, place: str
) -> None:
    found = [flaw for flaw in reports[week].flaws if flaw.aspect == aspect]
    place = place.replace("week09", week)
    assert [f for f in found if text in f.text and place in f.location], list(map(str, reports[week].flaws))


WEIGHTLESS = """import dataclasses
_ONE = POST.scenarios[0]
_ONE = dataclasses.replace(_ONE, checks=tuple(check.worth(0) for check in _ONE.checks))
POST = dataclasses.replace(POST, scenarios=(_ONE,))
TASKS = (POST,)"""
NOTHING_WEIGHS = [(PUBLIC, "TASKS = (POST,)", WEIGHTLESS), (HIDDEN, "HIDDEN = {", "HIDDEN = {}\n_ = {")]
READ: list[Row] = [
    ("files", [(PUBLIC, "(0.6, 0.8, 1.2, 1.4)}", "()}")], "'height': (), expected a tuple of options", ""),
    ("files", [(PUBLIC, "(0.6, 0.8, 1.2, 1.4)}", "(0.6)}")], "0.6, expected a tuple of options", ""),
    ("files", [(PUBLIC, SHAPE, SHAPE.replace(".t", ".worth(-1).t"))], "the weight -1: expected a number", ""),
    ("files", [(PUBLIC, "(POST,)", "(PST,)")], "NameError: name 'PST' is not defined. Did you mean POST", ""),
    ("files", [(PUBLIC, "(POST,)", "(PST,)")], "checks/week09.py line 59: ", ""),
    ("files", [(PUBLIC, '"CYLINDER"', '"CYLINDR"')], "week09.py line 46: expect_marker: type='CYL", ""),
    ("files", [(PUBLIC, '"CYLINDER"', '"CYLINDR"')], "Did you mean CYLINDER", ""),
    ("files", [(TOML, "post = 100", "pots = 100")], "course.toml has points for ['week09.pots']", ""),
    ("files", [(TOML, "title = \"O", "titel = \"O")], "toml line 7: weeks: week09: titel: unknown key", ""),
    ("files", [(TOML, "post = 100", "post = 90")], "line 6: weeks: week09: points: they sum to 90", ""),
    ("files", [(TOML, "week09", "week08")], "course.toml has no points for week09, but ", ""),
    ("files", [(ANSWERS, 'miss = "red"', 'mis = "red"')], "week09.toml line 21: week09.post: ", ""),
    ("quiz", [(QUIZ, "right = true\n", "")], "has 0", ""),
    ("quiz", [(QUIZ, "[[question]]", "[[questoin]]")], "no table 'questoin'. Did you mean question?", ""),
    ("quiz", [(QUIZ, '"0.4 m"', "0.4")], "week09.toml line 4: 0.4, expected a string in quotes", ""),
    ("quiz", [(QUIZ, "right = true", "right = 'true'")], "right = 'true', expected true or false", ""),
    ("quiz", [(QUIZ, "[[question]]", "[question]")], "week09.toml line 3: expected [[question]]", ""),
    ("lesson", [(LESSON, '"cell_type": "code"', '"cell": "code"')], "cell 2 has no 'cell_type'", LESSON),
    ("files", NOTHING_WEIGHS, "week09.post: all its checks have the weight 0, so it gives no points", ""),
    ("fresh", [(EXERCISE, "Save the notebook", "Save it")], "it differs from the exercise", EXERCISE),
    ("fresh", [(SOLUTION, "# end of solution", "# end of it")], "an answer is not closed", SOLUTION),
    (
        "fields",
        [
            (PUBLIC, "            seed=1,\n", INPUT),
            (PUBLIC, "    Check,\n", "    Check,\n    Message,\n"),
        ],
        "has no attribute 'dta'",
        "checks/week09.py line 46",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("aspect", "changes", "text", "place"), READ, ids=lambda value: str(value)[:40])
@pytest.mark.usefixtures("_nothing_runs")
def test_fault_visible_when_files_are_read_is_reported(
    course: Course, change: Break, aspect: str, changes: list[tuple[str, str, str]], text: str, place: str
) -> None:
    for one in changes:
        change(*one)
    reports = {report.week: report for report in verify(course, jobs=1)}
    found = [flaw for flaw in reports["week09"].flaws if flaw.aspect == aspect]
    assert [flaw for flaw in found if text in flaw.text and place in flaw.location], list(map(str, found))


# original text of the answers, faulty text, and the message that is reported without a run
CHANGES = [
    ('"position.z = height / 2"', '"position.y = 1"', "'position.y = 1' is in 0 cells of the solution"),
    ('"scale.z = height"', '"height"', "times in the cell with PostNode, expected once: include more"),
    ("# Wrong answers", "[same]\npots = []\n# Wrong", "[same]: there is no task 'week09.pots'"),
    ("# Wrong answers", "[same]\npost = ['lifetime: none']\n# Wrong", "no mutant 'lifetime: none'"),
    ('says = "too low"', 'says = "too (low"', "'too (low' is not a regular expression"),
]


@pytest.mark.parametrize(("old", "new", "text"), CHANGES, ids=[row[2][:40] for row in CHANGES])
def test_answer_with_unintended_change_is_reported(
    course: Course, change: Break, old: str, new: str, text: str
) -> None:
    change(ANSWERS, old, new)
    cells = cells_of(course.solutions / "week09_solution.ipynb")
    try:
        answers = read_answers(course.solutions, "week09")
        found = make_edits(catalog_of(course).tasks_of_week("week09"), answers, cells, GENERAL)
        messages = [str(flaw) for flaw in found if isinstance(flaw, Flaw)]
    except CourseError as error:
        messages = [str(error)]
    assert [line for line in messages if text in line and "week09.toml" in line], messages


MUTANT = "[[mutant]]\nname = 'no alpha'\npattern = 'color.a = (1).0'\nreplacement = '{}'\nnames = 'color'\n"


@pytest.mark.usefixtures("_nothing_runs")
def test_mutant_without_match_in_any_solution_is_reported(course: Course) -> None:
    file = course.solutions / "answers" / "mutants.toml"
    file.write_text(MUTANT.format("pass"))
    assert [report.week for report in verify(course, jobs=1)] == ["week09"]
    file.write_text(MUTANT.format("pass").replace("color.a", "colour.a"))
    _, extras = verify(course, jobs=1)
    assert [str(flaw) for flaw in extras.flaws] == [
        f"{file} line 2: the pattern of the mutant 'no alpha' does not match any solution"
    ]


def test_mutant_replacement_with_unknown_group_is_rejected(course: Course) -> None:
    (course.solutions / "answers" / "mutants.toml").write_text(MUTANT.format(r"\2"))
    with pytest.raises(CourseError, match=r"mutants\.toml: invalid group reference 2"):
        operators(course.solutions)


@pytest.mark.usefixtures("_nothing_runs")
def test_template_placeholders_are_reported_until_replaced(course: Course, change: Break) -> None:
    picture = f"{LESSON}, its picture, which is the template's: 1 REPLACE"
    hints = "exercises/mistakes/week09.toml, which is the template's: 1 REPLACE"
    messages = lines(list(verify(course, jobs=1)), course)
    assert {picture, hints} <= set(messages)
    change(LESSON, template_picture(), "iVBORw0KGgo=")
    change("exercises/mistakes/week09.toml", "The foot is", "The lower end is")
    messages = lines(list(verify(course, jobs=1)), course)
    assert not [line for line in messages if "its picture" in line or "exercises/mistakes" in line]


@pytest.mark.parametrize(
    ("topic", "message"),
    [
        ("/posst", "the solution does not use the input topic '/posst'. Did you mean post?"),
        ("/post", ""),
        ("/odometry", ""),
    ],
)
@pytest.mark.usefixtures("_nothing_runs")
def test_misspelled_input_topic_is_reported(course: Course, change: Break, topic: str, message: str) -> None:
    inputs = f'inputs=(Message("{topic}", "std_msgs/msg/Bool", {{"data": True}}),),\n'
    change(PUBLIC, "            seed=1,\n", f"            seed=1,\n            {inputs}")
    change(PUBLIC, "    Check,\n", "    Check,\n    Message,\n")
    (report,) = verify(course, jobs=1)
    found = [str(flaw) for flaw in report.flaws if flaw.aspect == "fields"]
    assert len(found) == bool(message)
    assert all(message in line and "checks/week09.py line 46" in line for line in found)


@pytest.mark.slow
def test_endless_loop_in_a_solution_ends_the_verification_of_its_week(course: Course, change: Break) -> None:
    change(TOML, "[weeks]\n", "[limits]\ncell_seconds = 1\nscenario_seconds = 1\n\n[weeks]\n")
    change(
        SOLUTION,
        'height = my_values(\\"week09.post\\")',
        'while True: pass\\n        my_values(\\"week09.post\\")',
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("course_lib.authoring.verify._check_exercise", lambda *_: iter(()))
        patch.setattr("course_lib.authoring.verify.page_flaws", lambda *_: iter(()))
        patch.setattr("course_lib.authoring.verify.make_edits", lambda *_: pytest.fail("it went on"))
        (report,) = verify(course, ("week09",), jobs=1)
    assert {flaw.aspect for flaw in report.flaws} == {"solution"}
    assert any("still running after 1 s: is it an endless loop?" in f.text for f in report.flaws)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("return True", "TypeError: the check returned True, expected passed(...) or failed(...)"),
        ("return evidence.nothing", "AttributeError: 'Evidence' object has no attribute 'nothing'"),
        ("while True: pass", "TimeoutError: it takes more than 0.5 s"),
    ],
)
def test_broken_check_of_an_author_is_reported_once_and_ends_its_week(
    course: Course, change: Break, body: str, message: str
) -> None:
    change(PUBLIC, "POST = Task(", f"def own(evidence):\n    {body}\n\n\nPOST = Task(")
    change(PUBLIC, "checks=steady(", 'checks=steady(Check("my own", own),')
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("course_lib.authoring.verify._check_exercise", lambda *_: iter(()))
        patch.setattr("course_lib.authoring.verify.page_flaws", lambda *_: iter(()))
        patch.setattr("course_lib.authoring.verify.make_edits", lambda *_: pytest.fail("it went on"))
        patch.setattr("course_lib.grading.judge.CHECK_SECONDS", 0.5)
        patch.setattr("course_lib.authoring.rehearsal._hollow_results", lambda *_: pytest.fail("hollow"))
        (report,) = verify(course, ("week09",), jobs=1)
    (flaw,) = [flaw for flaw in report.flaws if flaw.aspect == "solution"]
    assert message in flaw.text
    assert re.search(r"checks/week09\.py line \d+: ", flaw.text)


def test_wrong_answer_with_most_points_is_reported(course: Course) -> None:
    report = WeekReport("week09", (), earned_fractions={"week09.post: red": 0.9, "a": 0.1, "b": 0.2})
    (line,) = [line for line in lines([report], course) if "wrong answers" in line]
    assert line.startswith("week09: 3 wrong answers keep 0.20 of their task's points in the median, ")
    assert line.endswith("at most 0.90 (week09.post: red)")


@pytest.mark.parametrize(
    "line", ["from vizualization_msgs.msg import Marker", "from visualization_msgs.msgs import Marker"]
)
@pytest.mark.usefixtures("_nothing_runs")
def test_failing_import_in_a_solution_does_not_end_verification(
    course: Course, change: Break, line: str
) -> None:
    change(SOLUTION, "from visualization_msgs.msg import Marker", line)
    (report,) = verify(course, jobs=1)
    assert {flaw.aspect for flaw in report.flaws} == {"fresh"}


@pytest.mark.slow
@pytest.mark.usefixtures("_nothing_runs")
def test_faulty_week_does_not_prevent_verification_of_other_weeks(course: Course, change: Break) -> None:
    new_week("week10", "Planning", course)
    change(PUBLIC, "TASKS = (POST,)", "TASKS = POST")
    nine, ten = verify(course, jobs=1)
    assert (nine.week, nine.cell("files"), nine.cell("solution")) == ("week09", "✘", ".")
    assert (ten.week, ten.flaws) == ("week10", ())


@pytest.mark.slow
@pytest.mark.usefixtures("_nothing_runs")
def test_faulty_week_table_in_course_toml_prevents_release_but_not_verification_of_other_weeks(
    course: Course, change: Break
) -> None:
    new_week("week10", "Planning", course)
    change(TOML, "post = 100\n\n[weeks.week10]", "post = 90\n\n[weeks.week10]")
    nine, ten = verify(course, jobs=1)
    assert (nine.week, nine.cell("files"), nine.cell("solution")) == ("week09", "✘", ".")
    assert (ten.week, ten.flaws) == ("week10", ())
    with pytest.raises(CourseError, match=r"nothing was released.*line \d+: weeks: week09: points"):
        reject_broken(course)


def test_broken_course_is_not_released_and_verified_weeks_are_not_rerun(
    course: Course, change: Break, monkeypatch: pytest.MonkeyPatch
) -> None:
    verified = list[str]()

    def look(_: Course, weeks: Sequence[str]) -> Iterator[WeekReport]:
        verified.extend(weeks)
        yield from (WeekReport(week, flaws) for week in weeks)

    flaws: tuple[Flaw, ...] = (Flaw("quiz", "no right answer", "week09.toml line 3"),)
    monkeypatch.setattr("course_lib.authoring.verify.verify", look)
    messages = list[str]()
    with pytest.raises(CourseError, match=r"nothing was released\. week09, quiz: week09\.toml line 3"):
        reject_broken(course, messages.append)
    assert messages[1] == "week09: 1 flaw. quiz: week09.toml line 3: no right answer"
    flaws, messages = (), []
    reject_broken(course, messages.append)
    assert messages == ["verifying week09 (1 of 1), which can take minutes …"]
    reject_broken(course, messages.append)
    assert len(messages) == 1
    assert verified == ["week09", "week09"]
    change(QUIZ, "0.8 m stands", "0.9 m stands")
    reject_broken(course)
    assert verified == 3 * ["week09"]
