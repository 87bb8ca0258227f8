"""`course robot` and `start_robot`: a simulated robot in a separate process."""

import _thread
import socket
import subprocess
import sys
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from course_lib.errors import CourseError
from course_lib.ros.robot.addresses import DDS
from course_lib.ros.robot.connect import RobotAddress, require_zenoh

HERE = Path(__file__)
PROGRAMS = {
    "driving": HERE.with_name("driving_robot.py"),
    "unknown": HERE.parents[1] / "robots" / "unknown_robot.py",
}
# The robot that does not import the kit.
REAL_KIND = "driving"
THIS_COMPUTER = f"{DDS}127.0.0.1"
# Polling period [s].
POLL = 0.05
START_SECONDS = 120.0  # [s] time limit for the start of a robot's process on a busy computer
END_SECONDS = 30.0  # [s] time limit for a robot's process to exit after its input was closed
WITHOUT_ZENOH = "course robot --dds and start_robot('dds') run a robot that needs none."
# The program logs this when the robot is ready.
READY = "The robot is ready"


@dataclass(frozen=True)
class SimulatedRobotAddress:
    """The address of a simulated robot.

    Args:
        address: The address of its router, like `tcp/0.0.0.0:7447`, or THIS_COMPUTER for DDS.
        domain: Its ROS_DOMAIN_ID.
        is_on_real_ros: Whether it runs on the real rclpy, which needs DDS.
    """

    address: str
    domain: int = 0
    is_on_real_ros: bool = False


def robot(
    kind: str,
    place: SimulatedRobotAddress,
    write: Callable[[str], None],
    *,
    with_parent: bool = False,
) -> int:
    """Run a robot until Ctrl+C, and return the program's exit code.

    Args:
        kind: A robot of PROGRAMS.
        place: The robot's address.
        write: Prints a line.
        with_parent: Whether to end when standard input is closed.

    Raises:
        CourseError: The robot does not exist or cannot run here.
    """
    if kind not in PROGRAMS:
        raise CourseError(f"There is no robot {kind!r}: start one of {', '.join(PROGRAMS)}.")
    program = PROGRAMS[kind]
    if place.is_on_real_ros:
        if kind != REAL_KIND:
            raise CourseError(f"The robot {kind!r} needs the kit: --ros runs only {REAL_KIND!r}.")
        return _run_on_real_ros(program, place.domain, write, with_parent=with_parent)
    from course_lib.tools.run import run

    router = None
    address = RobotAddress(place.address, place.domain, everything=True)
    if place.address.startswith(DDS):
        domain = f" --domain {place.domain}" if place.domain else ""
        write(
            "The robot is reached over DDS. Connect with: "
            f"%ros2 connect {place.address}{domain} --send /cmd_vel"
        )
    else:
        require_zenoh(WITHOUT_ZENOH)
        # Imported here, because the sandbox, in which this module is imported too, has no zenoh.
        from course_lib.gateway.gateway import open_router

        router = open_router({"listen/endpoints": [place.address]})
        write(
            f"The router of the robot listens at {place.address}. Connect with: "
            f"%ros2 connect {place.address} --send /cmd_vel"
        )
        address = replace(address, router=f"tcp/127.0.0.1:{place.address.rpartition(':')[2]}")
    if with_parent:
        _thread.start_new_thread(_end_with_input, ())
    try:
        return run([program], seconds=None, seed=0, bag=None, args=(), real_time=False, robot=address)
    finally:
        if router is not None:
            router.close()


def _run_on_real_ros(
    program: Path,
    domain: int,
    write: Callable[[str], None],
    *,
    with_parent: bool,
) -> int:
    from course_lib.real.environment import find_environment
    from course_lib.real.process import RealProcesses, temporary_folder

    environment = find_environment()
    with temporary_folder() as folder:
        programs = RealProcesses(environment, folder, [program], write, domain)
        write(f"The robot runs on {environment}.")
        write(f"Connect with: %ros2 connect {THIS_COMPUTER} --domain {programs.domain} --send /cmd_vel")
        if with_parent:
            _thread.start_new_thread(_end_with_input, ())
        programs.start(program)
        try:
            while programs.are_running():
                time.sleep(POLL)
        except KeyboardInterrupt:
            pass
        return programs.end(lambda: time.sleep(POLL))


