"""What `ros2 bag info` prints of a bag, and the digest of what is in it."""

import time
from pathlib import Path
from typing import Any

from course_lib.recording.bag import METADATA, read_bag

_LABEL = 19  # characters before the values, as rosbag2's formatter has it
_SECOND = 10**9  # [ns]
_UNITS = ("B", "KiB", "MiB", "GiB", "TiB")


def bag_info(folder: str | Path) -> str:
    """Describe a bag in the format of `ros2 bag info`, with one line more: the digest.

    Raises:
        CourseError: There is no bag, or it is damaged.
    """
    recording = read_bag(folder)
    about = _metadata(Path(folder))
    files = [Path(folder, name) for name in about["relative_file_paths"]]
    rows = [
        ("Files:", f"\n{' ' * _LABEL}".join(path.name for path in files)),
        ("Bag size:", _size(sum(path.stat().st_size for path in files))),
        ("Storage id:", about["storage_identifier"]),
        ("ROS Distro:", about.get("ros_distro") or "unknown"),
        ("Duration:", f"{_seconds(recording.end_ns - recording.start_ns)}s"),
        ("Start:", _date(recording.start_ns)),
        ("End:", _date(recording.end_ns)),
        ("Messages:", str(len(recording.samples))),
        ("Topic information:", f"\n{' ' * _LABEL}".join(_topics(about))),
        ("Service:", "0"),
        ("Service information: ", ""),
        ("Digest:", recording.digest()),
    ]
    return "\n" + "\n".join(f"{label:<{_LABEL}}{value}" for label, value in rows) + "\n"


def _metadata(folder: Path) -> dict[str, Any]:
    from ruamel.yaml import YAML

    text = (folder / METADATA).read_text(encoding="utf-8")
    about: dict[str, Any] = YAML(typ="safe").load(text)["rosbag2_bagfile_information"]
    return about


def _topics(about: dict[str, Any]) -> list[str]:
    """Describe each topic, also one without messages."""
    rows = [(topic["topic_metadata"], topic["message_count"]) for topic in about["topics_with_message_count"]]
    return [
        f"Topic: {topic['name']} | Type: {topic['type']} | Count: {count} | "
        f"Serialization Format: {topic['serialization_format']}"
        for topic, count in sorted(rows, key=lambda row: row[0]["name"])
    ]


def _size(size: float) -> str:
    """Write a number of bytes as rosbag2 does, 12.3 KiB."""
    for unit in _UNITS:
        if size < 1024 or unit == _UNITS[-1]:
            break
        size /= 1024
    return f"{size:.0f} {unit}" if unit == "B" else f"{size:.1f} {unit}"


def _seconds(duration_ns: int) -> str:
    return f"{duration_ns // _SECOND}.{duration_ns % _SECOND:09d}"


def _date(stamp_ns: int) -> str:
    """Write a time in the machine's time zone, as rosbag2 does."""
    date = time.strftime("%b %d %Y %H:%M:%S", time.localtime(stamp_ns // _SECOND))
    return f"{date}.{stamp_ns % _SECOND:09d} ({_seconds(stamp_ns)})"
