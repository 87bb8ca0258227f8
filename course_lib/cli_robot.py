"""`course …` for robots: options that link a command to one, and the commands `robot` and `router`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from course_lib.errors import CourseError

if TYPE_CHECKING:
    from course_lib.ros.zenoh.connect import RobotAddress

Robot = Annotated[str | None, typer.Option(help="The Zenoh router of a robot: tcp/192.168.1.5:7447")]
Domain = Annotated[int | None, typer.Option(help="The robot's ROS_DOMAIN_ID.")]
Send = Annotated[list[str] | None, typer.Option(help="A topic that may go out to the robot.")]
Call = Annotated[list[str] | None, typer.Option(help="A service or action of the robot that may be called.")]

robots = typer.Typer()


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


@robots.command()
def robot(
    kind: Annotated[
        str, typer.Argument(help="driving: a base with a laser scanner; unknown: week 6's.")
    ] = "driving",
    listen: Annotated[str, typer.Option(help="Where others connect.")] = "tcp/127.0.0.1:7447",
    domain: Annotated[int, typer.Option(min=0, max=232, help="Its ROS_DOMAIN_ID.")] = 0,
    with_parent: Annotated[bool, typer.Option("--with-parent", hidden=True)] = False,
) -> None:
    """Run a robot for those who have no real one; all that it has is on the network."""
    from course_lib.gateway.robot import robot as run_robot

    raise typer.Exit(run_robot(kind, listen, domain, typer.echo, with_parent=with_parent))


@robots.command()
def router(
    robot: Annotated[str, typer.Option(help="The robot's router, tcp/192.168.1.5:7447.")] = "",
    send: Annotated[
        list[str] | None, typer.Option(help="A topic that the driver may publish; may be given again.")
    ] = None,
    call: Annotated[
        list[str] | None, typer.Option(help="A service that students may call; may be given again.")
    ] = None,
    students: Annotated[
        Path | None, typer.Option(help="The platform's CSV; each student gets a token.")
    ] = None,
    id_column: Annotated[
        str, typer.Option(help="The heading of the IDs in --students; default: found by what is in it.")
    ] = "",
    driver: Annotated[
        str, typer.Option(help="Who drives, or nobody; also changes it while a gateway runs.")
    ] = "",
    listen: Annotated[str, typer.Option(help="Where students connect.")] = "tcp/0.0.0.0:7448",
    certificate: Annotated[Path | None, typer.Option(help="PEM file for --listen tls/…, with --key.")] = None,
    key: Annotated[Path | None, typer.Option(help="The certificate's private key, PEM.")] = None,
    domain: Annotated[int, typer.Option(min=0, max=232, help="The robot's ROS_DOMAIN_ID.")] = 0,
    robot_port: Annotated[
        int, typer.Option(min=1, max=65535, help="Without --robot: where a robot on this computer connects.")
    ] = 7447,
    folder: Annotated[Path, typer.Option(help="Where tokens are kept.")] = Path("course_router"),
) -> None:
    """Run a gateway: a class hears a robot, and one student at a time drives it."""
    from course_lib.gateway.access import checked_names
    from course_lib.gateway.gateway import Settings
    from course_lib.gateway.router import router as run

    sends, calls = checked_names(send or (), "--send"), checked_names(call or (), "--call")
    there = f"tcp/127.0.0.1:{robot_port}"
    settings = Settings(listen, robot, sends, calls, domain, certificate, key, there)
    run(settings, folder, students, id_column, driver, typer.echo)
