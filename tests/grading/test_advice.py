"""Hints by the mistake that was seen."""

import ast
import json
import math
import re
from collections.abc import Callable
from dataclasses import replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, Literal

import pytest
import rclpy
from geometry_msgs.msg import Point
from sensor_msgs.msg import Image
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker

import course_lib.grading.vocabulary
from course_lib.course.material import exercises_dir, solutions_dir
from course_lib.grading.advice import (
    AFTER_AN_ERROR,
    AFTER_AN_ERROR_IN_A_CALL,
    SILENT,
    TOO_MUCH,
    Advice,
    Code,
    best_effort_hint,
    hints_by_mistake,
    incompatible_policy_hint,
    large_message_hint,
    missing_node_hint,
    missing_return_hint,
    nan_hint,
    parameter_order_hint,
)
from course_lib.grading.evidence import Evidence
from course_lib.grading.judge import NEEDS_ANOTHER
from course_lib.grading.records import CheckResult, TaskResult
from course_lib.grading.task import Call, Message, Scenario, Task, load_catalog
from course_lib.grading.vocabulary.markers import PROPERTIES
from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.ros.time.time_lock import time_lock

SNIPPET = re.compile(r"`([^`]+)`")
WORDS = Path(course_lib.grading.vocabulary.__file__).parent
LADDER = ("one", "two", "three")
MISTAKE = "a value has the wrong sign"
TASK = Task("week01.half", "Half of it", "function", "half", LADDER, (Scenario("public"),))


def failing(mistake: str, title: str = "its value") -> CheckResult:
    return CheckResult(title, "public", False, 1.0, 0.0, "2.00, expected -2.00", mistake)


def result(*checks: CheckResult) -> TaskResult:
    return TaskResult("week01.half", "Half of it", 10.0, False, checks)


def texts(node: ast.AST) -> set[str]:
    """Return all strings in a piece of code, with * for each replacement field."""
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
    """Return the texts with which a Problem is created, and the texts in the table of marker properties."""
    found = {row[0] for row in PROPERTIES.values()}
    for node in (node for tree in TREES for node in ast.walk(tree)):
        match node:
            case ast.Call(func=ast.Name("Problem"), args=[_, ast.Constant() | ast.JoinedStr() as mistake]):
                found |= texts(mistake)
    return found


def test_every_mistake_reported_by_a_check_has_a_hint() -> None:
    table, named = hints_by_mistake(), named_by_words()
    assert len(named) > 80
    with_value = {"a stamp is *", "a stamp is "}  # the table has both, in the past and in the future
    with_part = {"*: the *", ": the "}  # another mistake, followed by the part that is wrong
    missing = {m for m in named - with_value - with_part if not any(fnmatchcase(m, kind) for kind in table)}
    assert missing == set(), "grading/vocabulary/hints.toml has a hint for each kind of mistake"


def test_every_hint_belongs_to_a_mistake_that_a_check_can_report() -> None:
    said = set().union(*map(texts, TREES))
    unused = {k for k in hints_by_mistake() if not any(fnmatchcase(k, text) for text in said)}
    assert unused == set(), "no check function reports these mistakes of grading/vocabulary/hints.toml"


PASSING = CheckResult("its size", "public", False, 1.0, 1.0, "as expected", "as expected")


def test_hint_of_the_task_for_a_mistake_precedes_the_general_hint() -> None:
    own = replace(TASK, mistakes={MISTAKE: "Half of it, not minus half of it."})
    assert Advice().hint(own, result(failing(MISTAKE))) == ["Hint: Half of it, not minus half of it."]
    (general,) = Advice().hint(TASK, result(failing(MISTAKE)))
    assert general.startswith("Hint: The size is right, but the sign")


def test_hint_for_the_mistake_precedes_the_hint_ladder_each_time() -> None:
    advice = Advice()
    shown = [[line[:11] for line in advice.hint(TASK, result(failing(MISTAKE)))] for _ in range(5)]
    by_cause = "Hint: The s"
    assert shown == [
        [by_cause],
        *([by_cause, f"Hint {step} of 3"] for step in (1, 2, 3, 3)),
    ]
    assert Advice().hint(TASK, result(failing("of no kind"))) == ["Hint 1 of 3: one"]


