"""What a launch knows while it runs."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Protocol

from launch.substitution import Substitution

if TYPE_CHECKING:
    from launch.action import Action, Entities
    from launch.event_handlers import BaseEventHandler
    from launch.events import Event


class Runner(Protocol):
    """What carries out what descriptions ask for."""

    def start(self, action: "Action", package: str, executable: str, words: Iterable[str]) -> None:
        """Start an executable with the words of its command line."""

    def later(self, seconds: float, entities: "Entities") -> None:
        """Visit entities when so much robot time [s] is over."""

    def emit(self, event: "Event") -> None:
        """Let the event handlers take an event."""

    def log(self, level: str, name: str, text: str) -> None:
        """Write a line of the launch's own log."""


class LaunchContext:
    """The values of arguments, the event handlers, the file that is read; a Runner carries things out."""

    def __init__(self, runner: Any = None, *, file: str = "") -> None:
        self.launch_configurations: dict[str, Any] = {}
        self.handlers: list[BaseEventHandler] = []
        self.file = file
        self.runner: Runner = runner

    def perform_substitution(self, substitution: Substitution) -> str:
        """Make a substitution's text."""
        return substitution.perform(self)
