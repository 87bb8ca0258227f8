"""Points of laser scans."""

from enum import IntFlag
from typing import Any

import numpy as np
from sensor_msgs.msg import LaserScan, PointCloud2, PointField
from sensor_msgs_py.point_cloud2 import create_cloud, dtype_from_fields

_VIEWPOINT = ("vp_x", "vp_y", "vp_z")


class LaserProjection:
    """A projection of scans into clouds in the laser's own frame; ranges out of bounds are left out."""

    LASER_SCAN_INVALID = -1.0
    LASER_SCAN_MIN_RANGE = -2.0
    LASER_SCAN_MAX_RANGE = -3.0

    class ChannelOption(IntFlag):
        """Fields beside x, y and z."""

        NONE = 0x00
        INTENSITY = 0x01
        INDEX = 0x02
        DISTANCE = 0x04
        TIMESTAMP = 0x08
        VIEWPOINT = 0x10
        DEFAULT = INTENSITY | INDEX

    def projectLaser(  # noqa: N802  # ROS's name
        self, scan_in: LaserScan, range_cutoff: float = -1.0, channel_options: int = ChannelOption.DEFAULT
    ) -> PointCloud2:
        """Return the cloud of a scan.

        Args:
            scan_in: The scan.
            range_cutoff: Points from here on are left out, too, [m]; below 0: those from `range_max` on.
            channel_options: Of ChannelOption, joined by |.
        """
        ranges = np.array(scan_in.ranges, np.float64)
        numbers = np.arange(len(ranges))
        angles = scan_in.angle_min + numbers * scan_in.angle_increment
        columns = {"x": ranges * np.cos(angles), "y": ranges * np.sin(angles), "z": np.zeros(len(ranges))}
        columns |= self._channels(scan_in, ranges, numbers, channel_options)
        limit = scan_in.range_max if range_cutoff < 0 else min(range_cutoff, scan_in.range_max)
        valid = (ranges < limit) & (ranges >= scan_in.range_min)
        fields = [_field(name, 4 * place) for place, name in enumerate(columns)]
        points = np.zeros(np.count_nonzero(valid), dtype_from_fields(fields))
        for name, values in columns.items():
            points[name] = values[valid]
        return create_cloud(scan_in.header, fields, points)

    def _channels(self, scan: LaserScan, ranges: Any, numbers: Any, options: int) -> dict[str, Any]:
        """Return the values of the fields that are asked for; intensities only if the scan has them."""
        has, columns = self.ChannelOption, dict[str, Any]()
        if options & has.INTENSITY and scan.intensities:
            columns["intensity"] = np.array(scan.intensities)
        if options & has.INDEX:
            columns["index"] = numbers
        if options & has.DISTANCE:
            columns["distances"] = ranges
        if options & has.TIMESTAMP:
            columns["stamps"] = numbers * scan.time_increment
        if options & has.VIEWPOINT:
            columns |= dict.fromkeys(_VIEWPOINT, np.zeros(len(ranges)))
        return columns


def _field(name: str, offset: int) -> PointField:
    datatype = PointField.INT32 if name == "index" else PointField.FLOAT32
    return PointField(name=name, offset=offset, datatype=datatype, count=1)
