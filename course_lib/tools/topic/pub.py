"""`ros2 topic pub`."""

import sys
from argparse import Namespace
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from course_lib.errors import CourseError
from course_lib.ros.driving import until_interrupted
from course_lib.ros.messages import message_class
from course_lib.tools.message_fields import fill
from course_lib.tools.sources import NODE_NAME, Source
from course_lib.tools.topic.lookup import full_name
from course_lib.tools.topic.qos import PRESETS, asked_qos, qos_options
from course_lib.tools.verb import NODE_OPTIONS, Verb, Write, flag, positive, value

if TYPE_CHECKING:
    from rclpy.node import Node

LOOK_EVERY = 0.1  # [s] for subscriptions; the wait is told of each tenth time


def run(source: Source, arguments: Namespace, write: Write) -> None:
    """Publish a message again and again, or a few times.

    Raises:
        CourseError: Nobody can hear it, or type, values or topic are wrong.
    """
    if not source.live:
        raise CourseError(
            "A recording hears nothing. Publish to nodes that run: course ros2 --run program.py …"
        )
    text = sys.stdin.read() if arguments.stdin else arguments.values
    message: Any = message_class(arguments.message_type)()
    set_times = fill(message, text)
    with until_interrupted():
        source.wait(lambda: True, 0.0)  # says if rclpy is not started
        node = _node(arguments)
        try:
            publish = _publisher(node, arguments)
            _wait_for_subscriptions(source, arguments, write)
            write("publisher: beginning loop\n")

            def send(count: int) -> None:
                for set_time in set_times:
                    set_time(node.get_clock().now().to_msg())
                if arguments.print and count % arguments.print == 0:
                    write(f"publishing #{count}: {message!r}\n\n")
                publish(message)

            _loop(source, arguments, write, send)
        finally:
            node.destroy_node()


def _node(arguments: Namespace) -> "Node":
    from rclpy.node import Node

    name = arguments.node_name or NODE_NAME
    return Node(name, start_parameter_services=False, enable_rosout=False)


def _publisher(node: "Node", arguments: Namespace) -> Callable[[Any], None]:
    from rclpy.exceptions import InvalidTopicNameException
    from rclpy.impl.qos_conversion import to_profile

    qos = asked_qos(arguments) or PRESETS[arguments.qos_profile]
    profile = to_profile(replace(qos, depth=qos.depth or 1))
    try:
        kind = message_class(arguments.message_type)
        return node.create_publisher(kind, arguments.topic_name, profile).publish
    except InvalidTopicNameException as error:
        raise CourseError(str(error)) from error


def _wait_for_subscriptions(source: Source, arguments: Namespace, write: Write) -> None:
    once, longest = arguments.once or arguments.times, arguments.max_wait_time_secs
    wanted = arguments.wait_matching_subscriptions
    wanted = int(bool(once)) if wanted is None else wanted
    if not wanted and longest is not None:
        raise CourseError(
            "--max-wait-time-secs option is only effective with --wait-matching-subscriptions, "
            "--once or --times"
        )
    topic, start_ns, looks = full_name(arguments.topic_name), source.graph.now_ns, 0
    longest = longest or source.limit()

    def found() -> int:
        return sum(e.type_name == arguments.message_type for e in source.endpoints(topic, "sub"))

    while found() < wanted and not source.graph.ended:
        if looks % 10 == 0:
            write(f"Waiting for at least {wanted} matching subscription(s)...\n")
        if longest is not None and source.graph.now_ns - start_ns >= longest * 1e9:
            raise CourseError(
                f"Timed out waiting for subscribers: Expected {wanted} subcribers but only got {found()} "
                "subscribers. `-w 0` publishes without any."
            )
        looks += 1
        source.wait(lambda: found() >= wanted, LOOK_EVERY)


def _loop(source: Source, arguments: Namespace, write: Write, send: Callable[[int], None]) -> None:
    """Publish at the rate that was asked for, so often or until ■; without a page for a while."""
    times = 1 if arguments.once else arguments.times
    limit = None if times else source.limit()
    start_ns, count = source.graph.now_ns, 0
    while not source.graph.ended and (not times or count < times):
        count += 1
        send(count)
        if limit is not None and source.graph.now_ns - start_ns >= limit * 1e9:
            write(f"No page is watching: ros2 topic pub stopped after {limit:g} s of robot time.\n")
            return
        pause = arguments.keep_alive if count == times else 1 / arguments.rate
        source.wait(lambda: False, pause)


def _whole(text: str) -> int:
    number = int(text)
    if number < 0:
        raise ValueError("Value must be positive or zero")
    return number


TOPIC_PUB = Verb(
    "topic",
    "pub",
    "Publish a message to a topic",
    (
        value("topic_name", help="Name of the ROS topic to publish to (e.g. '/chatter')"),
        value("message_type", help="Type of the ROS message (e.g. 'std_msgs/msg/String')"),
        value("values", nargs="?", default="{}", help="Values to fill the message with in YAML format"),
        flag("--stdin", help="Read values from standard input"),
        value("-r", "--rate", metavar="N", type=positive(float), default=1.0, help="Publishing rate in Hz"),
        value("-p", "--print", metavar="N", type=int, default=1, help="Only print every N-th message"),
        flag("-1", "--once", help="Publish one message and exit"),
        value("-t", "--times", type=_whole, default=0, help="Publish this number of times and then exit"),
        value("-w", "--wait-matching-subscriptions", type=_whole, help="Wait for so many subscriptions"),
        value("--max-wait-time-secs", type=positive(float), help="The longest wait for them in seconds"),
        value(
            "--keep-alive",
            metavar="N",
            type=positive(float),
            default=0.1,
            help="Keep publishing node alive for N seconds after the last msg (default: 0.1)",
        ),
        value("-n", "--node-name", help="Name of the created publishing node"),
        *qos_options("publish", "default"),
        *NODE_OPTIONS[:2],
    ),
    run,
)
