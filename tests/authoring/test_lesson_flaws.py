"""The rules for lessons and for tasks in notebooks: one violation of each is reported."""

import ast

import pytest

from course_lib.authoring.rules import page_flaws, parse_cell
from course_lib.grading.store import Course
from tests.authoring.conftest import Break

SOLUTION, LESSON = "solutions/week09_solution.ipynb", "notebooks/week09_occupancy_maps.ipynb"

# the notebook, its original text, the faulty text, and the reported message
ASKED = [
    (LESSON, 'quiz(\\"week09\\")', "quiz('week08')", "it asks quiz('week08'): there is no week08.toml"),
    (
        LESSON,
        'predict(\\"week09.top',
        'predict(\\"week09.tip',
        "has no prediction with key = 'tip'. Did you mean top",
    ),
    (
        LESSON,
        'compare(\\"week09.top\\"',
        "compare('week09.tip'",
        "it asks compare('week09.tip'): week09.toml",
    ),
    (SOLUTION, "rclpy.init()", "predict('week07.x')", "it asks predict('week07.x'): there is no week07.toml"),
]


@pytest.mark.parametrize(("file", "old", "new", "text"), ASKED, ids=[row[3][:40] for row in ASKED])
def test_undefined_question_is_reported(
    course: Course, change: Break, file: str, old: str, new: str, text: str
) -> None:
    change(file, old, new)
    flaws = [flaw for flaw in page_flaws("week09", course) if flaw.aspect == "quiz"]
    assert [flaw for flaw in flaws if text in flaw.text and file in flaw.location], list(map(str, flaws))


# original text of the lesson, faulty text, and the reported message
LESSONS = [
    ("attachment:picture.png", "picture.png", "the first cell has no picture"),
    ("(attachment:picture.png", "(attachment:pic.png", "'attachment:pic.png' is missing"),
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
    ("## 4. Recap", "#### 4. Recap", "has level 4, but follows one of level 2"),
    ("# Week 9: Occupancy", "## Week 9: Occupancy", "expected one title"),
    ("Understanding topics, an official ROS 2 tutorial", "here", "the link 'here' needs a description"),
    ('"outputs": []', '"outputs": [{"output_type": "stream", "name": "stdout", "text": []}]', "have outputs"),
    ('"nbformat": 4,', '"nbformat":4,', "its JSON is formatted differently"),
    ("Nothing is marked.", f"Nothing {'is it and ' * 12} marked.", "a sentence has"),
    ("rclpy.init()", "rclpy.init()" + 25 * "\\nprint()", "expected at most 25"),
    ("my_values", "my_value", "an answer uses my_values, which no lesson up to this week shows"),
]


@pytest.mark.parametrize(("old", "new", "text"), LESSONS, ids=[row[2][:40] for row in LESSONS])
def test_lesson_that_violates_a_rule_is_reported(
    course: Course, change: Break, old: str, new: str, text: str
) -> None:
    change(LESSON, old, new)
    flaws = [str(flaw) for flaw in page_flaws("week09", course)]
    assert [line for line in flaws if text in line], flaws


def test_command_that_continues_on_further_lines_is_not_a_syntax_error() -> None:
    tree = parse_cell("%ros2 topic list | \\\n    grep \\\n    scan\nrclpy.init()\n!ls")
    assert [ast.unparse(statement) for statement in tree.body] == ["rclpy.init()"]
    with pytest.raises(SyntaxError):
        parse_cell("%ros2 topic list\n    grep")
