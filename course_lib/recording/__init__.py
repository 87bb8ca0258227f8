"""Recordings: samples in memory, in the order of their publication, and rosbag2 bags of them.

A bag is a folder with metadata.yaml and an MCAP file. `storage` reads the files of damaged bags.
"""

import hashlib
import os
import re
import shutil
import struct
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_lib.errors import CourseError, format_count
from course_lib.files import draft_folder
from course_lib.recording.storage import (
    CDR,
    SECOND_NS,
    STORAGES,
    TEXT_ENCODINGS,
    check_format,
    check_stamp,
    data_files,
    from_bag,
    is_data_file,
    salvage,
    to_bag,
    write_ahead_log,
)
from course_lib.ros.graph.graph import Graph, Sample, TopicSelector
from course_lib.ros.graph.topics import Qos, read_tick
from course_lib.ros.messages import RosMessage
from course_lib.ros.messages.definitions import add_stored_definition, definition, type_hash, typestore
from course_lib.third_party import MOST_TEXT, check_size, read_text

if TYPE_CHECKING:
    from rosbags.interfaces import Connection
    from rosbags.rosbag2 import Reader


@dataclass(frozen=True)
class TopicSummary:
    """A topic of a recording, with the different QoS of its publishers."""

    name: str
    type_name: str
    count: int
    offered: tuple[Qos, ...]


@dataclass(frozen=True)
class Recording:
    """Samples in the order of their publication."""

    samples: Sequence[Sample]

    @property
    def start_ns(self) -> int:
        """Robot time of the first sample [ns]; 0 without samples."""
        return self.samples[0].stamp_ns if self.samples else 0

    @property
    def end_ns(self) -> int:
        """Robot time of the last sample [ns]; 0 without samples."""
        return self.samples[-1].stamp_ns if self.samples else 0

    def topics(self) -> list[TopicSummary]:
        """List the topics by name. A topic with two types is listed twice."""
        groups: dict[tuple[str, str], list[Qos]] = {}
        for sample in self.samples:
            groups.setdefault((sample.topic, sample.type_name), []).append(sample.qos)
        return [
            TopicSummary(name, type_name, len(qos), tuple(dict.fromkeys(qos)))
            for (name, type_name), qos in sorted(groups.items())
        ]

    def messages(self, topic: str) -> Iterator[tuple[int, RosMessage]]:
        """Yield (robot time [ns], message) of a topic.

        Raises:
            CourseError: A type is unknown, or the bytes are not a message of this type.
        """
        for sample in self.samples:
            if sample.topic == topic:
                yield sample.stamp_ns, sample.message()

    def digest(self) -> str:
        """Return the SHA-256 of all samples' topics, types, stamps and CDR bytes, in hex."""
        total = hashlib.sha256()
        for sample in self.samples:
            stamp = sample.stamp_ns.to_bytes(8, "little", signed=True)
            for part in (sample.topic.encode(), sample.type_name.encode(), stamp, sample.cdr):
                total.update(len(part).to_bytes(8, "little"))
                total.update(part)
        return total.hexdigest()


class Recorder:
    """Collects the samples of a graph until it is stopped; also a context manager."""

    def __init__(self, graph: Graph) -> None:
        self._samples = graph.latched_samples()
        self._end_tap = graph.tap(self._samples.append)
        self._is_listening = True

    def stop(self) -> None:
        """Stop collecting samples."""
        if self._is_listening:
            self._end_tap()
        self._is_listening = False

    def recording(self) -> Recording:
        """Return the collected samples as a recording."""
        return Recording(tuple(self._samples))

    def __enter__(self) -> "Recorder":
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()


def record(graph: Graph) -> Recorder:
    """Start to record all topics of a graph, including latched samples."""
    return Recorder(graph)


METADATA = "metadata.yaml"
# Name of the MCAP file. rosbags would use the folder's name and write it into the file.
NAME = "recording"


