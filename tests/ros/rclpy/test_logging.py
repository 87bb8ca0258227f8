from typing import Any

import pytest
import rclpy
import rclpy.logging
from rcl_interfaces.msg import Log, LoggerLevel
from rcl_interfaces.srv import GetLoggerLevels, SetLoggerLevels
from rclpy.clock import Clock
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.rcutils_logger import LoggingFilter, Once, SkipFirst, Throttle
from rclpy.logging import LoggingSeverity, get_logger
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

from course_lib.ros.graph.graph import Graph

Captured = pytest.CaptureFixture[str]


@pytest.mark.parametrize("level", ["info", "warning", "warn", "error", "fatal"])
def test_log_message_is_one_line_on_stderr_in_the_format_of_ros(
    node: Node, capsys: Captured, level: str
) -> None:
    node.get_clock().sleep_for(Duration(nanoseconds=123_456_789))
    assert getattr(node.get_logger(), level)("hello")
    name = level.upper().replace("WARNING", "WARN")
    assert capsys.readouterr().err == f"[{name}] [1700000000.123456789] [talker]: hello\n"


def test_child_loggers_have_the_name_of_their_parent_as_prefix(node: Node, capsys: Captured) -> None:
    node.get_logger().get_child("arm").info("up")
    assert "[talker.arm]: up" in capsys.readouterr().err
    with pytest.raises(ValueError, match=r"^Child logger name must not be empty.$"):
        node.get_logger().get_child("")
    with pytest.raises(ValueError, match=r"^Logger name must not be empty.$"):
        get_logger("")


def test_debug_messages_are_hidden_until_the_level_allows_them(graph: Graph, capsys: Captured) -> None:
    logger = get_logger("a")
    assert not logger.debug("hidden")
    logger.set_level(LoggingSeverity.DEBUG)
    assert logger.debug("shown")
    assert capsys.readouterr().err == "[DEBUG] [1700000000.000000000] [a]: shown\n"


def test_debug_level_shows_only_the_messages_of_the_program(graph: Graph, capsys: Captured) -> None:
    rclpy.init(args=["--ros-args", "--log-level", "debug"])
    Node("talker").get_logger().debug("shown")
    rclpy.shutdown()
    assert capsys.readouterr().err == "[DEBUG] [1700000000.000000000] [talker]: shown\n"


def test_log_levels_are_inherited(graph: Graph) -> None:
    rclpy.logging.set_logger_level("a", LoggingSeverity.ERROR)
    assert get_logger("a.b.c").get_effective_level() is LoggingSeverity.ERROR
    assert not get_logger("a.b").is_enabled_for(LoggingSeverity.WARN)
    assert get_logger("ab").get_effective_level() is LoggingSeverity.INFO
    rclpy.logging.set_logger_level("a", LoggingSeverity.UNSET)
    assert rclpy.logging.get_logger_effective_level("a.b") is LoggingSeverity.INFO


def test_non_string_log_message_is_an_error(node: Node) -> None:
    with pytest.raises(TypeError, match="the message must be a str, not int; write str"):
        node.get_logger().info(42)  # type: ignore[arg-type]  # the mistake under test


def log_five_times(node: Node, **options: Any) -> None:
    for number in range(5):
        node.get_logger().info(str(number), **options)
        node.get_clock().sleep_for(Duration(seconds=0.4))


@pytest.mark.parametrize(
    ("options", "logged"),
    [
        ({}, "01234"),
        ({"once": True}, "0"),
        ({"skip_first": True}, "1234"),
        ({"throttle_duration_sec": 1.0}, "03"),
        ({"throttle_duration_sec": 1.0, "throttle_time_source_type": Clock()}, "03"),
        ({"throttle_duration_sec": 1.0, "skip_first": True}, "3"),
        ({"once": False}, "01234"),
    ],
)
def test_logging_options_filter_repeated_calls_from_one_line(
    node: Node, capsys: Captured, options: dict[str, Any], logged: str
) -> None:
    log_five_times(node, **options)
    lines = capsys.readouterr().err.splitlines()
    assert "".join(line[-1] for line in lines) == logged


@pytest.mark.parametrize(
    ("logging_filter", "options", "shown"),
    [
        (LoggingFilter, {}, [True, True, True]),
        (Once, {"once": True}, [True, False, False]),
        (SkipFirst, {"skip_first": True}, [False, True, True]),
        (Throttle, {"throttle_duration_sec": 1.0}, [True, False, False]),
    ],
)
def test_logging_filter_is_used_with_a_context_as_in_rclpy(
    node: Node, logging_filter: type[LoggingFilter], options: dict[str, Any], shown: list[bool]
) -> None:
    context: dict[str, Any] = {}
    logging_filter.initialize_context(context, **options)
    assert [logging_filter.should_log(context) for _ in shown] == shown
    if options:
        with pytest.raises(TypeError, match=f'specified for logging filter "{logging_filter.__name__}"$'):
            logging_filter.initialize_context({})


