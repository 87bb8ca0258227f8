"""The simulated world: things with shape, color and pose, their motions, and ray casting."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from course_lib.arrays import Floats, Indices
from course_lib.errors import CourseError
from course_lib.sensors.checked import (
    Motion,
    Pose,
    check_array,
    check_number,
    check_rays,
    check_transform,
    pose_function,
)
from course_lib.sensors.shapes import Shape

SKY = (0.6, 0.75, 0.9)  # red, green, blue of nothing
_STEP = 1e-4  # [s] of the difference that gives velocities


def placed(x: float, y: float, z: float, yaw: float = 0.0) -> Floats:
    """Return the pose, shape (4, 4), of a thing at (x, y, z) [m], turned about z by yaw [rad]."""
    cos, sin = np.cos(yaw), np.sin(yaw)
    return np.array([[cos, -sin, 0, x], [sin, cos, 0, y], [0, 0, 1, z], [0, 0, 0, 1]], float)


def straight(start: ArrayLike, goal: ArrayLike, speed: float) -> Callable[[float], Floats]:
    """Return a motion along a line, to and fro; x looks ahead.

    Args:
        start: Where it begins in the world, shape (3,), [m].
        goal: Where it turns round, shape (3,), [m].
        speed: [m/s]

    Returns:
        transform_thing_to_world, shape (4, 4), [m], as a function of robot time [s].
    """
    begin, end = check_array("start [m]", start, (3,)), check_array("goal [m]", goal, (3,))
    length = float(np.linalg.norm(end - begin))
    check_number("speed [m/s]", speed, above=0)
    if length == 0:
        raise CourseError(f"start and goal are both {begin.tolist()}; give two different points.")
    yaw = float(np.arctan2(*(end - begin)[1::-1]))

    def pose(seconds: float) -> Floats:
        gone = seconds * speed % (2 * length)
        back = gone >= length
        point = begin + (end - begin) * ((2 * length - gone if back else gone) / length)
        return placed(point[0], point[1], point[2], yaw + np.pi * back)

    return Motion(pose)


def circle(center: ArrayLike, radius: float, period: float) -> Callable[[float], Floats]:
    """Return a motion on a horizontal circle; x looks ahead.

    Args:
        center: In the world, shape (3,), [m].
        radius: [m]
        period: Of one round, [s]; clockwise if it is negative.

    Returns:
        transform_thing_to_world, shape (4, 4), [m], as a function of robot time [s].
    """
    x, y, z = check_array("center [m]", center, (3,))
    check_number("radius [m]", radius, above=0)
    if check_number("period [s]", period) == 0:
        raise CourseError("period [s] is 0; give the time of one round, negative for clockwise.")

    def pose(seconds: float) -> Floats:
        angle = 2 * np.pi * seconds / period
        ahead = angle + np.copysign(np.pi / 2, period)
        return placed(x + radius * np.cos(angle), y + radius * np.sin(angle), z, ahead)

    return Motion(pose)


@dataclass(frozen=True, eq=False)
class Thing:
    """One thing in the world.

    Args:
        shape: What it looks like.
        pose: transform_thing_to_world, shape (4, 4), [m], or a function of robot time [s] that gives it.
        color: Red, green, blue, each 0 to 1.
        label: What a detector calls it; without one, detectors leave it alone.
    """

    shape: Shape
    pose: Pose
    color: Sequence[float] = (0.7, 0.7, 0.7)
    label: str = ""
    transform_at: Callable[[float], Floats] = field(init=False, repr=False)  # robot time [s] -> (4, 4)

    def __post_init__(self) -> None:
        if not isinstance(self.shape, Shape):
            known = "box(x, y, z), sphere(radius), cylinder(radius, height) or plane()"
            raise CourseError(f"shape is {self.shape!r}, which is none; give {known}.")
        color = check_array("color", self.color, (3,))
        if color.min() < 0 or color.max() > 1:
            raise CourseError(f"color is {list(self.color)}; red, green and blue go from 0 to 1.")
        if self.label and not np.isfinite(self.shape.size).all():
            raise CourseError(
                f"The plane is labelled {self.label!r}; planes are endless, label a box instead."
            )
        name = f"pose of {self.label or 'a thing'}"
        object.__setattr__(self, "transform_at", pose_function(name, self.pose))

    def velocity_at(self, seconds: float) -> Floats:
        """Return the velocity of its frame in the world at a robot time [s], shape (3,), [m/s]."""
        before, after = self.transform_at(seconds - _STEP), self.transform_at(seconds + _STEP)
        return (after - before)[:3, 3] / (2 * _STEP)


@dataclass(frozen=True, eq=False)
class Hits:
    """The first things on N rays.

    Args:
        distance: Along each ray, shape (N,), [m]; inf for nothing.
        thing: Number of the thing in `World.things`, shape (N,); -1 for nothing.
    """

    distance: Floats
    thing: Indices


class World:
    """Things that sensors see.

    Args:
        things: In the order of their numbers.
    """

    def __init__(self, things: Sequence[Thing]) -> None:
        for number, thing in enumerate(things):
            if not isinstance(thing, Thing):
                raise CourseError(f"Number {number} of the world is {thing!r}; give Thing(shape, pose).")
        self.things = tuple(things)
        self._reach = np.array([thing.shape.reach for thing in things], float)
        self.colors = np.array([*(thing.color for thing in things), SKY], float)  # (M + 1, 3): -1 is the sky

    def cast(
        self, transform_sensor_to_world: ArrayLike, rays: ArrayLike, seconds: float, far: float = np.inf
    ) -> Hits:
        """Return the first things on rays from one point; sensor and rays are checked.

        Args:
            transform_sensor_to_world: Rigid, shape (4, 4), [m].
            rays: Unit vectors in the sensor's frame as columns, shape (3, N).
            seconds: Robot time, [s].
            far: Things beyond this need not be found, [m].
        """
        pose = check_transform("transform_sensor_to_world", transform_sensor_to_world)
        return self.cast_among(self.poses(seconds), pose, check_rays(rays), far)

    def poses(self, seconds: float) -> Floats:
        """Return transform_thing_to_world of all things at a robot time [s], shape (M, 4, 4)."""
        return np.array([thing.transform_at(seconds) for thing in self.things]).reshape(-1, 4, 4)

    def cast_among(self, poses: Floats, pose: Floats, rays: Floats, far: float) -> Hits:
        """Cast rays as `cast` does; all is checked already: poses of things and sensor, and the rays."""
        origin, rays = pose[:3, 3], pose[:3, :3] @ rays
        distance, found = np.full(rays.shape[1], np.inf), np.full(rays.shape[1], -1)
        for number, chosen in enumerate(self._near(poses[:, :3, 3] - origin, rays, far)):
            if not len(chosen):
                continue
            to_thing = poses[number, :3, :3].T
            start = to_thing @ (origin - poses[number, :3, 3])
            length = self.things[number].shape.distances(start, to_thing @ rays[:, chosen])
            closer = length < distance[chosen]
            distance[chosen[closer]], found[chosen[closer]] = length[closer], number
        return Hits(distance, found)

    def _near(self, centers: Floats, rays: Floats, far: float) -> list[Indices]:
        """Return, per thing, the rays that may meet its sphere; centers (M, 3) from the sensor, [m]."""
        away = np.linalg.norm(centers, axis=1)
        inside = away <= self._reach
        # A ray meets the sphere if it goes along its centre at least as far as the tangents do.
        tangent = np.sqrt(np.where(inside, 0, away**2 - np.where(inside, 0, self._reach) ** 2))
        least = np.where(inside, -np.inf, tangent - 1e-9 * (1 + away))
        least[away - self._reach > far] = np.inf
        return [np.flatnonzero(row) for row in centers @ rays >= least[:, None]]
