"""Hints by the mistake that was seen."""

import ast
import math
from collections.abc import Callable
from dataclasses import replace
from fnmatch import fnmatchcase
from pathlib import Path

from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker

import course_lib.grading.vocabulary
from course_lib.course.installation import exercises_dir
from course_lib.grading.advice import AFTER_AN_ERROR, Advice, hints_by_mistake, large_messages, not_numbers
from course_lib.grading.catalog import load_catalog
from course_lib.grading.evidence import Evidence
from course_lib.grading.judge import NEEDS_ANOTHER, CheckResult, TaskResult
from course_lib.grading.task import Scenario, Task
from course_lib.grading.vocabulary.markers import PROPERTIES

WORDS = Path(course_lib.grading.vocabulary.__file__).parent
LADDER = ("one", "two", "three")
MISTAKE = "a value has the wrong sign"
TASK = Task("week01.half", "Half of it", "function", "half", LADDER, (Scenario("public"),))


def failing(mistake: str, title: str = "its value") -> CheckResult:
    return CheckResult(title, "public", False, 1.0, 0.0, "2.00, expected -2.00", mistake)


def result(*checks: CheckResult) -> TaskResult:
    return TaskResult("week01.half", "Half of it", 10.0, False, checks)


def texts(node: ast.AST) -> set[str]:
    """All texts in a piece of code; a value inside an f-string stands as *."""
    found: set[str] = set()
    for part in ast.walk(node):
        match part:
            case ast.JoinedStr(values):
                found.add("".join(str(v.value) if isinstance(v, ast.Constant) else "*" for v in values))
            case ast.Constant(str(text)):
                found.add(text)
    return found


TREES = [ast.parse(path.read_text(encoding="utf-8")) for path in sorted(WORDS.glob("*.py"))]


def named_by_words() -> set[str]:
    """The texts that stand where a Problem is made, and those of the table of a marker's properties."""
    found = {row[0] for row in PROPERTIES.values()}
    for node in (node for tree in TREES for node in ast.walk(tree)):
        match node:
            case ast.Call(func=ast.Name("Problem"), args=[_, ast.Constant() | ast.JoinedStr() as mistake]):
                found |= texts(mistake)
    return found


def test_every_mistake_that_a_word_names_has_a_hint() -> None:
    table, named = hints_by_mistake(), named_by_words()
    assert len(named) > 80
    with_value = {"a stamp is *", "a stamp is "}  # the table has both, in the past and in the future
    assert {m for m in named - with_value if not any(fnmatchcase(m, kind) for kind in table)} == set()


def test_every_hint_belongs_to_a_mistake_that_the_vocabulary_can_name() -> None:
    said = set().union(*map(texts, TREES))
    assert {k for k in hints_by_mistake() if not any(fnmatchcase(k, text) for text in said)} == set()


def test_the_first_failure_shows_the_kind_and_the_second_the_numbers() -> None:
    advice, wrong = Advice(), result(failing(MISTAKE))
    assert [advice.reasons(wrong).checks[0].message for _ in range(2)] == [MISTAKE, "2.00, expected -2.00"]


def test_a_check_without_a_kind_or_behind_another_keeps_its_message() -> None:
    kept = result(failing(""), failing(NEEDS_ANOTHER))
    assert Advice().reasons(kept) == kept


def test_a_task_s_own_hint_for_a_mistake_comes_before_the_general_one() -> None:
    own = replace(TASK, mistakes={MISTAKE: "Half of it, not minus half of it."})
    assert Advice().hint(own, result(failing(MISTAKE))) == "Hint: Half of it, not minus half of it."
    assert Advice().hint(TASK, result(failing(MISTAKE))).startswith("Hint: The size is right and the sign")


def test_the_ladder_follows_where_the_mistake_s_hint_was_shown_or_there_is_none() -> None:
    advice = Advice()
    said = [advice.hint(TASK, result(failing(MISTAKE)))[:11] for _ in range(3)]
    assert said == ["Hint: The s", "Hint 1 of 3", "Hint 2 of 3"]
    assert Advice().hint(TASK, result(failing("of no kind"))) == "Hint 1 of 3: one"


def test_the_cause_is_the_first_check_that_fails_by_itself() -> None:
    behind = failing(NEEDS_ANOTHER, "the rate")
    assert "wrong sign" not in Advice().hint(TASK, result(behind, failing("a value is missing")))
    assert Advice().hint(TASK, result(behind, failing("a value is missing"))).startswith("Hint: Nothing came")


def test_a_new_kernel_counts_from_the_beginning() -> None:
    first, second = Advice(), Advice()
    assert first.hint(TASK, result(failing(MISTAKE))) == second.hint(TASK, result(failing(MISTAKE)))


def test_messages_that_take_most_of_the_time_are_named(evidence: Callable[..., Evidence]) -> None:
    small, large = Marker(points=[Point()]), Marker(points=[Point()] * 100_000)
    assert large_messages([evidence((1.0, "/small", small))]) == []
    (said,) = large_messages([evidence((1.0, "/small", small), (1.5, "/large", large))])
    assert said.startswith("This took long: a message on /large holds 2 MB")


def test_nan_is_found_in_doubles_floats_and_long_lists(evidence: Callable[..., Evidence]) -> None:
    points = [Point()] * 7 + [Point(y=math.nan)]
    for message, place in (
        (Marker(points=points), "points[7].y"),
        (Marker(color=ColorRGBA(g=math.nan)), "color.g"),
    ):
        (said,) = not_numbers([evidence((1.0, "/m", message))])
        assert f"{place} on /m" in said
    assert not_numbers([evidence((1.0, "/m", Marker(id=-1, text="odd")))]) == []


def test_a_task_s_own_hints_are_for_mistakes_that_the_vocabulary_names() -> None:
    catalog = load_catalog(exercises_dir())
    kinds = {kind for task in catalog.tasks.values() for kind in task.mistakes}
    assert kinds
    assert {k for k in kinds if not any(fnmatchcase(k, known) for known in hints_by_mistake())} == set()


def test_after_an_exception_there_is_no_hint_on_what_its_node_did_not_publish() -> None:
    advice = Advice()
    stopped = replace(
        result(failing("nothing was published on an expected topic")), errors=("ValueError: x",)
    )
    said = [advice.hint(TASK, stopped) for _ in range(2)]
    assert said == [f"Hint: {AFTER_AN_ERROR}", "Hint 1 of 3: one"]


def test_the_ladder_is_for_an_exception_that_comes_again_not_for_the_next_one() -> None:
    advice, texts = Advice(), ("ValueError: x", "TypeError: y", "TypeError: y")
    errors = [f"{text} (cell In[{cell}], line {cell}: x())" for cell, text in enumerate(texts)]
    said = [advice.hint(TASK, replace(result(failing(MISTAKE)), errors=(error,))) for error in errors]
    assert said == [f"Hint: {AFTER_AN_ERROR}", f"Hint: {AFTER_AN_ERROR}", "Hint 1 of 3: one"]
