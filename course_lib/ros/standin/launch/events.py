"""The events of a launch."""

import signal
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from launch.entities import Action, Event, LaunchDescription
from launch.entities import ExecutionComplete as ExecutionComplete


@dataclass(kw_only=True)
class Shutdown(Event):
    """The shutdown of the launch and all its processes."""

    reason: str = "reason not given"
    due_to_sigint: bool = False


@dataclass
class IncludeLaunchDescription(Event):
    """The inclusion of a description into the launch."""

    launch_description: LaunchDescription


class RunningProcessEvent(Event):
    """Base class of process events. `action` is the action that started the process."""

    def __init__(
        self,
        *,
        action: Action,
        name: str,
        cmd: list[str],
        cwd: str | None,
        env: dict[str, str] | None,
        pid: int,
    ) -> None:
        self.action, self.process_name, self.pid = action, name, pid
        self.cmd, self.cwd, self.env = cmd, cwd, env


class ProcessStarted(RunningProcessEvent):
    """The start of a process."""


class ProcessExited(RunningProcessEvent):
    """The exit of a process."""

    def __init__(self, *, returncode: int, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.returncode = returncode


class ProcessIO(RunningProcessEvent):
    """A line of output of a process. `fd` is 1 for standard output, 2 for standard error."""

    def __init__(self, *, text: bytes, fd: int, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.text, self.fd = text, fd
        self.from_stdout, self.from_stderr = fd == 1, fd == 2


class ProcessStdout(ProcessIO):
    """A line of a process on standard output."""

    def __init__(self, *, text: bytes, **kwargs: Any) -> None:
        super().__init__(text=text, fd=1, **kwargs)


class ProcessStderr(ProcessIO):
    """A line of a process on standard error."""

    def __init__(self, *, text: bytes, **kwargs: Any) -> None:
        super().__init__(text=text, fd=2, **kwargs)


@dataclass(kw_only=True)
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


def matches_action(target_action: Action) -> Callable[[Action], bool]:
    """Return a matcher for one action."""
    return lambda action: action is target_action


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