class BagWriter:
    """The writer of a one-file bag. As a context manager it leaves a partial bag after an error.

    Args:
        folder: The bag's folder, which is created.
        storage: "mcap" or "sqlite3".
        compression: What is compressed with zstd: "none", the whole "file", each "message", or with
            "storage" the chunks of messages in an MCAP file.
        custom_data: Strings by name for the metadata.
    """

    def __init__(
        self,
        folder: Path,
        storage: str = "mcap",
        *,
        compression: str = "none",
        custom_data: Mapping[str, str] | None = None,
    ) -> None:
        from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

        self._metadata = folder / METADATA
        self._writer = Writer(folder, version=9, storage_plugin=StoragePlugin[storage.upper()])
        self._writer.set_compression(CompressionMode[compression.upper()], CompressionFormat.ZSTD)
        for name, text in (custom_data or {}).items():
            self._writer.set_custom_data(name, text)
        try:
            self._writer.open()
        except OSError as error:
            # On a full disk, the writer leaves an incomplete bag in the folder that it has created.
            if not isinstance(error, FileExistsError):
                shutil.rmtree(folder, ignore_errors=True)
            raise
        self._connections: dict[tuple[str, str], Connection] = {}

    def add(self, topic: str, type_name: str, offered: Sequence[Qos] = ()) -> None:
        """Add a topic, or raise a CourseError if its type is unknown."""
        # This raises a CourseError if the type is unknown.
        definition(type_name)
        self._connections[topic, type_name] = self._writer.add_connection(
            topic,
            type_name,
            typestore=typestore(),
            # As in rosbag2: the parts of an action have no file of their own to be included.
            msgdef="" if "/action/" in type_name else None,
            rihs01=type_hash(type_name),
            offered_qos_profiles=[to_bag(qos) for qos in offered],
        )

    def write(self, topic: str, type_name: str, stamp_ns: int, cdr: bytes) -> None:
        """Append a message of a topic that was added before."""
        self._writer.write(self._connections[topic, type_name], stamp_ns, cdr)

    def close(self) -> None:
        """Complete the file and write the metadata."""
        self._writer.close()
        # rosbags writes its own name instead of the ROS distribution.
        about = read_text(self._metadata)
        text = about.replace("ros_distro: rosbags", "ros_distro: jazzy")
        self._metadata.write_text(text, encoding="utf-8")

    def abort(self) -> None:
        """Stop writing and leave an incomplete bag."""
        self._writer.abort()

    def __enter__(self) -> "BagWriter":
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is None:
            self.close()
        else:
            self.abort()


def write_bag(recording: Recording, folder: str | Path, *, force: bool = False) -> None:
    """Write a recording as a bag.

    Equal recordings give equal bytes, regardless of the folder's name. The bag is written into a
    temporary folder and renamed, so that a crash leaves no incomplete bag.

    Args:
        recording: The recording.
        folder: The bag's folder, which is created with its parents.
        force: Whether to replace an existing bag.

    Raises:
        CourseError: The folder exists or cannot be written, or a message type is unknown.
    """
    target = Path(folder).absolute()
    check_free(target, force)
    try:
        with draft_folder(target) as temporary_folder:
            with BagWriter(temporary_folder / NAME) as writer:
                for topic in recording.topics():
                    writer.add(topic.name, topic.type_name, topic.offered)
                for sample in recording.samples:
                    writer.write(sample.topic, sample.type_name, sample.stamp_ns, sample.cdr)
            if target.exists():
                os.replace(target, temporary_folder / "replaced")
            os.replace(temporary_folder / NAME, target)
    except OSError as error:
        raise CourseError(
            f"Can't write the bag {folder}: {error.strerror}. Choose another folder."
        ) from error


