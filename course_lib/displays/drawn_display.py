"""Displays that draw what they were told last, anew with every message and every changed property."""

from collections.abc import Mapping
from typing import Any

from course_lib.displays.topic_display import FilteredDisplay
from course_lib.viewer.drawables import Drawable


class DrawnDisplay(FilteredDisplay):
    """A display whose picture is made of its properties and of what it keeps of messages."""

    def changed(self, label: str) -> None:
        """Draw anew."""
        super().changed(label)
        if self.started:
            self.draw()

    def parts(self) -> Mapping[str, Drawable]:
        """Return what is to be seen, by name; nothing before the first message."""
        raise NotImplementedError

    def put_in_frame(self, header: Any) -> bool:
        """Let the parts lie in a header's frame, where that was at its stamp; say whether that is known."""
        transform = self.transform_at(header)
        if transform is not None:
            self.context.scene.set_transform(f"{self.path}/drawn", transform)
        return transform is not None

    def draw(self) -> None:
        """Put the parts into the scene, in place of those that are there."""
        scene, node, parts = self.context.scene, f"{self.path}/drawn", self.parts()
        old = scene.find(node)
        gone = {path.rpartition("/")[2] for path in old.children} - parts.keys() if old else ()
        for name in gone:
            scene.delete(f"{node}/{name}")
        for name, drawable in parts.items():
            scene.set_object(f"{node}/{name}", drawable)
