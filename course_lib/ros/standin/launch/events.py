"""The events of a launch."""

import signal
from collections.abc import Callable
from dataclasses import dataclass, field

from launch.entities import Action, Event, LaunchDescription
from launch.entities import ExecutionComplete as ExecutionComplete


@dataclass
class Shutdown(Event):
    """The shutdown of the launch and all its processes."""

    reason: str = "reason not given"
    due_to_sigint: bool = False


@dataclass
class IncludeLaunchDescription(Event):
    """The inclusion of a description into the launch."""

    launch_description: LaunchDescription


@dataclass
class RunningProcessEvent(Event):
    """Base class of process events. `action` is the action that started the process."""

    action: Action
    process_name: str = ""
    pid: int = 0
    cmd: list[str] = field(default_factory=list)


@dataclass
class ProcessStarted(RunningProcessEvent):
    """The start of a process."""


@dataclass
class ProcessExited(RunningProcessEvent):
    """The exit of a process."""

    returncode: int = 0


@dataclass
class ProcessIO(RunningProcessEvent):
    """A line of output of a process. `fd` is 1 for standard output, 2 for standard error."""

    text: bytes = b""
    fd: int = 1

    @property
    def from_stdout(self) -> bool:
        """True for standard output."""
        return self.fd == 1

    @property
    def from_stderr(self) -> bool:
        """True for standard error."""
        return self.fd == 2


class ProcessStdout(ProcessIO):
    """A line of a process on standard output."""


class ProcessStderr(ProcessIO):
    """A line of a process on standard error."""


@dataclass
class ProcessTargetedEvent(Event):
    """Base class of requests to the processes of the matching actions."""

    process_matcher: Callable[[Action], bool]


class ShutdownProcess(ProcessTargetedEvent):
    """Request to shut down the processes of the matching actions."""


@dataclass(kw_only=True)
class SignalProcess(ProcessTargetedEvent):
    """Request to send a signal to the processes of the matching actions.

    SIGINT, SIGTERM and SIGKILL end them.
    """

    signal_number: str | signal.Signals


def matches_action(target: Action) -> Callable[[Action], bool]:
    """Return a matcher for one action."""
    return lambda action: action is target


def matches_pid(pid: int) -> Callable[[Action], bool]:
    """Return a matcher for the action whose process has this number."""
    return lambda action: action.process_details is not None and action.process_details["pid"] == pid


def matches_name(name: str) -> Callable[[Action], bool]:
    """Return a matcher for the action whose process has this name, like "talker-1"."""
    return lambda action: action.process_details is not None and action.process_details["name"] == name


def matches_executable(executable: str) -> Callable[[Action], bool]:
    """Return a matcher for actions that run a program whose path ends with `executable`."""

    def matches(action: Action) -> bool:
        return action.process_details is not None and action.process_details["cmd"][0].endswith(executable)

    return matches
