"""Recordings as rosbag2 bags: a folder with metadata.yaml and one MCAP file."""

import os
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from course_lib.errors import CourseError, counted
from course_lib.recording import bag_qos
from course_lib.recording.bag_writer import METADATA, BagWriter
from course_lib.recording.recording import Recording
from course_lib.recording.salvage import data_files, salvage
from course_lib.ros.graph import Sample

if TYPE_CHECKING:
    from rosbags.rosbag2 import Reader

NAME = "recording"  # of the MCAP file: rosbags names it after the folder and writes that name into it


def write_bag(recording: Recording, folder: str | Path, *, force: bool = False) -> None:
    """Write a recording as a bag; equal recordings give equal bytes, whatever the folder's name.

    The bag is written aside and renamed, so that a crash leaves no half of one.

    Args:
        recording: What to write.
        folder: The bag's folder, made with its parents.
        force: Replace a bag that is there.

    Raises:
        CourseError: The place is taken, or can't be written to; a message type is not known.
    """
    target = Path(folder).absolute()
    check_free(target, force)
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with TemporaryDirectory(prefix=f".{target.name}.", dir=target.parent) as aside:
            _write(recording, Path(aside, NAME))
            if target.exists():
                os.replace(target, Path(aside, "replaced"))
            os.replace(Path(aside, NAME), target)
    except OSError as error:
        raise CourseError(
            f"Can't write the bag {folder}: {error.strerror}. Choose another folder."
        ) from error


def read_bag(folder: str | Path) -> Recording:
    """Read a bag of MCAP or SQLite files; bags hold no node ids, so each is 0.

    A bag that was cut off is read up to its last whole message, with a line on stderr.

    Raises:
        CourseError: There is no bag, or nothing in it is whole.
    """
    from rosbags.rosbag2 import Reader

    path = Path(folder)
    _check_bag(path)
    try:
        with Reader(path) as reader:
            return Recording(tuple(_samples(reader)))
    # A damaged file makes rosbags, its decompressors and SQLite raise almost anything.
    except Exception as error:
        damage = f"The bag {folder} is damaged or was cut off: {_reason(error, path)}"
        samples = salvage(path)
        if not samples:
            raise CourseError(damage) from error
        whole = counted(len(samples), "message")
        sys.stderr.write(f"warning: {damage}. Read from its beginning, up to the damage: {whole}.\n")
        return Recording(tuple(samples))


def check_free(target: Path, force: bool) -> None:
    """Raise a CourseError if a bag can't be written here, because something is there already."""
    if not target.exists() or (target.is_dir() and not any(target.iterdir())):
        return
    if not force:
        raise CourseError(f"{target} exists already. Choose another folder, or say force to replace the bag.")
    if not (target / METADATA).is_file():
        raise CourseError(f"{target} is not a bag, so it is not replaced. Choose another folder.")


def _check_bag(path: Path) -> None:
    if not path.exists():
        raise CourseError(f"There is no bag {path}. `course run FILE.py --bag {path}` records one.")
    if not path.is_dir() or not ((path / METADATA).is_file() or data_files(path)):
        what = "a folder" if path.is_dir() else "a file"
        raise CourseError(f"{path} is {what} but not a bag. Give a bag's folder: the one with a {METADATA}.")


def _reason(error: Exception, path: Path) -> str:
    if not (path / METADATA).is_file():
        return f"it has no {METADATA}. If its program still runs, writer.close() completes it"
    return str(error).splitlines()[0].rstrip(".") if str(error) else type(error).__name__


def _write(recording: Recording, folder: Path) -> None:
    with BagWriter(folder) as writer:
        for topic in recording.topics():
            writer.add(topic.name, topic.type_name, topic.offered)
        for sample in recording.samples:
            writer.write(sample.topic, sample.type_name, sample.stamp_ns, sample.cdr)


def _samples(reader: "Reader") -> list[Sample]:
    connections: list[Any] = reader.connections  # all of rosbag2's kind
    offered = {one.id: bag_qos.from_bag(one.ext.offered_qos_profiles) for one in connections}
    return [
        Sample(stamp_ns, connection.topic, connection.msgtype, bytes(cdr), offered[connection.id], node=0)
        for connection, stamp_ns, cdr in reader.messages()
    ]
