"""All texts equal those of rosidl_generator_py for Humble; Jazzy aborts the process instead."""

from array import array
from typing import Any

import numpy as np
import pytest

from course_lib.ros.messages import message_class

POINT, STRING, INT8 = "geometry_msgs/msg/Point", "std_msgs/msg/String", "std_msgs/msg/Int8"
MARKER, POSE, COLOR = "visualization_msgs/msg/Marker", "geometry_msgs/msg/Pose", "std_msgs/msg/ColorRGBA"
DOUBLES, JOINTS, LEVEL = (
    "std_msgs/msg/Float64MultiArray",
    "sensor_msgs/msg/JointState",
    "diagnostic_msgs/msg/DiagnosticStatus",
)
COVARIANCE, SOLID = "geometry_msgs/msg/PoseWithCovariance", "shape_msgs/msg/SolidPrimitive"
BYTES, IMAGE = "std_msgs/msg/ByteMultiArray", "sensor_msgs/msg/Image"
PARAMETER, NODE_INFO = "rcl_interfaces/msg/ParameterValue", "rmw_dds_common/msg/NodeEntitiesInfo"
DOUBLE_RANGE = f"[{-1.7976931348623157e308:f}, {1.7976931348623157e308:f}]"

REFUSED = [
    (POINT, "x", 1, "The 'x' field must be of type 'float'"),
    (POINT, "x", np.float32(1), "The 'x' field must be of type 'float'"),
    (STRING, "data", 3, "The 'data' field must be of type 'str'"),
    (MARKER, "frame_locked", 1, "The 'frame_locked' field must be of type 'bool'"),
    (MARKER, "id", 1.0, "The 'id' field must be of type 'int'"),
    (MARKER, "id", np.int32(1), "The 'id' field must be of type 'int'"),
    (INT8, "data", 128, "The 'data' field must be an integer in [-128, 127]"),
    ("std_msgs/msg/UInt8", "data", -1, "The 'data' field must be an unsigned integer in [0, 255]"),
    (COLOR, "r", 1e39, "The 'r' field must be a float in [-3.402823466e+38, 3.402823466e+38]"),
    (MARKER, "pose", (0, 0), "The 'pose' field must be a sub message of type 'Pose'"),
    (LEVEL, "level", 2, "The 'level' field must be of type 'bytes' or 'ByteString' with length 1"),
    (
        MARKER,
        "points",
        [(0.0, 0.0, 0.0)],
        "The 'points' field must be a set or sequence and each value of type 'Point'",
    ),
    (JOINTS, "name", "ab", "The 'name' field must be a set or sequence and each value of type 'str'"),
    (
        DOUBLES,
        "data",
        ["1"],
        "The 'data' field must be a set or sequence and each value of type 'float' and each double in "
        + DOUBLE_RANGE,
    ),
    (
        IMAGE,
        "data",
        [256],
        "The 'data' field must be a set or sequence and each value of type 'int' "
        "and each unsigned integer in [0, 255]",
    ),
    (
        COVARIANCE,
        "covariance",
        [0.0],
        "The 'covariance' field must be a set or sequence with length 36 and each value of type 'float' "
        "and each double in " + DOUBLE_RANGE,
    ),
    (
        COVARIANCE,
        "covariance",
        np.zeros(36, complex),
        "The 'covariance' numpy.ndarray() must have the dtype of 'numpy.float64'",
    ),
    (
        COVARIANCE,
        "covariance",
        np.zeros((6, 6)),
        "The 'covariance' numpy.ndarray() must have a size of 36",
    ),
    (SOLID, "dimensions", array("d", [0.0] * 4), "The 'dimensions' array.array() must have a size <= 3"),
    (
        SOLID,
        "dimensions",
        [0.0] * 4,
        "The 'dimensions' field must be a set or sequence with length <= 3 and each value of type 'float' "
        "and each double in " + DOUBLE_RANGE,
    ),
    (BYTES, "data", [1], "The 'data' field must be a set or sequence and each value of type 'bytes'"),
    (NODE_INFO, "node_name", "n" * 257, "The 'node_name' field must be string value not longer than 256"),
]

TAKEN = [
    (POINT, "x", np.float64(1)),
    (POINT, "x", float("inf")),
    (POINT, "x", float("nan")),
    (MARKER, "id", True),
    (MARKER, "points", ()),
    (JOINTS, "position", (1.0, 2.0)),
    (JOINTS, "position", np.array([1.0, 2.0])),
    (JOINTS, "position", np.arange(3)),
    ("sensor_msgs/msg/LaserScan", "ranges", np.linspace(0, 1, 5)),
    (IMAGE, "data", b"abc"),
    (IMAGE, "data", np.array([0, 255])),
    (BYTES, "data", [b"a", b"b"]),
    (LEVEL, "level", b"\x02"),
    (PARAMETER, "bool_array_value", [True, False]),
    (COVARIANCE, "covariance", [0.0] * 36),
]


@pytest.mark.parametrize(("type_name", "field", "value", "text"), REFUSED)
def test_invalid_value_is_rejected_with_ros_text(type_name: str, field: str, value: Any, text: str) -> None:
    message = message_class(type_name)()
    with pytest.raises(AssertionError) as raised:
        setattr(message, field, value)
    assert str(raised.value) == text


@pytest.mark.parametrize(("type_name", "field", "value"), TAKEN)
def test_valid_value_is_accepted(type_name: str, field: str, value: Any) -> None:
    message = message_class(type_name)()
    setattr(message, field, value)
    assert len(repr(getattr(message, field))) > 0


@pytest.mark.parametrize("value", [np.array([256]), np.array([[1]]), np.array([0.5])])
def test_invalid_numpy_array_is_rejected(value: Any) -> None:
    with pytest.raises(AssertionError, match="'data' field must be a set or sequence"):
        setattr(message_class(IMAGE)(), "data", value)  # noqa: B010  # mypy would refuse the plain form


def test_constructors_check_values() -> None:
    with pytest.raises(AssertionError, match=r"^The 'x' field must be of type 'float'$"):
        message_class(POINT)(x=1)
