"""Inputs of a scenario: published messages, and values that depend on the student.

Personal values make a copied answer useless, because the same check expects another number from
each student.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

from course_lib.arrays import Vector
from course_lib.course.exercise import current_identity, personal_number
from course_lib.errors import CourseError, did_you_mean
from course_lib.grading.run.outcome import plain
from course_lib.grading.task import Message, Task, resolve
from course_lib.ros.graph.graph import START_NS

# Set in the grader's worker, which has no access to the check files.
_values: dict[str, dict[str, Any]] | None = None


def personal_values(task: Task, student: str | None) -> dict[str, Any]:
    """Choose one option per row of the task's table, by a hash of the student's normalized ID."""
    return {
        name: plain(options[personal_number(student, f"{task.id}/{name}", len(options))])
        for name, options in task.personal.items()
    }


def my_values(task_id: str) -> Mapping[str, Any]:
    """Return your personal values of a task by name: `my_values("week01.post")["height"]`.

    The values depend on your student ID. Without an ID, you get the values of a guest.

    Args:
        task_id: The task, "week01.post".

    Raises:
        CourseError: The task does not exist.
    """
    if _values is not None:
        if task_id not in _values:
            task_ids, suggestion = ", ".join(_values), did_you_mean(task_id, _values)
            raise CourseError(f"there is no task {task_id!r} in this exercise, only {task_ids}{suggestion}")
        return PersonalValues(task_id, _values[task_id])
    from course_lib.grading.task import shipped_catalog

    return PersonalValues(task_id, personal_values(shipped_catalog().task(task_id), current_identity()))


class PersonalValues(dict[str, Any]):
    """Values by name. The error about an unknown name lists the known ones."""

    def __init__(self, task_id: str, values: Mapping[str, Any]) -> None:
        super().__init__(values)
        self._task_id = task_id

    def __missing__(self, name: str) -> Any:
        known = f"only {', '.join(map(repr, self))}" if self else "nor any other. Is another task meant?"
        raise CourseError(f"{self._task_id} has no value {name!r}, {known}{did_you_mean(str(name), self)}")


def set_values(values: dict[str, dict[str, Any]]) -> None:
    """Set the result of `my_values` by task, in the worker that runs a submission."""
    global _values
    _values = values


def build(message: Message, personal: Mapping[str, Any]) -> Any:
    """Build the ROS message of an input, with the student's personal values.

    Raises:
        CourseError: A field is unknown or its value is invalid; the message has the topic and the
            reason.
    """
    from course_lib.ros.messages import message_class
    from course_lib.ros.messages.conversions import set_fields

    built = message_class(message.type_name)()
    try:
        set_fields(built, resolve(message.fields, personal))
    except (AssertionError, AttributeError, TypeError, ValueError) as error:
        raise CourseError(f"the message for {message.topic} ({message.type_name}): {error}") from error
    return built


@dataclass(frozen=True)
class DetectedObject:
    """An object that a detector reports.

    Args:
        track: Number of the object.
        label: Class of the object.
        center: Center of its box [m].
        size: Edge lengths of its box [m].
        confidence: From 0 to 1, or a personal value `my(...)`.
        yaw: Rotation of its box about z [rad].
    """

    track: int
    label: str
    center: Vector
    size: Vector
    confidence: Any
    yaw: float = 0.0


def header(at: float, frame: str) -> dict[str, Any]:
    """Return the header of a message stamped `at` [s] after the start of the scenario."""
    seconds, nanoseconds = divmod(START_NS + round(at * 1e9), 10**9)
    return {"frame_id": frame, "stamp": {"sec": seconds, "nanosec": nanoseconds}}


def xyz(values: Iterable[float]) -> dict[str, float]:
    """Return three numbers as the fields of a point or vector message."""
    return dict(zip("xyz", values, strict=True))


def corners(center: Vector, size: Vector) -> list[list[float]]:
    """Return the eight corners of a box [m]."""
    ends = [(middle - edge / 2, middle + edge / 2) for middle, edge in zip(center, size, strict=True)]
    return [list(corner) for corner in product(*ends)]


def yaw_quaternion(yaw: float) -> dict[str, float]:
    """Return the quaternion of a rotation about z [rad], as the fields of a Quaternion message."""
    return {"z": math.sin(yaw / 2), "w": math.cos(yaw / 2)}


def detections(
    found: Iterable[DetectedObject],
    at: float,
    frame: str = "base_link",
    *,
    delay: float = 0.0,
) -> Message:
    """Return a detector's message on `/objects`, published `at` [s] after the start.

    Its stamp is `delay` [s] earlier: a detector needs time, and the stamp is that of the image.
    """
    seen = header(at - delay, frame)
    reported = [
        {
            "header": seen,
            "id": str(box.track),
            "bbox": {
                "center": {"position": xyz(box.center), "orientation": yaw_quaternion(box.yaw)},
                "size": xyz(box.size),
            },
            "results": [{"hypothesis": {"class_id": box.label, "score": box.confidence}}],
        }
        for box in found
    ]
    fields = {"header": seen, "detections": reported}
    return Message("/objects", "vision_msgs/msg/Detection3DArray", fields, at=at)


def pose(parent: str, child: str, translation: Vector, yaw: float = 0.0) -> dict[str, Any]:
    """Return a transform from child to parent for `transforms`: translation [m], yaw about z [rad]."""
    placement = {"translation": xyz(translation), "rotation": yaw_quaternion(yaw)}
    return {"parent": parent, "child_frame_id": child, "transform": placement}


def transforms(poses: Iterable[Mapping[str, Any]], at: float) -> Message:
    """Return a message on `/tf`, published and stamped `at` [s] after the start."""
    stamped = [
        {"header": header(at, made["parent"]), **{k: v for k, v in made.items() if k != "parent"}}
        for made in poses
    ]
    return Message("/tf", "tf2_msgs/msg/TFMessage", {"transforms": stamped}, at=at)


def circling(
    begin: float,
    end: float,
    parent: str = "world",
    child: str = "base_link",
) -> Iterable[Message]:
    """Yield transforms at 20 Hz of a frame that moves along `circle_position` between two times [s]."""
    for step in range(round((end - begin) * 20)):
        at = begin + step / 20  # [s]
        yield transforms([pose(parent, child, circle_position(at), at + math.pi / 2)], at)


def circle_position(at: float) -> Vector:
    """Return the position `at` [s] on a circle of radius 3 m and height 0.5 m, at 1 rad/s."""
    return (3.0 * math.cos(at), 3.0 * math.sin(at), 0.5)


def scan(
    ranges: Iterable[float],
    at: float,
    frame: str = "laser",
    *,
    first: float,
    step: float,
    topic: str = "/scan",
    delay: float = 0.0,
    best_effort: bool = False,
) -> Message:
    """Return a laser scanner's message: ranges [m] from the angle `first` in steps of `step` [rad].

    It is published `at` [s] after the start, and stamped `delay` [s] earlier. With `best_effort` a
    subscription that requests Reliable does not receive it.
    """
    readings = list(ranges)
    fields = {
        "header": header(at - delay, frame),
        "angle_min": first,
        "angle_max": first + step * (len(readings) - 1),
        "angle_increment": step,
        "range_min": 0.1,  # [m]
        "range_max": 30.0,  # [m]
        "ranges": readings,
    }
    return Message(topic, "sensor_msgs/msg/LaserScan", fields, at=at, best_effort=best_effort)


def odometry(topic: str, at: float, place: Vector, frame: str = "odom") -> Message:
    """Return an Odometry message: the position [m] of `base_link` in `frame`."""
    fields = {"header": header(at, frame), "child_frame_id": "base_link", "pose": {"pose": _upright(place)}}
    return Message(topic, "nav_msgs/msg/Odometry", fields, at=at)


def path(topic: str, at: float, places: Iterable[Vector], frame: str = "odom") -> Message:
    """Return a Path message through positions [m] in `frame`."""
    fields = {"header": header(at, frame), "poses": [{"pose": _upright(place)} for place in places]}
    return Message(topic, "nav_msgs/msg/Path", fields, at=at)


def marker_array(
    topic: str,
    at: float,
    frame: str,
    center: Vector,
    size: Vector,
    kind: int = 1,
) -> Message:
    """Return a MarkerArray with one green marker, a cube by default; center and size in [m]."""
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
    """Return the marker of an expected picture: type number, center and size [m], RGB(A), yaw [rad]."""
    fields = {
        "header": {"frame_id": frame},
        "ns": "expected",
        "id": number,
        "type": kind,
        "pose": {"position": xyz(center), "orientation": yaw_quaternion(yaw)},
        "scale": xyz(size),
        "color": dict(zip("rgba", (*color, 1.0), strict=False)),
    }
    return Message("/expected", "visualization_msgs/msg/Marker", fields)


def images(
    topic: str,
    hz: float,
    begin: float,
    end: float,
    frame: str = "camera_link",
    *,
    best_effort: bool = False,
) -> Iterable[Message]:
    """Yield images of two pixels at the rate `hz` [1/s] between two times [s].

    With `best_effort` a subscription that requests Reliable receives none of them.
    """
    fields = {"width": 2, "height": 1, "step": 2, "encoding": "mono8", "data": [9, 9]}
    for number in range(round(hz * (end - begin))):
        at = begin + (number + 0.5) / hz  # [s]
        content = {"header": header(at, frame), **fields}
        yield Message(topic, "sensor_msgs/msg/Image", content, at=at, best_effort=best_effort)


def set_parameters(node: str, at: float, *, at_once: bool = False, **values: Any) -> Message:
    """Return the service request of `ros2 param set` to a node, sent `at` [s] after the start.

    With `at_once` all values belong together: the node's callback gets them in one list.
    """
    # A value of another type is a `my(...)` value, which becomes a double.
    kinds = {
        bool: (1, "bool_value"),
        int: (2, "integer_value"),
        str: (4, "string_value"),
        list: (8, "double_array_value"),
    }
    parameters = []
    for name, value in values.items():
        number, field = kinds.get(type(value), (3, "double_value"))
        parameters.append({"name": name, "value": {"type": number, field: value}})
    service, kind = ("_atomically", "Atomically") if at_once else ("", "")
    return Message(
        f"{node}/set_parameters{service}",
        f"rcl_interfaces/srv/SetParameters{kind}",
        {"parameters": parameters},
        at=at,
    )


def _upright(place: Vector) -> Mapping[str, Any]:
    """Return the fields of a Pose message without rotation."""
    return {"position": xyz(place), "orientation": {"w": 1.0}}
