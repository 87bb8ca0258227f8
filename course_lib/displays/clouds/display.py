"""What the displays of point clouds share: style, colours, and how long clouds stay (PointCloudCommon)."""

from typing import Any, NamedTuple

import numpy as np

from course_lib.displays.clouds.cloud import Cloud
from course_lib.displays.clouds.colors import COLOR_PROPERTIES, TRANSFORMERS, best_transformer
from course_lib.displays.frames import NS
from course_lib.displays.marker.lists import drawn_twice
from course_lib.displays.properties import Property, flag, number, words
from course_lib.displays.topic_display import TopicDisplay
from course_lib.viewer.arrays import Floats
from course_lib.viewer.drawables import Points, Spot

# Squares have soft edges in RViz, which nobody sees at their size.
STYLES: dict[str, Spot] = {
    "Points": "disc",
    "Squares": "square",
    "Flat Squares": "square",
    "Spheres": "sphere",
    "Boxes": "box",
    "Tiles": "tile",
}

CLOUD_PROPERTIES = (
    Property("Selectable", True, flag),
    Property("Style", "Flat Squares", words(*STYLES)),
    Property("Size (m)", 0.01, number(0.0001)),  # [m]
    Property("Size (Pixels)", 3.0, number(1.0)),  # [px]
    Property("Alpha", 1.0, number(0.0, 1.0)),
    Property("Decay Time", 0.0, number(0.0)),  # [s]
    Property("Position Transformer", "", words("", "XYZ")),
    Property("Color Transformer", "", words("", *TRANSFORMERS)),
    *COLOR_PROPERTIES,
)
_NOT_DRAWN = {"Enabled", "Topic", "Selectable", "Decay Time"}


class Shown(NamedTuple):
    """A cloud that is in the scene."""

    cloud: Cloud
    path: str


class CloudDisplay(TopicDisplay):
    """Shows clouds for some time; those that come between two frames appear with the next one."""

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._new: list[Cloud] = []
        self._shown: list[Shown] = []
        self._stale = False
        self._number = 0

    def changed(self, label: str) -> None:
        """Draw all clouds anew in the next frame, if they look different."""
        super().changed(label)
        self._stale |= label.partition("/")[0] not in _NOT_DRAWN

    def reset(self) -> None:
        """Forget all clouds."""
        super().reset()
        self._new, self._shown = [], []

    def keep(self, cloud: Cloud) -> None:
        """Keep a cloud for the next frame, if RViz can draw it."""
        self.statuses.delete("Message")
        self._values["Color Transformer"] = best_transformer(cloud, self["Color Transformer"])
        if not (cloud.is_single("x") and {"y", "z"} <= cloud.channels.keys()):
            self.statuses.set("error", "Message", "No position transformer available for cloud")
            return
        self._values["Position Transformer"] = "XYZ"
        self._new.append(cloud)

    def update(self) -> None:
        """Show what has come, remove what is too old."""
        super().update()
        if self._stale:
            for shown in self._shown:
                self._draw(shown)
        self._stale = False
        if self._new or self["Decay Time"] > 0:
            self._remove_old()
        for cloud in self._new:
            if cloud is self._new[-1] or not self._is_old(cloud):
                self._show(cloud)
        self._new = []
        count = sum(len(shown.cloud.positions) for shown in self._shown)
        text = f"Showing [{count}] points from [{len(self._shown)}] messages"
        self.statuses.set("ok", "Points", text)

    def _is_old(self, cloud: Cloud) -> bool:
        """Say whether a cloud goes; without a decay time it does when another one has come."""
        age = (self.context.now_ns - cloud.received_ns) / NS  # [s]
        return bool(age > self["Decay Time"] or not self["Decay Time"])

    def _remove_old(self) -> None:
        while self._shown and self._is_old(self._shown[0].cloud):
            self.context.scene.delete(self._shown.pop(0).path)

    def _show(self, cloud: Cloud) -> None:
        self._number += 1
        shown = Shown(cloud, f"{self.path}/clouds/{self._number}")
        self._shown.append(shown)
        self.context.scene.set_transform(shown.path, cloud.transform_cloud_to_fixed)
        self._draw(shown)

    def _draw(self, shown: Shown) -> None:
        style = self["Style"]
        in_pixels = style == "Points"
        size = (self["Size (Pixels)" if in_pixels else "Size (m)"],) * 3
        colors = self._colors(shown.cloud)
        grow = not in_pixels and bool(self._values.get("Auto Size"))
        drawn = Points(shown.cloud.positions, colors, size, in_pixels, STYLES[style], grow)
        self.context.scene.set_object(shown.path, drawn)

    def _colors(self, cloud: Cloud) -> Floats:
        """Return RGBA of each point, shape (N, 4); alpha of a channel counts only if it is called rgba."""
        name = best_transformer(cloud, self["Color Transformer"])
        colors, bounds = TRANSFORMERS[name].colors(cloud, self)
        self._values |= bounds
        each = np.empty((len(colors), 4), np.float32)
        each[:, :3] = colors[:, :3]
        each[:, 3] = self["Alpha"] * (colors[:, 3] if colors.shape[1] == 4 else 1.0)
        if not (each[:, 3] == 1).all():
            each[:, 3] = drawn_twice(each[:, 3])
        return each
