"""Bags that were cut off open up to the last whole message, wherever the cut is."""

import re
import shutil
import sqlite3
import struct
import time
import tracemalloc
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rosbag2_py
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from course_lib.errors import CourseError
from course_lib.recording import Recording, bag_info, bag_metadata, read_bag, write_bag
from course_lib.ros.graph.graph import Sample
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import message_class, serialize
from course_lib.ros.messages.definitions import definition, field_definitions, typestore

START = 1_700_000_000_000_000_000  # [ns]
STRING = "std_msgs/msg/String"
LATCHED = Qos(depth=1, durability="transient_local")


def make_recording(count: int) -> Recording:
    """Samples of two topics whose texts differ."""
    return Recording(
        tuple(
            Sample(
                START + i * 10**7,
                ("/chatter", "/latched")[i % 2],
                STRING,
                serialize(message_class(STRING)(data=f"{i:04d} " + f"{i * 7919 % 997}" * 20)),
                (Qos(), LATCHED)[i % 2],
                node=0,
            )
            for i in range(count)
        )
    )


def write(recording: Recording, folder: Path, storage: StoragePlugin, compressed: bool = False) -> Path:
    """Write a bag as rosbags does, and name its file."""
    writer = Writer(folder, version=9 if storage is StoragePlugin.MCAP else 8, storage_plugin=storage)
    if compressed:
        writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    with writer:
        added = {
            t.name: writer.add_connection(t.name, STRING, typestore=typestore()) for t in recording.topics()
        }
        for sample in recording.samples:
            writer.write(added[sample.topic], sample.stamp_ns, sample.cdr)
    return next(path for path in folder.iterdir() if path.suffix != ".yaml")


def is_beginning(part: Recording, whole: Recording) -> bool:
    keys = [[(s.stamp_ns, s.topic, s.type_name, s.cdr) for s in one.samples] for one in (part, whole)]
    return keys[0] == keys[1][: len(keys[0])]