def test_two_calls_on_one_line_are_filtered_separately(node: Node, capsys: Captured) -> None:
    logger = node.get_logger()
    for _ in range(2):
        logger.info("a", once=True), logger.info("b", once=True)
    assert [line[-1] for line in capsys.readouterr().err.splitlines()] == ["a", "b"]


def test_log_call_cannot_change_its_severity_name_or_filters(node: Node) -> None:
    def log(severity: LoggingSeverity, **options: Any) -> None:
        node.get_logger().log("hello", severity, **options)

    log(LoggingSeverity.INFO)
    with pytest.raises(ValueError, match=r"^Logger severity cannot be changed between calls.$"):
        log(LoggingSeverity.WARN)
    with pytest.raises(ValueError, match=r"^Logger name cannot be changed between calls.$"):
        log(LoggingSeverity.INFO, name="other")
    with pytest.raises(ValueError, match=r"^Requested logging filters cannot be changed between calls.$"):
        log(LoggingSeverity.INFO, once=True)


def test_throttled_call_cannot_change_its_duration(node: Node) -> None:
    def log(seconds: float) -> None:
        node.get_logger().info("hello", throttle_duration_sec=seconds)

    log(1.0)
    with pytest.raises(ValueError, match=r"^Logging filter parameters cannot be changed between calls.$"):
        log(2.0)


def test_unknown_and_incomplete_options_are_rejected_as_in_ros(node: Node) -> None:
    with pytest.raises(TypeError, match=r'^parameter "twice" is not one of the recognized logging options'):
        node.get_logger().info("hello", twice=True)
    with pytest.raises(TypeError, match=r'^required parameter "throttle_duration_sec" not specified'):
        node.get_logger().info("hello", throttle_time_source_type=Clock())
    with pytest.raises(TypeError, match=r'^Required parameter "throttle_time_source_type" was not specified'):
        node.get_logger().info("hello", throttle_duration_sec=1.0, throttle_time_source_type=None)
    with pytest.raises(
        ValueError, match=r'^Received throttle_time_source_type of "wall" is not a clock instance'
    ):
        node.get_logger().info("hello", throttle_duration_sec=1.0, throttle_time_source_type="wall")


def test_log_messages_of_a_node_and_its_children_are_published_on_rosout(node: Node) -> None:
    node.get_logger().get_child("arm").error("ouch")
    messages: list[Log] = []
    latched = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_subscription(Log, "/rosout", messages.append, latched)
    rclpy.spin_once(node)
    log = messages[0]
    assert (log.name, log.msg, log.level, log.stamp.sec) == ("talker.arm", "ouch", 40, 1_700_000_000)
    assert (log.file, log.function) == (
        "test_logging.py",
        "test_log_messages_of_a_node_and_its_children_are_published_on_rosout",
    )
    assert log.line > 0


def test_location_of_cell_code_is_equal_on_all_machines(node: Node, started_graph: Graph) -> None:
    exec(compile("logger.info('hello')", "/tmp/ipykernel_42/1234.py", "exec"), {"logger": node.get_logger()})
    messages: list[Log] = []
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_subscription(Log, "/rosout", messages.append, latched)
    rclpy.spin_once(node)
    assert messages[0].file == "cell"


def call(executor: SingleThreadedExecutor, node: Node, kind: Any, verb: str, request: Any) -> Any:
    future = node.create_client(kind, f"/robot/chatty/{verb}_logger_levels").call_async(request)
    executor.spin_until_future_complete(future)
    return future.result()


def test_logger_services_of_a_node_report_and_set_its_levels(node: Node) -> None:
    server = Node("chatty", namespace="robot", enable_logger_service=True)
    executor = SingleThreadedExecutor()
    executor.add_node(server)
    executor.add_node(node)
    wanted = [LoggerLevel(name="chatty.arm", level=10), LoggerLevel(name="chatty", level=7)]
    done = call(executor, node, SetLoggerLevels, "set", SetLoggerLevels.Request(levels=wanted))
    assert [result.successful for result in done.results] == [True, False]
    assert done.results[1].reason == "Failed reason: Invalid logger level."
    names = GetLoggerLevels.Request(names=["chatty.arm", "chatty"])
    seen = call(executor, node, GetLoggerLevels, "get", names)
    assert [(level.name, level.level) for level in seen.levels] == [("chatty.arm", 10), ("chatty", 0)]
    assert get_logger("chatty.arm").debug("shown")


def test_logger_services_are_disabled_by_default(node: Node) -> None:
    names = [name for name, _ in node.get_service_names_and_types()]
    assert [name for name in names if "logger_levels" in name] == []


def test_console_format_of_rcutils_is_ignored(
    node: Node, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RCUTILS_CONSOLE_OUTPUT_FORMAT", "{message}")
    node.get_logger().info("hello")
    assert capfd.readouterr().err.startswith("[INFO] [1700000000.000000000] [talker]: hello")
