"""Parts of week 7's dashboard: parameters, geometry, markers, and a simulated robot.

The lesson imports them. `export` copies what a node uses into the node's own module.
"""

import copy
import math
from collections.abc import Callable
from typing import Any

import numpy as np
from geometry_msgs.msg import Point, PoseStamped, TransformStamped
from nav_msgs.msg import Path
from rclpy.node import Node
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker

from course_lib.sensors import (
    CameraNode,
    Detector,
    DetectorNode,
    Pinhole,
    Thing,
    World,
    box,
    circle,
    cylinder,
    placed,
    plane,
    straight,
)

# --- 1. Parameters: every number that somebody may want to change later -------------------------------

PARAMETERS = {  # rates in [Hz], lengths in [m], colors RGBA
    "marker_update_rate": 10.0,
    "transform_update_rate": 20.0,
    "path_update_rate": 1.0,
    "trajectory_update_rate": 10.0,
    "image_update_rate": 5.0,
    "marker_lifetime": 1.0,  # [s]
    "trajectory_max_points": 100,
    "confidence_threshold": 0.5,
    "max_detections": 20,
    "world_frame": "world",
    "base_frame": "base_link",
    "camera_frame": "camera_link",
    "laser_frame": "laser_frame",
    "bicycle_color": [0.0, 0.5, 1.0, 0.5],
    "car_color": [1.0, 0.0, 0.0, 0.5],
    "person_color": [0.0, 1.0, 0.0, 0.5],
    "text_size": 0.5,
    "arrow_shaft_diameter": 0.1,
    "arrow_head_diameter": 0.25,
}

# --- 2. Poses and transforms ---------------------------------------------------------------------------


def pose_at(seconds: float) -> tuple[float, float, float]:
    """Return the robot's x, y [m] and yaw [rad]: a circle of 3 m, once round in 20 s."""
    angle = 2 * math.pi * (seconds % 20.0) / 20.0  # [rad]
    return 3.0 * math.cos(angle), 3.0 * math.sin(angle), angle + math.pi / 2


def stamped(parent: str, child: str, stamp: Any, place: Any, turn: Any) -> TransformStamped:
    """Return the message of a transform child to parent; place in [m], turn (x, y, z, w)."""
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id, message.header.stamp = parent, stamp
    at, q = message.transform.translation, message.transform.rotation
    at.x, at.y, at.z = place
    q.x, q.y, q.z, q.w = turn
    return message


def pose_message(header: Any, x: float, y: float) -> PoseStamped:
    """Return a pose at a place [m] on the ground."""
    pose = PoseStamped(header=header)
    pose.pose.position.x, pose.pose.position.y = x, y
    return pose


def plan(frame: str, now: Any) -> Path:
    """Return the path of the next 5 s, in 50 poses."""
    path = Path()
    path.header.frame_id, path.header.stamp = frame, now.to_msg()
    for number in range(50):
        x, y, _ = pose_at(now.nanoseconds / 1e9 + number / 10)
        path.poses.append(pose_message(path.header, x, y))
    return path


# --- 3. From a box in space to lines on a picture ------------------------------------------------------


def matrix_of(place: Any, turn: Any) -> Any:
    """Return the matrix, shape (4, 4), of a place [m] and a quaternion (x, y, z, w)."""
    x, y, z, w = turn.x, turn.y, turn.z, turn.w
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), place.x],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), place.y],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), place.z],
            [0, 0, 0, 1],
        ]
    )


def corners_of(bbox: Any) -> Any:
    """Return the corners of a box, shape (4, 8): x, y, z [m] and a 1, in the frame of the message."""
    ends = (-0.5, 0.5)
    unit = np.array([[x, y, z, 1.0] for x in ends for y in ends for z in ends]).T
    size = np.array([[bbox.size.x], [bbox.size.y], [bbox.size.z], [1.0]])
    return matrix_of(bbox.center.position, bbox.center.orientation) @ (unit * size)


ALONG_Z = [(0, 1), (2, 3), (4, 5), (6, 7)]  # pairs of corners
ALONG_Y = [(0, 2), (1, 3), (4, 6), (5, 7)]
ALONG_X = [(0, 4), (1, 5), (2, 6), (3, 7)]
EDGES = [*ALONG_Z, *ALONG_Y, *ALONG_X]


def draw_box(pen: Any, corners: Any, text: str, color: Any) -> None:
    """Draw the edges of a box, given its eight corners [px], and a text above it."""
    rgb = tuple(round(255 * part) for part in color[:3])
    for one, other in EDGES:
        pen.line([corners[one], corners[other]], fill=rgb)
    left, top = (min(corner[axis] for corner in corners) for axis in (0, 1))
    pen.text((left, top - 12), text, fill=rgb)  # [px]


