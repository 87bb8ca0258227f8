# mypy: ignore-errors
"""Arguments, results and output of loggers: unusual messages, filters, levels, names, and shutdown."""

import re
import time
from typing import Any

import rclpy
import rclpy.logging
from probing import captured, lines, main, outcome, probe
from rcl_interfaces.msg import Log
from rclpy.clock import Clock, ClockType
from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.logging import LoggingSeverity, get_logger
from rclpy.node import Node


def _logged(log: Any) -> Any:
    """Return the result or exception of a call and its stderr, without times."""
    found, text = captured(log)
    return found.partition(" incompatible")[0], re.sub(r"\[\d+\.\d{9}\]", "[time]", text)


def _info(message: Any, **options: Any) -> Any:
    return _logged(lambda: Node("n").get_logger().info(message, **options))


lines(
    "message",
    text=lambda: _info("text"),
    none=lambda: _info(None),
    bytes=lambda: _info(b"bytes"),
    byte_array=lambda: _info(bytearray(b"bytes")),
    umlaut_bytes=lambda: _info("ä".encode()),
    number=lambda: _info(5),
    float=lambda: _info(1.5),
    bool=lambda: _info(True),
    list=lambda: _info(["a"]),
    error=lambda: _info(ValueError("a")),
    message=lambda: _info(Log()),
    empty=lambda: _info(""),
    two_lines=lambda: _info("a\nb"),
    trailing_newline=lambda: _info("a\n"),
    zero=lambda: _info("a\0b"),
    zero_bytes=lambda: _info(b"a\0b"),
    umlaut=lambda: _info("ä→😀"),
    surrogate=lambda: _info("\ud800"),
    percent=lambda: _info("100 % %s %d {}"),
    braces=lambda: _info("{name} {message}"),
    long=lambda: [len(part) for part in _info("x" * 5000)],
    tabs=lambda: _info("a\tb"),
    two_arguments=lambda: _logged(lambda: Node("n").get_logger().info("a", "b")),
    none_given=lambda: _logged(lambda: Node("n").get_logger().info()),
    unknown_option=lambda: _info("a", twice=True),
    name=lambda: _info("a", name="other"),
    name_none=lambda: outcome(lambda: Node("n").get_logger().info("a", name=None)).partition(" incom")[0],
)


def _many(times: Any, pause: Any = 0.0, **options: Any) -> Any:
    logger, found = Node("n").get_logger(), []
    for _ in range(times):
        found.append(logger.info("a", **options))
        time.sleep(pause)
    return found


lines(
    "filters",
    once=lambda: _many(3, once=True),
    once_false=lambda: _many(3, once=False),
    skip_first=lambda: _many(3, skip_first=True),
    throttle=lambda: _many(5, 0.1, throttle_duration_sec=0.25),
    throttle_zero=lambda: _many(3, throttle_duration_sec=0),
    throttle_steady=lambda: _many(
        3, 0.1, throttle_duration_sec=0.15, throttle_time_source_type=Clock(clock_type=ClockType.STEADY_TIME)
    ),
    throttle_text=lambda: _many(2, throttle_duration_sec="1"),
    clock_only=lambda: _many(2, throttle_time_source_type=Clock()),
    clock_text=lambda: _many(2, throttle_duration_sec=1.0, throttle_time_source_type="ROS"),
    once_and_skip=lambda: _many(4, once=True, skip_first=True),
    once_and_throttle=lambda: _many(4, once=True, throttle_duration_sec=0.1),
)


def _changing(*calls: Any) -> Any:
    logger, found = Node("n").get_logger(), []
    for severity, options in calls:
        found.append(outcome(lambda: logger.log("a", severity, **options)))  # noqa: B023
    return found


lines(
    "changing",
    severity=lambda: _changing((LoggingSeverity.INFO, {}), (LoggingSeverity.WARN, {})),
    name=lambda: _changing((LoggingSeverity.INFO, {"name": "a"}), (LoggingSeverity.INFO, {"name": "b"})),
    filters=lambda: _changing((LoggingSeverity.INFO, {}), (LoggingSeverity.INFO, {"once": True})),
    parameters=lambda: _changing(
        (LoggingSeverity.INFO, {"throttle_duration_sec": 1.0}),
        (LoggingSeverity.INFO, {"throttle_duration_sec": 2.0}),
    ),
    disabled=lambda: _changing((LoggingSeverity.DEBUG, {}), (LoggingSeverity.INFO, {})),
    number=lambda: _changing((20, {}), (LoggingSeverity.INFO, {})),
    unknown_number=lambda: _changing((25, {})),
    unset=lambda: _changing((0, {})),
    text=lambda: _changing(("INFO", {})),
)


def _levels(*levels: Any) -> Any:
    logger = Node("levels").get_logger()
    child = logger.get_child("child")
    found = []
    for level in levels:
        found.append(outcome(lambda: logger.set_level(level)))  # noqa: B023
        found.append([logger.get_effective_level().name, child.get_effective_level().name])
        found.append([child.is_enabled_for(severity) for severity in (10, 20, 30, 40, 50)])
    logger.set_level(LoggingSeverity.UNSET)
    return found