def _end_with_input() -> None:
    sys.stdin.read()
    _thread.interrupt_main()


class RobotProcess:
    """A robot in another process, which ends with this one; see `start_robot`.

    Args:
        process: The robot's process.
        place: The robot's address.
        software: The ROS software on which it runs.
    """

    def __init__(self, process: "subprocess.Popen[str]", place: SimulatedRobotAddress, software: str) -> None:
        self._process, self._software = process, software
        self.address, self.domain = place.address, place.domain

    @property
    def router(self) -> str:
        """The address for `connect`."""
        return self.address

    def stop(self) -> None:
        """End the robot. Calling it again has no effect."""
        if self._process.stdin is not None:
            self._process.stdin.close()
        try:
            self._process.wait(END_SECONDS)
        except subprocess.TimeoutExpired:
            # The interrupt of its main thread may be lost while the program starts.
            self._process.kill()
            self._process.wait()

    def __repr__(self) -> str:
        state = "has ended" if self._process.poll() is not None else "runs in another process"
        domain = f" in domain {self.domain}" if self.domain else ""
        return f"The robot at {self.address}{domain} {state}, on {self._software}."


def start_robot(link: Literal["zenoh", "dds"] = "zenoh") -> RobotProcess:
    """Start a driving robot in another process, as if it were a real one.

    Args:
        link: The middleware. With "dds" the robot runs on the real rclpy, if `course ros --install`
            has installed it, and in a random domain, because another ROS 2 may run on this
            computer.

    Raises:
        CourseError: The robot does not start. The message contains its output.
    """
    if link not in ("zenoh", "dds"):
        raise CourseError(f"start_robot({link!r}): expected 'zenoh' or 'dds'.")
    software = "the kit's own rclpy"
    options = []
    if link == "zenoh":
        require_zenoh(WITHOUT_ZENOH)
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            place = SimulatedRobotAddress(f"tcp/127.0.0.1:{free.getsockname()[1]}")
        options = ["--listen", place.address]
    else:
        from course_lib.real.environment import find_environment
        from course_lib.real.process import free_domain

        place = SimulatedRobotAddress(THIS_COMPUTER, free_domain())
        options = ["--dds", "--domain", str(place.domain)]
        try:
            software = f"the real {find_environment()}"
            options.append("--ros")
        except CourseError:
            # The real ROS 2 is not installed, so the robot runs on the kit's rclpy.
            pass
    command = [sys.executable, "-P", "-m", "course_lib", "robot", *options, "--with-parent"]
    pipe = subprocess.PIPE
    process = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=subprocess.STDOUT, text=True)
    is_late = False
    reading = _thread.allocate_lock()
    reading.acquire()

    def limit() -> None:
        nonlocal is_late
        if not reading.acquire(timeout=START_SECONDS):
            is_late = True
            # The end of the process also ends the lines that are read below.
            process.kill()

    # A thread of `threading` would run in robot time, and `course run` would wait for it.
    _thread.start_new_thread(limit, ())
    output = list[str]()
    lines = iter(process.stdout or ())
    try:
        for line in lines:
            output.append(line)
            if READY in line:
                # The pipe must be read, or it would become full and block the robot. A deque of
                # length 0 reads all lines and keeps none.
                _thread.start_new_thread(deque, (lines, 0))
                return RobotProcess(process, place, software)
        process.wait()
    finally:
        reading.release()
    within = f" within {START_SECONDS:g} s" if is_late else ""
    printed = " ".join("".join(output).split()) or "it printed nothing"
    raise CourseError(f"The robot did not start{within}: {printed}")
