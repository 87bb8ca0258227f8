"""Every aspect of `course verify` notices what it is for, and names the place."""

from collections.abc import Iterator, Sequence

import pytest

from course_lib.authoring.flaw import Flaw
from course_lib.authoring.memory import refuse_broken
from course_lib.authoring.new_week import new_week
from course_lib.authoring.verify import WeekReport, page_flaws, verify
from course_lib.errors import CourseError
from course_lib.grading.records import Course
from tests.authoring.conftest import Break, empty_course, write

TOML = "exercises/course.toml"
PUBLIC, HIDDEN = "exercises/checks/week09.py", "solutions/checks/week09.py"
SOLUTION, LESSON = "solutions/week09_solution.ipynb", "notebooks/week09_occupancy_maps.ipynb"
EXERCISE = "exercises/week09_exercise.ipynb"
ANSWERS, QUIZ = "solutions/answers/week09.toml", "exercises/quizzes/week09.toml"
SHAPE = 'scale=(0.2, 0.2, my("height"))).titled('
FORMAL = "*with_formal([check.requiring(always) for check in content], *formal)"
BLUE = "expect_marker(TOPIC, color=(0.0, 0.0, 1.0, 1.0))"
INPUT = '            seed=1,\n            inputs=(Message("/a", "std_msgs/msg/Bool", {"dta": 1}),),\n'
GRADING = "from course_lib.grading import ("

# aspect; file, what stands there, what somebody writes instead; what is said of it, and where
Row = tuple[str, list[tuple[str, str, str]], str, str]
RUN: list[Row] = [
    ("solution", [(HIDDEN, "times=0.5", "times=0.6")], "hidden 'longer'", "checks/week09.py line 18"),
    (
        "solution",
        [(SOLUTION, 'height = my_values(\\"week09.post\\")[\\"height\\"]', "height = 0.6")],
        "the solution with {'height': 0.8} has",
        PUBLIC,
    ),
    ("stub", [(EXERCISE, "raise NotImplementedError", "print")], "does not say what is missing", SOLUTION),
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
    ("wrong", [(ANSWERS, '"too low"', '"too high"')], "expected a message with 'too high'", ANSWERS),
    ("wrong", [(ANSWERS, "Marker.CUBE", "Marker.CUBES")], "a box: the code raises", ANSWERS),
    ("wrong", [(ANSWERS, '"position.z = height / 2"', '"position.y = 1"')], "is in 0 cells", ANSWERS),
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
    ("fields", [(PUBLIC, '"CYLINDER"', '"CYLINDR"')], "Did you mean CYLINDER", "checks/week09.py line 46"),
]


@pytest.fixture
def _nothing_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("course_lib.authoring.verify.WeekRehearsals.flaws", lambda _: iter(()))


WEEKS = [f"week{number:02}" for number in range(9, 9 + len(RUN))]  # each fault of RUN has a week of its own


@pytest.fixture(scope="module")
def reports(tmp_path_factory: pytest.TempPathFactory) -> dict[str, WeekReport]:
    """All faults of RUN, verified at once: to start what runs answers costs more than a week does."""
    course = empty_course(tmp_path_factory.mktemp("faults"))
    for week, (_, changes, _, _) in zip(WEEKS, RUN, strict=True):
        new_week(week, "Occupancy maps", course)
        for name, old, new in changes:
            write(course, *(part.replace("week09", week) for part in (name, old, new)))
    return {report.week: report for report in verify(course, WEEKS, jobs=2)}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("week", "aspect", "text", "place"),
    [(week, aspect, text, place) for week, (aspect, _, text, place) in zip(WEEKS, RUN, strict=True)],
    ids=[f"{aspect}-{text[:40]}" for aspect, _, text, _ in RUN],
)
def test_a_fault_that_shows_when_answers_run_is_found(
    reports: dict[str, WeekReport], week: str, aspect: str, text: str, place: str
) -> None:
    found = [flaw for flaw in reports[week].flaws if flaw.aspect == aspect]
    place = place.replace("week09", week)
    assert [f for f in found if text in f.text and place in f.place], list(map(str, reports[week].flaws))


