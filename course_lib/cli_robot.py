"""Options of `course …` that link it to a robot."""

from typing import TYPE_CHECKING, Annotated

import typer

from course_lib.errors import CourseError

if TYPE_CHECKING:
    from course_lib.ros.zenoh.connect import RobotAddress

Robot = Annotated[str | None, typer.Option(help="The Zenoh router of a robot: tcp/192.168.1.5:7447")]
Domain = Annotated[int | None, typer.Option(help="The robot's ROS_DOMAIN_ID.")]
Send = Annotated[list[str] | None, typer.Option(help="A topic that may go out to the robot.")]
Call = Annotated[list[str] | None, typer.Option(help="A service or action of the robot that may be called.")]


def address(
    robot: str | None, domain: int | None, send: list[str] | None, call: list[str] | None
) -> "RobotAddress | None":
    """Return where the robot is, and what may go out to it; None without a robot.

    Raises:
        CourseError: Options are about a robot that is not named.
    """
    from course_lib.ros.zenoh.connect import RobotAddress

    if robot is not None:
        return RobotAddress(robot, domain, send or (), call or ())
    if domain is not None or send or call:
        raise CourseError("--domain, --send and --call are about a robot: add --robot tcp/HOST:7447.")
    return None