def test_hint_ladder_does_not_advance_while_more_checks_pass() -> None:
    advice, size = Advice(), failing("the size of a marker is wrong", "its size")
    assert advice.hint(TASK, result(failing("of no kind"), size)) == ["Hint 1 of 3: one"]
    better = advice.hint(TASK, result(failing("of no kind"), PASSING))
    assert better == ["Better: 1 of 2 checks pass now, 0 before."]
    assert advice.hint(TASK, result(failing("of no kind"), PASSING)) == ["Hint 2 of 3: two"]


def test_hint_ladder_does_not_advance_while_faults_are_fixed_one_by_one() -> None:
    advice = Advice()
    kinds = ("a value is missing", "a list has the wrong length", "a key is missing", MISTAKE)
    shown = [advice.hint(TASK, result(failing(kind))) for kind in kinds]
    assert [len(lines) for lines in shown] == [1, 1, 1, 1]
    assert all(lines[0].startswith("Hint: ") for lines in shown)


def test_hint_ladder_advances_while_a_student_alternates_between_two_mistakes() -> None:
    advice = Advice()
    kinds = (MISTAKE, "a value is missing", MISTAKE, "a value is missing")
    shown = [advice.hint(TASK, result(failing(kind))) for kind in kinds]
    assert [lines[1:] for lines in shown] == [[], [], ["Hint 1 of 3: one"], ["Hint 2 of 3: two"]]


def test_hint_ladder_advances_if_fewer_checks_pass_for_the_same_cause() -> None:
    advice, size = Advice(), failing(MISTAKE, "its size")
    advice.hint(TASK, result(failing(MISTAKE), PASSING))
    assert advice.hint(TASK, result(failing(MISTAKE), size))[1:] == ["Hint 1 of 3: one"]


SOURCE = """
    def draw(self):
        cube = Marker(ns="cubes")
        cube.pose.position.z = .5
        cube.scale.x = cube.scale.y = 1.0
        cube.header.stamp = self.get_clock().now().to_msg()
"""


@pytest.mark.parametrize(
    ("hint", "is_there"),
    [
        ("Set `pose.position.z = 0.5`.", True),
        ("Set `marker.pose.position.z = 0.5`.", False),
        ("Set `pose.position.z = 0.5` and `scale.y = 1.0`.", True),
        ("Set `pose.position.z = 0.5` and `scale.z = 1.0`.", False),
        ("`self.get_clock().now().to_msg()` is the time.", True),
        ("Give it `ns='cubes'`.", True),
        ("How high is the center?", False),
        ("Write `not ) python`.", False),
    ],
)
def test_hint_is_omitted_if_the_code_already_contains_it(hint: str, is_there: bool) -> None:
    assert Code(SOURCE).has_code_of(hint) is is_there
    task = replace(TASK, mistakes={MISTAKE: hint})
    first = Advice().hint(task, result(failing(MISTAKE)), SOURCE)
    assert first == (["Hint 1 of 3: one"] if is_there else [f"Hint: {hint}"])


def test_hint_ladder_skips_a_step_that_the_code_already_contains() -> None:
    task = replace(TASK, hints=("one", "`cube.scale.x = 1.0`", "`cube.scale.z = 1.0`"))
    advice = Advice()
    shown = [advice.hint(task, result(failing("of no kind")), SOURCE) for _ in range(3)]
    assert shown == [["Hint 1 of 3: one"], *[["Hint 3 of 3: `cube.scale.z = 1.0`"]] * 2]


def test_hint_is_for_the_first_check_whose_required_checks_pass() -> None:
    behind = failing(NEEDS_ANOTHER, "the rate")
    (shown,) = Advice().hint(TASK, result(behind, failing("a value is missing")))
    assert shown.startswith("Hint: Nothing was")


def test_hint_ladder_restarts_in_a_new_kernel() -> None:
    first, second = Advice(), Advice()
    assert first.hint(TASK, result(failing(MISTAKE))) == second.hint(TASK, result(failing(MISTAKE)))


