"""RViz's Map display."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from course_lib.arrays import Bytes
from course_lib.displays.display import INVALID, DrawnDisplay, Subscription, qos_of, qos_properties
from course_lib.displays.frames import nanoseconds, pose_in_fixed_frame
from course_lib.displays.properties import Property, flag, integer, number, read_only, words
from course_lib.displays.shapes import pose_numbers
from course_lib.displays.statuses import Level
from course_lib.viewer.drawables import OPAQUE_FROM, Drawable, Sheet

# Colors of binary maps: below the threshold, and from the threshold on.
_BINARY = {
    "map": ((255, 255, 255), (0, 0, 0)),
    "costmap": ((0, 0, 255), (255, 0, 0)),
    "raw": ((0, 0, 0), (255, 255, 255)),
}
SCHEMES = tuple(_BINARY)
_UPDATES = "Update Topic"
_UPDATE = "map_msgs/msg/OccupancyGridUpdate"
# Initial values of measured properties; the orientation is a quaternion (x, y, z, w).
_INFO_VALUES = {
    "Resolution": 0.0, "Width": 0, "Height": 0,
    "Position": (0.0, 0.0, 0.0), "Orientation": (0.0, 0.0, 0.0, 1.0),
}  # fmt: skip


def palette(scheme: str, threshold: int | None = None) -> Bytes:
    """Return the colors of a scheme, shape (256, 4); only two different colors if there is a threshold."""
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
    if scheme != "raw":
        # RViz colors invalid values: green from 101 on, negative ones from red to yellow.
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
        *qos_properties(label=_UPDATES),
        Property("Alpha", 0.7, number(0.0, 1.0)),
        Property("Color Scheme", "map", words(*SCHEMES)),
        Property("Draw Behind", False, flag),
        *(Property(label, nothing, read_only) for label, nothing in _INFO_VALUES.items()),
        Property("Use Timestamp", False, flag),
        Property("Binary representation", False, flag),
        Property("Binary threshold", 100, integer(0, 100)),
    )
    # The last valid map.
    _map: Any = None
    _cells: Bytes = np.empty((0, 0), np.uint8)  # shape (height, width)

    def on_property_change(self, label: str) -> None:
        """Subscribe to other topics, or redraw. The topic of updates follows the map's topic."""
        super().on_property_change(label)
        if label == "Topic":
            self[_UPDATES] = f"{self['Topic']}_updates"
        elif label.startswith(_UPDATES) and self.is_started:
            self.start()

    def reset(self) -> None:
        """Discard the map."""
        super().reset()
        self._map = None
        self._values |= _INFO_VALUES
        self.statuses.set("warn", "Message", "No map received")

    def make_subscriptions(self) -> tuple[Subscription, ...]:
        """Subscribe to maps and to updates."""
        self.statuses.set("ok", _UPDATES, "OK")
        qos = qos_of(self, _UPDATES)
        return (
            *super().make_subscriptions(),
            self.subscription(self[_UPDATES], _UPDATE, self._apply_update, qos),
        )

    def process(self, message: Any) -> None:
        """Show a map. A map that RViz rejects leaves the previous one in place."""
        info, size = message.info, len(message.data)
        # RViz has no status for a map without data.
        level: Level
        level, text = "error", ""
        if size and not np.isfinite([info.resolution, *pose_numbers([info.origin])[0]]).all():
            text = INVALID
        elif size and not info.width * info.height:
            text = f"Map is zero-sized ({info.width}x{info.height})"
        elif size and info.width * info.height != size:
            wrong = f"width = {info.width}, height = {info.height}, data size = {size}"
            text = f"Data size doesn't match width*height: {wrong}"
        elif size:
            level, text = "ok", "Map OK"
        self.statuses.hint(
            "Map", *([] if text else ["the map has no cells: RViz draws nothing, without a status."])
        )
        if text:
            self.statuses.set(level, "Map", text)
        if not text or level == "error":
            return
        self.statuses.set("ok", "Message", "Map received")
        self._map = message
        self._cells = np.array(message.data, np.int8).view(np.uint8).reshape(info.height, info.width)
        origin = tuple(pose_numbers([info.origin])[0].tolist())
        map_info = (float(info.resolution), info.width, info.height, origin[:3], origin[3:])
        self._values |= dict(zip(_INFO_VALUES, map_info, strict=True))
        self._place()
        self.draw()

    def update(self) -> None:
        """Follow the map's frame."""
        super().update()
        self._place()

    def drawables(self) -> Mapping[str, Drawable]:
        """Return the textured rectangle of cells."""
        if self._map is None:
            return {}
        threshold = self["Binary threshold"] if self["Binary representation"] else None
        colors = palette(self["Color Scheme"], threshold) / 255
        # RViz blends only below this alpha: the transparent cells of a costmap are black above it.
        colors[:, 3] = colors[:, 3] * self["Alpha"] if self["Alpha"] < OPAQUE_FROM else 1.0
        return {"map": Sheet(self._cells, colors, self._map.info.resolution, self["Draw Behind"])}

    def _place(self) -> None:
        """Place the map at its frame's latest pose, or at the pose at its stamp if requested and known."""
        if self._map is None:
            return
        header, frames = self._map.header, self.context.frames
        stamp_ns = nanoseconds(header.stamp) if self["Use Timestamp"] else 0
        has_stamp = frames.transform(header.frame_id, stamp_ns) is not None
        transform = self.transform_at(header, stamp_ns=stamp_ns if has_stamp else 0)
        node = f"{self.path}/drawn"
        self.context.scene.set_visible(node, transform is not None)
        if transform is not None:
            self.context.scene.set_transform(node, pose_in_fixed_frame(transform, self._map.info.origin))

    def _apply_update(self, update: Any) -> None:
        """Apply an update to a part of the map."""
        if self._map is None:
            return
        self.statuses.set("ok", "Topic", self.count_status("update messages"))
        height, width = self._cells.shape
        inside = 0 <= update.x <= width - update.width and 0 <= update.y <= height - update.height
        if not inside:
            self.statuses.set("error", "Update", "Update area outside of original map area.")
            return
        count = len(update.data)
        fits = count == update.width * update.height
        problem = f"the update has {count} cells instead of {update.width} x {update.height}, and is ignored."
        self.statuses.hint("Update", *([] if fits else [problem]))
        if not fits:
            return
        part = np.array(update.data, np.int8).view(np.uint8).reshape(update.height, update.width)
        self._cells[update.y : update.y + update.height, update.x : update.x + update.width] = part
        self.statuses.set("ok", "Update", "Update OK")
        self.draw()
