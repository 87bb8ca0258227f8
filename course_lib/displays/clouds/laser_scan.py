"""The LaserScan display."""

from typing import Any

import numpy as np

from course_lib.displays.clouds.cloud import Channel, Cloud
from course_lib.displays.clouds.display import CLOUD_PROPERTIES, CloudDisplay
from course_lib.displays.frames import NS, Matrix, nanoseconds
from course_lib.displays.topic_display import FilteredDisplay
from course_lib.ros.tf2_errors import TransformException
from course_lib.ros.tf2_transform import Transform, interpolated


class LaserScanDisplay(CloudDisplay, FilteredDisplay):
    """Shows the ends of a scanner's beams, each where the scanner was at the time of that beam."""

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
        """Say why a scan has to wait: tf2 must know where its first and its last beam begin."""
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


def _duration_ns(scan: Any) -> int:
    """Return the time from the first beam to the last, [ns]."""
    return max(int((len(scan.ranges) - 1) * float(scan.time_increment) * NS), 0)


def _projected(scan: Any, first: Transform, last: Transform) -> dict[str, Channel]:
    """Return the ends of the beams in the fixed frame, and their intensities (laser_geometry)."""
    ranges = np.asarray(scan.ranges, np.float64)
    with np.errstate(invalid="ignore"):
        beam = np.flatnonzero((ranges < scan.range_max) & (ranges >= scan.range_min))
    angles = scan.angle_min + beam * scan.angle_increment
    points = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles]) * ranges[beam, None]
    placed = _placed(points, beam / max(len(ranges) - 1, 1), first, last).astype(np.float32)
    channels: dict[str, Channel] = dict(zip("xyz", placed.T, strict=True))
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
