import numpy as np
import pytest
from sensor_msgs.msg import PointCloud2, PointField
from sensor_msgs_py import point_cloud2
from std_msgs.msg import Header

FIELDS = [
    PointField(name="x", offset=0, datatype=PointField.FLOAT32, count=1),
    PointField(name="ring", offset=4, datatype=PointField.UINT16, count=1),
    PointField(name="", offset=6, datatype=PointField.UINT8, count=2),
]
HEADER = Header(frame_id="lidar")


def test_points_survive_a_round_trip_through_a_point_cloud() -> None:
    points = np.random.default_rng(0).normal(size=(20, 3)).astype(np.float32)
    for given in (points, points.tolist()):
        cloud = point_cloud2.create_cloud_xyz32(HEADER, given)
        assert (cloud.width, cloud.height, cloud.point_step, cloud.row_step) == (20, 1, 12, 240)
        np.testing.assert_array_equal(point_cloud2.read_points_numpy(cloud), points)
    np.testing.assert_array_equal(point_cloud2.read_points(cloud)["y"], points[:, 1])
    np.testing.assert_array_equal(
        point_cloud2.read_points_numpy(cloud, ["z"], uvs=[3, 1]), points[[3, 1], 2:]
    )
    assert point_cloud2.read_points_list(cloud, ["x"])[4].x == points[4, 0]


def test_fields_of_many_types_and_unnamed_fields_become_columns() -> None:
    cloud = point_cloud2.create_cloud(HEADER, FIELDS, [(1.0, 2, 3, 4), (5.0, 6, 7, 8)])
    read = point_cloud2.read_points(cloud)
    assert read.dtype.names == ("x", "ring", "unnamed_field_2_0", "unnamed_field_2_1")
    assert read.tolist() == [(1.0, 2, 3, 4), (5.0, 6, 7, 8)]
    assert point_cloud2.create_cloud(HEADER, FIELDS, read) == cloud
    with pytest.raises(AssertionError, match="All fields need to have the same datatype"):
        point_cloud2.read_points_numpy(cloud)
    with pytest.raises(AssertionError, match=r"^Requests field is not in the fields of the PointCloud!$"):
        point_cloud2.read_points(cloud, ["y"])


def test_non_finite_points_are_skipped_on_request() -> None:
    cloud = point_cloud2.create_cloud_xyz32(HEADER, [(0, 0, 1), (np.nan, 0, 2), (0, 0, 3)])
    assert point_cloud2.read_points(cloud, skip_nans=True)["z"].tolist() == [1, 3]
    cloud.is_dense = True
    assert len(point_cloud2.read_points(cloud, skip_nans=True)) == 3


def test_big_endian_points_are_read() -> None:
    data = np.array([1.5, -2.0], ">f4").tobytes()
    x = PointField(name="x", offset=0, datatype=PointField.FLOAT32, count=1)
    cloud = PointCloud2(width=2, height=1, fields=[x], point_step=4, row_step=8, is_bigendian=True, data=data)
    assert point_cloud2.read_points(cloud)["x"].tolist() == [1.5, -2.0]


def test_rows_of_an_organized_cloud_are_kept_as_in_ros() -> None:
    points = np.zeros((4, 2, 3), np.float32)
    cloud = point_cloud2.create_cloud_xyz32(HEADER, points)
    assert (cloud.width, cloud.height) == (4, 2)
    assert point_cloud2.read_points(cloud, reshape_organized_cloud=True).shape == (4, 2)
