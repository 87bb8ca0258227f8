"""Displays that keep the last messages, as many as a property says."""

from collections import deque
from typing import Any, ClassVar

from course_lib.displays.drawn_display import DrawnDisplay


class HistoryDisplay(DrawnDisplay):
    """A display that draws together what it has kept."""

    length_label: ClassVar[str] = "History Length"  # of the property; 0 keeps all

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self.kept: deque[Any] = deque(maxlen=self[self.length_label] or None)

    def changed(self, label: str) -> None:
        """Draw anew; RViz makes its buffers anew when they change their length, and cuts its histories."""
        if label == self.length_label:
            self.kept = deque(() if label == "Buffer Length" else self.kept, self[label] or None)
        super().changed(label)

    def reset(self) -> None:
        """Forget all that was kept."""
        super().reset()
        self.kept.clear()

    def keep(self, thing: Any) -> None:
        """Keep one more, and draw."""
        self.kept.append(thing)
        self.draw()
