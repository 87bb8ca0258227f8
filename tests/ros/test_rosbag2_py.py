"""rosbag2_py: programs that write and read bags."""

import os
from pathlib import Path
from textwrap import dedent

import pytest
import rosbag2_py
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import String

from course_lib.errors import CourseError
from course_lib.recording import bag_info, read_bag
from course_lib.ros.graph.topics import Qos
from tests.warm import run_course

STRING = "std_msgs/msg/String"
NO_CONVERSION = rosbag2_py.ConverterOptions("", "")
RECORDER = """
    import rclpy
    import rosbag2_py
    from rclpy.executors import ExternalShutdownException
    from rclpy.node import Node
    from rclpy.serialization import serialize_message
    from std_msgs.msg import String

    class Recorder(Node):
        def __init__(self):
            super().__init__("recorder")
            self.writer = rosbag2_py.SequentialWriter()
            options = rosbag2_py._storage.StorageOptions(uri="my_bag", storage_id="mcap")
            self.writer.open(options, rosbag2_py._storage.ConverterOptions("", ""))
            self.writer.create_topic(rosbag2_py._storage.TopicMetadata(
                id=0, name="chatter", type="std_msgs/msg/String", serialization_format="cdr"))
            self.subscription = self.create_subscription(String, "chatter", self.on_text, 10)
            self.publisher = self.create_publisher(String, "chatter", 10)
            self.timer = self.create_timer(1.0, lambda: self.publisher.publish(String(data="hello")))

        def on_text(self, msg):
            self.writer.write("chatter", serialize_message(msg), self.get_clock().now().nanoseconds)

    def main(args=None):
        try:
            with rclpy.init(args=args):
                rclpy.spin(Recorder())
        except (KeyboardInterrupt, ExternalShutdownException):
            pass

    if __name__ == "__main__":
        main()
"""
READER = """
    import rclpy
    import rosbag2_py
    from rclpy.node import Node
    from std_msgs.msg import String

    class Reader(Node):
        def __init__(self):
            super().__init__("reader")
            self.reader = rosbag2_py.SequentialReader()
            options = rosbag2_py._storage.StorageOptions(uri="my_bag", storage_id="mcap")
            self.reader.open(options, rosbag2_py._storage.ConverterOptions("", ""))
            self.publisher = self.create_publisher(String, "chatter", 10)
            self.subscription = self.create_subscription(String, "chatter", self.on_text, 10)
            self.timer = self.create_timer(0.1, self.on_timer)

        def on_text(self, msg):
            print("heard", msg.data)

        def on_timer(self):
            if self.reader.has_next():
                self.publisher.publish(self.reader.read_next()[1])

    rclpy.init()
    rclpy.spin(Reader())
"""


def topic(name: str, type_name: str = STRING) -> rosbag2_py.TopicMetadata:
    return rosbag2_py.TopicMetadata(id=0, name=name, type=type_name, serialization_format="cdr")


def opened(folder: Path, storage: str = "mcap") -> rosbag2_py.SequentialWriter:
    writer = rosbag2_py.SequentialWriter()
    writer.open(rosbag2_py.StorageOptions(uri=str(folder), storage_id=storage), NO_CONVERSION)
    return writer


def write(folder: Path, storage: str = "mcap") -> None:
    """Write 10 messages in turn on /a and /b, and a topic /silent without any."""
    writer = opened(folder, storage)
    for name in ("/a", "/b", "/silent"):
        writer.create_topic(topic(name))
    for number in range(10):
        writer.write("/ab"[0] + "ab"[number % 2], serialize_message(String(data=str(number))), 100 + number)
    writer.close()


def reader_of(uri: Path) -> rosbag2_py.SequentialReader:
    reader = rosbag2_py.SequentialReader()
    reader.open(rosbag2_py.StorageOptions(uri=str(uri), storage_id="mcap"), NO_CONVERSION)
    return reader


def rest(reader: rosbag2_py.SequentialReader) -> str:
    """Read the remaining messages, a digit for each."""
    digits = ""
    while reader.has_next():
        _, cdr, _ = reader.read_next()
        digits += deserialize_message(cdr, String).data
    return digits


@pytest.fixture
def bag(tmp_path: Path) -> Path:
    write(tmp_path / "bag")
    return tmp_path / "bag"


@pytest.mark.slow
def test_programs_of_the_tutorial_record_a_bag_and_publish_it_again(tmp_path: Path) -> None:
    message = ""
    for name, text, seconds in (("recorder.py", RECORDER, "3.5"), ("reader.py", READER, "2")):
        (tmp_path / name).write_text(dedent(text))
        process = run_course("run", name, "--seconds", seconds, cwd=tmp_path)
        assert process.returncode == 0, process.stderr
        message += process.stdout
    assert message.splitlines() == ["heard hello"] * 3
    assert "Topic: chatter | Type: std_msgs/msg/String | Count: 3 |" in bag_info(tmp_path / "my_bag")


@pytest.mark.parametrize("storage", sorted(rosbag2_py.get_registered_writers()))
def test_bag_survives_a_round_trip(tmp_path: Path, storage: str) -> None:
    write(tmp_path / "bag", storage)
    reader = reader_of(tmp_path / "bag")
    assert reader.read_next() == ("/a", serialize_message(String(data="0")), 100)
    assert rest(reader) == "123456789"
    with pytest.raises(RuntimeError, match=r"^Bag is at end\. No next message\.$"):
        reader.read_next()
    names = [(one.name, one.type) for one in reader.get_all_topics_and_types()]
    assert names == [("/a", STRING), ("/b", STRING), ("/silent", STRING)]


