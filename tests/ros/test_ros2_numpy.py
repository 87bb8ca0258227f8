"""Messages from and to numpy arrays."""

from typing import Any

import numpy as np
import pytest
import ros2_numpy
from geometry_msgs.msg import Point, Pose, Quaternion, Transform, Vector3
from nav_msgs.msg import OccupancyGrid
from ros2_numpy import (
    get_xyz_points,
    merge_rgb_fields,
    msgify,
    numpify,
    pointcloud2_to_xyz_array,
    split_rgb_field,
)
from sensor_msgs.msg import Image, PointCloud2, PointField
from std_msgs.msg import String

CHANCE = np.random.default_rng(1)


@pytest.mark.parametrize(
    ("cls", "value"),
    [
        (Point, [1.0, 2.0, 3.0]),
        (Vector3, [1.0, 2.0, 3.0]),
        (Quaternion, [0.0, 0.0, 0.6, 0.8]),
        (Pose, [[0.0, -1.0, 0.0, 1.0], [1.0, 0.0, 0.0, 2.0], [0.0, 0.0, 1.0, 3.0], [0.0, 0.0, 0.0, 1.0]]),
        (Transform, [[1.0, 0, 0, 1.0], [0, 0, -1.0, 2.0], [0, 1.0, 0, 3.0], [0, 0, 0, 1.0]]),
    ],
)
def test_geometry_messages_survive_a_round_trip(cls: type[Any], value: Any) -> None:
    message = msgify(cls, np.array(value))
    assert isinstance(message, cls)
    np.testing.assert_allclose(numpify(message), value, atol=1e-12)


def test_homogeneous_coordinates_of_points_and_vectors_differ() -> None:
    assert numpify(Point(x=2.0), hom=True).tolist() == [2.0, 0.0, 0.0, 1.0]
    assert numpify(Vector3(x=2.0), hom=True).tolist() == [2.0, 0.0, 0.0, 0.0]
    assert msgify(Point, np.array([2.0, 4.0, 6.0, 2.0])) == Point(x=1.0, y=2.0, z=3.0)
    assert msgify(Vector3, np.zeros((2, 3))) == [Vector3(), Vector3()]


@pytest.mark.parametrize("encoding", ["mono8", "rgb8", "bgra8", "mono16", "16UC1", "32FC1", "64FC3", "8SC2"])
def test_image_survives_a_round_trip(encoding: str) -> None:
    dtype, channels = ros2_numpy._format_of(encoding)
    shape = (4, 5) if channels == 1 else (4, 5, channels)
    pixels = (CHANCE.random(shape) * 100).astype(dtype)
    message = msgify(Image, pixels, encoding=encoding)
    assert (message.height, message.width, message.encoding) == (4, 5, encoding)
    np.testing.assert_array_equal(numpify(message), pixels)


def test_image_with_padded_rows_and_big_endian_pixels_is_read() -> None:
    rows = np.zeros((2, 10), np.uint8)
    rows[:, 1] = 7
    image = Image(height=2, width=3, encoding="mono16", is_bigendian=1, step=10, data=rows.tobytes())
    assert numpify(image).tolist() == [[7, 0, 0], [7, 0, 0]]


@pytest.mark.parametrize(
    ("pixels", "encoding", "text"),
    [
        (np.zeros((2, 2), np.uint8), "nope", "Unrecognized encoding nope"),
        (np.zeros((2, 2), np.uint8), "rgb8", "Array has 1 channels, rgb8 requires 3"),
        (np.zeros((2, 2, 3)), "rgb8", "Array is <class 'numpy.float64'>, rgb8 requires"),
        (np.zeros(2, np.uint8), "mono8", "two or three dimensional"),
    ],
)
def test_array_that_does_not_match_the_encoding_is_rejected(pixels: Any, encoding: str, text: str) -> None:
    with pytest.raises(TypeError, match=text):
        msgify(Image, pixels, encoding=encoding)


def test_structured_cloud_keeps_its_fields() -> None:
    kinds = [
        ("x", np.float32),
        ("y", np.float32),
        ("z", np.float32),
        ("vectors", np.float32, (3,)),
        ("i", "u1"),
    ]
    points = np.zeros(10, dtype=kinds)
    points["x"] = np.arange(10)
    points["vectors"] = np.arange(10)[:, np.newaxis]
    message = msgify(PointCloud2, points, frame_id="map")
    assert (message.width, message.height, message.header.frame_id) == (10, 1, "map")
    assert (message.fields[3].count, message.fields[4].offset) == (3, 24)
    np.testing.assert_array_equal(np.asarray(numpify(message)), points)


def test_cloud_of_coordinates_and_colors_is_read_under_both_function_names() -> None:
    xyz = CHANCE.random((6, 3)).astype(np.float32)
    message = msgify(PointCloud2, {"xyz": xyz, "rgb": np.full((6, 3), (255, 128, 0), np.uint8)})
    read = numpify(message)
    np.testing.assert_array_equal(read["xyz"], xyz.astype(float))
    np.testing.assert_array_equal(read["x"], xyz[:, 0])
    split = split_rgb_field(np.asarray(read))
    assert (split["r"][0], split["g"][0], split["b"][0]) == (255, 128, 0)
    assert merge_rgb_fields(split)["rgb"].view(np.uint32)[0] == 0xFF8000


def test_non_finite_points_are_removed() -> None:
    points = np.zeros(3, dtype=[(name, np.float64) for name in "xyz"])
    points["y"][1] = np.nan
    message = msgify(PointCloud2, points)
    assert not message.is_dense
    assert pointcloud2_to_xyz_array(message).shape == (2, 3)
    assert get_xyz_points(points, remove_nans=False).shape == (3, 3)


def test_rows_of_an_organized_cloud_are_kept() -> None:
    fields = [PointField(name=name, offset=4 * n, datatype=7, count=1) for n, name in enumerate("xyz")]
    data = np.arange(2 * 3 * 4, dtype=np.float32).tobytes()
    cloud = PointCloud2(height=2, width=3, fields=fields, point_step=16, row_step=48, data=data)
    assert numpify(cloud).shape == (2, 3)
    assert numpify(cloud)["y"][1, 2] == 21


def test_unknown_map_cells_are_masked() -> None:
    cells = np.array([[0, 100, -1], [50, -1, 0]], dtype=np.int8)
    message = msgify(OccupancyGrid, cells)
    assert (message.info.width, message.info.height) == (3, 2)
    read = numpify(message)
    assert read.mask.tolist() == [[False, False, True], [False, True, False]]
    assert msgify(OccupancyGrid, read) == message
    with pytest.raises(TypeError, match="int8"):
        msgify(OccupancyGrid, cells.astype(int))


def test_type_without_a_converter_is_rejected_with_the_supported_types() -> None:
    with pytest.raises(ValueError, match=r"Unable to convert message String - only supports Vector3, Point"):
        numpify(String())
    with pytest.raises(ValueError, match="Unable to build message String"):
        msgify(String, np.zeros(3))
    with pytest.raises(ValueError, match="empty Collection"):
        numpify([])
