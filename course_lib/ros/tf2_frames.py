"""What tf2 says of all its frames."""

from course_lib.ros.tf2_cache import seconds
from course_lib.ros.tf2_core import BufferCore

_SHORTEST_NS = 100_000  # [ns] counts as the length of a shorter history, also of a static transform


def as_yaml(buffer: BufferCore) -> str:
    """Describe the frames as tf2's all_frames_as_yaml does; `[]` if there is none."""
    frames = buffer.frames()
    return (
        "".join(_described(buffer, frame, parent) for frame, parent in parents(buffer).items())
        if frames
        else "[]"
    )


def parents(buffer: BufferCore) -> dict[str, str]:
    """Give the latest parent of each frame that has one, in the order in which the frames came up."""
    found = ((frame, buffer.parent(frame)) for frame in buffer.frames())
    return {frame: parent for frame, parent in found if parent is not None}


def chain(buffer: BufferCore, start: str, end: str) -> list[str]:
    """List the frames on the way from one frame to another of its tree."""
    ups = [_upwards(buffer, frame) for frame in (start, end)]
    meeting = next(frame for frame in ups[0] if frame in ups[1])
    up, down = (way[: way.index(meeting)] for way in ups)
    return [*up, meeting, *reversed(down)]


def _upwards(buffer: BufferCore, frame: str) -> list[str]:
    known, way = parents(buffer), [frame]
    while (parent := known.get(way[-1])) is not None and parent not in way:
        way.append(parent)
    return way


def _described(buffer: BufferCore, frame: str, parent: str) -> str:
    count, oldest_ns, newest_ns = buffer.span(frame)
    length_ns = newest_ns - oldest_ns
    return (
        f"{frame}: \n"
        f"  parent: '{parent}'\n"
        f"  broadcaster: '{buffer.authorities[frame]}'\n"
        f"  rate: {count * 1e9 / max(length_ns, _SHORTEST_NS):.3f}\n"
        f"  most_recent_transform: {seconds(newest_ns)}\n"
        f"  oldest_transform: {seconds(oldest_ns)}\n"
        f"  buffer_length: {length_ns / 1e9:.3f}\n"
    )