lines(
    "level",
    debug=lambda: _levels(LoggingSeverity.DEBUG),
    number=lambda: _levels(40),
    unset=lambda: _levels(LoggingSeverity.ERROR, LoggingSeverity.UNSET),
    unknown=lambda: _levels(7),
    text=lambda: _levels("DEBUG"),
    none=lambda: _levels(None),
    of_child=lambda: _child_level(),
    by_name=lambda: _level_by_name(),
    from_text=lambda: [
        outcome(lambda: rclpy.logging.get_logging_severity_from_string(word))  # noqa: B023
        for word in ("INFO", "info", "Warn", "WARNING", "", "x")
    ],
    members=lambda: [(severity.name, int(severity)) for severity in LoggingSeverity],
    as_text=lambda: [str(LoggingSeverity.INFO), repr(LoggingSeverity.INFO)],
)


def _child_level() -> Any:
    logger = get_logger("parent")
    child = logger.get_child("child")
    child.set_level(LoggingSeverity.DEBUG)
    found = [child.get_effective_level().name, logger.get_effective_level().name]
    return [*found, _logged(lambda: child.debug("a")), _logged(lambda: logger.debug("a"))]


def _level_by_name() -> Any:
    rclpy.logging.set_logger_level("by_name", LoggingSeverity.FATAL)
    found = [rclpy.logging.get_logger_effective_level("by_name").name]
    return [*found, _logged(lambda: get_logger("by_name").error("a"))]


lines(
    "name",
    of_node=lambda: [Node("n").get_logger().name, Node("m", namespace="/a/b").get_logger().name],
    of_child=lambda: Node("n").get_logger().get_child("a").get_child("b").name,
    empty_child=lambda: Node("n").get_logger().get_child(""),
    number_child=lambda: Node("n").get_logger().get_child(5),
    none=lambda: get_logger(None),
    empty=lambda: get_logger(""),
    number=lambda: get_logger(5),
    dots=lambda: get_logger("a..b").name,
    root=lambda: _logged(lambda: RcutilsLogger().info("a")),
    plain=lambda: _logged(lambda: get_logger("plain").warning("a")),
    warn=lambda: _logged(lambda: get_logger("plain").warn("a")),
    fatal=lambda: _logged(lambda: get_logger("plain").fatal("a")),
    error=lambda: _logged(lambda: get_logger("plain").error("a")),
    debug=lambda: _logged(lambda: get_logger("plain").debug("a")),
    same=lambda: Node("n").get_logger() is get_logger("n"),
    of_publisher=lambda: Node("n", namespace="/ns").create_publisher(Log, "a", 1).logger_name,
)


@probe
def logging_when_shut_down() -> Any:
    node = Node("n")
    rclpy.shutdown()
    found = [_logged(lambda: node.get_logger().info("after"))]
    found.append(_logged(lambda: get_logger("other").info("other")))
    node.destroy_node()
    return [*found, _logged(lambda: node.get_logger().info("destroyed"))]


@probe
def logging_of_a_destroyed_node() -> Any:
    node = Node("n")
    node.destroy_node()
    return _logged(lambda: node.get_logger().info("a"))


@probe
def logging_before_init() -> Any:
    rclpy.shutdown()
    return _logged(lambda: get_logger("early").info("a"))


def _on_rosout(*calls: Any, **options: Any) -> Any:
    node, seen = Node("n", **options), []
    other = Node("listener", enable_rosout=False)
    other.create_subscription(
        Log, "/rosout", lambda m: seen.append((m.level, m.name, m.msg, m.function != "", m.line > 0)), 50
    )
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    executor.add_node(other)

    def spin(seconds: Any) -> None:
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            executor.spin_once(timeout_sec=0.02)

    spin(0.4)
    for call in calls:
        call(node.get_logger())
    spin(0.4)
    return sorted(seen)


lines(
    "rosout",
    levels=lambda: _on_rosout(
        lambda logger: logger.debug("d"), lambda logger: logger.info("i"), lambda logger: logger.fatal("f")
    ),
    child=lambda: _on_rosout(lambda logger: logger.get_child("c").info("a")),
    none=lambda: _on_rosout(lambda logger: logger.info(None)),
    bytes=lambda: _on_rosout(lambda logger: logger.info(b"a")),
    foreign=lambda: _on_rosout(lambda logger: get_logger("foreign").info("a")),
    other_name=lambda: _on_rosout(lambda logger: logger.info("a", name="other")),
    disabled=lambda: _on_rosout(lambda logger: logger.info("a"), enable_rosout=False),
    in_namespace=lambda: _on_rosout(lambda logger: logger.info("a"), namespace="/ns"),
)


if __name__ == "__main__":
    main()
