"""What joint_trajectory_controller takes as a JointTrajectory, and what it says of others."""

from collections.abc import Iterator, Sequence
from itertools import chain, pairwise

import numpy as np
from rclpy.duration import Duration
from rclpy.time import Time
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from course_lib.errors import CourseError
from course_lib.robots.spline import Waypoint

_FIELDS = ("positions", "velocities", "accelerations")
_SMALLEST_SPEED = float(np.finfo(np.float32).eps)  # as there


def waypoints_of(message: JointTrajectory, joints: Sequence[str], now: Time) -> list[Waypoint]:
    """Read a trajectory: its times from its start, its numbers in the order of `joints`.

    Raises:
        CourseError: If joint_trajectory_controller refuses it, with its words.
    """
    for problem in chain(_of_names(message, joints), _of_times(message, now), _of_points(message)):
        raise CourseError(problem)
    order = [list(message.joint_names).index(joint) for joint in joints]
    return [Waypoint(_seconds(point), np.array(_given(point))[:, order]) for point in message.points]


def _seconds(point: JointTrajectoryPoint) -> float:
    return Duration.from_msg(point.time_from_start).nanoseconds / 1e9


def _given(point: JointTrajectoryPoint) -> list[Sequence[float]]:
    """Positions, then velocities, then accelerations, as far as they are there."""
    fields = [getattr(point, name) for name in _FIELDS]
    return fields[: next((i for i, field in enumerate(fields) if not len(field)), len(fields))]


def _of_names(message: JointTrajectory, joints: Sequence[str]) -> Iterator[str]:
    if len(set(message.joint_names)) != len(joints):
        yield "Joints on incoming trajectory don't match the controller joints."
    for name in message.joint_names:
        if name not in joints:
            yield f"Incoming joint {name} doesn't match the controller's joints."
    if not message.points:
        yield "Empty trajectory received."


def _of_times(message: JointTrajectory, now: Time) -> Iterator[str]:
    times = [_seconds(point) for point in message.points]  # [s]
    start = Time.from_msg(message.header.stamp).nanoseconds / 1e9
    if start and start + times[-1] < now.nanoseconds / 1e9:
        start_and_end = f"start time ({start:f}) that ends in the past ({start + times[-1]:f})"
        yield f"Received trajectory with non-zero {start_and_end}"
    for number, (before, after) in enumerate(pairwise(times)):
        if after <= before:
            times_are = f"it is {before:f} and {after:f} respectively"
            yield f"Time between points {number} and {number + 1} is not strictly increasing, {times_are}"


def _of_points(message: JointTrajectory) -> Iterator[str]:
    names = message.joint_names
    for number, point in enumerate(message.points):
        for name in _FIELDS:
            came = len(getattr(point, name))
            if came != len(names) and (came or name == "positions"):
                sizes = f"joint_names size ({len(names)}) and {name} ({came})"
                yield f"Mismatch between {sizes} at point #{number}."
            if not np.isfinite(getattr(point, name)).all():
                yield f"The {name} at point #{number} are not all finite."
        if len(point.effort):
            kind = "controllers using the 'effort' command interface"
            yield f"Trajectories with effort fields are only supported for {kind}."
    for name, speed in zip(names, message.points[-1].velocities, strict=False):
        if abs(speed) > _SMALLEST_SPEED:
            yield f"Velocity of last trajectory point of joint {name} is not zero: {speed:.15f}"
