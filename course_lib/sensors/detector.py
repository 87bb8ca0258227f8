"""A simulated object detector with misses, noise and false alarms, and its node."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from geometry_msgs.msg import Point, Vector3
from rclpy.node import Node
from std_msgs.msg import Header
from transforms3d.quaternions import mat2quat
from vision_msgs.msg import Detection3D, Detection3DArray, ObjectHypothesisWithPose

from course_lib.arrays import Floats
from course_lib.ros.graph.graph import START_NS
from course_lib.sensors.world import Pose, World, check_number, pose_function

# Factors of a shape's size. These points are inside every shape.
_STEPS = np.array([-0.25, 0.0, 0.25])
_POINTS = np.stack(np.meshgrid(_STEPS, _STEPS, _STEPS), axis=-1).reshape(-1, 3)


@dataclass(frozen=True, eq=False)
class Detection:
    """A labeled 3D box.

    Args:
        track: The number of the object while it is tracked.
        label: The class of the object.
        confidence: 0 to 1.
        transform_box_to_world: Shape (4, 4), [m].
        size: Edges of the box, shape (3,), [m].
        velocity: Velocity in the world, shape (3,), [m/s].
    """

    track: int
    label: str
    confidence: float
    transform_box_to_world: Floats
    size: Floats
    velocity: Floats


@dataclass
class Detector:
    """Detects the labeled objects of a world.

    Args:
        world: The world to measure.
        pose: transform_sensor_to_world, shape (4, 4), [m], or a function of robot time [s]; x
            points ahead.
        range_max: [m]
        field_of_view: The full angle around x, [rad].
        noise: Standard deviation of positions [m] and velocities [m/s].
        miss_rate: Fraction of visible objects that are not detected.
        false_alarms: Mean number of false alarms per detection.
        alarm_confidence: Minimum and maximum confidence of a false alarm.
        keep: Time for which an object that is out of sight keeps its track, [s].
        seed: The same seed gives the same detections.
    """

    world: World
    pose: Pose
    range_max: float = 20.0
    field_of_view: float = 2 * np.pi
    noise: float = 0.0
    miss_rate: float = 0.0
    false_alarms: float = 0.0
    keep: float = 2.0
    seed: int = 0
    alarm_confidence: tuple[float, float] = (0.1, 0.5)

    def __post_init__(self) -> None:
        check_number("range_max [m]", self.range_max, above=0)
        check_number("field_of_view [rad]", self.field_of_view, above=0, high=2 * np.pi)
        check_number("miss_rate", self.miss_rate, low=0, high=1)
        for name in ("noise", "false_alarms", "keep", "seed"):
            check_number(name, getattr(self, name), low=0)
        for share in self.alarm_confidence:
            check_number("alarm_confidence", share, low=0, high=1)
        self._transform_at = pose_function("pose of the detector", self.pose)
        # The track of each object, and the time at which it was last detected [s].
        self._tracks = dict[int, tuple[int, float]]()
        self._last_track = 0

    def detect(self, seconds: float) -> list[Detection]:
        """Detect objects at a robot time since the start of the run [s].

        Times must increase from call to call.
        """
        chance = np.random.default_rng((self.seed, round(abs(seconds) * 1e9)))
        detections, poses = list[Detection](), self.world.poses(seconds)
        labelled = [number for number, item in enumerate(self.world.things) if item.label]
        shares = self._confidences(labelled, self._transform_at(seconds), poses) if labelled else np.zeros(0)
        confidences = dict(zip(labelled, shares.tolist(), strict=True))
        for number in range(len(self.world.things)):
            missed, errors = chance.random() < self.miss_rate, self.noise * chance.standard_normal((2, 3))
            confidence = confidences.get(number, 0.0)
            if confidence and not missed:
                item = self.world.things[number]
                track, last_seen = self._tracks.get(number, (0, -np.inf))
                if seconds - last_seen > self.keep:
                    track = self._new_track()
                self._tracks[number] = track, seconds
                transform = poses[number].copy()
                transform[:3, 3] += errors[0]
                velocity = item.velocity_at(seconds) + errors[1]
                detections.append(
                    Detection(track, item.label, confidence, transform, item.shape.size, velocity)
                )
        alarms = chance.poisson(self.false_alarms)
        return detections + [self._false_alarm(seconds, chance) for _ in range(alarms)]

    def confidence(self, number: int, seconds: float) -> float:
        """Return the confidence of an object, 0 to 1.

        It is the visible fraction of the object, reduced to half at range_max.
        """
        return float(self._confidences([number], self._transform_at(seconds), self.world.poses(seconds))[0])

    def _confidences(
        self,
        numbers: list[int],
        transform_sensor_to_world: Floats,
        poses: Floats,
    ) -> Floats:
        """Return the confidences of K objects, shape (K,), by casting all rays in one call."""
        sizes = np.array([self.world.things[number].shape.size for number in numbers]).reshape(-1, 1, 3)
        rotations, centers = poses[numbers, :3, :3], poses[numbers, None, :3, 3]
        in_world = (_POINTS * sizes @ rotations.transpose(0, 2, 1) + centers).reshape(-1, 3)
        rays = transform_sensor_to_world[:3, :3].T @ (in_world - transform_sensor_to_world[:3, 3]).T
        length = np.linalg.norm(rays, axis=0)
        forward = np.zeros_like(rays)
        forward[0] = 1
        rays = np.divide(rays, length, out=forward, where=length > 0)
        in_view = (rays[0] >= np.cos(self.field_of_view / 2) - 1e-12) & (length <= self.range_max)
        hits = self.world.cast_among(poses, transform_sensor_to_world, rays, self.range_max)
        open_sight = (hits.thing == np.repeat(numbers, len(_POINTS))) | (hits.distance >= length)
        share: Floats = np.mean((in_view & open_sight).reshape(-1, len(_POINTS)), axis=1)
        middle = length.reshape(-1, len(_POINTS))[:, len(_POINTS) // 2]
        share *= np.maximum(0.0, 1 - 0.5 * middle / self.range_max)
        return share

    def _false_alarm(self, seconds: float, chance: np.random.Generator) -> Detection:
        """Return a random box in the field of view, with a label of the world."""
        angle, distance = (
            chance.uniform(-0.5, 0.5) * self.field_of_view,
            chance.uniform(0.1, 1) * self.range_max,
        )
        transform = np.eye(4)
        transform[:3, 3] = distance * np.cos(angle), distance * np.sin(angle), 0
        labels = sorted({item.label for item in self.world.things if item.label}) or ["Unknown"]
        label, confidence = labels[chance.integers(len(labels))], chance.uniform(*self.alarm_confidence)
        transform, size = self._transform_at(seconds) @ transform, chance.uniform(0.3, 2.0, 3)
        return Detection(self._new_track(), label, confidence, transform, size, np.zeros(3))

    def _new_track(self) -> int:
        self._last_track += 1
        return self._last_track


class DetectorNode(Node):
    """Publishes vision_msgs/Detection3DArray.

    Args:
        detector: The detector.
        name: The node's name.
        topic: The topic of the detections.
        frame_id: The world's frame, in which boxes are given.
        rate: Rate of detections, [Hz].
    """

    def __init__(
        self,
        detector: Detector,
        *,
        name: str = "detector",
        topic: str = "objects",
        frame_id: str = "map",
        rate: float = 2.0,
    ) -> None:
        self.detector, self.frame_id = detector, frame_id
        period = 1 / check_number("rate [Hz]", rate, above=0)
        super().__init__(name)
        self.publisher = self.create_publisher(Detection3DArray, topic, 10)
        self.timer = self.create_timer(period, self.publish_detections)

    def publish_detections(self) -> None:
        """Detect the objects at the current time, and publish them with their tracks as ids."""
        now = self.get_clock().now()
        header = Header(stamp=now.to_msg(), frame_id=self.frame_id)
        messages = []
        for detection in self.detector.detect((now.nanoseconds - START_NS) * 1e-9):
            message = Detection3D(header=header, id=str(detection.track))
            transform = detection.transform_box_to_world
            _write(message.bbox.center.position, transform[:3, 3])
            for axis, value in zip("xyzw", quaternion(transform[:3, :3]), strict=True):
                setattr(message.bbox.center.orientation, axis, value)
            _write(message.bbox.size, detection.size)
            hypothesis = ObjectHypothesisWithPose()
            hypothesis.hypothesis.class_id = detection.label
            hypothesis.hypothesis.score = float(detection.confidence)
            hypothesis.pose.pose = message.bbox.center
            message.results = [hypothesis]
            messages.append(message)
        self.publisher.publish(Detection3DArray(header=header, detections=messages))


def quaternion(rotation: Floats) -> tuple[float, ...]:
    """Return a rotation, shape (3, 3), as a quaternion in the order x, y, z, w."""
    return _quaternion(tuple(rotation.flat))


# Cached, because most things do not rotate.
@lru_cache
def _quaternion(rotation: tuple[float, ...]) -> tuple[float, ...]:
    w, x, y, z = map(float, mat2quat(np.reshape(rotation, (3, 3))))
    return x, y, z, w


def _write(vector: Vector3 | Point, values: Floats) -> None:
    vector.x, vector.y, vector.z = map(float, values)