def test_messages_that_take_most_of_the_check_time_are_reported(evidence: Callable[..., Evidence]) -> None:
    small, large = Marker(points=[Point()]), Marker(points=[Point()] * 100_000)
    assert large_message_hint([evidence((1.0, "/small", small))]) == []
    (message,) = large_message_hint([evidence((1.0, "/small", small), (1.5, "/large", large))])
    assert message.startswith("This took long: a message on /large holds 2 MB")


@pytest.mark.parametrize(
    ("message", "reliability", "is_reported"),
    [
        (Marker(), "best_effort", True),
        (Marker(), "reliable", False),
        # The task about a camera intends it.
        (Image(), "best_effort", False),
    ],
)
def test_best_effort_markers_that_rviz2_would_not_display_are_reported(
    evidence: Callable[..., Evidence],
    message: Any,
    reliability: Literal["reliable", "best_effort"],
    is_reported: bool,
) -> None:
    made = evidence((1.0, "/m", message))
    samples = tuple(replace(one, qos=replace(one.qos, reliability=reliability)) for one in made.samples)
    said = best_effort_hint([replace(made, samples=samples)])
    assert [text[:70] for text in said] == [
        "Here the checks accept that /m is published with Best Effort. On ROS 2"
    ] * is_reported


def test_nan_is_detected_in_doubles_floats_and_long_lists(evidence: Callable[..., Evidence]) -> None:
    points = [Point()] * 7 + [Point(y=math.nan)]
    for message, place in (
        (Marker(points=points), "points[7].y"),
        (Marker(color=ColorRGBA(g=math.nan)), "color.g"),
    ):
        (line,) = nan_hint([evidence((1.0, "/m", message))])
        assert f"{place} on /m" in line
    assert nan_hint([evidence((1.0, "/m", Marker(id=-1, text="odd")))]) == []


def test_task_hints_are_for_mistakes_that_a_check_can_report() -> None:
    catalog = load_catalog(exercises_dir())
    # A kind may end with a part of a value.
    kinds = {kind.partition(": the ")[0] for task in catalog.tasks.values() for kind in task.mistakes}
    assert kinds
    assert {k for k in kinds if not any(fnmatchcase(k, known) for known in hints_by_mistake())} == set()


def test_hint_for_a_part_of_a_value_precedes_the_hint_for_its_kind() -> None:
    own = replace(TASK, mistakes={"a value is wrong: the gap": "The longest one.", MISTAKE: "Half."})
    assert Advice().hint(own, result(failing("a value is wrong: the gap"))) == ["Hint: The longest one."]
    assert Advice().hint(own, result(failing(f"{MISTAKE}: the gap"))) == ["Hint: Half."]
    (general,) = Advice().hint(TASK, result(failing("a value is wrong: the gap")))
    assert general.startswith("Hint: Compute one case by hand")


@pytest.mark.parametrize(
    ("source", "sentence"),
    [
        ("def half(x):\n    print(x / 2)", "print shows a value, and return gives it to the caller."),
        ("def half(x):\n    return viewer.save_rviz(x)", "viewer.save_rviz(…) returns nothing."),
        ("def half(x):\n    y = x / 2", "is there a return?"),
        ("def half(x):\n    def inner():\n        return x / 2", "the lines of def inner run only when"),
        ("def half(x):\n    return own(x)\n\ndef own(x):\n    x / 2", "own has no return with a value."),
    ],
)
def test_cause_of_a_missing_return_value_is_reported(source: str, sentence: str) -> None:
    (line,) = missing_return_hint(TASK, [Evidence("week01.half", "public", 5.0, returns=(None,))], source)
    assert sentence in line


def test_return_in_a_loop_is_reported_before_the_missing_return_value() -> None:
    source = "def half(items):\n    for item in items:\n        return item / 2"
    evidence = [Evidence("week01.half", "public", 5.0, returns=(None,))]
    assert missing_return_hint(TASK, evidence, source) == []


