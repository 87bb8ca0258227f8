"""`ros2 doctor`: topics without a partner and incompatible QoS (ros2doctor)."""

import platform
from argparse import Namespace
from collections.abc import Iterator

from course_lib.ros.graph.graph import EndpointInfo
from course_lib.ros.graph.topics import Qos
from course_lib.tools.sources import ALWAYS_THERE, Source
from course_lib.tools.verb import Verb, Write, flag

_PACKAGES = ("course-lib", "ipywidgets", "jupyterlab", "meshcat", "numpy", "rosbags")
# Topics of these types contain the robot's time stamps and cause little traffic.
_SMALL = (
    "tf2_msgs/msg/TFMessage", "nav_msgs/msg/Odometry", "sensor_msgs/msg/Imu", "sensor_msgs/msg/JointState",
    "sensor_msgs/msg/LaserScan",
)  # fmt: skip
# Time for receiving messages on these topics [s].
LISTENING = 1.0
Rows = list[tuple[str, object]]


def _run(source: Source, arguments: Namespace, write: Write) -> None:
    link = _link_rows(source)
    reports = _reports(source, link)
    if arguments.exclude_packages:
        del reports["PACKAGE VERSIONS"]
    if arguments.report:
        write("".join(_table(title, rows) for title, (_, rows) in reports.items()))
        return
    write(_table("ROBOT LINK", link) if link else "")
    # The warnings begin with the lines of ros2doctor's source that print them.
    unmatched, incompatible = list[str](), list[str]()
    for topic in source.topics():
        is_published, is_subscribed = (bool(source.endpoints(topic, kind)) for kind in ("pub", "sub"))
        if topic not in ALWAYS_THERE and is_published and not is_subscribed:
            unmatched.append(f"topic.py: 42: UserWarning: Publisher without subscriber detected on {topic}.")
        elif topic not in ALWAYS_THERE and is_subscribed and not is_published:
            unmatched.append(f"topic.py: 45: UserWarning: Subscriber without publisher detected on {topic}.")
    for topic, publisher, subscription in _pairs(source):
        if reason := problem(publisher.qos, subscription.qos).removeprefix("ERROR: "):
            text = f"ERROR: QoS compatibility error found on topic '{topic}': {reason}"
            incompatible.append(f"qos_compatibility.py: 51: UserWarning: {text}")
    write("".join(f"ros2doctor/api/{text}\n" for text in (*unmatched, *incompatible)))
    failed = ["topic"] * bool(unmatched and arguments.include_warnings) + ["middleware"] * bool(incompatible)
    # The number of checks: platform, network, topic, middleware, package.
    total = 5 - arguments.exclude_packages
    if not failed:
        write(f"\nAll {total} checks passed\n\n")
        return
    write(f"\n{len(failed)}/{total} check(s) failed\n\nFailed modules: {' '.join(failed)}\n")
    if arguments.report_failed:
        write("".join(_table(title, rows) for title, (of, rows) in reports.items() if of in failed))


def _link_rows(source: Source) -> Rows:
    """Return the state of the link to a robot, after briefly receiving its small topics."""
    import rclpy

    graph = source.graph
    if not graph.link_report() or not rclpy.ok():
        return graph.link_report()
    names = {
        endpoint.topic
        for endpoint in graph.endpoints()
        if endpoint.kind == "pub" and endpoint.type_name in _SMALL
    }
    end_listening = graph.tap(lambda _: None, lambda: names)
    try:
        source.wait(lambda: False, LISTENING)
        return graph.link_report()
    finally:
        end_listening()


def problem(offered: Qos, requested: Qos) -> str:
    """Return the QoS errors of a pair with the text of rclpy's qos_check_compatible, or ""."""
    # Imported late because rclpy is slow to import.
    from rclpy.impl.graph_queries import to_profile
    from rclpy.qos import qos_check_compatible

    return qos_check_compatible(to_profile(offered), to_profile(requested))[1]


def _pairs(source: Source) -> Iterator[tuple[str, EndpointInfo, EndpointInfo]]:
    for topic in source.topics():
        for publisher in source.endpoints(topic, "pub"):
            yield from ((topic, publisher, subscription) for subscription in source.endpoints(topic, "sub"))


def _reports(source: Source, link: Rows) -> dict[str, tuple[str, Rows]]:
    """Return the category and the rows of each report by its title."""
    # Imported late because it is slow to import, and `course run` imports all verbs.
    from importlib import metadata

    system: Rows = [
        ("system", platform.system()),
        ("platform info", platform.platform()),
        ("release", platform.release()),
        ("processor", platform.processor()),
    ]
    # The first row of a link has its address.
    protocol = "rmw_zenoh" if link and "dds/" not in str(link[0][1]) else "DDS"
    topics: Rows = []
    for topic in (name for name in source.topics() if name not in ALWAYS_THERE):
        topics += [
            ("topic", topic),
            ("publisher count", len(source.endpoints(topic, "pub"))),
            ("subscriber count", len(source.endpoints(topic, "sub"))),
        ]
    names, pairs = {node.id: node.name for node in source.graph.nodes()}, Rows()
    for topic, publisher, subscription in _pairs(source):
        pairs += [
            ("topic [type]", f"{topic} [{publisher.type_name}]"),
            ("publisher node", names[publisher.node]),
            ("subscriber node", names[subscription.node]),
            ("compatibility status", problem(publisher.qos, subscription.qos) or "OK"),
        ]
    versions: Rows = [(name, f"latest=N/A, local={metadata.version(name)}") for name in _PACKAGES]
    return {
        "PLATFORM INFORMATION": ("platform", system),
        "ROS 2 INFORMATION": ("platform", [("distribution name", "jazzy"), ("distribution type", "ros2")]),
        "NETWORK CONFIGURATION": (
            "network",
            link or [("inet", "none is used: all nodes run in one process")],
        ),
        "RMW MIDDLEWARE": (
            "middleware",
            [("middleware name", f"{protocol} (course_lib)" if link else "course_lib")],
        ),
        "TOPIC LIST": (
            "topic",
            topics or [("topic", "none"), ("publisher count", 0), ("subscriber count", 0)],
        ),
        "QOS COMPATIBILITY LIST": (
            "middleware",
            pairs or [("compatibility status", "No publisher/subscriber pairs found")],
        ),
        "PACKAGE VERSIONS": ("package", versions),
    }


def _table(title: str, rows: Rows) -> str:
    longest = max(len(name) for name, _ in rows)
    width = 8 if longest < 8 else longest + 4
    return f"\n   {title}\n" + "".join(f"{name:{width}}: {text}\n" for name, text in rows)


_OPTIONS = (
    flag("-r", "--report", help="Print all reports."),
    flag("-rf", "--report-failed", help="Print reports of failed checks only."),
    flag("-ep", "--exclude-packages", help="Exclude package checks or report."),
    flag("-iw", "--include-warnings", help="Include warnings as failed checks."),
)
DOCTOR_VERBS = (
    Verb("doctor", "", "Check ROS setup and other potential issues", _OPTIONS, _run),
    Verb("wtf", "", "Use `wtf` as alias to `doctor`", _OPTIONS, _run),
)
