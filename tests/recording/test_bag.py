import errno
import os
from pathlib import Path

import pytest
from rosbags.rosbag2 import StoragePlugin, Writer

from course_lib.errors import CourseError
from course_lib.recording import BagWriter, Recording, read_bag, write_bag
from course_lib.ros.graph.graph import Sample
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import message_class, serialize
from course_lib.ros.messages.definitions import typestore

START = 1_700_000_000_000_000_000  # [ns]
STRING = "std_msgs/msg/String"
LATCHED = Qos(depth=1, durability="transient_local", deadline_ns=10**9)
REFERENCE = Path(__file__).parent.parent / "data/rviz_reference"


def make_recording(count: int = 3, size: int = 1) -> Recording:
    """Samples of two topics, in pairs of one stamp."""
    cdr = [serialize(message_class(STRING)(data=str(i) * size)) for i in range(count)]
    topics = [("/latched", LATCHED), ("/chatter", Qos())]
    return Recording(
        tuple(
            Sample(START + i, topic, STRING, cdr[i], qos, node=0)
            for i in range(count)
            for topic, qos in topics
        )
    )


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_bag_survives_a_round_trip(tmp_path: Path) -> None:
    recording = make_recording()
    write_bag(recording, tmp_path / "new" / "bag")
    assert read_bag(tmp_path / "new" / "bag") == recording


def test_message_order_is_kept_with_equal_stamps_and_in_large_bags(tmp_path: Path) -> None:
    recording = make_recording(count=200, size=10_000)
    write_bag(recording, tmp_path / "bag")
    assert read_bag(tmp_path / "bag").digest() == recording.digest()


def test_equal_recordings_give_equal_bytes_in_any_folder(tmp_path: Path) -> None:
    write_bag(make_recording(), tmp_path / "one")
    write_bag(make_recording(), tmp_path / "other")
    assert contents(tmp_path / "one") == contents(tmp_path / "other")
    assert contents(tmp_path / "one").keys() == {"recording.mcap", "metadata.yaml"}


def test_empty_recording_is_saved_as_a_bag(tmp_path: Path) -> None:
    write_bag(Recording(()), tmp_path / "bag")
    assert read_bag(tmp_path / "bag") == Recording(())


def test_existing_bag_is_replaced_only_with_force(tmp_path: Path) -> None:
    write_bag(make_recording(1), tmp_path / "bag")
    with pytest.raises(CourseError, match="already exists"):
        write_bag(make_recording(2), tmp_path / "bag")
    write_bag(make_recording(2), tmp_path / "bag", force=True)
    assert len(read_bag(tmp_path / "bag").samples) == 4
    assert [path.name for path in tmp_path.iterdir()] == ["bag"]


def test_force_replaces_only_bags(tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("all of it")
    with pytest.raises(CourseError, match="is not a bag, so it is not replaced"):
        write_bag(make_recording(), tmp_path, force=True)
    assert (tmp_path / "thesis.txt").exists()


def test_crash_while_writing_leaves_no_files_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def crash(*_: object) -> None:
        raise RuntimeError("power cut")

    monkeypatch.setattr(BagWriter, "add", crash)
    with pytest.raises(RuntimeError):
        write_bag(make_recording(), tmp_path / "bag")
    assert list(tmp_path.iterdir()) == []


def test_writer_that_cannot_start_on_a_full_disk_leaves_no_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(writer: Writer) -> None:
        writer.path.mkdir()
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Writer, "open", fail)
    with pytest.raises(OSError, match="No space left on device"):
        BagWriter(tmp_path / "bag")
    assert not any(tmp_path.iterdir())


