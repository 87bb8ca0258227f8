"""RViz's PointCloud2, PointCloud and LaserScan displays."""

from typing import Any, NamedTuple

import numpy as np

from course_lib.arrays import AnyArray, Float32s, Matrix
from course_lib.displays.clouds.cloud import (
    COLOR_PROPERTIES,
    TRANSFORMERS,
    Cloud,
    best_transformer,
    channels_of,
    finite,
    has_positions,
    size_problem,
)
from course_lib.displays.frames import NS, nanoseconds
from course_lib.displays.marker.drawables import drawn_twice
from course_lib.displays.properties import Property, flag, number, words
from course_lib.displays.topic_display import FilteredDisplay, TopicDisplay
from course_lib.errors import counted
from course_lib.ros.tf2_transform import Transform, TransformException, interpolated
from course_lib.viewer.drawables import Points, Spot

# Squares have soft edges in RViz, invisible at their size.
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
    """Clouds, each for its decay time; those that come between two frames appear with the next one."""

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._new: list[Cloud] = []
        self._shown: list[Shown] = []
        self._stale = False
        self._number = 0

    def changed(self, label: str) -> None:
        """Redraw all clouds in the next frame, if they look different."""
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
        """Return whether a cloud is removed; without a decay time, the next one replaces it."""
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

    def _colors(self, cloud: Cloud) -> Float32s:
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


class PointCloud2Display(CloudDisplay):
    """A display of clouds of any layout, without a wait for transforms."""

    class_name = "rviz_default_plugins/PointCloud2"
    type_name = "sensor_msgs/msg/PointCloud2"
    properties = (*CloudDisplay.properties, *CLOUD_PROPERTIES)

    def process(self, message: Any) -> None:
        """Show a cloud; one without x, y and z is passed over in silence, as RViz does, but for a hint."""
        silent = [] if has_positions(message) else ["the cloud has no fields x, y and z: RViz draws nothing."]
        self.statuses.hint("Fields", *silent)
        if silent:
            return
        problem = size_problem(message)
        if problem:
            self.statuses.set("error", "Message", problem)
            return
        transform = self.transform_at(message.header)
        if transform is not None:
            channels, wrong = channels_of(message)
            self.statuses.hint("Fields", *wrong)
            self.keep(Cloud(channels, transform, self.context.now_ns))


class PointCloudDisplay(CloudDisplay, FilteredDisplay):
    """Clouds of ROS 1's first type, with a list of numbers for each channel."""

    class_name = "rviz_default_plugins/PointCloud"
    type_name = "sensor_msgs/msg/PointCloud"
    properties = (*FilteredDisplay.properties, *CLOUD_PROPERTIES)

    def process(self, message: Any) -> None:
        """Show a cloud; a channel that does not have a number for each point is left out."""
        transform = self.transform_at(message.header)
        if transform is None:
            return
        points = counted(len(message.points), "point")
        wrong = [
            f"channel {channel.name!r} has {counted(len(channel.values), 'value')} for {points}."
            for channel in message.channels
            if len(channel.values) != len(message.points)
        ]
        self.statuses.hint("Channels", *wrong)
        self.keep(Cloud(finite(_lists(message)), transform, self.context.now_ns))


class LaserScanDisplay(CloudDisplay, FilteredDisplay):
    """The ends of a scanner's beams, each from the scanner's pose at the time of that beam."""

    class_name = "rviz_default_plugins/LaserScan"
    type_name = "sensor_msgs/msg/LaserScan"
    properties = (*FilteredDisplay.properties, *CLOUD_PROPERTIES)

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._longest_ns = 0  # the longest time that a scan took, [ns]

    def reset(self) -> None:
        """Forget all scans; the warning about their time stays, as in RViz."""
        super().reset()
        self._warn_of_time()

    def process(self, message: Any) -> None:
        """Show a scan."""
        duration_ns = _duration_ns(message)
        if duration_ns > self._longest_ns:
            self._longest_ns = duration_ns
            self._warn_of_time()
        frames, frame = self.context.frames, message.header.frame_id.removeprefix("/")
        stamp_ns = nanoseconds(message.header.stamp)
        try:
            ends = [
                frames.buffer.lookup(frames.fixed_frame, frame, t) for t in (stamp_ns, stamp_ns + duration_ns)
            ]
        except TransformException:
            self.transform_at(message.header, known=False)
            return
        self.transform_at(message.header)
        hits, intensities = len(message.ranges), len(message.intensities)
        wrong = f"the scan has {hits} ranges but {intensities} intensities, which are not used."
        self.statuses.hint("Intensities", *([wrong] if intensities not in (0, hits) else []))
        self.keep(Cloud(_projected(message, *ends), np.eye(4), self.context.now_ns))

    def problem(self, message: Any) -> str | None:
        """Return the reason for a scan to wait: tf2 must know the origins of its first and its last beam."""
        later = nanoseconds(message.header.stamp) + self._longest_ns
        frame = message.header.frame_id.removeprefix("/")
        return super().problem(message) or self.context.frames.problem(frame, later)

    def _warn_of_time(self) -> None:
        seconds = self._longest_ns // NS
        if seconds > 1:
            self.statuses.set(
                "warn",
                "Scan Time",
                "Laser scan time, computed from time_increment * len(ranges), is rather large:  "
                f"{seconds}s.\nThe display of any message will be delayed by this amount of time!",
            )


def _lists(message: Any) -> dict[str, AnyArray]:
    """Return the coordinates and channels of a sensor_msgs/msg/PointCloud by name, shape (N,) each."""
    points = np.array([(p.x, p.y, p.z) for p in message.points], np.float32).reshape(-1, 3)
    channels: dict[str, AnyArray] = {
        channel.name: np.array(channel.values, np.float32)
        for channel in message.channels
        if len(channel.values) == len(points)
    }
    return {**channels, **dict(zip("xyz", points.T, strict=True))}


def _duration_ns(scan: Any) -> int:
    """Return the time from the first beam to the last, [ns]."""
    return max(int((len(scan.ranges) - 1) * float(scan.time_increment) * NS), 0)


def _projected(scan: Any, first: Transform, last: Transform) -> dict[str, AnyArray]:
    """Return the ends of the beams in the fixed frame, and their intensities (laser_geometry)."""
    ranges = np.asarray(scan.ranges, np.float64)
    with np.errstate(invalid="ignore"):
        beam = np.flatnonzero((ranges < scan.range_max) & (ranges >= scan.range_min))
    angles = scan.angle_min + beam * scan.angle_increment
    points = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles]) * ranges[beam, None]
    placed = _placed(points, beam / max(len(ranges) - 1, 1), first, last).astype(np.float32)
    channels: dict[str, AnyArray] = dict(zip("xyz", placed.T, strict=True))
    if len(scan.intensities) == len(ranges):
        channels["intensity"] = np.asarray(scan.intensities, np.float32)[beam]
    return channels


def _placed(points: Matrix, share: Matrix, first: Transform, last: Transform) -> Matrix:
    """Place points, shape (N, 3), by transforms between two: at shares of the way from 0 to 1, shape (N,)."""
    if first.pose == last.pose:
        transform = first.matrix()
        return points @ transform[:3, :3].T + transform[:3, 3]
    # tf2's interpolation goes by time: here a second from the one to the other.
    start = Transform(first.parent, first.child, 0, *first.pose)
    end = Transform(last.parent, last.child, NS, *last.pose)
    matrices = np.array([interpolated(start, end, round(part * NS)).matrix() for part in share])
    placed: Matrix = (matrices[:, :3, :3] @ points[:, :, None])[..., 0] + matrices[:, :3, 3]
    return placed
