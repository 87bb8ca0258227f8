"""The messages of diagnostic_updater, with the texts and rules of ros/diagnostics, branch ros2-jazzy."""

from collections.abc import Callable
from typing import Any

import pytest
import rclpy
from builtin_interfaces.msg import Time as TimeMessage
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from diagnostic_updater import (
    CompositeDiagnosticTask,
    DiagnosedPublisher,
    DiagnosticStatusWrapper,
    DiagnosticTask,
    FrequencyStatusParam,
    FunctionDiagnosticTask,
    HeaderlessTopicDiagnostic,
    Heartbeat,
    TimeStampStatus,
    TimeStampStatusParam,
    TopicDiagnostic,
    Updater,
)
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.time import Time
from sensor_msgs.msg import Image

from course_lib.ros.hints import hint

OK, WARN, ERROR = DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR


def collect_statuses(node: Node) -> list[Any]:
    """Return a list to which arriving statuses are appended while a node spins."""
    statuses: list[Any] = []
    node.create_subscription(DiagnosticArray, "/diagnostics", lambda array: statuses.extend(array.status), 99)
    return statuses


def saying(level: bytes, message: str) -> Callable[[DiagnosticStatusWrapper], DiagnosticStatusWrapper]:
    def fill(stat: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        stat.summary(level, message)
        stat.add(message, "1")
        return stat

    return fill


def result(task: DiagnosticTask) -> DiagnosticStatusWrapper:
    return task.run(DiagnosticStatusWrapper())


def values(status: Any) -> dict[str, str]:
    return {pair.key: pair.value for pair in status.values}


@pytest.mark.parametrize(
    ("first", "second", "merged"),
    [
        ((OK, "a"), (OK, "b"), (OK, "a; b")),
        ((OK, "a"), (WARN, "b"), (WARN, "b")),
        ((ERROR, "a"), (OK, "b"), (ERROR, "a")),
        ((WARN, "a"), (ERROR, "b"), (ERROR, "a; b")),
        ((ERROR, ""), (WARN, "b"), (ERROR, "b")),
    ],
)
def test_merge_summary_keeps_the_worse_level_and_joins_messages_of_equal_kind(
    first: tuple[bytes, str], second: tuple[bytes, str], merged: tuple[bytes, str]
) -> None:
    status = DiagnosticStatusWrapper()
    status.summary(*first)
    status.mergeSummary(*second)
    assert (status.level, status.message) == merged
    other = DiagnosticStatusWrapper(level=second[0], message=second[1])
    status.summary(*first)
    status.mergeSummary(other)
    assert (status.level, status.message) == merged
    status.clearSummary()
    assert (status.level, status.message) == (OK, "")


def test_non_string_value_is_rejected_as_it_aborts_on_a_robot() -> None:
    with pytest.raises(AssertionError, match="The 'value' field must be of type 'str'"):
        DiagnosticStatusWrapper().add("Battery", 12.5)  # type: ignore[arg-type]


def test_updater_reports_node_starting_up_and_then_publishes_once_per_period(node: Node) -> None:
    statuses = collect_statuses(node)
    updater = Updater(node, period=2.0)
    updater.setHardwareID("cam-1")
    updater.add("Lens", saying(WARN, "dusty"))
    rclpy.spin(node)
    assert [(s.name, s.message, s.level) for s in statuses] == [
        ("talker: Lens", "Node starting up", OK),
        *[("talker: Lens", "dusty", WARN)] * 4,  # at 2, 4, 6 and 8 s; that of 10 s arrives after the end
    ]
    assert statuses[1].hardware_id == "cam-1"
    assert values(statuses[1]) == {"dusty": "1"}


def test_period_is_set_by_a_parameter(started_graph: object) -> None:
    node = Node("talker", parameter_overrides=[Parameter("diagnostic_updater.period", value=4.0)])
    updater = Updater(node)
    updater.add(Heartbeat())
    statuses = collect_statuses(node)
    rclpy.spin(node)
    assert updater.period == 4.0
    assert [s.message for s in statuses] == ["Alive"] * 2


def test_full_node_name_precedes_the_task_name_if_enabled(started_graph: object) -> None:
    node = Node(
        "cam",
        namespace="/left",
        parameter_overrides=[Parameter("diagnostic_updater.use_fqn", value=True)],
    )
    statuses = collect_statuses(node)
    Updater(node).add(Heartbeat())
    rclpy.spin_once(node)
    assert statuses[0].name == "/left/cam: Heartbeat"


def test_task_without_a_summary_is_an_error(node: Node) -> None:
    updater = Updater(node)
    updater.add("lazy", lambda stat: stat)
    statuses = collect_statuses(node)
    updater.force_update()
    rclpy.spin_once(node)
    assert (statuses[0].level, statuses[0].message) == (ERROR, "No message was set")


def test_task_without_a_returned_status_raises_with_a_hint(node: Node) -> None:
    updater = Updater(node)
    updater.add("forgetful", lambda stat: stat.summary(OK, "fine"))  # type: ignore[arg-type,return-value]
    with pytest.raises(AttributeError, match=r"^'NoneType' object has no attribute 'level'$") as raised:
        updater.update()
    assert hint(raised.value) == "end the task's function with `return stat`."


def test_task_without_a_function_is_rejected(node: Node) -> None:
    with pytest.raises(TypeError, match=r"add\('Lens'\): give the task's function, too"):
        Updater(node).add("Lens")


def test_missing_hardware_id_is_warned_about_once_if_all_statuses_are_ok(
    node: Node, capfd: pytest.CaptureFixture[str]
) -> None:
    updater = Updater(node)
    updater.add("x", saying(WARN, "not yet"))
    updater.update()
    assert "HW_ID" not in capfd.readouterr().err
    assert updater.removeByName("x")
    assert not updater.removeByName("x")
    updater.update()
    updater.update()
    gap = " " * 16
    assert capfd.readouterr().err.count(f"No HW_ID was set. This is probably{gap}a bug. Please") == 1


def test_broadcast_sets_the_status_of_every_task(node: Node) -> None:
    updater = Updater(node)
    updater.add("a", saying(OK, "fine"))
    updater.add("b", saying(OK, "fine"))
    statuses = collect_statuses(node)
    updater.broadcast(WARN, "shutting down")
    rclpy.spin_once(node)
    assert [(s.name, s.message) for s in statuses] == [
        ("talker: a", "shutting down"),
        ("talker: b", "shutting down"),
    ]


def test_composite_task_has_the_worst_status_of_its_tasks() -> None:
    both = CompositeDiagnosticTask("Bounds")
    both.addTask(FunctionDiagnosticTask("low", saying(OK, "low is fine")))
    both.addTask(FunctionDiagnosticTask("high", saying(WARN, "too high")))
    status = result(both)
    assert (both.getName(), status.level, status.message) == ("Bounds", WARN, "too high")
    assert list(values(status)) == ["low is fine", "too high"]


@pytest.mark.parametrize(
    ("rate", "level", "message"),
    [
        (0, ERROR, "No events recorded."),
        (4, WARN, "Frequency too low."),
        (9, OK, "Desired frequency met"),
        (11, OK, "Desired frequency met"),
        (12, WARN, "Frequency too high."),
    ],
)
def test_frequency_is_compared_with_its_bounds_and_tolerance(
    node: Node, rate: int, level: bytes, message: str
) -> None:
    updater = Updater(node)
    statuses = collect_statuses(node)
    topic = HeaderlessTopicDiagnostic("scan", updater, FrequencyStatusParam({"min": 10, "max": 10}))
    for _ in range(rate):
        topic.tick()
    rclpy.spin_once(node)  # "Node starting up" arrives
    rclpy.spin_once(node)
    rclpy.spin_once(node)
    assert (statuses[1].name, statuses[1].level, statuses[1].message) == (
        "talker: scan topic status",
        level,
        message,
    )
    assert values(statuses[1]) == {
        "Events in window": f"{rate}",
        "Events since startup": f"{rate}",
        "Duration of window (s)": "1.000000",
        "Actual frequency (Hz)": f"{rate}.000000",
        "Target frequency (Hz)": "10.000000",
        "Minimum acceptable frequency (Hz)": "9.000000",
        "Maximum acceptable frequency (Hz)": "11.000000",
    }


def test_frequency_bounds_may_change_at_run_time_and_lack_a_maximum(node: Node) -> None:
    bounds = {"min": 1.0}
    topic = HeaderlessTopicDiagnostic("scan", Updater(node), FrequencyStatusParam(bounds, 0.0, 2))
    topic.tick()
    assert result(topic).message == "Desired frequency met"  # in no time at all
    bounds["max"] = 5.0
    topic.clear_window()
    for _ in range(6):
        topic.tick()
    rclpy.spin_once(node)
    status = result(topic)
    assert values(status)["Maximum acceptable frequency (Hz)"] == "5.000000"
    assert status.message == "Frequency too high."


@pytest.mark.parametrize(
    ("ages", "level", "message"),
    [
        ([], WARN, "No data since last update."),
        ([0.0, 4.9, -0.9], OK, "Timestamps are reasonable."),
        ([0.0, 5.1], ERROR, "Timestamps too far in past seen."),
        ([-1.1, 0.0], ERROR, "Timestamps too far in future seen."),
        ([-1.1, 5.1], ERROR, "Timestamps too far in past seen."),
    ],
)
def test_stamp_age_is_compared_with_its_limits(
    node: Node, ages: list[float], level: bytes, message: str
) -> None:
    task = TimeStampStatus()
    now = node.get_clock().now().nanoseconds
    for age in ages:
        task.tick(Time(nanoseconds=now - round(age * 1e9)))
    status = result(task)
    assert (status.level, status.message) == (level, message)
    assert values(status) == {
        "Earliest timestamp delay:": f"{min(ages, default=0):f}",
        "Latest timestamp delay:": f"{max(ages, default=0):f}",
        "Earliest acceptable timestamp delay:": "-1.000000",
        "Latest acceptable timestamp delay:": "5.000000",
        "Late diagnostic update count:": f"{int(5.1 in ages)}",
        "Early diagnostic update count:": f"{int(-1.1 in ages)}",
        "Zero seen diagnostic update count:": "0",
    }
    assert result(task).message == "No data since last update."


def test_unset_stamp_is_an_error(node: Node) -> None:
    task = TimeStampStatus(TimeStampStatusParam(-1, 5))
    task.tick(node.get_clock().now().nanoseconds * 1e-9)
    task.tick(0.0)
    assert result(task).message == "Zero timestamp seen."


def test_diagnosed_publisher_checks_rate_and_stamps(node: Node) -> None:
    images: list[Any] = []
    node.create_subscription(Image, "/cam/image", images.append, 10)
    publisher = DiagnosedPublisher(
        node.create_publisher(Image, "cam/image", 10),
        Updater(node),
        FrequencyStatusParam({"min": 1.0, "max": 100.0}, 0.1, 2),
        TimeStampStatusParam(),
    )
    rclpy.spin_once(node)
    image = Image()
    image.header.stamp = node.get_clock().now().to_msg()
    publisher.publish(image)
    rclpy.spin_once(node)
    assert len(images) == 1
    assert publisher.getName() == "/cam/image topic status"
    assert result(publisher).message == "Desired frequency met; Timestamps are reasonable."


def test_stamp_message_is_rejected_as_a_time_with_a_hint(node: Node) -> None:
    bounds = FrequencyStatusParam({"min": 1.0})
    topic = TopicDiagnostic("scan", Updater(node), bounds, TimeStampStatusParam())
    with pytest.raises(AttributeError, match=r"^'Time' object has no attribute 'nanoseconds'$") as raised:
        topic.tick(TimeMessage())  # type: ignore[arg-type]
    assert hint(raised.value) == "write `Time.from_msg(stamp)`, with rclpy's Time."
