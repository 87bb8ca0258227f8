import math
import os
import random
import string
import subprocess
import sys
from array import array
from functools import cache
from itertools import groupby
from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import Pose, PoseArray, PoseWithCovariance, Vector3
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore
from sensor_msgs.msg import Imu
from std_msgs.msg import Bool, ByteMultiArray, ColorRGBA, Empty, Float64MultiArray, String
from visualization_msgs.msg import Marker

from course_lib.errors import CourseError
from course_lib.ros.messages import RosMessage, deserialize, message_class, serialize
from course_lib.ros.messages.definitions import (
    PRIMITIVES,
    FieldDefinition,
    definition,
    type_names,
    typestore,
)
from course_lib.ros.messages.interface_files import kit_files, parse_interface
from tests.patience import PATIENCE

# The types of a package are tested together: collecting 2,128 tests takes each worker a second.
PACKAGES = {
    package: list(names)
    for package, names in groupby(sorted(type_names()), lambda name: name.partition("/")[0])
}


def random_value(field: FieldDefinition, rng: random.Random) -> Any:
    """A value that fits the field, of the type a ROS program would assign."""
    if field.container == "scalar":
        return random_item(field, rng)
    length = field.size if field.container == "array" else rng.randint(0, min(field.size or 4, 4))
    return [random_item(field, rng) for _ in range(length)]


def random_item(field: FieldDefinition, rng: random.Random) -> Any:
    if field.is_message:
        return random_message(field.base, rng)
    if field.base == "string":
        return "".join(rng.choices(string.ascii_letters + "äß✓", k=rng.randint(0, 9)))
    if field.base == "byte":
        return bytes([rng.randrange(256)])
    primitive = PRIMITIVES[field.base]
    if primitive.python is float:
        return rng.choice([0.5, -1.25, 1024.0, math.inf])
    if primitive.python is bool:
        return rng.random() < 0.5
    return rng.randint(int(primitive.low), int(primitive.high))


def random_message(type_name: str, rng: random.Random) -> RosMessage:
    values = {field.name: random_value(field, rng) for field in definition(type_name).fields}
    values.pop("structure_needs_at_least_one_member", None)
    return message_class(type_name)(**values)


@pytest.mark.parametrize("package", PACKAGES)
def test_every_type_survives_serialization(package: str) -> None:
    for type_name in PACKAGES[package]:
        rng = random.Random(type_name)
        for _ in range(5):
            message = random_message(type_name, rng)
            received = deserialize(serialize(message), type(message))
            assert received == message, type_name
            assert repr(received) == repr(message), type_name


@cache
def rosbags_own() -> Typestore:
    """Return a store with rosbags' own classes, also of the kit's files."""
    store = get_typestore(Stores.ROS2_JAZZY)
    for file, text in kit_files().items():
        store.register(parse_interface(text, file))
    return store


@pytest.mark.parametrize("package", PACKAGES)
def test_serialized_bytes_equal_rosbags_output(package: str) -> None:
    store = rosbags_own()
    for type_name in PACKAGES[package]:
        cdr = serialize(random_message(type_name, random.Random(type_name)))
        received = store.deserialize_cdr(cdr, type_name)
        assert bytes(store.serialize_cdr(received, type_name)) == cdr, type_name


def test_serialized_bytes_equal_known_bytes() -> None:
    assert serialize(String(data="hi")) == b"\x00\x01\x00\x00\x03\x00\x00\x00hi\x00"
    assert serialize(Bool(data=True)) == b"\x00\x01\x00\x00\x01"
    assert serialize(Empty()) == b"\x00\x01\x00\x00\x00"
    assert serialize(DiagnosticStatus(level=b"\xff"))[4] == 255


def test_big_endian_bytes_are_read() -> None:
    message = Float64MultiArray(data=[1.0, -2.5])
    store = typestore()
    twin = store.deserialize_cdr(serialize(message), message._TYPE_NAME)
    assert (
        deserialize(bytes(store.serialize_cdr(twin, message._TYPE_NAME, little_endian=False)), type(message))
        == message
    )


