"""A robot that stands still in a scene, without messages."""

from collections.abc import Mapping
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from course_lib.arrays import Floats
from course_lib.displays.display import node_name
from course_lib.displays.robot_model.links import DrawnLink, Wanted
from course_lib.errors import CourseError
from course_lib.robots.kinematics import link_poses
from course_lib.robots.robot import Robot, pinocchios
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
        configuration: Positions of joints by name, [rad] or [m], or Pinocchio's vector, which also places the
            root of a model with a free-flyer; None takes the rest posture.

    Raises:
        CourseError: If a joint does not exist, or a mesh cannot be read.
    """
    poses = _poses(robot, configuration)
    scene.delete(path)
    for link in links_of(robot.urdf):
        drawn = DrawnLink(scene, f"{path}/{node_name(link.name)}", link, robot.path)
        drawn.place(poses[link.name])
        drawn.show(_SEEN)
        if drawn.looks.errors:
            raise CourseError(f"{robot.name!r} cannot be drawn: {'; '.join(drawn.looks.errors)}")


def _poses(robot: Robot, configuration: Configuration) -> dict[str, Floats]:
    """Return transform_link_to_ground, shape (4, 4), of all links."""
    if configuration is not None and not isinstance(configuration, Mapping):
        return _poses_by_pinocchio(robot, np.asarray(configuration, dtype=float))
    poses = link_poses(robot, robot.rest.positions if configuration is None else configuration)
    return {link: robot.rest.transform_root_to_ground @ pose for link, pose in poses.items()}


def _poses_by_pinocchio(robot: Robot, configuration: Floats) -> dict[str, Floats]:
    pinocchio, model = pinocchios("pinocchio"), robot.model
    if configuration.shape != (model.nq,):
        shape = configuration.shape
        raise CourseError(f"The configuration has shape {shape}, expected ({model.nq},), or a dict.")
    if not np.isfinite(configuration).all():
        raise CourseError(f"The configuration {configuration.tolist()} has numbers that are not finite.")
    data = model.createData()
    # Points on unit circles and quaternions that are not quite of length 1 still place the robot.
    pinocchio.framesForwardKinematics(model, data, pinocchio.normalize(model, configuration))
    frames, body = zip(model.frames, data.oMf, strict=True), pinocchio.FrameType.BODY
    found = {frame.name: pose.homogeneous for frame, pose in frames if frame.type == body}
    rest = link_poses(robot, robot.rest.positions)
    root = found.get(robot.tree.root, np.eye(4))
    return {link: root @ pose for link, pose in rest.items()} | found  # models may lack links
