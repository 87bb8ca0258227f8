"""Displays that draw what they keep of messages, anew with every message and every changed property."""

from collections import deque
from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from course_lib.arrays import Matrix
from course_lib.displays.topic_display import FilteredDisplay
from course_lib.viewer.drawables import Drawable

INVALID = "Message contained invalid floating point values (nans or infs)"


class DrawnDisplay(FilteredDisplay):
    """A display whose picture is made of its properties and of what it keeps: of one message, or of more."""

    length_label: ClassVar[str] = ""  # of the property that says of how many messages; 0 keeps all
    in_frame: ClassVar[bool] = (
        False  # whether the parts lie in the last message's frame, not in the fixed one
    )

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self.kept: deque[Any] = deque(maxlen=(self[self.length_label] or None) if self.length_label else 1)

    def numbers(self, message: Any) -> npt.ArrayLike:
        """Return those numbers of a message that must be finite."""
        return ()

    def made(self, message: Any, transform_frame_to_fixed: Matrix) -> Any:
        """Return what is to be kept of a message."""
        raise NotImplementedError

    def parts(self) -> Mapping[str, Drawable]:
        """Return what is to be seen, by name; nothing before the first message."""
        raise NotImplementedError

    def process(self, message: Any) -> None:
        """Show a message, if its numbers are finite and its frame is known."""
        if not np.isfinite(self.numbers(message)).all():
            self.statuses.set("error", "Topic", INVALID)
            return
        transform = self.transform_at(message.header)
        if transform is not None and self.in_frame:
            self.context.scene.set_transform(f"{self.path}/drawn", transform)
        if transform is not None:
            self.keep(self.made(message, transform))

    def keep(self, thing: Any) -> None:
        """Keep one more, and draw."""
        self.kept.append(thing)
        self.draw()

    def reset(self) -> None:
        """Forget all that was kept."""
        super().reset()
        self.kept.clear()

    def changed(self, label: str) -> None:
        """Draw anew; RViz makes its buffers anew when they change their length, and cuts its histories."""
        if label == self.length_label:
            self.kept = deque(() if label == "Buffer Length" else self.kept, self[label] or None)
        super().changed(label)
        if self.started:
            self.draw()

    def draw(self) -> None:
        """Put the parts into the scene, in place of those that are there."""
        scene, node, parts = self.context.scene, f"{self.path}/drawn", self.parts()
        old = scene.find(node)
        gone = {path.rpartition("/")[2] for path in old.children} - parts.keys() if old else ()
        for name in gone:
            scene.delete(f"{node}/{name}")
        for name, drawable in parts.items():
            scene.set_object(f"{node}/{name}", drawable)