def test_unwritable_bag_folder_is_reported(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(CourseError, match=r"Can't write the bag .*file/bag"):
        write_bag(make_recording(), tmp_path / "file" / "bag")


def test_unknown_type_in_a_bag_is_reported(tmp_path: Path) -> None:
    stranger = Sample(START, "/x", "my_msgs/msg/Thing", b"", Qos(), node=0)
    advice = "put the folder of the package my_msgs, with its msg/Thing.msg, beside the program"
    with pytest.raises(CourseError, match=f"No message type 'my_msgs/msg/Thing' here: {advice}"):
        write_bag(Recording((stranger,)), tmp_path / "bag")


def test_missing_bag_error_explains_how_to_record_one(tmp_path: Path) -> None:
    with pytest.raises(CourseError, match=r"There is no bag .*nowhere\. `course run FILE.py --bag"):
        read_bag(tmp_path / "nowhere")


def test_path_that_is_not_a_bag_is_rejected(tmp_path: Path) -> None:
    (tmp_path / "file.txt").write_text("x")
    with pytest.raises(CourseError, match="is a folder but not a bag"):
        read_bag(tmp_path)
    with pytest.raises(CourseError, match="is a file but not a bag"):
        read_bag(tmp_path / "file.txt")


@pytest.mark.parametrize(
    ("name", "advice"),
    [
        ("drive.bag", r"a bag of ROS 1\. .*: rosbags-convert --src .*drive\.bag --dst drive$"),
        ("drive.zip", r"drive\.zip is an archive\. Unpack it, and pass the folder of the bag in it\.$"),
        ("drive_0.mcap.zstd", r"a compressed file of a bag\. .*: zstd -d .*drive_0\.mcap\.zstd$"),
    ],
)
def test_bag_in_another_container_is_rejected_with_the_command_to_convert_it(
    name: str, advice: str, tmp_path: Path
) -> None:
    (tmp_path / name).write_bytes(b"x")
    with pytest.raises(CourseError, match=advice):
        read_bag(tmp_path / name)


def test_folder_with_a_bag_of_ros_1_is_rejected_with_the_command_to_convert_it(tmp_path: Path) -> None:
    (tmp_path / "drive.bag").write_bytes(b"#ROSBAG V2.0\n")
    with pytest.raises(CourseError, match=r"drive\.bag is a bag of ROS 1\. .* --dst drive$"):
        read_bag(tmp_path)


@pytest.mark.parametrize("in_folder", [False, True])
@pytest.mark.parametrize("storage", ["recording.mcap", "recording.db3"])
def test_bag_that_git_lfs_has_not_fetched_is_reported(tmp_path: Path, storage: str, in_folder: bool) -> None:
    write_bag(make_recording(), tmp_path / "bag")
    (tmp_path / "bag" / "recording.mcap").unlink()
    file = tmp_path / "bag" / storage
    file.write_bytes(b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 990\n")
    with pytest.raises(CourseError, match=rf"{storage} is not a file of a bag: .*, then git lfs pull\.$"):
        read_bag(tmp_path / "bag" if in_folder else file)


@pytest.mark.parametrize("kept", [0, 5, 100, 400])
def test_bag_without_intact_messages_is_an_error(tmp_path: Path, kept: int) -> None:
    write_bag(make_recording(), tmp_path / "bag")
    file = tmp_path / "bag" / "recording.mcap"
    file.write_bytes(file.read_bytes()[:kept])
    with pytest.raises(CourseError, match=r"bag is damaged or was cut off: .+"):
        read_bag(tmp_path / "bag")


@pytest.mark.parametrize("text", ["", "[", "a: 1", "rosbag2_bagfile_information: 3"])
def test_broken_metadata_is_reported_as_a_single_error(tmp_path: Path, text: str) -> None:
    (tmp_path / "metadata.yaml").write_text(text)
    with pytest.raises(CourseError, match="damaged"):
        read_bag(tmp_path)


def test_sqlite_bag_is_read(tmp_path: Path) -> None:
    recording = make_recording()
    with Writer(tmp_path / "bag", version=8, storage_plugin=StoragePlugin.SQLITE3) as writer:
        for topic in recording.topics():
            connection = writer.add_connection(topic.name, STRING, typestore=typestore())
            for sample in recording.samples:
                if sample.topic == topic.name:
                    writer.write(connection, sample.stamp_ns, sample.cdr)
    assert sorted(texts(read_bag(tmp_path / "bag"))) == sorted(texts(recording))


def texts(recording: Recording) -> list[str]:
    return [repr(pair) for topic in recording.topics() for pair in recording.messages(topic.name)]


@pytest.mark.parametrize("scene", sorted(path.name for path in REFERENCE.iterdir()))
def test_every_message_of_the_reference_bags_is_read(scene: str) -> None:
    recording = read_bag(REFERENCE / scene / "bag")
    found = [message for topic in recording.topics() for _, message in recording.messages(topic.name)]
    assert len(found) == len(recording.samples) > 0
    assert sorted(map(serialize, found)) == sorted(sample.cdr for sample in recording.samples)
