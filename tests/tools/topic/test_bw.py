from collections.abc import Callable

import pytest
from rclpy.node import Node
from std_msgs.msg import String

from course_lib.recording import Recording
from course_lib.ros.graph.graph import Sample
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import serialize
from course_lib.tools.ros2 import ros2
from course_lib.tools.sources import RecordingSource
from course_lib.tools.topic import bandwidth

Run = Callable[[str], str]


def test_sizes_are_serialized_message_sizes(run: Run, talker: Node) -> None:
    size = len(serialize(String(data="hello 1")))
    assert size == len(serialize(String(data="hello 9")))
    lines = run("topic bw /chatter").splitlines()
    assert lines[0] == "Subscribed to [/chatter]"
    assert lines[1].endswith(" B/s from 9 messages")  # the tenth arrives a millisecond after the second
    assert lines[2] == f"\tMessage size mean: {size} B min: {size} B max: {size} B"
    assert lines[-1] == "No page is watching: ros2 topic bw stopped after 5 s of robot time."


def test_recording_output_begins_with_the_header() -> None:
    cdr = serialize(String(data="hello 1"))
    samples = tuple(Sample(10**18 + i * 10**8, "/a", "std_msgs/msg/String", cdr, Qos(), 1) for i in range(11))
    output: list[str] = []
    ros2(["topic", "bw", "/a"], RecordingSource(Recording(samples)), output.append)
    size = f"{len(cdr)} B"
    assert "".join(output) == (
        f"Subscribed to [/a]\n{len(cdr) * 11} B/s from 11 messages\n"
        f"\tMessage size mean: {size} min: {size} max: {size}\n"
    )


@pytest.mark.parametrize(
    ("sizes", "seconds", "text"),
    [
        ([100, 300], 1.0, "400 B/s from 2 messages\n\tMessage size mean: 200 B min: 100 B max: 300 B\n"),
        (
            [120] * 10,
            1.0,
            "1.20 KB/s from 10 messages\n\tMessage size mean: 0.12 KB min: 0.12 KB max: 0.12 KB\n",
        ),
        (
            [2_000_000, 4_000_000],
            2.0,
            "3.00 MB/s from 2 messages\n\tMessage size mean: 3.00 MB min: 2.00 MB max: 4.00 MB\n",
        ),
    ],
)
def test_units_are_multiples_of_1000_selected_by_the_rate(
    sizes: list[int], seconds: float, text: str
) -> None:
    assert bandwidth(sizes, seconds) == text
