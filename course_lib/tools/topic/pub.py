"""`ros2 topic pub`."""

import sys
from argparse import Namespace
from collections.abc import Iterator
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, Any

from course_lib.errors import CourseError
from course_lib.ros.interrupts import until_interrupted
from course_lib.ros.messages import RosMessage, message_class
from course_lib.tools.message_yaml import fill, kind_of
from course_lib.tools.sources import NODE_NAME, Source, own_node
from course_lib.tools.topic.lookup import PRESETS, asked_qos, qos_options
from course_lib.tools.verb import NODE_OPTIONS, Verb, Write, flag, positive, unsigned, value

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.publisher import Publisher

LOOK_EVERY = 0.1  # [s] for subscriptions; the wait is told of each tenth time


def _run(source: Source, arguments: Namespace, write: Write) -> None:
    kind = kind_of(message_class, arguments.message_type, "msg")
    message: Any = kind()
    set_times = fill(message, sys.stdin.read() if arguments.stdin else arguments.values)
    with until_interrupted(), _node(source, arguments) as node:
        publisher = _publisher(node, kind, arguments)
        _wait_for_subscriptions(source, publisher, arguments, write)
        write("publisher: beginning loop\n")
        for count in _beats(source, node, arguments, write):
            for set_time in set_times:
                set_time(node.get_clock().now().to_msg())
            if arguments.print and count % arguments.print == 0:
                write(f"publishing #{count}: {message!r}\n\n")
            publisher.publish(message)


def _publisher(node: "Node", kind: type[RosMessage], arguments: Namespace) -> "Publisher[Any]":
    from rclpy.exceptions import InvalidTopicNameException
    from rclpy.impl.graph_queries import to_profile

    qos = asked_qos(arguments) or PRESETS[arguments.qos_profile]
    try:
        return node.create_publisher(kind, arguments.topic_name, to_profile(qos))
    except InvalidTopicNameException as error:
        raise CourseError(str(error)) from error


def _wait_for_subscriptions(
    source: Source, publisher: "Publisher[Any]", arguments: Namespace, write: Write
) -> None:
    wanted, longest = arguments.wait_matching_subscriptions, arguments.max_wait_time_secs
    if wanted is None:
        wanted = int(arguments.once or arguments.times > 0)
    if not wanted and longest is not None:
        raise CourseError(
            "--max-wait-time-secs option is only effective with --wait-matching-subscriptions, "
            "--once or --times"
        )
    longest, looks = longest or source.limit(), 0
    while (found := publisher.get_subscription_count()) < wanted and not source.graph.ended:
        if looks % 10 == 0:
            write(f"Waiting for at least {wanted} matching subscription(s)...\n")
        if longest is not None and looks * LOOK_EVERY >= longest:
            raise CourseError(
                f"Timed out waiting for subscribers: Expected {wanted} subcribers but only got {found} "
                "subscribers. `-w 0` publishes without any."
            )
        looks += 1
        source.wait(lambda: False, LOOK_EVERY)


def _node(source: Source, arguments: Namespace) -> "AbstractContextManager[Node]":
    return own_node(source, arguments.node_name or NODE_NAME, use_sim_time=arguments.use_sim_time)


def _beats(source: Source, node: "Node", arguments: Namespace, write: Write) -> Iterator[int]:
    times = 1 if arguments.once else arguments.times
    limit = None if times else source.limit()
    start_ns, count = source.graph.now_ns, 0
    if arguments.use_sim_time:
        source.wait(lambda: node.get_clock().now().nanoseconds > 0, source.limit())
    while not source.graph.ended and (not times or count < times):
        count += 1
        yield count
        if limit is not None and source.graph.now_ns - start_ns >= limit * 1e9:
            write(f"No page is watching: ros2 topic pub stopped after {limit:g} s of robot time.\n")
            return
        if arguments.use_sim_time and count != times:
            _pause(source, node, 1 / arguments.rate)
        else:
            source.wait(lambda: False, arguments.keep_alive if count == times else 1 / arguments.rate)


def _pause(source: Source, node: "Node", seconds: float) -> None:
    """Wait by the time on /clock."""
    calls = list[None]()
    timer = node.create_timer(seconds, lambda: calls.append(None))
    source.wait(lambda: bool(calls), source.limit())
    node.destroy_timer(timer)


_OPTIONS = (
    value("topic_name", help="Name of the ROS topic to publish to (e.g. '/chatter')"),
    value("message_type", help="Type of the ROS message (e.g. 'std_msgs/msg/String')"),
    value("values", nargs="?", default="{}", help="Values to fill the message with in YAML format"),
    flag("--stdin", help="Read values from standard input"),
    value("-r", "--rate", metavar="N", type=positive(float), default=1.0, help="Publishing rate in Hz"),
    value("-p", "--print", metavar="N", type=int, default=1, help="Only print every N-th message"),
    flag("-1", "--once", help="Publish one message and exit", exclusive="count"),
    value(
        "-t",
        "--times",
        type=unsigned,
        default=0,
        help="Publish this number of times and exit",
        exclusive="count",
    ),
    value("-w", "--wait-matching-subscriptions", type=unsigned, help="Wait for so many subscriptions"),
    value("--max-wait-time-secs", type=positive(float), help="The longest wait for them in seconds"),
    value(
        "--keep-alive",
        type=positive(float),
        default=0.1,
        help="Keep publishing node alive for so many seconds after the last msg (default: 0.1)",
    ),
    value("-n", "--node-name", help="Name of the created publishing node"),
    *qos_options("publish", "default"),
    *NODE_OPTIONS[:2],
)
TOPIC_PUB = Verb("topic", "pub", "Publish a message to a topic", _OPTIONS, _run)