@pytest.mark.parametrize(
    ("chosen", "digits"),
    [
        (rosbag2_py.StorageFilter(topics=["/a"]), "2468"),
        (rosbag2_py.StorageFilter(regex="/[bc]"), "13579"),
        (rosbag2_py.StorageFilter(topics=["/a", "/b"], exclude_topics=["/a"]), "13579"),
        (rosbag2_py.StorageFilter(regex_to_exclude="b"), "2468"),
        (rosbag2_py.StorageFilter(topics=["/nothing"]), ""),
    ],
)
def test_filter_selects_the_topics_of_the_remaining_messages(
    bag: Path, chosen: rosbag2_py.StorageFilter, digits: str
) -> None:
    reader = reader_of(bag)
    reader.read_next()
    reader.set_filter(chosen)
    assert rest(reader) == digits
    reader.reset_filter()
    reader.seek(108)
    assert rest(reader) == "89"


def test_bag_is_read_in_reverse_order(bag: Path) -> None:
    reader = reader_of(bag)
    assert reader.set_read_order(rosbag2_py.ReadOrder(reverse=True))
    assert rest(reader) == "9876543210"
    reader.seek(102)
    assert rest(reader) == "210"


def test_metadata_count_the_messages_and_print_like_bag_info(bag: Path) -> None:
    about = rosbag2_py.Info().read_metadata(str(bag), "mcap")
    assert (about.message_count, about.duration.nanoseconds, about.starting_time.nanoseconds) == (10, 9, 100)
    counts = {one.topic_metadata.name: one.message_count for one in about.topics_with_message_count}
    assert counts == {"/a": 5, "/b": 5, "/silent": 0}
    assert f"{about!r}\n" == bag_info(bag, digest=False)
    assert about == reader_of(bag).get_metadata()


def test_bag_can_be_opened_by_its_file(bag: Path) -> None:
    assert rest(reader_of(bag / "bag.mcap")) == "0123456789"
    (bag / "other.mcap").touch()
    with pytest.raises(RuntimeError, match=r"is one of several files\. Open the bag's folder: .*bag"):
        reader_of(bag / "bag.mcap")


def test_topic_qos_is_copied_from_bag_to_bag(bag: Path, tmp_path: Path) -> None:
    latched = topic("/map")
    latched.offered_qos_profiles = [Qos(durability="transient_local")]
    writer = opened(tmp_path / "copy")
    writer.create_topic(latched)
    writer.write("/map", serialize_message(String()), 1)
    writer.close()
    assert reader_of(tmp_path / "copy").get_all_topics_and_types()[0].offered_qos_profiles == [
        Qos(durability="transient_local")
    ]


def test_unreferenced_writer_completes_its_bag(tmp_path: Path) -> None:
    writer = opened(tmp_path / "bag")
    writer.create_topic(topic("/a"))
    writer.write("/a", serialize_message(String(data="1")), 5)
    del writer
    assert len(read_bag(tmp_path / "bag").samples) == 1


def test_reading_an_incomplete_bag_raises_an_error_with_the_call_that_completes_it(tmp_path: Path) -> None:
    writer = opened(tmp_path / "bag")
    writer.create_topic(topic("/a"))
    with pytest.raises(CourseError, match=r"has no metadata\.yaml\. If .* writer\.close\(\) completes it"):
        bag_info(tmp_path / "bag")
    writer.close()
    assert "Topic: /a |" in bag_info(tmp_path / "bag")


def test_existing_folder_is_not_replaced(bag: Path) -> None:
    with pytest.raises(
        RuntimeError, match=r"Bag directory already exists \(.*\), can't overwrite existing bag"
    ):
        opened(bag)


@pytest.mark.skipif(os.geteuid() == 0, reason="root writes everywhere")
def test_unwritable_folder_is_reported(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(
        RuntimeError, match=r"Can't write the bag .*: Permission denied\. Choose another folder"
    ):
        opened(tmp_path / "bag")


def test_invalid_calls_are_rejected_with_the_next_step(bag: Path, tmp_path: Path) -> None:
    writer = rosbag2_py.SequentialWriter()
    with pytest.raises(RuntimeError, match=r"Bag is not open\. Call open\(\) before writing\."):
        writer.create_topic(topic("/a"))
    with pytest.raises(RuntimeError, match=r"There is no storage 'rosbag'\. Choose one of mcap, sqlite3"):
        opened(tmp_path / "new", "rosbag")
    writer = opened(tmp_path / "new")
    with pytest.raises(RuntimeError, match="my_msgs/msg/Unknown"):
        writer.create_topic(topic("/a", "my_msgs/msg/Unknown"))
    with pytest.raises(RuntimeError, match=r"Failed to write on topic '/a'\. Call create_topic"):
        writer.write("/a", b"", 1)
    writer.create_topic(topic("/a"))
    with pytest.raises(TypeError, match="call serialize_message"):
        writer.write("/a", String(), 1)  # type: ignore[arg-type]
    with pytest.raises(RuntimeError, match="the stamp -1 is below 0 ns"):
        writer.write("/a", b"", -1)
    with pytest.raises(RuntimeError, match="There is no bag"):
        reader_of(tmp_path / "none")
    with pytest.raises(RuntimeError, match=r"Bag is not open\. Call open\(\) before reading\."):
        rosbag2_py.SequentialReader().has_next()
