"""`course robot` and `start_robot`: a robot for those who have none, in a process of its own."""

import _thread
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

from course_lib.errors import CourseError
from course_lib.gateway.zenoh_router import open_router
from course_lib.ros.zenoh.connect import RobotAddress

FOLDER = Path(__file__).parent
PROGRAMS = {"driving": "driving_robot.py", "unknown": "unknown_robot.py"}
READY = "The robot is ready"  # what the program logs


def robot(
    kind: str, listen: str, domain: int, write: Callable[[str], None], *, with_parent: bool = False
) -> int:
    """Run a router and a robot until Ctrl+C; return the program's exit code.

    Args:
        kind: The robot, of PROGRAMS.
        listen: Where others connect, like `tcp/0.0.0.0:7447`.
        domain: Its ROS_DOMAIN_ID.
        write: Prints a line.
        with_parent: End when standard input does.

    Raises:
        CourseError: There is no such robot.
    """
    from course_lib.tools.run import run

    if kind not in PROGRAMS:
        raise CourseError(f"There is no robot {kind!r}: start one of {', '.join(PROGRAMS)}.")
    router = open_router({"listen/endpoints": [listen]})
    write(f"Its router listens at {listen}. Connect with: %ros2 connect {listen} --send /cmd_vel")
    if with_parent:
        _thread.start_new_thread(_end_with_input, ())
    address = RobotAddress(f"tcp/127.0.0.1:{listen.rpartition(':')[2]}", domain, everything=True)
    try:
        return run(
            [FOLDER / PROGRAMS[kind]], seconds=None, seed=0, bag=None, args=(), real_time=False, robot=address
        )
    finally:
        router.close()  # type: ignore[no-untyped-call]  # untyped there


def _end_with_input() -> None:
    sys.stdin.read()
    _thread.interrupt_main()


def _drop(lines: Iterator[str]) -> None:
    for _ in lines:
        pass


class RobotProcess:
    """A robot in another process, which ends with this one; `start_robot` makes it.

    Args:
        process: Runs the robot.
        router: The address of its Zenoh router, for `connect`.
    """

    def __init__(self, process: "subprocess.Popen[str]", router: str) -> None:
        self._process = process
        self.router = router

    def stop(self) -> None:
        """End the robot; calling it again changes nothing."""
        if self._process.stdin is not None:
            self._process.stdin.close()
        self._process.wait()

    def __repr__(self) -> str:
        state = "has ended" if self._process.poll() is not None else "runs in another process"
        return f"The robot at {self.router} {state}."


def start_robot() -> RobotProcess:
    """Start a driving robot in another process, as if it were a real one.

    Raises:
        CourseError: It does not come up; shows its output.
    """
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        router = f"tcp/127.0.0.1:{free.getsockname()[1]}"
    command = [sys.executable, "-m", "course_lib", "robot", "--listen", router, "--with-parent"]
    pipe = subprocess.PIPE
    process = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=subprocess.STDOUT, text=True)
    said = list[str]()
    lines = iter(process.stdout or ())
    for line in lines:
        said.append(line)
        if READY in line:
            _thread.start_new_thread(_drop, (lines,))  # or the pipe would fill
            return RobotProcess(process, router)
    process.wait()
    raise CourseError(f"The robot did not start: {' '.join(''.join(said).split())}")
