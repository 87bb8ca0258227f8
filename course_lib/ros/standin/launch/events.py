"""The events of a launch."""

from collections.abc import Callable
from dataclasses import dataclass

from launch.entities import Action, Event


@dataclass
class Shutdown(Event):
    """The end of the launch, with all its processes."""

    reason: str = "reason not given"
    due_to_sigint: bool = False


@dataclass
class ProcessStarted(Event):
    """The start of a process; `action` has started it."""

    action: Action
    process_name: str = ""


@dataclass
class ProcessExited(ProcessStarted):
    """The end of a process."""

    returncode: int = 0


def matches_action(target: Action) -> Callable[[Action], bool]:
    """Return a matcher for one action."""
    return lambda action: action is target
