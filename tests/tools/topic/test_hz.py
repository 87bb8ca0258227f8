from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rclpy.node import Node
from std_msgs.msg import String

from course_lib.errors import CourseError
from course_lib.recording import Recording
from course_lib.ros.graph.graph import Sample
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import message_class, serialize
from course_lib.tools.ros2 import ros2
from course_lib.tools.sources import RecordingSource

Run = Callable[[str], str]
STRING = "std_msgs/msg/String"


def test_topic_at_10_hz_is_measured_as_10_hz(run: Run, talker: Node) -> None:
    assert run("topic hz /chatter") == (
        "average rate: 10.000\n\tmin: 0.100s max: 0.100s std dev: 0.00000s window: 11\n"
        "average rate: 10.000\n\tmin: 0.100s max: 0.100s std dev: 0.00000s window: 21\n"
        "average rate: 10.000\n\tmin: 0.100s max: 0.100s std dev: 0.00000s window: 31\n"
        "average rate: 10.000\n\tmin: 0.100s max: 0.100s std dev: 0.00000s window: 41\n"
        "No page is watching: ros2 topic hz stopped after 5 s of robot time.\n"
    )


def test_window_and_filter_select_the_messages(run: Run, talker: Node) -> None:
    assert run("topic hz chatter --window 5").splitlines()[1].endswith("window: 5")
    text = run("topic hz /chatter --filter int(m.data.split()[1])%2==0")
    assert text.startswith("average rate: 5.000\n\tmin: 0.200s max: 0.200s")


@given(st.lists(st.integers(1, 3 * 10**7), min_size=1, max_size=30))
def test_statistics_agree_with_numpy(gaps: list[int]) -> None:
    cdr = serialize(message_class(STRING)())
    stamps = np.cumsum([10**18, *gaps])
    samples = tuple(Sample(int(stamp), "/a", STRING, cdr, Qos(), 1) for stamp in stamps)
    output: list[str] = []
    ros2(["topic", "hz", "/a"], RecordingSource(Recording(samples)), output.append)
    seconds = np.array(gaps) * 1e-9
    assert output == [
        f"average rate: {1 / seconds.mean():.3f}\n\tmin: {seconds.min():.3f}s max: {seconds.max():.3f}s "
        f"std dev: {seconds.std():.5f}s window: {len(gaps)}\n"
    ]


def test_hz_waits_for_a_topic_and_lists_the_existing_ones(run: Run, talker: Node) -> None:
    with pytest.raises(CourseError, match=r"^Could not determine the type .* Did you mean /chatter\?"):
        run("topic hz /chater")
    assert run.written == "WARNING: topic [/chater] does not appear to be published yet\n"  # type: ignore[attr-defined]


@pytest.mark.parametrize("verb", ["hz", "bw", "delay", "echo"])
def test_hidden_topics_are_not_listed(run: Run, talker: Node, verb: str) -> None:
    talker.create_publisher(String, "_hidden/status", 10)
    with pytest.raises(CourseError, match=r"Topics here: /chatter, /parameter_events, /place, /rosout\.$"):
        run(f"topic {verb} /unknown")


@pytest.mark.parametrize("verb", ["hz", "bw", "delay"])
def test_silent_topic_is_explained(run: Run, talker: Node, verb: str) -> None:
    with pytest.raises(CourseError, match=r"^No message came on /rosout in 5 s of robot time\."):
        run(f"topic {verb} /rosout")


def test_window_must_be_a_positive_number(run: Run, talker: Node) -> None:
    with pytest.raises(CourseError, match="argument -w/--window: value must be a positive integer"):
        run("topic hz /chatter -w 0")