def test_hint_states_the_missing_node_whose_parameters_are_set() -> None:
    output = "At 3.00 s: Node not found: /lamp\n"
    source = 'class Lamp(Node):\n    def __init__(self):\n        super().__init__("lamp_node")'
    (line,) = missing_node_hint([Evidence("week01.half", "public", 5.0, output=output)], source)
    assert line.endswith(
        "finds no node /lamp. Compare the name in super().__init__, which here is 'lamp_node'."
    )


def test_after_an_exception_hints_on_missing_messages_are_omitted() -> None:
    advice = Advice()
    stopped = replace(
        result(failing("nothing was published on an expected topic")), errors=("ValueError: x (line 3: x())",)
    )
    messages = [advice.hint(TASK, stopped) for _ in range(2)]
    assert messages == [[f"Hint: {AFTER_AN_ERROR}"], [f"Hint: {AFTER_AN_ERROR}", "Hint 1 of 3: one"]]


def test_error_in_one_call_does_not_hide_the_hint_on_the_other_calls() -> None:
    checks = (failing("a value is missing"), failing(MISTAKE))
    two_calls = Scenario("public", calls=(Call(1.0), Call(2.0)))
    stopped = replace(result(*checks), errors=("ValueError: math domain error (line 3: x())",))
    task = replace(TASK, scenarios=(two_calls,))
    (hint,) = Advice().hint(task, stopped)
    (own,) = Advice().hint(TASK, result(failing(MISTAKE)))
    assert hint == f"Hint: {AFTER_AN_ERROR_IN_A_CALL}{own.removeprefix('Hint: ')}"
    # A layout that was not returned is a consequence of the error.
    without_layout = replace(stopped, checks=(failing("there is no layout"),))
    assert Advice().hint(task, without_layout) == [f"Hint: {AFTER_AN_ERROR}"]
    assert Advice().hint(TASK, stopped) == [f"Hint: {AFTER_AN_ERROR}"]


@pytest.mark.parametrize(
    ("policy", "sentence"),
    [
        ("RELIABILITY", "Hint: Nothing arrives from /scan: it is published with Best Effort"),
        ("DURABILITY", "Hint: Nothing arrives from /scan: it is published as Volatile"),
    ],
)
def test_incompatible_policy_of_a_subscription_is_reported(policy: str, sentence: str) -> None:
    log = (
        "[WARN] [n]: New publisher discovered on topic '/scan', offering incompatible QoS. No "
        f"messages will be received from it. Last incompatible policy: {policy}"
    )
    (hint,) = incompatible_policy_hint([Evidence("week01.half", "public", 1.0, output=log)])
    assert hint.startswith(sentence)


@pytest.mark.parametrize("period", ["60", "1000 * 1.0", "1 / 0.01"])
def test_timer_that_is_due_after_the_scenario_is_reported(period: str) -> None:
    code = f"class A(Node):\n    def __init__(self):\n        self.create_timer({period}, self.tick)"
    task = replace(TASK, scenarios=(Scenario("public", seconds=6.0),))
    shown = Advice().hint(task, result(failing(SILENT)), code)
    assert shown[0].startswith("Hint: The timer calls self.tick for the first time after ")
    assert "timer calls" not in str(Advice().hint(task, result(failing(SILENT)), code.replace(period, "6.0")))


def test_run_that_exceeds_its_limit_has_a_hint_for_the_cause() -> None:
    error = "messages and returned values exceed the limit of a submission (32 MB for all of its tasks)"
    stopped = replace(result(failing(MISTAKE)), errors=(error,))
    assert Advice().hint(TASK, stopped) == [f"Hint: {TOO_MUCH}"]
    code = "def f():\n    return 1 // 12"
    assert Advice().hint(TASK, stopped, code)[0].startswith('Hint: "1 // 12" is 0')


