"""laser_geometry and tf2_sensor_msgs: from a scan to a cloud, and on to another frame."""

import math

import pytest
import rclpy
from geometry_msgs.msg import Transform, TransformStamped, Vector3
from laser_geometry import LaserProjection
from sensor_msgs.msg import LaserScan, PointCloud2
from sensor_msgs_py.point_cloud2 import create_cloud_xyz32, read_points
from tf2_ros import Buffer
from tf2_sensor_msgs import do_transform_cloud

from course_lib.ros.graph.graph import Graph, use_graph

SCAN = LaserScan(
    angle_min=0.0,
    angle_increment=math.pi / 2,
    time_increment=0.5,
    range_min=0.5,
    range_max=10.0,
    ranges=[1.0, 2.0, 0.1, 4.0, math.inf, math.nan, 10.0],
    intensities=[5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0],
)
SCAN.header.frame_id = "laser"
Option = LaserProjection.ChannelOption


def rows(cloud: PointCloud2) -> list[tuple[float, ...]]:
    return [tuple(round(float(value), 3) + 0.0 for value in point) for point in read_points(cloud)]


def turned() -> TransformStamped:
    """A quarter of a turn to the left, 1 m up, from laser to map."""
    transform = TransformStamped(child_frame_id="laser")
    transform.header.frame_id = "map"
    transform.transform.translation = Vector3(z=1.0)
    transform.transform.rotation.z = transform.transform.rotation.w = math.sqrt(0.5)
    return transform


def test_valid_ranges_become_points_with_their_intensities_and_indices() -> None:
    cloud = LaserProjection().projectLaser(SCAN)
    assert [field.name for field in cloud.fields] == ["x", "y", "z", "intensity", "index"]
    assert rows(cloud) == [(1, 0, 0, 5, 0), (0, 2, 0, 6, 1), (0, -4, 0, 8, 3)]
    assert cloud.header.frame_id == "laser"


def test_range_cutoff_and_channel_options_are_applied() -> None:
    cloud = LaserProjection().projectLaser(SCAN, 2.5, Option.DISTANCE | Option.TIMESTAMP)
    assert [field.name for field in cloud.fields[3:]] == ["distances", "stamps"]
    assert rows(cloud) == [(1, 0, 0, 1, 0), (0, 2, 0, 2, 0.5)]


def test_scan_without_intensities_or_ranges_gives_a_cloud_without_them() -> None:
    bare = LaserScan(ranges=[1.0], range_max=5.0)
    assert [field.name for field in LaserProjection().projectLaser(bare).fields] == ["x", "y", "z", "index"]
    assert rows(LaserProjection().projectLaser(LaserScan())) == []


@pytest.mark.parametrize("stamped", [True, False])
def test_transformed_cloud_keeps_its_other_fields(stamped: bool) -> None:
    transform: TransformStamped | Transform = turned() if stamped else turned().transform
    cloud = do_transform_cloud(LaserProjection().projectLaser(SCAN), transform)
    assert rows(cloud) == [(0, 1, 1, 5, 0), (-2, 0, 1, 6, 1), (4, 0, 1, 8, 3)]
    assert cloud.header.frame_id == ("map" if stamped else "laser")


def test_buffer_transforms_clouds() -> None:
    with use_graph(Graph()):
        rclpy.init()
        buffer = Buffer()
        buffer.set_transform_static(turned(), "test")
        cloud = create_cloud_xyz32(SCAN.header, [(1.0, 0.0, 0.0)])
        assert rows(buffer.transform(cloud, "map")) == [(0, 1, 1)]
        rclpy.shutdown()


def test_cloud_without_coordinates_is_rejected() -> None:
    with pytest.raises(AssertionError, match="Point cloud needs the fields x, y, and z"):
        do_transform_cloud(PointCloud2(), turned())