def read_bag(folder: str | Path) -> Recording:
    """Read a bag of MCAP or SQLite files, or one such file.

    Node ids are 0, because bags do not contain them. An incomplete bag is read up to its last
    complete message, with a warning on standard error.

    Raises:
        CourseError: The bag does not exist, has no complete message, or is not serialized as CDR.
    """
    from rosbags.rosbag2 import Reader

    path = Path(folder)
    _check_bag(path)
    # rosbags does not read the logs of SQLite.
    if is_data_file(path) or any(map(write_ahead_log, data_files(path))):
        return _read_files(path, "")
    try:
        check_size(path / METADATA, MOST_TEXT)
        with Reader(path) as reader:
            samples, listed_count = _samples(reader), reader.message_count
    # A damaged file can cause many kinds of errors in rosbags, its decompressors and SQLite.
    except Exception as error:
        for topic in _topics_in_metadata(bag_metadata(path)):
            check_format(path, topic["name"], topic.get("serialization_format", CDR))
        # rosbags looks up the encoding of each definition, and does not know this one.
        is_unknown_encoding = isinstance(error, KeyError) and error.args == (TEXT_ENCODINGS[-1],)
        return _read_files(path, "" if is_unknown_encoding else _describe_damage(path, error))
    if len(samples) < listed_count and bag_metadata(path).get("compression_mode", "") in ("", "NONE"):
        # rosbags leaves out topics whose QoS in the metadata differs from the QoS in the files.
        samples_of_files, _ = salvage(data_files(path))
        samples = samples_of_files if len(samples_of_files) == listed_count else samples
    if len(samples) < listed_count:
        sys.stderr.write(
            f"warning: The bag {path} is damaged: {format_count(listed_count, 'message')} should be "
            f"in it, as its {METADATA} states, and {len(samples)} can be read. For the others, copy "
            "the bag again from where it was recorded, or record it again.\n"
        )
    return Recording(tuple(samples))


def _describe_damage(bag: Path, error: Exception) -> str:
    """Describe why rosbags cannot read a bag as a whole.

    Its own texts are used where they are about the bag. Others quote Python's error.
    """
    from rosbags.rosbag2 import ReaderError

    path = bag / METADATA
    if not path.is_file():
        return f"the bag has no {METADATA}. If its program still runs, writer.close() completes it"
    text = str(error).partition("\n")[0].rstrip(".").partition("; please")[0]
    if isinstance(error, ReaderError) and re.search("supported$|^Some database files", text):
        return text
    if path.stat().st_size > MOST_TEXT:
        return f"its {METADATA} is larger than {MOST_TEXT // 2**20} MB"
    # rosbags reads these entries before it opens the files.
    required = {"version", "storage_identifier", "topics_with_message_count", "message_count"}
    about = bag_metadata(bag)
    if about.keys() >= required:
        storages = {STORAGES[file.suffix] for file in data_files(bag)}
        stated = about["storage_identifier"]
        if stated in STORAGES.values() and stated not in storages:
            return f"its {METADATA} states the storage {stated}, but its files are of {storages.pop()}"
        return "its files have bytes that were changed"
    return (
        f"its {METADATA} {'is malformed' if path.read_bytes().strip() else 'is empty'}. It should "
        "list the files and topics under rosbag2_bagfile_information. The kit reads a bag without "
        f"it; on a computer with ROS, delete it and run `ros2 bag reindex {bag}`"
    )


def _read_files(path: Path, reason: str) -> Recording:
    """Read the complete messages of a bag's files.

    A warning reports the damage of a file, or the reason why the bag cannot be read as a whole.
    """
    samples, damage = salvage(data_files(path))
    if not (reason or damage):
        return Recording(tuple(samples))
    # Damage to its files explains why rosbags cannot read a bag, unless its recorder still runs.
    is_unfinished = reason and not (path / METADATA).is_file()
    cause = f"{damage}, and {reason}" if damage and is_unfinished else damage or reason
    text = f"The bag {path} is damaged or was cut off: {cause}"
    again = "copy the bag again from where it was recorded, or record it again."
    if not samples:
        raise CourseError(f"{text}. No complete message is in it: {again}")
    message_count = format_count(len(samples), "message")
    advice = f", up to the damage: {message_count}. For the others, {again}"
    end = advice if damage else f" to its end: {message_count}."
    sys.stderr.write(f"warning: {text}. Read from its beginning{end}\n")
    return Recording(tuple(samples))


def check_free(target: Path, force: bool) -> None:
    """Raise a CourseError if a bag cannot be written here because the path exists."""
    if not target.exists() or (target.is_dir() and not any(target.iterdir())):
        return
    if not force:
        raise CourseError(f"{target} already exists. Choose another folder, or use force to replace the bag.")
    if not (target / METADATA).is_file():
        raise CourseError(f"{target} is not a bag, so it is not replaced. Choose another folder.")