@pytest.mark.parametrize(
    ("mistake", "errors", "is_reported"),
    [
        ("a stamp is in the past", (), True),
        ("the numbers of names and positions differ", (), True),
        ("the numbers of names and positions differ", ("they exceed the limit of a submission",), True),
        ("the color of a marker is wrong", (), False),
        ("a stamp is in the past", ("ValueError: x",), False),
    ],
)
def test_growing_list_is_reported_if_a_check_found_too_many_or_old_items(
    mistake: str, errors: tuple[str, ...], is_reported: bool
) -> None:
    code = """class Boxes(Node):
    def __init__(self):
        self.markers = []
        self.create_timer(1.0, self.draw)

    def draw(self):
        self.markers.append(Marker())
"""
    failed = replace(result(failing(mistake)), errors=errors)
    hint = Advice().hint(TASK, failed, code)[0]
    assert hint.startswith("Hint: self.markers keeps the items of each earlier call of draw") == is_reported


@pytest.mark.parametrize(
    ("topics", "hint"),
    [
        (("/robot/image",), "Your node subscribes to /robot/image, but the messages arrive on /image."),
        (("image",), ""),
        (("/robot/image", "/image"), ""),
        (("~/image",), ""),
    ],
)
def test_subscription_to_another_topic_is_reported(topics: tuple[str, ...], hint: str) -> None:
    message = Message("/image", "sensor_msgs/msg/Image", {})
    task = replace(TASK, scenarios=(Scenario("public", inputs=(message,)),))
    lines = "".join(
        f"        self.create_subscription(Image, '{topic}', self.hear, 10)\n" for topic in topics
    )
    code = f"class Monitor(Node):\n    def __init__(self):\n{lines}"
    expected = f"Hint: {hint}" if hint else "Hint 1 of 3: one"
    advice = Advice()
    shown = [line for _ in range(2) for line in advice.hint(task, result(failing(MISTAKE)), code)]
    assert expected in shown


def test_hint_ladder_starts_when_an_exception_repeats() -> None:
    advice, texts = Advice(), ("ValueError: x", "TypeError: y", "TypeError: y")
    errors = [f"{text} (cell In[{cell}], line {cell}: x())" for cell, text in enumerate(texts)]
    stopped = [replace(result(failing(MISTAKE)), errors=(error,)) for error in errors]
    messages = [advice.hint(TASK, one) for one in stopped]
    after = f"Hint: {AFTER_AN_ERROR}"
    assert messages == [[after], [after], [after, "Hint 1 of 3: one"]]


def test_value_in_the_place_of_another_parameter_of_a_helper_is_reported() -> None:
    call = "self.broadcaster.sendTransform(stamped('map', 'base_link', now, x, y, yaw, 0.0))"
    code = f"class RobotFramesNode(Node):\n    def broadcast(self):\n        {call}\n"
    task = load_catalog(exercises_dir()).task("week04.robot_frames")
    (line,) = parameter_order_hint(task, code)
    assert line.startswith("Hint: stamped gets yaw where its z belongs. Its parameters are (")
    assert parameter_order_hint(task, code.replace("yaw, 0.0", "0.0, yaw")) == []


@pytest.mark.parametrize(
    ("task", "code", "expected"),
    [
        ("week07.box_on_image", "def box_on_image(corners, k): ...", "def box_on_image(k, corners)."),
        ("week07.box_on_image", "def box_on_image(points, k): ...", "def box_on_image(k, corners)."),
        ("week07.box_on_image", "def box_on_image(k, points): ...", ""),
        ("week07.box_on_image", "def box_on_image(corners): ...", "def box_on_image(k, corners)."),
        ("week07.box_on_image", "def box_on_image(k, corners, near): ...", "def box_on_image(k, corners)."),
        ("week07.box_on_image", "def box_on_image(k, corners, near=0.1): ...", ""),
        ("week07.box_on_image", "def box_on_image(*values): ...", ""),
        ("week06.camera", "class Camera(Node):\n    def own(self, b, a): ...", ""),
        ("week03.labels", "class Any(Node):\n    def draw(message, self): ...", "def draw(self, message)."),
    ],
)
def test_parameters_in_another_order_than_in_the_exercise_are_reported(
    task: str, code: str, expected: str
) -> None:
    found = parameter_order_hint(load_catalog(exercises_dir()).task(task), code)
    assert [line.split("write ")[1] for line in found] == [expected] * bool(expected)