def test_received_values_have_the_types_of_ros_and_are_writable() -> None:
    received = deserialize(serialize(PoseWithCovariance()), PoseWithCovariance)
    received.covariance[0] = 1.0
    assert isinstance(deserialize(serialize(Float64MultiArray(data=[1.0])), Float64MultiArray).data, array)
    assert deserialize(serialize(ByteMultiArray(data=[b"\x80"])), ByteMultiArray).data == [b"\x80"]
    assert deserialize(serialize(DiagnosticStatus(level=b"\x02")), DiagnosticStatus).level == b"\x02"


def test_float32_field_is_rounded_to_single_precision() -> None:
    assert deserialize(serialize(ColorRGBA(r=0.1)), ColorRGBA).r == float(np.float32(0.1))


def test_invalid_value_that_bypassed_the_setters_is_rejected_by_serialize() -> None:
    marker = Marker()
    marker.points.append(Vector3())  # type: ignore[arg-type]
    with pytest.raises(AssertionError, match=r"The 'points' field .* each value of type 'Point'"):
        serialize(marker)
    unchecked = Marker(check_fields=False, ns=3)  # type: ignore[arg-type]
    with pytest.raises(AssertionError, match="The 'ns' field must be of type 'str'") as raised:
        serialize(unchecked)
    assert raised.value.__suppress_context__  # the traceback is of the program alone


def test_valid_values_that_bypassed_the_setters_are_serialized() -> None:
    imu = Imu()
    imu._orientation_covariance = [1.0] * 9  # type: ignore[attr-defined]
    poses = PoseArray()
    poses._poses = (Pose(), Pose())  # type: ignore[attr-defined]
    assert deserialize(serialize(imu), Imu).orientation_covariance.tolist() == [1.0] * 9
    assert len(deserialize(serialize(poses), PoseArray).poses) == 2
    assert imu._orientation_covariance == [1.0] * 9  # type: ignore[attr-defined]


UNCHECKED = """
from course_lib.ros.programs import import_path; import_path.install()
from course_lib.ros.messages import deserialize, serialize
from sensor_msgs.msg import Imu
from std_msgs.msg import Int32
message = Int32(data="three")
again = deserialize(serialize(Int32(data=3)), Int32)
again.data = "four"
print(message.data, again.data)
serialize(message)
"""


def test_early_check_of_the_kit_can_be_deferred_to_publish_as_in_jazzy() -> None:
    environment = os.environ | {"ROS_PYTHON_CHECK_FIELDS": "0"}
    command = [sys.executable, "-c", UNCHECKED]
    process = subprocess.run(
        command, env=environment, capture_output=True, text=True, check=False, timeout=PATIENCE
    )
    assert process.stdout == "three four\n"
    assert process.stderr.endswith("AssertionError: The 'data' field must be of type 'int'\n")


def test_strided_array_is_serialized() -> None:
    message = PoseWithCovariance()
    message.covariance = np.arange(72.0)[::2]
    assert deserialize(serialize(message), PoseWithCovariance).covariance[1] == 2.0


def test_array_can_grow_after_serialization() -> None:
    message = Float64MultiArray(data=[1.0])
    serialize(message)
    message.data.extend([2.0])
    assert len(message.data) == 2


@pytest.mark.parametrize("cdr", [b"", b"\x00\x01\x00\x00", b"\x00\x01\x00\x00\xff\xff\xff\xff", b"\x09" * 40])
def test_invalid_cdr_bytes_are_rejected(cdr: bytes) -> None:
    with pytest.raises(CourseError, match="bytes are not a valid visualization_msgs/msg/Marker"):
        deserialize(cdr, Marker)


def test_unknown_type_error_suggests_close_names() -> None:
    with pytest.raises(CourseError, match="Did you mean visualization_msgs/msg/Marker"):
        message_class("visualization_msgs/msg/Marke")
