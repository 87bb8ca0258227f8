"""All checks of one marker judge the same marker, and surplus markers cost points."""

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import pytest
from rclpy.duration import Duration
from visualization_msgs.msg import Marker, MarkerArray

from course_lib.course.material import exercises_dir, solutions_dir
from course_lib.grading import Check, Scenario, expect_circle, expect_marker, expect_marker_count, my
from course_lib.grading.evidence import Evidence
from course_lib.grading.judge import judge_task
from course_lib.grading.records import Run, TaskResult
from course_lib.grading.task import Task, load_catalog
from course_lib.ros.graph.graph import START_NS, Sample
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import serialize, type_name

TOPIC = "/visualization_marker"
SURPLUS = "a topic shows more markers than the task asks for"
HEIGHTS = (0.6, 0.8, 1.2, 1.4, 1.6, 1.8)  # [m]
HINTS = ("a", "b", "c")

Publish = Callable[[float], Iterable[Any]]  # markers, or arrays of them, of a time [s]


def marker(
    kind: int, position: Sequence[float], scale: Sequence[float], color: Sequence[float], **more: Any
) -> Any:
    message = Marker(type=kind, ns=more.pop("ns", "shapes"), **more)
    message.header.frame_id = "map"
    message.pose.position.x, message.pose.position.y, message.pose.position.z = map(float, position)
    message.scale.x, message.scale.y, message.scale.z = map(float, scale)
    message.color.r, message.color.g, message.color.b, message.color.a = map(float, color)
    return message


def red_cube(number: int = 0, **more: Any) -> Any:
    return marker(Marker.CUBE, (0, 0, 0.5), (1, 1, 1), (1, 0, 0, 0.8), id=number, **more)


def cylinder(height: float, number: int = 0) -> Any:
    return marker(Marker.CYLINDER, (1, 0, height / 2), (0.4, 0.4, height), (0, 0, 1, 1), id=number)


def stamped(message: Any, seconds: float) -> Any:
    time_ns = START_NS + round(seconds * 1e9)
    for one in getattr(message, "markers", [message]):
        one.header.stamp.sec, one.header.stamp.nanosec = divmod(time_ns, 10**9)
    return message


def evidence_of(publish: Publish, seconds: float, hz: float, **more: Any) -> Evidence:
    times = [step / hz for step in range(1, round(seconds * hz) + 1)]
    samples = tuple(
        Sample(
            START_NS + round(at * 1e9), TOPIC, type_name(message), serialize(stamped(message, at)), Qos(), 1
        )
        for at in times
        for message in publish(at)
    )
    return Evidence("week01.demo", "public", seconds, samples, **more)


def judge_messages(task_id: str, publish: Publish, hz: float = 1.0, **personal: Any) -> TaskResult:
    """Judge the messages of a node by the public and hidden scenarios of a task of the course."""
    catalog = load_catalog(exercises_dir(), solutions_dir())
    task = catalog.task(task_id)
    public, hidden = task.scenarios, catalog.hidden[task_id]
    runs = [
        Run(
            scenario,
            evidence_of(publish, scenario.seconds, hz, personal=personal),
            is_hidden=scenario in hidden,
        )
        for scenario in (*public, *hidden)
    ]
    return judge_task(task, *catalog.points(task), runs)


def judge_by_checks(checks: Sequence[Check], publish: Publish, **personal: Any) -> TaskResult:
    """Judge the messages of a node by the checks of one scenario."""
    scenario = Scenario("public", seconds=6.0, checks=tuple(checks))
    task = Task("week01.demo", "A demo", "node", "Demo", HINTS, (scenario,))
    return judge_task(task, 20.0, False, [Run(scenario, evidence_of(publish, 6.0, 1.0, personal=personal))])


WRONG = (
    marker(Marker.CUBE, (0, 0, 7), (1, 1, 1), (0, 1, 0, 0.8), id=1),
    marker(Marker.CUBE, (0, 0, 0.5), (3, 3, 3), (0, 0, 1, 0.8), id=2),
    marker(Marker.CUBE, (0, 0, 9), (2, 2, 2), (1, 0, 0, 0.8), id=3),
)


def score_alone(one: Any) -> float:
    return judge_messages("week01.red_cube", lambda _: [one]).score


@pytest.mark.slow
def test_three_incorrect_markers_score_as_the_best_one() -> None:
    together = judge_messages("week01.red_cube", lambda _: list(WRONG))
    alone = [score_alone(one) for one in WRONG]
    assert together.score == max(alone) < 7.5


def test_correct_marker_gets_full_marks() -> None:
    assert judge_messages("week01.red_cube", lambda _: [red_cube()]).score == 15


def test_marker_array_published_in_each_timer_callback_gets_full_marks() -> None:
    assert judge_messages("week01.red_cube", lambda _: [MarkerArray(markers=[red_cube()])]).score == 15


def test_marker_replacing_an_earlier_one_gets_full_marks() -> None:
    result = judge_messages("week01.red_cube", lambda at: [red_cube() if at > 2 else cylinder(0.6, 0)])
    assert result.score == 15


