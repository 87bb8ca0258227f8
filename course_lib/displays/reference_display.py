"""Displays that draw one thing, at a frame of their own: Grid and Axes."""

from typing import Any

import numpy as np

from course_lib.displays.display import Display
from course_lib.displays.frames import FIXED_FRAME, Matrix
from course_lib.displays.properties import Property, frame
from course_lib.displays.statuses import Level
from course_lib.viewer.drawables import Drawable


class ReferenceDisplay(Display):
    """A display whose picture depends on its properties alone, and moves with its Reference Frame."""

    properties = (*Display.properties, Property("Reference Frame", FIXED_FRAME, frame))

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._placed_with: Matrix | None = None
        self._drawn = False

    def drawing(self) -> Drawable:
        """Return what is to be seen."""
        raise NotImplementedError

    def offset(self) -> Matrix:
        """Return where it lies in the reference frame, shape (4, 4)."""
        return np.eye(4)

    def said(self, reference: str, is_known: bool) -> tuple[Level, str]:
        """Return RViz's status of the reference frame."""
        raise NotImplementedError

    def changed(self, label: str) -> None:
        """Draw anew in the next frame."""
        super().changed(label)
        self._drawn = False

    def reset(self) -> None:
        """Draw anew in the next frame."""
        super().reset()
        self._drawn = False

    def update(self) -> None:
        """Draw, and stay at the frame."""
        if not self.enabled:
            return
        name = self["Reference Frame"]
        reference = self.context.frames.fixed_frame if name == FIXED_FRAME else name
        transform = self.context.frames.transform(reference)
        level, text = self.said(reference, transform is not None)
        self.statuses.set(level, "Transform", text)
        if transform is not self._placed_with or not self._drawn:
            self._draw(transform)

    def _draw(self, transform_reference_to_fixed: Matrix | None) -> None:
        self._placed_with, scene = transform_reference_to_fixed, self.context.scene
        node = f"{self.path}/drawing"
        scene.set_visible(node, transform_reference_to_fixed is not None)
        if transform_reference_to_fixed is not None:
            scene.set_transform(node, transform_reference_to_fixed @ self.offset())
        if not self._drawn:
            scene.set_object(node, self.drawing())
            self._drawn = True
