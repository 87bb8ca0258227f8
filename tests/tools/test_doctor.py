from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

from course_lib.ros.graph.graph import Graph
from course_lib.ros.graph.topics import Qos, find_incompatible_policy
from course_lib.tools.doctor import problem

Run = Callable[[str], str]
LIMITS = st.none() | st.integers(1, 3)
POLICIES = st.builds(
    Qos,
    reliability=st.sampled_from(["reliable", "best_effort"]),
    durability=st.sampled_from(["volatile", "transient_local"]),
    deadline_ns=LIMITS,
    liveliness=st.sampled_from(["automatic", "manual_by_topic"]),
    lease_ns=LIMITS,
)


def test_healthy_graph_passes_five_checks(run: Run, graph: Graph) -> None:
    assert run("doctor") == "\nAll 5 checks passed\n\n"
    assert run("wtf -ep") == "\nAll 4 checks passed\n\n"


def test_unconnected_endpoints_cause_warnings(run: Run, talker: Node) -> None:
    talker.create_subscription(String, "/deaf", print, 1)
    talker.create_subscription(String, "/chatter", print, 1)
    assert run("doctor") == (
        "ros2doctor/api/topic.py: 45: UserWarning: Subscriber without publisher detected on /deaf.\n"
        "ros2doctor/api/topic.py: 42: UserWarning: Publisher without subscriber detected on /place.\n"
        "\nAll 5 checks passed\n\n"
    )
    assert run("doctor -iw").endswith("\n1/5 check(s) failed\n\nFailed modules: topic\n")


def test_incompatible_qos_is_an_error(run: Run, talker: Node) -> None:
    best_effort = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    talker.create_publisher(String, "t", best_effort)
    talker.create_subscription(String, "t", print, 10)
    text = run("doctor -rf")
    assert (
        "UserWarning: ERROR: QoS compatibility error found on topic '/t': Best effort publisher and reliable "
        "subscription;\n" in text
    )
    assert "\n1/5 check(s) failed\n\nFailed modules: middleware\n\n   RMW MIDDLEWARE\n" in text
    assert text.endswith(
        "\n   QOS COMPATIBILITY LIST\ntopic [type]            : /t [std_msgs/msg/String]\n"
        "publisher node          : talker\nsubscriber node         : talker\n"
        "compatibility status    : ERROR: Best effort publisher and reliable subscription;\n"
    )


def test_report_has_the_sections_of_ros2doctor(run: Run, talker: Node) -> None:
    text = run("doctor --report")
    assert [line.strip() for line in text.splitlines() if line.startswith("   ")] == [
        "PLATFORM INFORMATION",
        "ROS 2 INFORMATION",
        "NETWORK CONFIGURATION",
        "RMW MIDDLEWARE",
        "TOPIC LIST",
        "QOS COMPATIBILITY LIST",
        "PACKAGE VERSIONS",
    ]
    assert "topic               : /chatter\npublisher count     : 1\nsubscriber count    : 0\n" in text
    assert "compatibility status    : No publisher/subscriber pairs found\n" in text
    assert "PACKAGE" not in run("doctor -r -ep")


@given(POLICIES, POLICIES)
def test_problem_is_reported_for_topics_without_matching_endpoints(offered: Qos, requested: Qos) -> None:
    told = problem(offered, requested)
    assert bool(told) == (find_incompatible_policy(offered, requested) is not None), (offered, requested)
    assert (told[:7], told[-1:]) == (("ERROR: ", ";") if told else ("", ""))


@pytest.mark.parametrize(
    ("offered", "requested", "text"),
    [
        (Qos(), Qos(durability="transient_local"), "Volatile publisher and transient local subscription"),
        (Qos(), Qos(deadline_ns=1), "Subscription deadline is less than publisher deadline"),
        (Qos(deadline_ns=2), Qos(deadline_ns=1), "Subscription deadline is less than publisher deadline"),
        (Qos(), Qos(liveliness="manual_by_topic"),
         "Publisher's liveliness is automatic and subscription's is manual by topic"),
        (Qos(lease_ns=2), Qos(lease_ns=1), "Subscription liveliness lease duration is less than publisher"),
        (Qos(reliability="best_effort"), Qos(durability="transient_local"),
         "Best effort publisher and reliable subscription;"
         "ERROR: Volatile publisher and transient local subscription"),
    ],
)  # fmt: skip
def test_problems_have_the_text_of_rmw(offered: Qos, requested: Qos, text: str) -> None:
    assert problem(offered, requested) == f"ERROR: {text};"


@pytest.mark.parametrize("word", ["doctor", "wtf"])
def test_help_has_the_format_of_argparse(run: Run, word: str) -> None:
    assert run(f"{word} -h").startswith(f"usage: ros2 {word} [-h] [-r] [-rf] [-ep] [-iw]")
