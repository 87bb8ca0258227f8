"""A robot that stands still in a scene, without messages."""

from collections.abc import Mapping
from math import atan2
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from course_lib.displays.display import node_name
from course_lib.displays.robot_model.links import DrawnLink, Wanted
from course_lib.errors import CourseError
from course_lib.robots.kinematics import link_poses
from course_lib.robots.robot import Robot
from course_lib.robots.urdf import links_of
from course_lib.viewer.scene import Scene

Configuration: TypeAlias = Mapping[str, float] | npt.ArrayLike | None
_SEEN = Wanted({"visual": True, "trail": False}, alpha=1.0)


def draw_still(scene: Scene, path: str, robot: Robot, configuration: Configuration) -> None:
    """Draw a robot's links below a node, in place of what is there.

    Args:
        scene: The scene.
        path: The node.
        robot: What `load_robot` returns.
        configuration: Positions of joints by name, [rad] or [m], or Pinocchio's vector, by which the root
            stays where it rests; None takes the rest posture.

    Raises:
        CourseError: If a joint does not exist, or a mesh cannot be read.
    """
    poses = link_poses(robot, _positions(robot, configuration))
    scene.delete(path)
    for link in links_of(robot.urdf):
        drawn = DrawnLink(scene, f"{path}/{node_name(link.name)}", link, robot.path)
        drawn.place(robot.rest.transform_root_to_ground @ poses[link.name])
        drawn.show(_SEEN)
        if drawn.looks.errors:
            raise CourseError(f"{robot.name!r} cannot be drawn: {'; '.join(drawn.looks.errors)}")


def _positions(robot: Robot, configuration: Configuration) -> Mapping[str, float]:
    if configuration is None:
        return robot.rest.positions
    if isinstance(configuration, Mapping):
        return configuration
    model, values = robot.model, np.asarray(configuration, dtype=float)
    if values.shape != (model.nq,):
        raise CourseError(f"The configuration has shape {values.shape}, expected ({model.nq},), or a dict.")
    found = {}
    for name, joint in zip(model.names[1:], model.joints[1:], strict=True):
        numbers = values[joint.idx_q : joint.idx_q + joint.nq].tolist()
        if name in robot.tree.joints and len(numbers) < 3:
            # A joint without limits is a point on the unit circle.
            found[name] = numbers[0] if len(numbers) == 1 else atan2(numbers[1], numbers[0])
    return found