def solution_code(week: str) -> str:
    """The code of a week's solution, without magics."""
    cells = json.loads((solutions_dir() / f"{week}_solution.ipynb").read_text(encoding="utf-8"))["cells"]
    code = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    return "\n".join(one for one in code if not re.search(r"^\s*[%!]", one, re.MULTILINE))


def test_hint_code_of_a_task_occurs_in_its_solution() -> None:
    wrong, seen = [], 0
    tasks = load_catalog(exercises_dir()).tasks.values()
    codes = {week: Code(solution_code(week)) for week in {task.week for task in tasks}}
    for task in tasks:
        for snippet in (
            one for hint in (*task.hints, *task.mistakes.values()) for one in SNIPPET.findall(hint)
        ):
            seen += 1
            if not codes[task.week].has(snippet):
                wrong.append((task.id, snippet))
    assert wrong == []
    assert seen > 15


PREAMBLE = """
import math
from rclpy.duration import Duration
from rclpy.node import Node
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path
from visualization_msgs.msg import Marker
from course_lib import Viewer
path = Path()
self, header, viewer, yaw, dx, dy = Node("robot"), Marker().header, Viewer(), 1.0, 1.0, 1.0
"""


def test_code_in_a_general_hint_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    snippets = [one for hint in hints_by_mistake().values() for one in SNIPPET.findall(hint)]
    assert len(snippets) > 5
    with time_lock.hold(), use_graph(Graph()):
        rclpy.init(args=[])
        for code in [PREAMBLE, *snippets]:
            exec(code, names)


@pytest.mark.parametrize(
    ("line", "remark"),
    [
        ("import time as t\n        t.time()", "Here the checks accept t.time()"),
        ("Clock().now()", "Here the checks accept Clock().now()"),
        ("self.get_clock().now()", ""),
        (
            "self.create_publisher(Marker, '/m', ReliabilityPolicy.BEST_EFFORT)",
            "ReliabilityPolicy.BEST_EFFORT is a number, which ROS takes as the queue depth.",
        ),
        ("self.create_publisher(Marker, '/m', 10)", ""),
        (
            "TransformBroadcaster(self)\n    def __init__(self):\n        self.create_timer(1.0, self.tick)",
            "Here the checks accept TransformBroadcaster(…) in tick. On ROS 2 a new publisher",
        ),
        ("Viewer(fixed_frame='/odom')", "Viewer removes the slash in front of the fixed frame '/odom'."),
        ("viewer.fixed_frame = 'odom'", ""),
    ],
)
def test_accepted_habits_are_remarked_when_the_task_passes(line: str, remark: str) -> None:
    code = f"class Lamp(Node):\n    def tick(self):\n        {line}\n"
    passed = TaskResult("week01.half", "Half of it", 10.0, False, ())
    lines = Advice().notes(TASK, replace(passed, checks=(replace(failing(""), score=1.0),)), [], "s1", code)
    assert [text[: len(remark)] for text in lines] == [remark] * bool(remark)


@pytest.mark.parametrize(
    ("task", "code", "start"),
    [
        ("week02.two_link", "class two_link: ...", "Hint: two_link is a class here"),
        ("week01.red_cube", "def RedCubeNode():\n    Node('a')", "Hint: RedCubeNode is a function here"),
        ("week01.red_cube", "def RedCubeNode():\n    return Node('a')", ""),
    ],
)
def test_class_in_the_place_of_a_function_is_reported(task: str, code: str, start: str) -> None:
    found = parameter_order_hint(load_catalog(exercises_dir()).task(task), code)
    assert [line[: len(start)] for line in found] == [start] * bool(start)


def test_relative_topic_in_a_namespace_is_explained() -> None:
    code = (
        "class Lamp(Node):\n    def tick(self):\n        self.create_publisher(Marker, 'm', 10).publish(1)\n"
    )
    check = replace(failing(SILENT), message="nothing was published on /m in 6 s, only on /robot/m")
    assert (
        Advice()
        .hint(TASK, result(check), code)[0]
        .startswith("Hint: 'm' without a slash in front is a name inside the node's namespace, here /robot/m")
    )
