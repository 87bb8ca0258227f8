"""Messages that our side publishes in a scenario, in the words of the check files."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

from course_lib.arrays import Vector
from course_lib.grading.task import Message
from course_lib.ros.clock import START_NS


@dataclass(frozen=True)
class Found:
    """An object that a detector reports.

    Args:
        track: Number of the object.
        label: What it is.
        center: Of its box, [m].
        size: Edges of its box, [m].
        confidence: 0 to 1, or a value of the student's own, `my(...)`.
        yaw: Turn of its box about z, [rad].
    """

    track: int
    label: str
    center: Vector
    size: Vector
    confidence: Any
    yaw: float = 0.0


def header(at: float, frame: str) -> dict[str, Any]:
    """Return the header of a message of `at` [s] after the start of the scenario."""
    seconds, nanoseconds = divmod(START_NS + round(at * 1e9), 10**9)
    return {"frame_id": frame, "stamp": {"sec": seconds, "nanosec": nanoseconds}}


def xyz(values: Iterable[float]) -> dict[str, float]:
    """Return three numbers as the fields of a point or a vector."""
    return dict(zip("xyz", values, strict=True))


def corners(center: Vector, size: Vector) -> list[list[float]]:
    """Return the eight corners of a box, [m]."""
    ends = [(middle - edge / 2, middle + edge / 2) for middle, edge in zip(center, size, strict=True)]
    return [list(corner) for corner in product(*ends)]


def turned(yaw: float) -> dict[str, float]:
    """Return the quaternion of a turn about z, [rad], as the fields of an orientation."""
    return {"z": math.sin(yaw / 2), "w": math.cos(yaw / 2)}


def detections(found: Iterable[Found], at: float, frame: str = "base_link") -> Message:
    """Return the message of a detector on `/objects`, `at` [s] after the start."""
    fields = {
        "header": header(at, frame),
        "detections": [{"header": header(at, frame), **_detection(one)} for one in found],
    }
    return Message("/objects", "vision_msgs/msg/Detection3DArray", fields, at=at)


def pose(parent: str, child: str, translation: Vector, yaw: float = 0.0) -> dict[str, Any]:
    """Return the transform child to parent for `transforms`: translation in [m], yaw about z in [rad]."""
    placed = {"translation": xyz(translation), "rotation": turned(yaw)}
    return {"parent": parent, "child_frame_id": child, "transform": placed}


def transforms(poses: Iterable[Mapping[str, Any]], at: float) -> Message:
    """Return the broadcast on `/tf`, `at` [s] after the start, with that stamp."""
    stamped = [
        {"header": header(at, made["parent"]), **{k: v for k, v in made.items() if k != "parent"}}
        for made in poses
    ]
    return Message("/tf", "tf2_msgs/msg/TFMessage", {"transforms": stamped}, at=at)


def circling(begin: float, end: float, parent: str = "world", child: str = "base_link") -> Iterable[Message]:
    """Yield transforms of a frame that drives round `on_circle`, 20 a second between two times [s]."""
    for step in range(round((end - begin) * 20)):
        at = begin + step / 20  # [s]
        yield transforms([pose(parent, child, on_circle(at), at + math.pi / 2)], at)


def on_circle(at: float) -> Vector:
    """Return the place on a circle of 3 m, driven round at 1 rad/s, `at` [s] after the start."""
    return (3.0 * math.cos(at), 3.0 * math.sin(at), 0.0)


def scan(
    ranges: Iterable[float],
    at: float,
    frame: str = "laser",
    *,
    first: float,
    step: float,
    topic: str = "/scan",
) -> Message:
    """Return the message of a laser scanner: ranges [m] from the angle `first` on, every `step`, [rad]."""
    measured = list(ranges)
    fields = {
        "header": header(at, frame),
        "angle_min": first,
        "angle_max": first + step * (len(measured) - 1),
        "angle_increment": step,
        "range_min": 0.1,  # [m]
        "range_max": 30.0,  # [m]
        "ranges": measured,
    }
    return Message(topic, "sensor_msgs/msg/LaserScan", fields, at=at)


def odometry(topic: str, at: float, place: Vector, frame: str = "odom") -> Message:
    """Return where `base_link` is in a frame, [m], `at` [s] after the start."""
    fields = {"header": header(at, frame), "child_frame_id": "base_link", "pose": {"pose": _upright(place)}}
    return Message(topic, "nav_msgs/msg/Odometry", fields, at=at)


def path(topic: str, at: float, places: Iterable[Vector], frame: str = "odom") -> Message:
    """Return a way through places of a frame, [m]."""
    fields = {"header": header(at, frame), "poses": [{"pose": _upright(place)} for place in places]}
    return Message(topic, "nav_msgs/msg/Path", fields, at=at)


def marker_array(topic: str, at: float, frame: str, center: Vector, size: Vector, kind: int = 1) -> Message:
    """Return a green marker of a type, a cube unless another one is given; center and size in [m]."""
    marker = {
        "header": header(at, frame),
        "ns": "found",
        "type": kind,
        "pose": _upright(center),
        "scale": xyz(size),
        "color": {"g": 1.0, "a": 1.0},
    }
    return Message(topic, "visualization_msgs/msg/MarkerArray", {"markers": [marker]}, at=at)


def ghost(
    kind: int,
    center: Sequence[Any],
    size: Sequence[Any],
    color: Sequence[float],
    number: int = 0,
    *,
    frame: str = "map",
    yaw: float = 0.0,
) -> Message:
    """Return the expected picture of one marker: type number, center and size [m], RGB or RGBA, yaw [rad]."""
    fields = {
        "header": {"frame_id": frame},
        "ns": "expected",
        "id": number,
        "type": kind,
        "pose": {"position": xyz(center), "orientation": turned(yaw)},
        "scale": xyz(size),
        "color": dict(zip("rgba", (*color, 1.0), strict=False)),
    }
    return Message("/expected", "visualization_msgs/msg/Marker", fields)


def images(topic: str, hz: float, begin: float, end: float, frame: str = "camera_link") -> Iterable[Message]:
    """Return images of one pixel, `hz` [1/s] of them between two times [s]."""
    fields = {"width": 1, "height": 1, "step": 1, "encoding": "mono8", "data": [9]}
    for number in range(round(hz * (end - begin))):
        at = begin + (number + 0.5) / hz  # [s]
        yield Message(topic, "sensor_msgs/msg/Image", {"header": header(at, frame), **fields}, at=at)


def set_parameters(node: str, at: float, **values: Any) -> Message:
    """Return the request of `ros2 param set` to a node, "/perception_node", `at` [s] after the start."""
    parameters = [{"name": name, "value": _parameter(value)} for name, value in values.items()]
    kind = "rcl_interfaces/srv/SetParameters"
    return Message(f"{node}/set_parameters", kind, {"parameters": parameters}, at=at)


def _upright(place: Vector) -> Mapping[str, Any]:
    """Return a pose that is not turned."""
    return {"position": xyz(place), "orientation": {"w": 1.0}}


def _parameter(value: Any) -> Mapping[str, Any]:
    """Return a rcl_interfaces/ParameterValue; a value of the student's own is a double."""
    number, field = {
        bool: (1, "bool_value"),
        int: (2, "integer_value"),
        str: (4, "string_value"),
        list: (8, "double_array_value"),
    }.get(type(value), (3, "double_value"))
    return {"type": number, field: value}


def _detection(found: Found) -> Mapping[str, Any]:
    center = {"position": xyz(found.center), "orientation": turned(found.yaw)}
    return {
        "id": str(found.track),
        "bbox": {"center": center, "size": xyz(found.size)},
        "results": [{"hypothesis": {"class_id": found.label, "score": found.confidence}}],
    }
