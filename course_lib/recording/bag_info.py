"""The text of `ros2 bag info`, with the digest of the bag's content."""

import time
from pathlib import Path
from typing import Any

from course_lib.recording.bag import read_bag
from course_lib.recording.bag_writer import METADATA
from course_lib.recording.recording import Recording
from course_lib.recording.salvage import data_files

_LABEL = 19  # characters before the values, as rosbag2's formatter has it
_SECOND = 10**9  # [ns]
_UNITS = ("B", "KiB", "MiB", "GiB", "TiB")


def bag_info(folder: str | Path, *, digest: bool = True) -> str:
    """Describe a bag in the format of `ros2 bag info`, with an additional line for the digest.

    Raises:
        CourseError: There is no bag, or it is damaged.
    """
    recording = read_bag(folder)
    about = bag_metadata(Path(folder))
    files = [Path(folder, name) for name in about.get("relative_file_paths", ())] or data_files(Path(folder))
    kind = about.get("storage_identifier", "mcap" if files[0].suffix == ".mcap" else "sqlite3")
    rows = [
        ("Files:", f"\n{' ' * _LABEL}".join(path.name for path in files)),
        ("Bag size:", _size(sum(path.stat().st_size for path in files))),
        ("Storage id:", kind),
        ("ROS Distro:", about.get("ros_distro") or "unknown"),
        ("Duration:", f"{_seconds(recording.end_ns - recording.start_ns)}s"),
        ("Start:", _date(recording.start_ns)),
        ("End:", _date(recording.end_ns)),
        ("Messages:", str(len(recording.samples))),
        ("Topic information:", f"\n{' ' * _LABEL}".join(_topics(about, recording))),
        ("Service:", "0"),
        ("Service information: ", ""),
        *([("Digest:", recording.digest())] if digest else []),
    ]
    return "\n" + "\n".join(f"{label:<{_LABEL}}{value}" for label, value in rows) + "\n"


def bag_metadata(folder: Path) -> dict[str, Any]:
    """Read the metadata, which a recorder writes at its end; empty without it."""
    import yaml  # type: ignore[import-untyped]  # PyYAML ships no types

    try:
        text = (folder / METADATA).read_text(encoding="utf-8")
        return dict(yaml.safe_load(text)["rosbag2_bagfile_information"])
    except (OSError, yaml.YAMLError, KeyError, TypeError):
        return {}


def topic_counts(about: dict[str, Any], recording: Recording) -> dict[tuple[str, str], int]:
    """Count the messages by topic and type, also where there are none, in the order of the file."""
    counts = {(topic.name, topic.type_name): topic.count for topic in recording.topics()}
    listed = [topic["topic_metadata"] for topic in about.get("topics_with_message_count", ())]
    topics = dict.fromkeys([*((topic["name"], topic["type"]) for topic in listed), *counts])
    return {key: counts.get(key, 0) for key in topics}


def _topics(about: dict[str, Any], recording: Recording) -> list[str]:
    return [
        f"Topic: {name} | Type: {kind} | Count: {count} | Serialization Format: cdr"
        for (name, kind), count in topic_counts(about, recording).items()
    ]


def _size(size: float) -> str:
    """Return a number of bytes as rosbag2 prints it, like 12.3 KiB."""
    for unit in _UNITS:
        if size < 1024 or unit == _UNITS[-1]:
            break
        size /= 1024
    return f"{size:.0f} {unit}" if unit == "B" else f"{size:.1f} {unit}"


def _seconds(duration_ns: int) -> str:
    return f"{duration_ns // _SECOND}.{duration_ns % _SECOND:09d}"


def _date(stamp_ns: int) -> str:
    """Return a time in the machine's time zone, as rosbag2 prints it."""
    local = time.localtime(stamp_ns // _SECOND)
    date = f"{time.strftime('%b', local)} {local.tm_mday:2d} {time.strftime('%Y %H:%M:%S', local)}"
    return f"{date}.{stamp_ns % _SECOND:09d} ({_seconds(stamp_ns)})"
