"""Bags of a link: selected topics, written continuously."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from std_msgs.msg import String

from course_lib.errors import CourseError
from course_lib.recording import BagWriter, read_bag, record_to_bag
from course_lib.ros.messages import serialize
from course_lib.ros.robot.robot_graph import RobotGraph
from tests.ros.zenoh.conftest import Kits
from tests.ros.zenoh.test_two_kits import LATCHED, say, talker, topics

LARGE = "x" * 500_000


def heard(kits: Kits, robot: RobotGraph, out: int, ready: Callable[[], bool]) -> None:
    """Publish until the bag contains a message."""

    def published() -> bool:
        robot.publish(out, serialize(String(data=LARGE)))
        return ready()

    kits.until(published, "the bag")


@pytest.mark.slow
def test_bag_of_a_link_is_written_while_recording_and_includes_earlier_latched_messages(
    kits: Kits, tmp_path: Path
) -> None:
    robot, student = kits.join(send="/flood /map"), kits.join()
    out, held = talker(robot, "/flood"), talker(robot, "/map", qos=LATCHED)
    say(robot, held, "the map")
    folder = tmp_path / "deep" / "bag"
    file = folder / "bag.mcap"

    def has_both() -> bool:
        return file.stat().st_size > 10 * len(LARGE) and b"the map" in file.read_bytes()

    with record_to_bag(student, folder):
        heard(kits, robot, out, has_both)
    recording = read_bag(folder)
    assert {topic.name for topic in recording.topics()} == {"/flood", "/map"}
    assert [message for _, message in recording.messages("/map")] == [String(data="the map")]
    stamps = [sample.stamp_ns for sample in recording.samples]
    assert stamps == sorted(stamps)


def test_only_recorded_topics_are_subscribed(kits: Kits, tmp_path: Path) -> None:
    robot, student = kits.join(send="/chatter /image"), kits.join()
    out, _ = talker(robot, "/chatter"), talker(robot, "/image")
    with record_to_bag(student, tmp_path / "bag", lambda topic, _: topic == "/chatter", lambda: ["/chatter"]):
        kits.until(lambda: "/chatter" in topics(robot, "sub"), "the subscription")
        heard(kits, robot, out, lambda: (tmp_path / "bag" / "bag.mcap").stat().st_size > len(LARGE))
        assert "/image" not in topics(robot, "sub")
    assert [topic.name for topic in read_bag(tmp_path / "bag").topics()] == ["/chatter"]


def test_full_disk_ends_the_bag_but_not_the_link(
    kits: Kits, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    student = kits.join()
    out = talker(student, "/chatter")
    write, left = BagWriter.write, [1]

    def write_one(writer: BagWriter, *sample: object) -> None:
        if not left:
            raise OSError(28, "No space left on device")
        left.pop()
        write(writer, *sample)  # type: ignore[arg-type]  # as they came

    monkeypatch.setattr(BagWriter, "write", write_one)

    def fill() -> None:
        with record_to_bag(student, tmp_path / "bag"):
            for _ in range(3):
                say(student, out, "hello")

    with pytest.raises(CourseError, match=r"Can't write the bag .*: No space left on device"):
        fill()
    monkeypatch.undo()
    shutil.rmtree(tmp_path / "bag")
    (tmp_path / "bag").mkdir()
    with record_to_bag(student, tmp_path / "bag"):  # an empty folder is free
        say(student, out, "hello")
    assert len(read_bag(tmp_path / "bag").samples) == 1
    with pytest.raises(CourseError, match="already exists"), record_to_bag(student, tmp_path / "bag"):
        pass
