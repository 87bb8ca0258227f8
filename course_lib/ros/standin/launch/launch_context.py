"""What a launch knows while it runs."""

import os
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


class LaunchContext:
    """The values of arguments, the environment, the event handlers; `runner` carries out what is asked."""

    def __init__(self, runner: Runner | None = None, *, file: str = "") -> None:
        self.launch_configurations: dict[str, Any] = {}
        self.environment = os.environ
        self.handlers: list[BaseEventHandler] = []
        self.file = file  # the launch file whose description is visited
        self.pushed: list[tuple[dict[str, Any], dict[str, str]]] = []
        self._runner = runner

    @property
    def runner(self) -> Runner:
        """What carries out what is asked."""
        if self._runner is None:
            raise RuntimeError("Nothing runs in this context: it only looks at a description.")
        return self._runner

    def perform_substitution(self, substitution: Substitution) -> str:
        """Make a substitution's text."""
        return substitution.perform(self)
