"""What happens in a launch."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from launch.action import Action


class Event:
    """Something that happened, or is to happen."""


@dataclass
class Shutdown(Event):
    """Everything is to end."""

    reason: str = "reason not given"
    due_to_sigint: bool = False


@dataclass
class ProcessStarted(Event):
    """A process has started; `action` is what started it."""

    action: "Action"
    process_name: str = ""


@dataclass
class ProcessExited(ProcessStarted):
    """A process has ended."""

    returncode: int = 0