@pytest.mark.parametrize("action", [Marker.DELETE, Marker.DELETEALL])
def test_deleting_an_earlier_marker_gets_full_marks(action: int) -> None:
    def publish(at: float) -> list[Any]:
        return [cylinder(0.6, 5)] if at < 2 else [MarkerArray(markers=[gone(), red_cube()])]

    def gone() -> Any:
        return marker(Marker.CYLINDER, (0, 0, 0), (1, 1, 1), (1, 1, 1, 1), id=5, action=action)

    assert judge_messages("week01.red_cube", publish).score == 15


def test_new_id_per_message_with_a_lifetime_of_one_period_gets_full_marks() -> None:
    life = Duration(seconds=1).to_msg()
    assert judge_messages("week01.red_cube", lambda at: [red_cube(round(at), lifetime=life)]).score == 15


def test_correct_marker_among_extra_markers_fails_one_check() -> None:
    result = judge_messages("week01.red_cube", lambda _: [red_cube(), cylinder(0.6, 1)])
    assert 9 <= result.score <= 12
    assert {check.mistake for check in result.checks if not check.passed} == {SURPLUS}
    assert (
        "/visualization_marker shows 2 markers at the end, expected at most 1: "
        "remove the others, because it is unclear which one is your answer"
    ) in [check.message for check in result.checks]


@pytest.mark.parametrize("height", HEIGHTS)
def test_cylinders_of_every_height_do_not_earn_the_personal_value(height: float) -> None:
    def publish(_: float) -> list[Any]:
        return [cylinder(one, number) for number, one in enumerate(HEIGHTS)]

    assert judge_messages("week01.blue_cylinder", lambda _: [cylinder(height)], height=height).score == 20
    result = judge_messages("week01.blue_cylinder", publish, height=height)
    assert result.score <= 20 * 0.3
    assert not any(check.passed for check in result.checks if "your" in check.title)


@pytest.mark.parametrize("lifetime", [0.05, 0.1, 1.05])
def test_short_lifetimes_do_not_hide_markers_of_every_height(lifetime: float) -> None:
    life = Duration(seconds=lifetime).to_msg()

    def publish(_: float) -> list[Any]:
        made = [cylinder(one, number) for number, one in enumerate(HEIGHTS)]
        for one in made[:-1]:
            one.lifetime = life
        return made

    result = judge_messages("week01.blue_cylinder", publish, height=1.2)
    assert result.score <= 20 * 0.3
    every = judge_messages(
        "week01.blue_cylinder", lambda at: [with_life(one, life) for one in publish(at)], height=1.2
    )
    assert every.score <= 20 * 0.3


def with_life(one: Any, life: Any) -> Any:
    one.lifetime = life
    return one


def test_extra_markers_fail_a_full_check_even_if_the_last_check_has_a_low_weight() -> None:
    boxes = [red_cube(), cylinder(0.6, 1)]
    checks = (SHAPE, PLACE, RED, expect_marker(TOPIC, ns="shapes").titled("the name").worth(0.2))
    assert failing(judge_by_checks(checks, lambda _: boxes)) == [RED.title]


def test_fading_trail_of_new_ids_is_not_counted_as_extra_markers() -> None:
    life = Duration(seconds=1.05).to_msg()
    assert judge_messages("week01.red_cube", lambda at: [red_cube(round(at), lifetime=life)]).score == 15


@pytest.mark.slow
def test_node_that_publishes_everything_does_not_get_full_marks_for_four_tasks() -> None:
    lamps = (((1, 0, 0, 1), 1.8), ((1, 1, 0, 1), 1.3), ((0, 1, 0, 1), 0.8))

    def publish(_: float) -> list[Any]:
        spheres = [
            marker(Marker.SPHERE, (0, 0, z), (0.4, 0.4, 0.4), color, ns="traffic_light", id=number)
            for number, (color, z) in enumerate(lamps)
        ]
        route = marker(Marker.LINE_STRIP, (0, 0, 0), (0.05, 0, 0), (1, 1, 0, 1), id=9)
        return [red_cube(), cylinder(1.2, 1), *spheres, route]

    for task, points in (("red_cube", 20), ("blue_cylinder", 25), ("traffic_light", 25)):
        result = judge_messages(f"week01.{task}", publish, height=1.2)
        assert result.score < 0.8 * points, task


SHAPE = expect_marker(TOPIC, type="CUBE", scale=(1, 1, 1))
PLACE = expect_marker(TOPIC, position=(0, 0, 0.5))
RED = expect_marker(TOPIC, color=(1, 0, 0, 0.8))
BLUE = expect_marker(TOPIC, color=(0, 0, 1))


def failing(result: TaskResult) -> list[str]:
    return [check.title for check in result.checks if not check.passed]


def test_extra_markers_pass_if_a_check_allows_them() -> None:
    checks = (SHAPE, PLACE, expect_marker(TOPIC, color=(1, 0, 0), allow_others=True))
    assert judge_by_checks(checks, lambda _: [red_cube(), cylinder(0.6, 1)]).score == 20


