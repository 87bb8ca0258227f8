"""Projection of laser scans to point clouds."""

from enum import IntFlag

import numpy as np
from sensor_msgs.msg import LaserScan, PointCloud2, PointField
from sensor_msgs_py.point_cloud2 import create_cloud, dtype_from_fields

_VIEWPOINT = ("vp_x", "vp_y", "vp_z")


class LaserProjection:
    """Projects scans to clouds in the frame of the laser.

    Ranges outside the limits are left out.
    """

    LASER_SCAN_INVALID = -1.0
    LASER_SCAN_MIN_RANGE = -2.0
    LASER_SCAN_MAX_RANGE = -3.0

    class ChannelOption(IntFlag):
        """Fields in addition to x, y and z."""

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
        """Project a scan to a point cloud.

        Args:
            scan_in: The scan.
            range_cutoff: Points at or beyond this range [m] are left out. A negative value stands
                for `range_max`.
            channel_options: Members of ChannelOption, combined with |.
        """
        ranges = np.array(scan_in.ranges, np.float64)
        numbers = np.arange(len(ranges))
        angles = scan_in.angle_min + numbers * scan_in.angle_increment
        columns = {"x": ranges * np.cos(angles), "y": ranges * np.sin(angles), "z": np.zeros(len(ranges))}
        channel = self.ChannelOption
        # Intensities are left out if the scan has none.
        if channel_options & channel.INTENSITY and scan_in.intensities:
            columns["intensity"] = np.array(scan_in.intensities)
        if channel_options & channel.INDEX:
            columns["index"] = numbers
        if channel_options & channel.DISTANCE:
            columns["distances"] = ranges
        if channel_options & channel.TIMESTAMP:
            columns["stamps"] = numbers * scan_in.time_increment
        if channel_options & channel.VIEWPOINT:
            columns |= dict.fromkeys(_VIEWPOINT, np.zeros(len(ranges)))
        limit = scan_in.range_max if range_cutoff < 0 else min(range_cutoff, scan_in.range_max)
        valid = (ranges < limit) & (ranges >= scan_in.range_min)
        kinds = [PointField.INT32 if name == "index" else PointField.FLOAT32 for name in columns]
        fields = [
            PointField(name=name, offset=4 * index, datatype=kind, count=1)
            for index, (name, kind) in enumerate(zip(columns, kinds, strict=True))
        ]
        points = np.zeros(np.count_nonzero(valid), dtype_from_fields(fields))
        for name, values in columns.items():
            points[name] = values[valid]
        return create_cloud(scan_in.header, fields, points)