def _check_bag(path: Path) -> None:
    if not path.exists():
        raise CourseError(f"There is no bag {path}. `course run FILE.py --bag {path}` records one.")
    if is_data_file(path) or (path.is_dir() and ((path / METADATA).is_file() or data_files(path))):
        return
    file = min(path.glob("*.bag"), default=path)
    if file.suffix == ".bag" and file.is_file():
        raise CourseError(
            f"{file} is a bag of ROS 1. Convert it into a bag of ROS 2 first: "
            f"rosbags-convert --src {file} --dst {file.stem}"
        )
    if path.suffix == ".zstd" and path.is_file():
        raise CourseError(
            f"{path} is a compressed file of a bag. Give the folder with its {METADATA}, or unpack "
            f"the file first: zstd -d {path}"
        )
    if path.suffix == ".zip" and path.is_file():
        raise CourseError(f"{path} is an archive. Unpack it, and pass the folder of the bag in it.")
    kind = "a folder" if path.is_dir() else "a file"
    raise CourseError(
        f"{path} is {kind} but not a bag. Pass the folder of a bag, which contains {METADATA}, or "
        "one of its files, .mcap or .db3."
    )


def _samples(reader: "Reader") -> list[Sample]:
    # Connections of rosbag2 bags, whose ext has the QoS.
    connections: list[Any] = reader.connections
    for topic in connections:
        add_stored_definition(topic.msgtype, topic.msgdef.data)
    qos_profiles = {topic.id: from_bag(topic.ext.offered_qos_profiles) for topic in connections}
    samples: list[Sample] = []
    for topic, stamp_ns, cdr in reader.messages():
        check_stamp(stamp_ns)
        samples.append(
            Sample(stamp_ns, topic.topic, topic.msgtype, bytes(cdr), qos_profiles[topic.id], node=0)
        )
    return samples


# Width of the labels, as in rosbag2's formatter.
_LABEL = 19
_SERVICES = "Service information: "
# A service introspected by ROS 2 publishes messages of type PACKAGE/srv/NAME_Event on this topic.
_EVENT_TOPIC, _EVENT = "/_service_event", "_Event"
# The kind of an event, the client's id and its call's number, in CDR of
# service_msgs/msg/ServiceEventInfo.
_EVENT_HEAD = struct.Struct("4xB3x8x16s4x8s")
_RESPONSE_SENT = 2
_UNITS = ("B", "KiB", "MiB", "GiB", "TiB")


def bag_info(folder: str | Path, *, digest: bool = True, verbose: bool = False) -> str:
    """Describe a bag in the format of `ros2 bag info`, with an additional line for the digest.

    With `verbose`, the requests and the responses of services are counted instead of their events.

    Raises:
        CourseError: The bag does not exist or is damaged.
    """
    recording = read_bag(folder)
    about = bag_metadata(Path(folder))
    listed_files = [Path(folder, name) for name in about.get("relative_file_paths", ())]
    # The files may have been renamed, so that they differ from the names in the metadata.
    files = (
        listed_files
        if listed_files and all(path.is_file() for path in listed_files)
        else data_files(Path(folder))
    )
    kind = about.get("storage_identifier", "mcap" if files[0].suffix == ".mcap" else "sqlite3")
    counts = topic_counts(about, recording)
    # As in rosbag2, the events of services are not counted as messages, nor listed as topics.
    services = {
        (topic, type_name): count
        for (topic, type_name), count in counts.items()
        if is_service_event(topic, type_name)
    }
    rows = [
        ("Files:", f"\n{' ' * _LABEL}".join(path.name for path in files)),
        ("Bag size:", _size(sum(path.stat().st_size for path in files))),
        ("Storage id:", kind),
        ("ROS Distro:", about.get("ros_distro") or "unknown"),
        ("Duration:", f"{_seconds(recording.end_ns - recording.start_ns)}s"),
        ("Start:", _date(recording.start_ns)),
        ("End:", _date(recording.end_ns)),
        ("Messages:", str(len(recording.samples) - sum(services.values()))),
        (
            "Topic information:",
            f"\n{' ' * _LABEL}".join(
                f"Topic: {name} | Type: {kind} | Count: {count} | Serialization Format: cdr"
                for (name, kind), count in counts.items()
                if (name, kind) not in services
            ),
        ),
        ("Service:", str(len(services))),
        (
            _SERVICES,
            f"\n{' ' * len(_SERVICES)}".join(
                f"Service: {name.removesuffix(_EVENT_TOPIC)} | Type: {kind.removesuffix(_EVENT)} | "
                f"{_count_calls(recording, name) if verbose else f'Event Count: {count}'} | "
                "Serialization Format: cdr"
                for (name, kind), count in services.items()
            )
            + "\n" * bool(services),
        ),
        *([("Digest:", recording.digest())] if digest else []),
    ]
    return "\n" + "\n".join(f"{label:<{_LABEL}}{value}" for label, value in rows) + "\n"