def test_markers_required_by_a_count_check_are_not_extra() -> None:
    checks = (SHAPE, PLACE, RED, expect_marker_count(TOPIC, 2))
    assert judge_by_checks(checks, lambda _: [red_cube(), cylinder(0.6, 1)]).score == 20
    result = judge_by_checks(checks, lambda _: [red_cube(), cylinder(0.6, 1), cylinder(0.8, 2)])
    assert failing(result) == ["the number of markers on /visualization_marker"]


def test_count_of_one_type_does_not_allow_other_types() -> None:
    checks = (SHAPE, PLACE, RED, expect_marker_count(TOPIC, 1, type="CUBE"))
    assert failing(judge_by_checks(checks, lambda _: [red_cube(), cylinder(0.6, 1)])) == [RED.title]


def test_contradicting_checks_are_bound_to_different_markers() -> None:
    checks = (RED.titled("red"), BLUE.titled("blue"), SHAPE)
    both = [red_cube(0), marker(Marker.CUBE, (3, 0, 0), (1, 1, 1), (0, 0, 1, 1), id=1)]
    assert judge_by_checks(checks, lambda _: both).score == 20
    other = [red_cube(0), marker(Marker.CUBE, (3, 0, 0), (2, 1, 1), (0, 0, 1, 1), id=1)]
    assert failing(judge_by_checks(checks, lambda _: other)) == [SHAPE.title]


def label(number: int, letters: float, ns: str = "labels") -> Any:
    scale, color = (0, 0, letters), (1, 1, 1, 1)
    return marker(Marker.TEXT_VIEW_FACING, (number, 0, 1), scale, color, id=number, ns=ns, text=f"L{number}")


LETTERS = (0.2, 0.25, 0.35)  # [m]
LABELS = (
    expect_marker_count(TOPIC, 2, type="TEXT_VIEW_FACING").titled("two"),
    expect_marker(TOPIC, id=1, text="L1").titled("first"),
    expect_marker(TOPIC, id=2, text="L2").titled("second"),
    expect_marker(TOPIC, scale=(None, None, my("letters"))).titled("letters of your height"),
)


def test_labels_of_one_size_are_judged_together() -> None:
    assert judge_by_checks(LABELS, lambda _: [label(1, 0.25), label(2, 0.25)], letters=0.25).score == 20
    mixed = judge_by_checks(LABELS, lambda _: [label(1, 0.25), label(2, 0.35)], letters=0.25)
    assert failing(mixed) == ["letters of your height"]


def test_labels_in_every_size_do_not_earn_the_personal_value() -> None:
    def publish(_: float) -> list[Any]:
        return [label(number, one, f"labels{one}") for number in (1, 2) for one in LETTERS]

    result = judge_by_checks(LABELS, publish, letters=0.25)
    assert failing(result) == ["two", "letters of your height"]


def test_missing_label_does_not_fail_the_other_labels() -> None:
    result = judge_by_checks(LABELS, lambda _: [label(1, 0.25), label(3, 0.25)], letters=0.25)
    assert failing(result) == ["second"]


def test_circle_check_uses_the_marker_with_the_expected_color() -> None:
    import math

    def publish(at: float) -> list[Any]:
        angle = at * math.tau / 10
        place = (2 * math.cos(angle), 2 * math.sin(angle), 0.5)
        moving = marker(Marker.SPHERE, place, (0.5, 0.5, 0.5), (0, 1, 0, 1), id=1)
        return [moving, marker(Marker.SPHERE, (5, 5, 5), (0.5, 0.5, 0.5), (1, 0, 1, 1), id=2)]

    checks = (
        expect_marker(TOPIC, type="SPHERE", color=(1, 0, 1)).titled("purple").worth(1),
        expect_circle(TOPIC, radius=2.0, height=0.5, period=10.0, allow_others=True)
        .titled("a circle")
        .worth(2),
    )
    assert failing(judge_by_checks(checks, publish)) == ["purple"]
    right = judge_by_checks(checks, lambda at: [publish(at)[0], red_cube(2)])
    assert failing(right) == ["purple"]


def test_message_fields_are_compared_with_the_bound_marker() -> None:
    from course_lib.grading import expect_message

    checks = (SHAPE, expect_marker(TOPIC, position=(0, 0, 0.5), allow_others=True))
    alpha = expect_message(TOPIC, {"color.a": 0.8}).titled("alpha")
    assert judge_by_checks((*checks, alpha), lambda _: [red_cube(), cylinder(0.6, 1)]).score == 20
    other = expect_message(TOPIC, {"color.a": 1.0}).titled("alpha")
    assert failing(judge_by_checks((*checks, other), lambda _: [red_cube(), cylinder(0.6, 1)])) == ["alpha"]


@pytest.mark.slow
def test_many_markers_are_judged_within_the_time_limit() -> None:
    flood = [MarkerArray(markers=[red_cube(number) for number in range(5000)])]
    result = judge_by_checks((SHAPE, PLACE, RED), lambda at: flood if at == 6 else [])
    assert not any(check.broken for check in result.checks)
    assert failing(result) == [RED.title]
