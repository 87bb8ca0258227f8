"""What a launch knows while it runs."""

from typing import TYPE_CHECKING, Any

from launch.substitution import Substitution

if TYPE_CHECKING:
    from course_lib.ros.launch_program import LaunchProgram
    from launch.event_handlers import BaseEventHandler


class LaunchContext:
    """The values of arguments, the event handlers, the file that is read; the runner carries things out."""

    def __init__(self, runner: Any = None, *, file: str = "") -> None:
        self.launch_configurations: dict[str, Any] = {}
        self.handlers: list[BaseEventHandler] = []
        self.file = file
        self.runner: LaunchProgram = runner

    def perform_substitution(self, substitution: Substitution) -> str:
        """Make a substitution's text."""
        return substitution.perform(self)