@pytest.mark.slow
def test_bag_truncated_anywhere_gives_the_messages_before_the_cut(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recording = make_recording(30)
    write_bag(recording, tmp_path / "bag")
    file = tmp_path / "bag" / "recording.mcap"
    data, last = file.read_bytes(), 0
    first = data.index(b"0000 ")
    for cut in range(first + 200, len(data), 97):
        file.write_bytes(data[:cut])
        part = read_bag(tmp_path / "bag")
        assert is_beginning(part, recording)
        assert last <= len(part.samples)
        last = len(part.samples)
    assert last == len(recording.samples)
    assert {sample.qos for sample in part.samples} == {Qos(), LATCHED}
    assert "is damaged or was cut off: " in (said := capsys.readouterr().err)
    assert said.splitlines()[0].endswith(" messages. For the others, " + _AGAIN)


@pytest.mark.sample(1)
@pytest.mark.parametrize("share", [0.3, 0.6, 0.9])
def test_truncated_compressed_chunk_is_read_up_to_the_damage(tmp_path: Path, share: float) -> None:
    recording = make_recording(20_000)
    file = write(recording, tmp_path / "bag", StoragePlugin.MCAP, compressed=True)
    data = file.read_bytes()
    file.write_bytes(data[: int(share * len(data))])
    part = read_bag(tmp_path / "bag")
    assert is_beginning(part, recording)
    assert share * 20_000 * 0.8 < len(part.samples)


@pytest.mark.parametrize("share", [0.3, 0.9])
def test_truncated_sqlite_bag_can_be_opened(tmp_path: Path, share: float) -> None:
    recording = make_recording(2_000)
    file = write(recording, tmp_path / "bag", StoragePlugin.SQLITE3)
    data = file.read_bytes()
    file.write_bytes(data[: int(share * len(data))])
    part = read_bag(tmp_path / "bag")
    assert is_beginning(part, recording)
    assert len(part.samples) > share * 2_000 * 0.6


def test_sqlite_bag_without_intact_messages_is_an_error(tmp_path: Path) -> None:
    file = write(make_recording(10), tmp_path / "bag", StoragePlugin.SQLITE3)
    file.write_bytes(file.read_bytes()[:3000])
    with pytest.raises(CourseError, match="damaged or was cut off"):
        read_bag(tmp_path / "bag")


@pytest.mark.parametrize("text", [None, "", "[", "rosbag2_bagfile_information: 3"])
def test_bag_without_metadata_is_read(tmp_path: Path, text: str | None) -> None:
    recording = make_recording(5)
    write_bag(recording, tmp_path / "bag")
    metadata = tmp_path / "bag" / "metadata.yaml"
    metadata.unlink() if text is None else metadata.write_text(text)
    assert read_bag(tmp_path / "bag") == recording
    assert "Messages:          5" in bag_info(tmp_path / "bag")


@pytest.mark.parametrize("storage", list(StoragePlugin))
def test_file_of_a_bag_is_read_without_its_folder(
    storage: StoragePlugin, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recording = make_recording(30)
    file = write(recording, tmp_path / "bag", storage)
    alone = file.rename(tmp_path / f"alone{file.suffix}")
    assert is_beginning(read_bag(alone), recording)
    assert len(read_bag(alone).samples) == 30
    assert f"Files:             {alone.name}\n" in bag_info(alone)
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("storage", list(StoragePlugin))
def test_truncated_single_file_is_read_with_a_warning(
    storage: StoragePlugin, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recording = make_recording(3000)
    file = write(recording, tmp_path / "bag", storage)
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    part = read_bag(file)
    assert is_beginning(part, recording)
    assert 0 < len(part.samples) < 3000
    warning = capsys.readouterr().err
    assert warning.startswith(f"warning: The bag {file} is damaged or was cut off: ")
    assert "None" not in warning


@pytest.mark.parametrize(
    ("text", "damage"),
    [
        ("", "is empty"),
        ("[", "is malformed"),
        ("a word", "is malformed"),
        ("rosbag2_bagfile_information: 3", "is malformed"),
        ("rosbag2_bagfile_information: {relative_file_paths: [recording.mcap]}", "is malformed"),
    ],
)
def test_warning_about_malformed_metadata_states_the_file_and_the_next_step(
    text: str, damage: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bag = tmp_path / "bag"
    write_bag(make_recording(5), bag)
    (bag / "metadata.yaml").write_text(text)
    assert len(read_bag(bag).samples) == 5
    assert capsys.readouterr().err == (
        f"warning: The bag {bag} is damaged or was cut off: its metadata.yaml {damage}. It should list "
        "the files and topics under rosbag2_bagfile_information. The kit reads a bag without it; on a "
        f"computer with ROS, delete it and run `ros2 bag reindex {bag}`. Read from its beginning to "
        "its end: 5 messages.\n"
    )


_AGAIN = "copy the bag again from where it was recorded, or record it again."


@pytest.mark.parametrize("first", [20, 60, 1000, 3000, 6000])
def test_warning_about_corrupt_bytes_omits_the_text_of_the_mcap_reader(
    first: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = write(make_recording(60), tmp_path / "bag", StoragePlugin.MCAP)
    data = bytearray(file.read_bytes())
    data[first:-100:7919] = bytes(byte ^ 0xFF for byte in data[first:-100:7919])
    file.write_bytes(data)
    try:
        read_bag(tmp_path / "bag")
    except CourseError as error:
        report = str(error)
    else:
        report = capsys.readouterr().err
    assert re.fullmatch(
        r"|(warning: )?The bag \S+ is damaged( or was cut off: (its files have|\S+ has) bytes that were "
        r"changed\. .*|: 60 messages should be in it, .*)\n?",
        report,
    )
    if "to its end" not in report:
        assert report == "" or report.rstrip().endswith(_AGAIN)


def test_messages_that_an_mcap_file_lost_are_counted_in_a_warning(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bag = tmp_path / "bag"
    write_bag(make_recording(5), bag)
    metadata = bag / "metadata.yaml"
    text = metadata.read_text()
    assert "\n  message_count: 5\n" in text
    metadata.write_text(text.replace("\n  message_count: 5\n", "\n  message_count: 7\n"))
    assert len(read_bag(bag).samples) == 5
    assert capsys.readouterr().err == (
        f"warning: The bag {bag} is damaged: 7 messages should be in it, as its metadata.yaml states, "
        f"and 5 can be read. For the others, {_AGAIN}\n"
    )


@pytest.mark.parametrize(
    ("size", "damage"),
    [
        (0, "is empty"),
        (50, "does not begin as a SQLite file does"),
        (3000, "the end of bag.db3 is missing"),
    ],
)
def test_error_about_a_truncated_sqlite_file_states_the_next_step(
    size: int, damage: str, tmp_path: Path
) -> None:
    file = write(make_recording(10), tmp_path / "bag", StoragePlugin.SQLITE3)
    file.write_bytes(file.read_bytes()[:size])
    with pytest.raises(CourseError) as refused:
        read_bag(tmp_path / "bag")
    assert damage in str(refused.value)
    assert str(refused.value).endswith(f"No complete message is in it: {_AGAIN}")


def test_info_of_a_bag_with_a_renamed_file_lists_the_existing_file(tmp_path: Path) -> None:
    write_bag(make_recording(3), tmp_path / "bag")
    (tmp_path / "bag" / "recording.mcap").rename(tmp_path / "bag" / "walk.mcap")
    assert "Files:             walk.mcap\n" in bag_info(tmp_path / "bag")


@pytest.mark.parametrize("part", ["bag", "file", "bag without metadata", "file without format"])
@pytest.mark.parametrize("storage", [StoragePlugin.MCAP, StoragePlugin.SQLITE3])
def test_bag_in_another_serialization_format_is_rejected_with_the_format(
    tmp_path: Path, storage: StoragePlugin, part: str
) -> None:
    bag = tmp_path / "bag"
    with Writer(bag, version=9 if storage is StoragePlugin.MCAP else 8, storage_plugin=storage) as writer:
        serialization_format = "" if part == "file without format" else "protobuf"
        topic = writer.add_connection(
            "/chatter", STRING, typestore=typestore(), serialization_format=serialization_format
        )
        writer.write(topic, START, b"\0\1\0\0\1\0\0\0\0")
    if part == "bag without metadata":
        (bag / "metadata.yaml").unlink()
    path = next(path for path in bag.iterdir() if path.suffix != ".yaml") if "file" in part else bag
    if not serialization_format:
        assert len(read_bag(path).samples) == 1
        return
    with pytest.raises(CourseError, match=r"format 'protobuf', on /chatter\. Only 'cdr' is supported"):
        read_bag(path)


def test_unwritten_space_of_an_mcap_file_is_not_parsed(tmp_path: Path) -> None:
    bag = tmp_path / "bag.mcap"
    with bag.open("wb") as file:
        file.truncate(300_000_000)
    # Zeros that were parsed as records without content would take minutes.
    with pytest.raises(CourseError, match="does not begin as an MCAP file does"):
        read_bag(bag)


def test_stamp_beyond_the_times_of_ros_is_reported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recording = make_recording(2)
    late = replace(recording.samples[1], stamp_ns=2**63)
    file = write(Recording((recording.samples[0], late)), tmp_path / "bag", StoragePlugin.MCAP)
    assert len(read_bag(file.parent).samples) == 1
    assert "9223372036854775808 ns, which exceeds the largest time of ROS" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b"rosbag2_bagfile_information", b"\xff\xfe"),
        (b"relative_file_paths:", b"relative_file_paths: 5 #"),
        (b"    type: std_msgs/msg/String", b"    kind: 5"),
        (b"  topics_with_message_count:", b"  topics_with_message_count: " + b"[" * 2000),
    ],
)
def test_bag_with_malformed_metadata_is_described_by_its_messages(
    tmp_path: Path, old: bytes, new: bytes
) -> None:
    file = write(make_recording(4), tmp_path / "bag", StoragePlugin.MCAP)
    metadata = file.parent / "metadata.yaml"
    assert old in metadata.read_bytes()
    metadata.write_bytes(metadata.read_bytes().replace(old, new))
    text = bag_info(file.parent)
    assert "Messages:          4" in text
    assert "Topic: /chatter | Type: std_msgs/msg/String | Count: 2" in text
    assert rosbag2_py.Info().read_metadata(str(file.parent), "").message_count == 4


def test_deeply_nested_metadata_is_rejected_quickly(tmp_path: Path) -> None:
    (tmp_path / "metadata.yaml").write_text("rosbag2_bagfile_information: " + "[" * 4000)
    begin = time.process_time()
    assert bag_metadata(tmp_path) == {}
    assert time.process_time() - begin < 0.5  # [s]; PyYAML's loader in Python takes 4 s


@pytest.mark.parametrize("opcode", [0, 3, 15])
def test_huge_file_without_messages_is_rejected_within_little_memory(opcode: int, tmp_path: Path) -> None:
    file = tmp_path / "huge.mcap"
    with file.open("wb") as huge:
        # One record of an exabyte. Its opcode is invalid, a schema's, or that of the end of the
        # data.
        huge.write(bytes(8) + struct.pack("<BQ", opcode, 10**18))
        huge.truncate(2**27)
    tracemalloc.start()
    try:
        with pytest.raises(CourseError, match="does not begin as an MCAP file does"):
            read_bag(file)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    # Only a record that is read takes memory, and never more than the file.
    assert peak < (2**24 if opcode != 3 else 2**28 + 2**24)


_STORED_REPORT = f"""std_msgs/Header header
Cell[2] cells
geometry_msgs/Point center
string name "unnamed"
uint8 FAST=1
{"=" * 80}
MSG: PACKAGE/Cell
float64[] values
bool is_free
{"=" * 80}
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
{"=" * 80}
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
{"=" * 80}
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
"""


_STORED_IDL = f"""{"=" * 80}
IDL: PACKAGE/msg/Report
#include "std_msgs/msg/Header.idl"
module PACKAGE {{
  module msg {{
    typedef PACKAGE::msg::Cell PACKAGE__msg__Cell__2[2];
    module Report_Constants {{
      const uint8 FAST = 1;
    }};
    struct Report {{
      std_msgs::msg::Header header;
      PACKAGE__msg__Cell__2 cells;
      geometry_msgs::msg::Point center;
      @default (value="unnamed")
      string name;
    }};
  }};
}};

{"=" * 80}
IDL: PACKAGE/msg/Cell
module PACKAGE {{ module msg {{ struct Cell {{ sequence<double> values; boolean is_free; }}; }}; }};
{"=" * 80}
IDL: std_msgs/msg/Header
module std_msgs {{ module msg {{
  struct Header {{ builtin_interfaces::msg::Time stamp; string frame_id; }};
}}; }};
"""


@pytest.fixture
def type_definitions() -> Iterator[None]:
    """Remove the types that a test reads from its bags."""
    known = set(field_definitions())
    yield
    for name in set(field_definitions()) - known:
        del field_definitions()[name]
    definition.cache_clear()


def write_custom_type(folder: Path, type_name: str, text: str, cdr: bytes, storage: StoragePlugin) -> Path:
    """Write a bag with one message of a type that only the bag defines; return its file."""
    with Writer(folder, version=9 if storage is StoragePlugin.MCAP else 8, storage_plugin=storage) as writer:
        topic = writer.add_connection("/report", type_name, msgdef=text, rihs01="RIHS01_" + "0" * 64)
        writer.write(topic, START, cdr)
    return next(path for path in folder.iterdir() if path.suffix != ".yaml")


@pytest.mark.usefixtures("type_definitions")
@pytest.mark.parametrize("is_single_file", [False, True])
@pytest.mark.parametrize("storage", [StoragePlugin.MCAP, StoragePlugin.SQLITE3])
@pytest.mark.parametrize("form", ["msg", "idl"])
def test_type_without_a_package_is_read_with_the_definition_in_the_bag(
    tmp_path: Path, form: str, storage: StoragePlugin, is_single_file: bool
) -> None:
    package = f"stored_{form}_{storage.name.lower()}_{int(is_single_file)}_msgs"
    text = {"msg": _STORED_REPORT, "idl": _STORED_IDL}[form].replace("PACKAGE", package)
    name = f"{package}/msg/Report"
    store = get_typestore(Stores.ROS2_JAZZY)
    types_text = _STORED_REPORT.replace("PACKAGE", package).replace(' "unnamed"', "")
    store.register(get_types_from_msg(types_text, name))
    types = store.types
    cells = [types[f"{package}/msg/Cell"](np.array([1.0, 2.0]), flag) for flag in (True, False)]
    stamp = types["builtin_interfaces/msg/Time"](3, 4)
    header = types["std_msgs/msg/Header"](stamp, "map")
    report = types[name](header, cells, types["geometry_msgs/msg/Point"](1.0, 2.0, 3.0), "left")
    cdr = bytes(store.serialize_cdr(report, name))
    file = write_custom_type(tmp_path / "bag", name, text, cdr, storage)
    recording = read_bag(file if is_single_file else tmp_path / "bag")
    message: Any
    ((_, message),) = recording.messages("/report")
    assert message.header.frame_id == "map"
    assert [list(cell.values) for cell in message.cells] == [[1.0, 2.0], [1.0, 2.0]]
    assert [cell.is_free for cell in message.cells] == [True, False]
    assert (message.center.z, message.name, message.FAST) == (3.0, "left", 1)
    message = message_class(name)()
    assert message.name == "unnamed"
    write_bag(recording, tmp_path / "copy")
    assert read_bag(tmp_path / "copy") == recording


@pytest.mark.parametrize(
    ("case", "text"),
    [
        ("code", "float64 x__import__\n"),
        ("syntax", "%%%\n"),
        ("heading", f"float64 x\n{'=' * 80}\nMSG: os; print(1)\nfloat64 y\n"),
        ("keyword", "float64 import\n"),
        ("unknown", "Nowhere place\n"),
        ("wide", "wstring name\n"),
        ("recursive", "Thing[] children\n"),
        ("large", "float64[1000001] x\n"),
        ("nested", f"A[2000] a\n{'=' * 80}\nMSG: refused_nested_msgs/A\nfloat64[2000] x\n"),
        ("digits", f"float64[{'9' * 5000}] x\n"),
        ("long", "float64 x\n" + "# comment\n" * 20_000),
        ("other", f"geometry_msgs/Point p\n{'=' * 80}\nMSG: geometry_msgs/Point\nfloat32 x\n"),
        ("idl", f"{'=' * 80}\nIDL: refused_idl_msgs/msg/Thing\nstruct Thing {{ double x; }};\n"),
    ],
)
def test_unusable_definition_in_a_bag_leaves_its_type_unknown(tmp_path: Path, case: str, text: str) -> None:
    name = f"refused_{case}_msgs/msg/Thing"
    write_custom_type(tmp_path / "bag", name, text, b"\0\1\0\0" + bytes(8), StoragePlugin.MCAP)
    recording = read_bag(tmp_path / "bag")
    assert len(recording.samples) == 1
    with pytest.raises(CourseError, match=f"No message type '{name}' here: put the folder"):
        next(recording.messages("/report"))
    assert [field.base for field in definition("geometry_msgs/msg/Point").fields] == ["float64"] * 3


@pytest.mark.usefixtures("type_definitions")
@pytest.mark.parametrize("storage", [StoragePlugin.MCAP, StoragePlugin.SQLITE3])
def test_bag_with_a_definition_of_unknown_encoding_is_read_without_a_warning(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], storage: StoragePlugin
) -> None:
    package = f"stored_srv_{storage.name.lower()}_msgs"
    text = f"{'=' * 80}\nSRV: {package}/srv/Go\nfloat64 x\n---\nbool is_done\n"
    cdr = serialize(message_class("std_srvs/srv/Trigger_Event")())
    file = write_custom_type(tmp_path / "bag", f"{package}/srv/Go_Event", text, cdr, storage)
    # As rosbag2 writes it for a service that names no other types.
    file.write_bytes(file.read_bytes().replace(b"ros2msg", b"unknown"))
    event: Any
    ((_, event),) = read_bag(tmp_path / "bag").messages("/report")
    assert (event.request, event.response) == ([], [])
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("storage", [StoragePlugin.MCAP, StoragePlugin.SQLITE3])
def test_topic_with_another_qos_in_the_metadata_is_read_without_a_warning(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], storage: StoragePlugin
) -> None:
    write_custom_type(tmp_path / "bag", STRING, "string data\n", bytes(8), storage)
    metadata = tmp_path / "bag" / "metadata.yaml"
    text = metadata.read_text()
    qos = "'- {history: 3, depth: 0, reliability: 1, durability: 2, deadline: {sec: 0, nsec: 0}, "
    qos += "lifespan: {sec: 0, nsec: 0}, liveliness: 1, liveliness_lease_duration: {sec: 0, nsec: 0}, "
    qos += "avoid_ros_namespace_conventions: false}'"
    metadata.write_text(re.sub(r"offered_qos_profiles: (\[\]|''|\"\")", f"offered_qos_profiles: {qos}", text))
    assert metadata.read_text() != text
    assert len(read_bag(tmp_path / "bag").samples) == 1
    assert capsys.readouterr().err == ""


def test_messages_in_the_log_of_sqlite_are_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    recording = make_recording(20)
    file = write(recording, tmp_path / "bag", StoragePlugin.SQLITE3)
    database = sqlite3.connect(file)
    database.execute("PRAGMA journal_mode = WAL")
    database.execute("DELETE FROM messages WHERE id > 10")
    database.commit()
    database.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    rows = [(s.stamp_ns, i % 2 + 1, s.cdr) for i, s in enumerate(recording.samples)][10:]
    database.executemany("INSERT INTO messages(timestamp, topic_id, data) VALUES (?, ?, ?)", rows)
    database.commit()
    # A recorder that is killed leaves the log, which SQLite removes when it ends.
    shutil.copytree(tmp_path / "bag", tmp_path / "killed")
    database.close()
    for bag in (tmp_path / "killed", tmp_path / "killed" / file.name):
        assert len(read_bag(bag).samples) == 20
        assert is_beginning(read_bag(bag), recording)
    assert capsys.readouterr().err == ""
    assert not list((tmp_path / "killed").glob("*-journal"))


@pytest.mark.parametrize("change", ["data = NULL", "timestamp = 'soon'", "data = 'text'"])
def test_rows_of_sqlite_that_are_not_messages_are_left_out_with_a_warning(
    change: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recording = make_recording(10)
    file = write(recording, tmp_path / "bag", StoragePlugin.SQLITE3)
    database = sqlite3.connect(file)
    # A table without the conditions of rosbag2's.
    database.execute("CREATE TABLE copied AS SELECT * FROM messages")
    database.execute("DROP TABLE messages")
    database.execute("ALTER TABLE copied RENAME TO messages")
    database.execute(f"UPDATE messages SET {change} WHERE id = 3")
    database.commit()
    database.close()
    assert len(read_bag(tmp_path / "bag").samples) == 9
    assert "damaged" in capsys.readouterr().err


def test_storage_that_differs_from_the_files_is_reported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write(make_recording(5), tmp_path / "bag", StoragePlugin.MCAP)
    metadata = tmp_path / "bag/metadata.yaml"
    metadata.write_text(metadata.read_text().replace(": mcap", ": sqlite3"))
    assert len(read_bag(tmp_path / "bag").samples) == 5
    stated = "its metadata.yaml states the storage sqlite3, but its files are of mcap"
    assert stated in capsys.readouterr().err