def remember(node: Any, kind: Any, topic: str, qos: Any = 10) -> None:
    """Keep the last message of a topic in node.last."""

    def keep(message: Any) -> None:
        node.last[topic] = message

    node.create_subscription(kind, topic, keep, qos)


# --- 4. What a detection looks like --------------------------------------------------------------------


def score_of(detection: Any) -> float:
    """Return how sure the detector is, 0 to 1."""
    return float(detection.results[0].hypothesis.score)


def text_of(detection: Any) -> str:
    """Return the class and the score, like "Person 0.92"."""
    return f"{detection.results[0].hypothesis.class_id} {score_of(detection):.2f}"


def color_of(node: Any, detection: Any) -> Any:
    """Return the color of a class, RGBA, from a parameter of the node; grey without one."""
    key = f"{detection.results[0].hypothesis.class_id.lower()}_color"
    return node.value(key) if node.has_parameter(key) else [0.5, 0.5, 0.5, 0.5]


def chosen(node: Any, message: Any) -> Any:
    """Return the detections to show: sure enough, the surest first, not too many."""
    threshold = node.value("confidence_threshold")
    sure = [one for one in message.detections if score_of(one) >= threshold]
    most = node.value("max_detections")
    return sorted(sure, key=score_of, reverse=True)[:most]


def box_of(detection: Any, color: Any) -> Marker:
    """Return the box of a detection."""
    marker = Marker(ns="boxes", type=Marker.CUBE)
    marker.pose, marker.scale = detection.bbox.center, detection.bbox.size
    marker.color.r, marker.color.g, marker.color.b, marker.color.a = color
    return marker


def label_of(detection: Any, letters: float) -> Marker:
    """Return a white text above the top of the box; letters are so high, [m]."""
    marker = Marker(ns="labels", type=Marker.TEXT_VIEW_FACING, text=text_of(detection))
    marker.pose = copy.deepcopy(detection.bbox.center)
    marker.pose.position.z += detection.bbox.size.z / 2 + 0.5  # [m]
    marker.scale.z = letters
    marker.color = ColorRGBA(r=1.0, g=1.0, b=1.0, a=1.0)
    return marker


def arrow_of(detection: Any, velocity: Any, shaft: float, head: float) -> Marker:
    """Return an arrow to where it will be in 1 s; velocity in [m/s], diameters in [m]."""
    start = detection.bbox.center.position
    end = Point(x=start.x + velocity[0], y=start.y + velocity[1], z=start.z + velocity[2])
    marker = Marker(ns="velocities", type=Marker.ARROW, points=[start, end])
    marker.scale.x, marker.scale.y = shaft, head
    marker.color = ColorRGBA(r=1.0, g=1.0, b=0.0, a=1.0)
    return marker


# --- 5. The simulated robot: on a real one, drivers do this. It is not exported -------------------------

GROUND = Thing(plane(), placed(0, 0, 0), color=(0.5, 0.55, 0.45))
PERSON = Thing(cylinder(0.25, 1.8), straight((1, 6, 0.9), (6, 6, 0.9), 0.8), (0.2, 0.4, 0.9), "Person")
CAR = Thing(box(4.5, 2.0, 1.5), placed(-6, 7, 0.75, 0.6), (0.8, 0.3, 0.2), "Car")
RIDE: Callable[[float], Any] = circle((0, 0, 0.5), 5.0, period=20.0)  # [m], [s]
BICYCLE = Thing(box(1.8, 0.6, 1.0), lambda t: RIDE(t + 3.0), (0.9, 0.8, 0.2), "Bicycle")  # 3 s ahead
WORLD = World([GROUND, PERSON, CAR, BICYCLE])
OPTICAL_TO_CAMERA = np.array([[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 0, 1]])


def camera_at(seconds: float) -> Any:
    """Return the transform camera_link to world, shape (4, 4), [m]."""
    x, y, yaw = pose_at(seconds)
    return placed(x, y, 0.0, yaw) @ placed(0.3, 0.0, 1.0)


def camera() -> Node:
    """Return a node that publishes five pictures a second."""
    lens = Pinhole(240, 180, 200.0)  # [px]: width, height, focal length
    return CameraNode(
        WORLD, lambda seconds: camera_at(seconds) @ OPTICAL_TO_CAMERA, pinhole=lens, rate=5.0, compressed=None
    )


def detector() -> Node:
    """Return a node that publishes ten arrays of detections a second, with errors of 2 cm."""
    return DetectorNode(Detector(WORLD, camera_at, noise=0.02, seed=7), frame_id="world", rate=10.0)