READ: list[Row] = [
    ("files", [(PUBLIC, "(POST,)", "(PST,)")], "NameError: name 'PST' is not defined. Did you mean POST", ""),
    ("files", [(PUBLIC, "(POST,)", "(PST,)")], "checks/week09.py line 59: ", ""),
    ("files", [(TOML, "post = 100", "pots = 100")], "course.toml has points for ['week09.pots']", ""),
    ("files", [(TOML, "week09", "week08")], "course.toml has no points for week09, but there is ", ""),
    ("files", [(ANSWERS, 'miss = "red"', 'mis = "red"')], "week09.toml line 21: week09.post: ", ""),
    ("quiz", [(QUIZ, "right = true\n", "")], "has 0", ""),
    ("fresh", [(EXERCISE, "Save the notebook", "Save it")], "it is not what the solution gives", EXERCISE),
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
def test_a_fault_that_shows_when_files_are_read_is_found(
    course: Course, change: Break, aspect: str, changes: list[tuple[str, str, str]], text: str, place: str
) -> None:
    for one in changes:
        change(*one)
    reports = {report.week: report for report in verify(course, jobs=1)}
    found = [flaw for flaw in reports["week09"].flaws if flaw.aspect == aspect]
    assert [flaw for flaw in found if text in flaw.text and place in flaw.place], list(map(str, found))


# what stands in the lesson, what somebody writes instead, and what is said of it
LESSONS = [
    ("attachment:picture.png", "picture.png", "the first cell has no picture"),
    ("**After this lesson you can**", "**You can**", "missing: **After this lesson you can**"),
    ("**A true story.**", "**A story.**", "above '## Do you remember?'"),
    ("> Source:", "> From:", "has no line '> Source: …'"),
    ("## Do you remember?", "## Once more", "the first section must be"),
    ('quiz(\\"week09_recall\\")', "pass", "the cells with quizzes are"),
    ("## 3. Show it (3 min)", "## 3. Look (3 min)", "expected the headings 'Show it'"),
    ("my_files/my_week9.html", "my_week9.html", "expected a file in my_files/"),
    ("(https://docs", "(http://docs", "at least 3 links"),
    ("<summary>Answer</summary>", "<summary>A</summary>", "has no <details>"),
    ("> **On the robot**", "> **There**", "missing: '> **On the robot**'"),
    ("(8 min)", "(9 min)", "the sections sum to 34 min"),
    ('"minutes": 32', '"minutes": 30', "course.minutes is 30"),
    ('compare(\\"week09.top\\"', 'print(\\"x\\"', "it asks to predict ['week09.top'], but compares []"),
    ("week09.top", "week09.height", "but week09.toml has ['week09.top']"),
    ("run_live(PostNode())", 'run_live(PostNode()); \\"1.0 m\\"', "shows the answer to week09.top"),
    ("%load_ext course_lib", "import course_lib", "must begin with: %load_ext course_lib"),
    (
        "import Viewer, ",
        "import Viewer, load_robot, ",
        "load_robot is imported from course_lib, but",
    ),
    ("rclpy.init()", "rclpy.init(", "SyntaxError"),
    ("## 4. Recap", "#### 4. Recap", "is of level 4, below one of level 2"),
    ("# Week 9: Occupancy", "## Week 9: Occupancy", "expected one title"),
    ("Understanding topics, an official ROS 2 tutorial", "here", "the link 'here' needs words"),
    ('"outputs": []', '"outputs": [{"output_type": "stream", "name": "stdout", "text": []}]', "have outputs"),
    ('"nbformat": 4,', '"nbformat":4,', "its JSON has another layout"),
    ("Nothing is marked.", f"Nothing {'is it and ' * 12} marked.", "a sentence has"),
    ("rclpy.init()", "rclpy.init()" + 25 * "\\nprint()", "expected at most 25"),
    ("my_values", "my_value", "an answer uses my_values, which no lesson up to this week shows"),
]


@pytest.mark.parametrize(("old", "new", "text"), LESSONS, ids=[row[2][:40] for row in LESSONS])
def test_a_lesson_against_a_rule_is_named(
    course: Course, change: Break, old: str, new: str, text: str
) -> None:
    change(LESSON, old, new)
    found = [str(flaw) for flaw in page_flaws("week09", course)]
    assert [line for line in found if text in line], found


@pytest.mark.usefixtures("_nothing_runs")
def test_a_faulty_week_does_not_keep_the_others_from_being_verified(course: Course, change: Break) -> None:
    new_week("week10", "Planning", course)
    change(PUBLIC, "TASKS = (POST,)", "TASKS = POST")
    nine, ten = verify(course, jobs=1)
    assert (nine.week, nine.cell("files"), nine.cell("solution")) == ("week09", "✘", ".")
    assert (ten.week, ten.flaws) == ("week10", ())


def test_a_broken_course_is_not_released_and_what_was_verified_is_not_run_again(
    course: Course, change: Break, monkeypatch: pytest.MonkeyPatch
) -> None:
    verified = list[str]()

    def look(_: Course, weeks: Sequence[str]) -> Iterator[WeekReport]:
        verified.extend(weeks)
        yield from (WeekReport(week, flaws) for week in weeks)

    flaws: tuple[Flaw, ...] = (Flaw("quiz", "no right answer", "week09.toml line 3"),)
    monkeypatch.setattr("course_lib.authoring.memory.verify", look)
    with pytest.raises(CourseError, match=r"nothing is released\. week09, quiz: week09\.toml line 3"):
        refuse_broken(course)
    flaws = ()
    refuse_broken(course)
    refuse_broken(course)
    assert verified == ["week09", "week09"]
    change(QUIZ, "0.8 m stands", "0.9 m stands")
    refuse_broken(course)
    assert verified == 3 * ["week09"]
