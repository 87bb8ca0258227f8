"""RViz's Map display."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from course_lib.arrays import Bytes
from course_lib.displays.display import Interest
from course_lib.displays.frames import nanoseconds, placed
from course_lib.displays.poses.shapes import numbers_of
from course_lib.displays.properties import Property, flag, integer, number, read_only, words
from course_lib.displays.statuses import Level
from course_lib.displays.topic_display import INVALID, DrawnDisplay, qos_of, with_qos
from course_lib.viewer.drawables import Drawable, Sheet

# Of binary maps: the colours of cells below the threshold, and from there on.
_BINARY = {
    "map": ((255, 255, 255), (0, 0, 0)),
    "costmap": ((0, 0, 255), (255, 0, 0)),
    "raw": ((0, 0, 0), (255, 255, 255)),
}
SCHEMES = tuple(_BINARY)
_UPDATES = "Update Topic"
_UPDATE = "map_msgs/msg/OccupancyGridUpdate"
# What is found out of the map, before there is one; the orientation is a quaternion (x, y, z, w).
_MEASURED = {
    "Resolution": 0.0, "Width": 0, "Height": 0,
    "Position": (0.0, 0.0, 0.0), "Orientation": (0.0, 0.0, 0.0, 1.0),
}  # fmt: skip


def palette(scheme: str, threshold: int | None = None) -> Bytes:
    """Return the colours of one of RViz's schemes, shape (256, 4); two of them if there is a threshold."""
    colors = np.full((256, 4), 255, np.uint8)
    value = np.arange(256)
    if threshold is not None:
        below, above = _BINARY[scheme]
        colors[:, :3] = np.where((value < threshold)[:, None], below, above)
    elif scheme == "costmap":
        share = 255 * value[:101] // 100
        colors[:101, :3] = np.column_stack([share, 0 * share, 255 - share])
        colors[99, :3] = 0, 255, 255
        colors[100, :3] = 255, 0, 255
        colors[0] = 0
    else:
        grey = 255 - 255 * value[:101] // 100 if scheme == "map" else value
        colors[: len(grey), :3] = grey[:, None]
    return colors if scheme == "raw" else _with_illegal(colors)


def _with_illegal(colors: Bytes) -> Bytes:
    """Colour what no cell should have: from 101 on green, negative from red to yellow; and -1."""
    colors[101:128, :3] = 0, 255, 0
    shades = 255 * np.arange(127) // 126
    colors[128:255, :3] = np.column_stack([np.full(127, 255), shades, 0 * shades])
    colors[255, :3] = 0x70, 0x89, 0x86
    return colors


class MapDisplay(DrawnDisplay):
    """An occupancy grid, and updates of parts of it."""

    class_name = "rviz_default_plugins/Map"
    type_name = "nav_msgs/msg/OccupancyGrid"
    properties = (
        *DrawnDisplay.properties,
        *with_qos(label=_UPDATES),
        Property("Alpha", 0.7, number(0.0, 1.0)),
        Property("Color Scheme", "map", words(*SCHEMES)),
        Property("Draw Behind", False, flag),
        *(Property(label, nothing, read_only) for label, nothing in _MEASURED.items()),
        Property("Use Timestamp", False, flag),
        Property("Binary representation", False, flag),
        Property("Binary threshold", 100, integer(0, 100)),
    )
    _map: Any = None  # the last one that can be shown
    _cells: Bytes = np.empty((0, 0), np.uint8)  # shape (height, width)

    def changed(self, label: str) -> None:
        """Subscribe to other topics, or redraw; the topic of updates is beside that of the map by default."""
        super().changed(label)
        if label == "Topic":
            self[_UPDATES] = f"{self['Topic']}_updates"
        elif label.startswith(_UPDATES) and self.started:
            self.start()

    def reset(self) -> None:
        """Forget the map."""
        super().reset()
        self._map = None
        self._values |= _MEASURED
        self.statuses.set("warn", "Message", "No map received")

    def wanted(self) -> tuple[Interest, ...]:
        """Listen to maps and to updates."""
        self.statuses.set("ok", _UPDATES, "OK")
        qos = qos_of(self, _UPDATES)
        return (*super().wanted(), self.interest(self[_UPDATES], _UPDATE, self._take_update, qos))

    def process(self, message: Any) -> None:
        """Show a map; one that RViz refuses leaves the last one."""
        level, text = _verdict(message)
        self.statuses.hint(
            "Map", *([] if text else ["the map has no cells: RViz draws nothing, and says nothing."])
        )
        if text:
            self.statuses.set(level, "Map", text)
        if not text or level == "error":
            return
        self.statuses.set("ok", "Message", "Map received")
        self._map, info = message, message.info
        self._cells = np.array(message.data, np.int8).view(np.uint8).reshape(info.height, info.width)
        origin = tuple(numbers_of([info.origin])[0].tolist())
        measured = (float(info.resolution), info.width, info.height, origin[:3], origin[3:])
        self._values |= dict(zip(_MEASURED, measured, strict=True))
        self._place()
        self.draw()

    def update(self) -> None:
        """Stay where the map's frame is."""
        super().update()
        self._place()

    def parts(self) -> Mapping[str, Drawable]:
        """Return the sheet of cells."""
        if self._map is None:
            return {}
        threshold = self["Binary threshold"] if self["Binary representation"] else None
        colors = palette(self["Color Scheme"], threshold) / 255
        colors[:, 3] *= self["Alpha"]
        return {"map": Sheet(self._cells, colors, self._map.info.resolution, self["Draw Behind"])}

    def _place(self) -> None:
        """Put the map where its frame is: now, or at its stamp if that is asked for and known."""
        if self._map is None:
            return
        header, frames = self._map.header, self.context.frames
        stamp_ns = nanoseconds(header.stamp) if self["Use Timestamp"] else 0
        known = frames.transform(header.frame_id, stamp_ns) is not None
        transform = self.transform_at(header, stamp_ns=stamp_ns if known else 0)
        node = f"{self.path}/drawn"
        self.context.scene.set_visible(node, transform is not None)
        if transform is not None:
            self.context.scene.set_transform(node, placed(transform, self._map.info.origin))

    def _take_update(self, update: Any) -> None:
        """Change part of the map."""
        if self._map is None:
            return
        self.statuses.set("ok", "Topic", self.received("update messages"))
        height, width = self._cells.shape
        inside = 0 <= update.x <= width - update.width and 0 <= update.y <= height - update.height
        if not inside:
            self.statuses.set("error", "Update", "Update area outside of original map area.")
            return
        part = np.array(update.data, np.int8).view(np.uint8).reshape(update.height, update.width)
        self._cells[update.y : update.y + update.height, update.x : update.x + update.width] = part
        self.statuses.set("ok", "Update", "Update OK")
        self.draw()


def _verdict(message: Any) -> tuple[Level, str]:
    """Return RViz's status of a nav_msgs/msg/OccupancyGrid; None for one without data."""
    info, size = message.info, len(message.data)
    if not size:
        return "error", ""
    if not np.isfinite([info.resolution, *numbers_of([info.origin])[0]]).all():
        return "error", INVALID
    if not info.width * info.height:
        return "error", f"Map is zero-sized ({info.width}x{info.height})"
    if info.width * info.height != size:
        wrong = f"width = {info.width}, height = {info.height}, data size = {size}"
        return "error", f"Data size doesn't match width*height: {wrong}"
    return "ok", "Map OK"
