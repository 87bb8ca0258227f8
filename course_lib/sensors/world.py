"""The simulated world: objects with shape, color and pose, their motions, and ray casting.

All rays of a measurement are cast together with numpy, for one object after the other. To save time,
only the rays that meet an object's bounding sphere are tested with its shape.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from course_lib.arrays import Floats, Indices
from course_lib.errors import CourseError

_EYE = np.eye(3)
# From robot time since the start of the run [s] to a transform, shape (4, 4).
PoseAt = Callable[[float], ArrayLike]
Pose = ArrayLike | PoseAt


def check_number(
    name: str, value: Any, *, above: float = -np.inf, low: float = -np.inf, high: float = np.inf
) -> float:
    """Return a finite number that is greater than `above` and lies in [low, high].

    Raises:
        CourseError: The value is invalid. The message contains the value and the limits.
    """
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = np.nan
    if not (np.isfinite(number) and number > above and low <= number <= high):
        limits = ((">", above), (">=", low), ("<=", high))
        limit_text = " and ".join(f"{sign} {limit:g}" for sign, limit in limits if np.isfinite(limit))
        raise CourseError(f"{name} is {value!r}; expected a number{' ' + limit_text if limit_text else ''}.")
    return number


def check_count(name: str, value: Any) -> int:
    """Return an integer of at least 1, or raise a CourseError."""
    if not isinstance(value, int | np.integer) or isinstance(value, bool) or value < 1:
        raise CourseError(f"{name} is {value!r}; expected a whole number, 1 or more.")
    return int(value)


def check_limits(name: str, unit: str, low: Any, high: Any) -> tuple[float, float]:
    """Return two numbers with low < high, or raise a CourseError."""
    lower = check_number(f"{name}_min [{unit}]", low)
    return lower, check_number(f"{name}_max [{unit}]", high, above=lower)


def check_array(name: str, value: ArrayLike, shape: tuple[int, ...]) -> Floats:
    """Return a read-only array of finite float64 numbers with a shape, where -1 means any length.

    Raises:
        CourseError: The shape differs or a number is not finite.
    """
    try:
        array = np.array(value, float)
    except (TypeError, ValueError):
        raise CourseError(f"{name} is {value!r}; expected numbers of shape {shape}.") from None
    expected_shape = tuple(
        actual_size if want == -1 else want for actual_size, want in zip(array.shape, shape, strict=False)
    )
    if array.ndim != len(shape) or array.shape != expected_shape:
        raise CourseError(f"{name} has shape {array.shape}; expected numbers of shape {shape}.")
    if not np.isfinite(array).all():
        raise CourseError(f"{name} contains {array[~np.isfinite(array)][0]}; expected finite numbers.")
    array.setflags(write=False)
    return array


def check_transform(name: str, value: ArrayLike) -> Floats:
    """Return a rigid transform, shape (4, 4), translation in [m].

    Raises:
        CourseError: The transform is not rigid. The message contains the invalid part.
    """
    matrix = check_array(name, value, (4, 4))
    rotation = matrix[:3, :3]
    if matrix[3].tolist() != [0, 0, 0, 1]:
        raise CourseError(f"The last row of {name} is {matrix[3].tolist()}; it must be [0, 0, 0, 1].")
    # The determinant of a (3, 3) matrix, ten times as fast as numpy for this size.
    (a, b, c), (d, e, f), (g, h, i) = rotation.tolist()
    determinant = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    if np.abs(rotation @ rotation.T - _EYE).max() > 1e-6 or determinant < 0:
        raise CourseError(
            f"The upper left 3x3 of {name} is {rotation.round(4).tolist()}, not a rotation: its "
            "columns must have length 1, be at right angles and right-handed. Start from "
            "numpy.eye(4)."
        )
    return matrix


def check_rays(value: ArrayLike) -> Floats:
    """Return unit vectors as columns, shape (3, N), N > 0, or raise a CourseError."""
    rays = np.asarray(value, float)
    if rays.ndim != 2 or rays.shape[0] != 3 or not rays.shape[1]:
        raise CourseError(f"rays have shape {rays.shape}; expected one or more as columns, shape (3, N).")
    square = np.einsum("ij,ij->j", rays, rays)
    # This comparison is false for NaN, so a ray with NaN is rejected, too.
    if not (np.abs(square - 1) <= 1e-6).all():
        worst = rays[:, np.nanargmax(np.where(np.isnan(square), np.inf, np.abs(square - 1)))]
        raise CourseError(
            f"A ray is {worst.tolist()}; divide rays by their length: rays / norm(rays, axis=0)."
        )
    return rays


@dataclass(frozen=True)
class Motion:
    """A function of robot time [s] to transforms that are always rigid, so they need no check."""

    at: Callable[[float], Floats]

    def __call__(self, seconds: float) -> Floats:
        """Return the transform at a robot time [s]."""
        return self.at(seconds)


def pose_function(name: str, pose: Pose) -> Callable[[float], Floats]:
    """Return a function from robot time [s] to checked transforms, for a fixed or moving pose."""
    if isinstance(pose, Motion):
        return pose.at
    if callable(pose):
        return lambda seconds: check_transform(f"{name} at {seconds:g} s", pose(seconds))
    fixed = check_transform(name, pose)
    return lambda seconds: fixed


@dataclass(frozen=True, eq=False)
class Shape:
    """A shape in its own frame, created by `box`, `sphere`, `cylinder` or `plane`.

    Args:
        size: Edges of its bounding box, centered on its frame, shape (3,), [m].
        reach: Radius of its bounding sphere, centered on its frame, [m].
        distances: Casts rays: the arguments are their common origin, shape (3,), [m], and unit
            vectors as columns, shape (3, N), both in the shape's frame; the result are distances,
            shape (N,), [m], inf for a miss.
    """

    size: Floats
    reach: float
    distances: Callable[[Floats, Floats], Floats]


def box(x: float, y: float, z: float) -> Shape:
    """Return a centered box with edges x, y, z [m]."""
    edges = (("x", x), ("y", y), ("z", z))
    size = np.array([check_number(f"{axis} [m] of a box", edge, above=0) for axis, edge in edges])

    def distances(origin: Floats, rays: Floats) -> Floats:
        return _first_hit(*_slab_distances(origin, rays, size / 2))

    return Shape(size, float(np.linalg.norm(size)) / 2, distances)


def sphere(radius: float) -> Shape:
    """Return a centered sphere with a radius [m]."""
    radius = check_number("radius [m] of a sphere", radius, above=0)

    def distances(origin: Floats, rays: Floats) -> Floats:
        return _first_hit(*_within_radius(origin, rays, radius))

    return Shape(np.full(3, 2 * radius), radius, distances)


def cylinder(radius: float, height: float) -> Shape:
    """Return a centered closed cylinder along z with a radius and a height [m]."""
    radius = check_number("radius [m] of a cylinder", radius, above=0)
    height = check_number("height [m] of a cylinder", height, above=0)

    def distances(origin: Floats, rays: Floats) -> Floats:
        enter, leave = _within_radius(origin[:2], rays[:2], radius)
        top, bottom = _slab_distances(origin[2:], rays[2:], np.array([height / 2]))
        return _first_hit(np.maximum(enter, top), np.minimum(leave, bottom))

    return Shape(np.array([2 * radius, 2 * radius, height]), float(np.hypot(radius, height / 2)), distances)


def plane() -> Shape:
    """Return the infinite plane z = 0, visible from both sides."""

    def distances(origin: Floats, rays: Floats) -> Floats:
        with np.errstate(divide="ignore", invalid="ignore"):
            along = -origin[2] / rays[2]
        return np.where((along >= 0) & np.isfinite(along), along, np.inf)

    return Shape(np.array([np.inf, np.inf, 0.0]), np.inf, distances)


def _slab_distances(origin: Floats, rays: Floats, half: Floats) -> tuple[Floats, Floats]:
    """Return the distances at which rays enter and leave |x| <= half, in any number of dimensions."""
    # For a ray along a wall, 0 * inf is NaN, which fmin and fmax ignore.
    with np.errstate(divide="ignore", invalid="ignore"):
        slopes = 1 / rays
        low, high = (-half - origin)[:, None] * slopes, (half - origin)[:, None] * slopes
    return np.fmin(low, high).max(axis=0), np.fmax(low, high).min(axis=0)


def _within_radius(origin: Floats, rays: Floats, radius: float) -> tuple[Floats, Floats]:
    """Return the distances at which rays enter and leave a sphere (3 rows) or cylinder (2 rows)."""
    square = np.einsum("ij,ij->j", rays, rays)
    along_axis = square < 1e-18
    square[along_axis] = 1
    nearest = -(origin @ rays) / square
    # The squared distance at the nearest point avoids the difference of large numbers in b^2 - 4ac.
    gap = radius**2 - ((origin[:, None] + nearest * rays) ** 2).sum(axis=0)
    # Comparisons with NaN are False, so NaN is a miss.
    half = np.sqrt(np.where(gap < 0, np.nan, gap) / square)
    half[along_axis & (gap >= 0)] = np.inf
    return nearest - half, nearest + half


def _first_hit(enter: Floats, leave: Floats) -> Floats:
    """Return the first distance ahead of rays that enter and leave a convex solid, inf for a miss."""
    distance = np.where(enter >= 0, enter, leave)
    return np.where((enter <= leave) & (leave >= 0), distance, np.inf)


# Red, green and blue of rays that hit nothing.
SKY = (0.6, 0.75, 0.9)
# Step of the finite difference for velocities [s].
_STEP = 1e-4


def placed(x: float, y: float, z: float, yaw: float = 0.0) -> Floats:
    """Return the pose, shape (4, 4), at (x, y, z) [m] with a rotation about z by yaw [rad]."""
    cos, sin = np.cos(yaw), np.sin(yaw)
    return np.array([[cos, -sin, 0, x], [sin, cos, 0, y], [0, 0, 1, z], [0, 0, 0, 1]], float)


def straight(start: ArrayLike, goal: ArrayLike, speed: float) -> Callable[[float], Floats]:
    """Return a motion along a line and back, with x pointing ahead.

    Args:
        start: The first point in the world, shape (3,), [m].
        goal: The point at which it turns around, shape (3,), [m].
        speed: [m/s]

    Returns:
        transform_thing_to_world, shape (4, 4), [m], as a function of robot time [s].
    """
    begin, end = check_array("start [m]", start, (3,)), check_array("goal [m]", goal, (3,))
    length = float(np.linalg.norm(end - begin))
    check_number("speed [m/s]", speed, above=0)
    if length == 0:
        raise CourseError(f"start and goal are both {begin.tolist()}; expected two different points.")
    yaw = float(np.arctan2(*(end - begin)[1::-1]))

    def pose(seconds: float) -> Floats:
        traveled = seconds * speed % (2 * length)
        is_returning = traveled >= length
        point = begin + (end - begin) * ((2 * length - traveled if is_returning else traveled) / length)
        return placed(point[0], point[1], point[2], yaw + np.pi * is_returning)

    return Motion(pose)


def circle(center: ArrayLike, radius: float, period: float) -> Callable[[float], Floats]:
    """Return a motion on a horizontal circle, with x pointing ahead.

    Args:
        center: The center in the world, shape (3,), [m].
        radius: [m]
        period: Time of a revolution, [s]; negative for clockwise.

    Returns:
        transform_thing_to_world, shape (4, 4), [m], as a function of robot time [s].
    """
    x, y, z = check_array("center [m]", center, (3,))
    check_number("radius [m]", radius, above=0)
    if check_number("period [s]", period) == 0:
        raise CourseError("period [s] is 0; expected the time of a revolution, negative for clockwise.")

    def pose(seconds: float) -> Floats:
        angle = 2 * np.pi * seconds / period
        heading = angle + np.copysign(np.pi / 2, period)
        return placed(x + radius * np.cos(angle), y + radius * np.sin(angle), z, heading)

    return Motion(pose)


@dataclass(frozen=True, eq=False)
class Thing:
    """An object in the world.

    Args:
        shape: The object's shape.
        pose: transform_thing_to_world, shape (4, 4), [m], or a function of robot time [s] that
            returns it.
        color: Red, green, blue, each 0 to 1.
        label: The class reported by detectors; "" for an object that they ignore.
    """

    shape: Shape
    pose: Pose
    color: Sequence[float] = (0.7, 0.7, 0.7)
    label: str = ""
    # From robot time [s] to a transform, shape (4, 4).
    transform_at: Callable[[float], Floats] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if not isinstance(self.shape, Shape):
            shape_forms = "box(x, y, z), sphere(radius), cylinder(radius, height) or plane()"
            raise CourseError(f"shape is {self.shape!r}, which is not a shape; expected {shape_forms}.")
        color = check_array("color", self.color, (3,))
        if color.min() < 0 or color.max() > 1:
            raise CourseError(f"color is {list(self.color)}; red, green and blue go from 0 to 1.")
        if self.label and not np.isfinite(self.shape.size).all():
            raise CourseError(
                f"The plane is labelled {self.label!r}; planes are infinite, so label a box instead."
            )
        name = f"pose of {self.label or 'a thing'}"
        object.__setattr__(self, "transform_at", pose_function(name, self.pose))

    def velocity_at(self, seconds: float) -> Floats:
        """Return the velocity of its frame in the world at a robot time [s], shape (3,), [m/s]."""
        before, after = self.transform_at(seconds - _STEP), self.transform_at(seconds + _STEP)
        return (after - before)[:3, 3] / (2 * _STEP)


@dataclass(frozen=True, eq=False)
class Hits:
    """The first hits of N rays.

    Args:
        distance: Distance along each ray, shape (N,), [m]; inf for nothing.
        thing: Index of the thing in `World.things`, shape (N,); -1 for nothing.
    """

    distance: Floats
    thing: Indices


class World:
    """The objects that simulated sensors measure.

    Args:
        things: The objects. Hits refer to them by their index.

    Raises:
        CourseError: An item is not a `Thing`.

    Example:
        >>> world = World([Thing(box(1.0, 1.0, 1.0), placed(3.0, 0.0, 0.0))])
        >>> hits = world.cast(np.eye(4), [[1.0], [0.0], [0.0]], seconds=0.0)
        >>> hits.distance
        array([2.5])
    """

    def __init__(self, things: Sequence[Thing]) -> None:
        for number, thing in enumerate(things):
            if not isinstance(thing, Thing):
                raise CourseError(f"Number {number} of the world is {thing!r}; expected Thing(shape, pose).")
        self.things = tuple(things)
        self._reach = np.array([thing.shape.reach for thing in things], float)
        # Shape (M + 1, 3); index -1 is the sky.
        self.colors = np.array([*(thing.color for thing in things), SKY], float)

    def cast(
        self,
        transform_sensor_to_world: ArrayLike,
        rays: ArrayLike,
        seconds: float,
        far: float = np.inf,
    ) -> Hits:
        """Return the first hits of rays from one point, after checking the arguments.

        Args:
            transform_sensor_to_world: Rigid, shape (4, 4), [m].
            rays: Unit vectors in the sensor's frame as columns, shape (3, N).
            seconds: Robot time, [s].
            far: Objects beyond this distance may be ignored, [m].

        Returns:
            The distance [m] and the object's index for each ray, both of shape (N,).
        """
        pose = check_transform("transform_sensor_to_world", transform_sensor_to_world)
        return self.cast_among(self.poses(seconds), pose, check_rays(rays), far)

    def poses(self, seconds: float) -> Floats:
        """Return transform_thing_to_world of all objects at a robot time [s], shape (M, 4, 4)."""
        return np.array([thing.transform_at(seconds) for thing in self.things]).reshape(-1, 4, 4)

    def cast_among(self, poses: Floats, pose: Floats, rays: Floats, far: float) -> Hits:
        """Cast rays as `cast` does, without checking the poses of objects and sensor, and the rays."""
        origin, rays = pose[:3, 3], pose[:3, :3] @ rays
        distance, hit_numbers = np.full(rays.shape[1], np.inf), np.full(rays.shape[1], -1)
        # The bounding spheres of the objects, from the sensor [m].
        centers = poses[:, :3, 3] - origin
        distances = np.linalg.norm(centers, axis=1)
        inside = distances <= self._reach
        # A ray meets the sphere if it points along the center at least as much as the tangents do.
        tangent = np.sqrt(np.where(inside, 0, distances**2 - np.where(inside, 0, self._reach) ** 2))
        least = np.where(inside, -np.inf, tangent - 1e-9 * (1 + distances))
        least[distances - self._reach > far] = np.inf
        may_hit = centers @ rays >= least[:, None]
        for number in np.flatnonzero(may_hit.any(axis=1)):
            ray_indices = np.flatnonzero(may_hit[number])
            to_thing = poses[number, :3, :3].T
            start = to_thing @ (origin - poses[number, :3, 3])
            length = self.things[number].shape.distances(start, to_thing @ rays[:, ray_indices])
            closer = length < distance[ray_indices]
            distance[ray_indices[closer]], hit_numbers[ray_indices[closer]] = length[closer], number
        return Hits(distance, hit_numbers)
