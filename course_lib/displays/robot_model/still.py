"""A robot that stands still in a scene, without messages."""

from collections.abc import Mapping

from course_lib.displays.display import node_name
from course_lib.displays.robot_model.links import DrawnLink, Wanted
from course_lib.errors import CourseError
from course_lib.robots.kinematics import link_poses
from course_lib.robots.robot import Robot
from course_lib.robots.urdf import links_of
from course_lib.viewer.scene import Scene

_SEEN = Wanted({"visual": True, "trail": False}, alpha=1.0)


def draw_still(scene: Scene, path: str, robot: Robot, positions: Mapping[str, float] | None) -> None:
    """Draw a robot's links below a node, in place of what is there.

    Args:
        scene: The scene.
        path: The node.
        robot: What `load_robot` returns.
        positions: Of joints by name, [rad] or [m]; None takes the rest posture.

    Raises:
        CourseError: If a joint does not exist, or a mesh cannot be read.
    """
    poses = link_poses(robot, robot.rest.positions if positions is None else positions)
    scene.delete(path)
    for link in links_of(robot.urdf):
        drawn = DrawnLink(scene, f"{path}/{node_name(link.name)}", link, robot.path)
        drawn.place(robot.rest.transform_root_to_ground @ poses[link.name])
        drawn.show(_SEEN)
        if drawn.looks.errors:
            raise CourseError(f"{robot.name!r} cannot be drawn: {'; '.join(drawn.looks.errors)}")
