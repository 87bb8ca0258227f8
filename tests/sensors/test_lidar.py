import numpy as np
import pytest
from sensor_msgs.msg import LaserScan, PointCloud2

from course_lib.errors import CourseError
from course_lib.sensors.sensor_nodes import LaserScanNode, PointCloudNode
from course_lib.sensors.world import Thing, World, box, placed, plane
from tests.sensors.scenes import AT_ORIGIN, published

WALL = World([Thing(box(1, 200, 10), placed(2.5, 0, 0), (1.0, 0.5, 0.0))])
POINT = np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("rgb", "<u4")])


def test_scan_of_a_wall_agrees_with_trigonometry() -> None:
    (scan,) = published(lambda: LaserScanNode(WALL, AT_ORIGIN, range_max=10.0), LaserScan)
    assert len(scan.ranges) == 720
    angles = scan.angle_min + scan.angle_increment * np.arange(720)
    assert angles[-1] == pytest.approx(scan.angle_max, abs=1e-5)
    expected = np.where(np.cos(angles) > 0.2, 2 / np.cos(angles), np.inf)
    np.testing.assert_allclose(scan.ranges, expected, rtol=1e-4)
    assert (scan.range_max, scan.scan_time) == (10, pytest.approx(0.1))


def test_too_near_range_is_minus_inf_as_in_rep_117() -> None:
    node = lambda: LaserScanNode(WALL, AT_ORIGIN, beams=1, angle_min=0, angle_max=1, range_min=3.0)  # noqa: E731  # one use
    (scan,) = published(node, LaserScan)
    assert list(scan.ranges) == [-np.inf]


def test_angles_run_counterclockwise_from_x() -> None:
    left = World([Thing(box(1, 1, 1), placed(0, 3, 0))])
    node = lambda: LaserScanNode(left, AT_ORIGIN, beams=3, angle_min=-np.pi / 2, angle_max=np.pi / 2)  # noqa: E731  # one use
    (scan,) = published(node, LaserScan)
    assert list(scan.ranges) == pytest.approx([np.inf, np.inf, 2.5])


def test_cloud_points_lie_on_surfaces_and_have_their_color() -> None:
    world = World([*WALL.things, Thing(plane(), placed(0, 0, -1), (0.0, 0.0, 1.0))])
    (cloud,) = published(lambda: PointCloudNode(world, AT_ORIGIN), PointCloud2)
    assert [(field.name, field.offset, field.datatype) for field in cloud.fields] == [
        ("x", 0, 7), ("y", 4, 7), ("z", 8, 7), ("rgb", 12, 7),
    ]  # fmt: skip
    points = np.frombuffer(cloud.data, POINT)
    assert len(points) == cloud.width * cloud.height
    assert len(cloud.data) == cloud.row_step == cloud.point_step * cloud.width
    wall = points["rgb"] == 0xFF8000
    np.testing.assert_allclose(points["x"][wall], 2, atol=1e-5)
    np.testing.assert_allclose(points["z"][~wall], -1, atol=1e-5)
    assert set(points["rgb"][~wall]) == {0x0000FF}


def test_cloud_without_hits_is_empty() -> None:
    (cloud,) = published(lambda: PointCloudNode(World([]), AT_ORIGIN), PointCloud2)
    assert (cloud.width, len(cloud.data), cloud.is_dense) == (0, 0, True)


def test_invalid_limits_are_reported() -> None:
    with pytest.raises(CourseError, match=r"range_max \[m\] is 1; expected a number > 5"):
        published(lambda: LaserScanNode(WALL, AT_ORIGIN, range_min=5, range_max=1), LaserScan)
    with pytest.raises(CourseError, match="rings is 0; expected a whole number"):
        published(lambda: PointCloudNode(WALL, AT_ORIGIN, rings=0), PointCloud2)