def is_service_event(topic: str, type_name: str) -> bool:
    """Return whether rosbag2 regards a topic as the events of a service."""
    return topic.endswith(_EVENT_TOPIC) and "/srv/" in type_name and type_name.endswith(_EVENT)


def _count_calls(recording: Recording, topic: str) -> str:
    """Count the requests and responses in the events of a service. Client and server may report each."""
    calls: tuple[set[bytes], set[bytes]] = set(), set()
    for sample in recording.samples:
        if sample.topic == topic:
            if len(sample.cdr) < _EVENT_HEAD.size:
                raise CourseError(
                    f"An event on {topic} has {len(sample.cdr)} bytes, at least {_EVENT_HEAD.size} are "
                    "expected, so its calls cannot be counted. Repeat the command without -v."
                )
            kind, client, number = _EVENT_HEAD.unpack_from(sample.cdr)
            calls[kind >= _RESPONSE_SENT].add(client + number)
    return f"Request Count: {len(calls[0])} | Response Count: {len(calls[1])}"


def bag_metadata(folder: Path) -> dict[str, Any]:
    """Read the metadata that a recorder writes when it stops; empty if missing or malformed."""
    import yaml

    try:
        text = read_text(folder / METADATA)
        # PyYAML's C loader is used if it is available, because its Python loader takes a second for a
        # line of nested brackets.
        loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
        about = dict(yaml.load(text, loader)["rosbag2_bagfile_information"])
        return about | {"relative_file_paths": [str(name) for name in about["relative_file_paths"]]}
    except (OSError, ValueError, RecursionError, yaml.YAMLError, KeyError, TypeError):
        return {}


