import re
import time
from pathlib import Path

import pytest
from rosbags.rosbag2 import StoragePlugin, Writer

from course_lib.errors import CourseError
from course_lib.recording import Recording, bag_info, write_bag
from course_lib.ros.graph.graph import Sample
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import message_class, serialize
from course_lib.ros.messages.definitions import typestore

EXPECTED = """
Files:             recording.mcap
Bag size:          {size}
Storage id:        mcap
ROS Distro:        jazzy
Duration:          1.500000000s
Start:             Nov 14 2023 22:13:20.000000000 (1700000000.000000000)
End:               Nov 14 2023 22:13:21.500000000 (1700000001.500000000)
Messages:          2
Topic information: Topic: /a | Type: std_msgs/msg/String | Count: 1 | Serialization Format: cdr
                   Topic: /b | Type: std_msgs/msg/String | Count: 1 | Serialization Format: cdr
Service:           0
Service information:{space}
Digest:            {digest}
"""


def test_info_has_the_format_of_ros2_bag_info(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TZ", "UTC")
    time.tzset()
    cdr = serialize(message_class("std_msgs/msg/String")())
    stamps = [(1_700_000_000_000_000_000, "/b"), (1_700_000_001_500_000_000, "/a")]
    recording = Recording(
        tuple(Sample(stamp, topic, "std_msgs/msg/String", cdr, Qos(), 1) for stamp, topic in stamps)
    )
    write_bag(recording, tmp_path / "bag")
    size = f"{(tmp_path / 'bag' / 'recording.mcap').stat().st_size / 1024:.1f} KiB"
    assert bag_info(tmp_path / "bag") == EXPECTED.format(space=" ", size=size, digest=recording.digest())
    plain = EXPECTED[: EXPECTED.index("Digest")]
    assert bag_info(tmp_path / "bag", digest=False) == plain.format(space=" ", size=size)
    (tmp_path / "bag" / "metadata.yaml").unlink()  # as after a crash
    without = bag_info(tmp_path / "bag", digest=False)
    assert without == plain.format(space=" ", size=size).replace("jazzy", "unknown")
    monkeypatch.undo()
    time.tzset()


def test_single_digit_day_is_padded_with_a_space(tmp_path: Path) -> None:
    stamp_ns = 1_699_358_400 * 10**9  # 7 November 2023, noon in Greenwich
    cdr = serialize(message_class("std_msgs/msg/String")())
    write_bag(Recording((Sample(stamp_ns, "/a", "std_msgs/msg/String", cdr, Qos(), 1),)), tmp_path / "bag")
    assert re.search(r"Start: +Nov  [678] 2023 ", bag_info(tmp_path / "bag"))


def test_topic_without_messages_is_listed(tmp_path: Path) -> None:
    with Writer(tmp_path / "bag", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        writer.add_connection("/tf", "tf2_msgs/msg/TFMessage", typestore=typestore())
    text = (
        "Topic information: Topic: /tf | Type: tf2_msgs/msg/TFMessage | Count: 0 | Serialization Format: cdr"
    )
    assert text in bag_info(tmp_path / "bag").splitlines()


def test_events_of_services_are_listed_as_services(tmp_path: Path) -> None:
    cdr = serialize(message_class("std_msgs/msg/String")())
    event = "example_interfaces/srv/AddTwoInts_Event"
    with Writer(tmp_path / "bag", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        for topic, kind, count in (("/a/_service_event", event, 2), ("/b", "std_msgs/msg/String", 1)):
            one = writer.add_connection(topic, kind, msgdef="", rihs01="RIHS01_" + "0" * 64)
            for stamp_ns in range(count):
                writer.write(one, stamp_ns, cdr)
    lines = bag_info(tmp_path / "bag", digest=False).splitlines()
    assert lines[-5:] == [
        "Messages:          1",
        "Topic information: Topic: /b | Type: std_msgs/msg/String | Count: 1 | Serialization Format: cdr",
        "Service:           1",
        "Service information: Service: /a | Type: example_interfaces/srv/AddTwoInts | Event "
        "Count: 2 | Serialization Format: cdr",
        "",
    ]


def test_verbose_info_counts_requests_and_responses_of_services(tmp_path: Path) -> None:
    event = message_class("service_msgs/msg/ServiceEventInfo")
    with Writer(tmp_path / "bag", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        kind = "example_interfaces/srv/AddTwoInts_Event"
        topic = writer.add_connection("/a/_service_event", kind, msgdef="", rihs01="RIHS01_" + "0" * 64)
        # The client and the server report both calls, but the second one got no response.
        for event_type, number in ((0, 1), (1, 1), (2, 1), (3, 1), (0, 2), (1, 2)):
            info = event(event_type=event_type, client_gid=[7] * 16, sequence_number=number)
            writer.write(topic, 5, serialize(info))
    line = bag_info(tmp_path / "bag", digest=False, verbose=True).splitlines()[-2]
    assert line.endswith("AddTwoInts | Request Count: 2 | Response Count: 1 | Serialization Format: cdr")


def test_path_that_is_not_a_bag_is_rejected(tmp_path: Path) -> None:
    with pytest.raises(CourseError, match="not a bag"):
        bag_info(tmp_path)