def _topics_in_metadata(about: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the descriptions of the topics in metadata; an empty list if it is malformed."""
    try:
        return [dict(entry["topic_metadata"]) for entry in about["topics_with_message_count"]]
    except (KeyError, TypeError, ValueError):
        return []


def topic_counts(about: dict[str, Any], recording: Recording) -> dict[tuple[str, str], int]:
    """Count the messages by topic and type, also topics without messages, in the file's order."""
    counts = {(topic.name, topic.type_name): topic.count for topic in recording.topics()}
    listed = [(topic.get("name"), topic.get("type")) for topic in _topics_in_metadata(about)]
    topics = dict.fromkeys([*((str(name), str(kind)) for name, kind in listed if name and kind), *counts])
    return {key: counts.get(key, 0) for key in topics}


def _size(size: float) -> str:
    """Return a number of bytes as rosbag2 prints it, like 12.3 KiB."""
    for unit in _UNITS:
        if size < 1024 or unit == _UNITS[-1]:
            break
        size /= 1024
    return f"{size:.0f} {unit}" if unit == "B" else f"{size:.1f} {unit}"


def _seconds(duration_ns: int) -> str:
    return f"{duration_ns // SECOND_NS}.{duration_ns % SECOND_NS:09d}"


def _date(stamp_ns: int) -> str:
    """Return a time in the machine's time zone, as rosbag2 prints it."""
    local = time.localtime(stamp_ns // SECOND_NS)
    date = f"{time.strftime('%b', local)} {local.tm_mday:2d} {time.strftime('%Y %H:%M:%S', local)}"
    return f"{date}.{stamp_ns % SECOND_NS:09d} ({_seconds(stamp_ns)})"


# Whether to record a topic with a type.
Chosen = Callable[[str, str], bool]
Stamped = Callable[[Sample], list[Sample]]


@contextmanager
def record_to_bag(
    graph: Graph,
    folder: Path,
    chosen: Chosen = lambda topic, type_name: True,
    select_topics: TopicSelector | None = None,
    *,
    in_sim_time: bool = False,
) -> Iterator[None]:
    """Record a graph into a bag during a `with` block.

    Args:
        graph: The graph. If it is linked to a robot, the bag is written during the run, otherwise
            at the end.
        folder: The bag's folder.
        chosen: Selects the topics.
        select_topics: Returns the topics that a linked robot has to send, in sim time including
            /clock; None for all.
        in_sim_time: Whether messages are stamped by /clock. Of earlier messages, only those of
            transient_local publishers are kept.

    Raises:
        CourseError: The bag cannot be written.
    """
    start_ns = graph.now_ns

    def stamp_by_start(sample: Sample) -> list[Sample]:
        # An earlier sample, from a transient_local publisher, gets the time of the start.
        return [sample if sample.stamp_ns >= start_ns else replace(sample, stamp_ns=start_ns)]

    stamp_samples = _SimTime().stamp_samples if in_sim_time else stamp_by_start
    if graph.keeps_wall_time:
        growing = _LiveBag(graph, folder, chosen, select_topics, stamp_samples)
        try:
            yield
        finally:
            growing.close()
        return
    with record(graph) as recorder:
        yield
    samples = [stamped for sample in recorder.recording().samples for stamped in stamp_samples(sample)]
    # Stamps may decrease if a simulation was reset.
    samples.sort(key=lambda sample: sample.stamp_ns)
    write_bag(Recording(tuple(s for s in samples if chosen(s.topic, s.type_name))), folder)


@dataclass
class _SimTime:
    """Stamps samples with the last time received on /clock."""

    _now_ns: int | None = None
    # Received before the first message on /clock.
    _latched: list[Sample] = field(default_factory=list)

    def stamp_samples(self, sample: Sample) -> list[Sample]:
        """Return the samples that can be stamped now that another one has been received."""
        time_ns = read_tick(sample)
        self._now_ns = self._now_ns if time_ns is None else time_ns
        if self._now_ns is None:
            self._latched += [sample] if sample.qos.is_latched else []
            return []
        ready, self._latched = [*self._latched, sample], []
        return [replace(sample, stamp_ns=self._now_ns) for sample in ready]


class _LiveBag:
    """A bag that is written during the run.

    A write error ends the recording and is reported at the end.
    """

    def __init__(
        self,
        graph: Graph,
        folder: Path,
        chosen: Chosen,
        select_topics: TopicSelector | None,
        stamp_samples: Stamped,
    ) -> None:
        check_free(folder.absolute(), force=False)
        self._folder, self._is_selected, self._stamp_samples = folder, chosen, stamp_samples
        # Whether a topic with a type is recorded.
        self._is_recorded = dict[tuple[str, str], bool]()
        self._problem: CourseError | None = None
        try:
            folder.absolute().parent.mkdir(parents=True, exist_ok=True)
            if folder.exists():
                # An empty folder, because the writer creates its own.
                folder.rmdir()
            self._writer = BagWriter(folder)
        except OSError as error:
            raise self._write_error(error) from error
        for sample in graph.latched_samples():
            self._on_sample(sample)
        self._end_tap = graph.tap(self._on_sample, select_topics)

    def close(self) -> None:
        """Complete the bag, or raise a CourseError if it could not be written."""
        self._end_tap()
        if self._problem is None:
            try:
                self._writer.close()
            except OSError as error:
                self._problem = self._write_error(error)
        if self._problem is not None:
            raise self._problem

    def _on_sample(self, sample: Sample) -> None:
        for stamped in self._stamp_samples(sample):
            if self._problem is not None:
                return
            name = stamped.topic, stamped.type_name
            try:
                if name not in self._is_recorded:
                    self._is_recorded[name] = self._is_selected(*name)
                    if self._is_recorded[name]:
                        self._writer.add(*name, [stamped.qos])
                if self._is_recorded[name]:
                    self._writer.write(*name, stamped.stamp_ns, stamped.cdr)
            except OSError as error:
                self._problem = self._write_error(error)
                self._writer.abort()

    def _write_error(self, error: OSError) -> CourseError:
        return CourseError(f"Can't write the bag {self._folder}: {error.strerror}. Choose another folder.")
