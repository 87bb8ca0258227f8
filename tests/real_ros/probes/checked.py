# mypy: ignore-errors
"""Values of each kind of field, assigned to messages that check them: `Point(check_fields=True)`.

Most values are wrong on purpose. Values with the same outcome are listed together. Sequences of
numbers are in values.py and overrides.py, as the kit converts them as Jazzy does without checks.
"""

import array
from collections import UserList, UserString, deque
from typing import Any

import numpy as np
from action_msgs.msg import GoalInfo
from builtin_interfaces.msg import Duration, Time
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import Point, Point32, Polygon, Pose, PoseStamped
from lifecycle_msgs.msg import State, TransitionEvent
from nav_msgs.msg import Path
from probing import lines, main, outcome
from rcl_interfaces.msg import ListParametersResult, ParameterDescriptor, ParameterValue
from sensor_msgs.msg import Image, JointState, NavSatStatus
from shape_msgs.msg import SolidPrimitive
from std_msgs.msg import (
    Bool,
    Byte,
    ByteMultiArray,
    ColorRGBA,
    Int8,
    Int16,
    Int32,
    Int64,
    String,
    UInt8,
    UInt16,
    UInt32,
    UInt64,
)
from std_srvs.srv import SetBool
from type_description_interfaces.msg import FieldType
from visualization_msgs.msg import Marker, MarkerArray


class _Text(str):
    __slots__ = ()


class _Whole(int):
    pass


class _Index:
    def __index__(self) -> Any:
        return 1

    def __float__(self) -> Any:
        return 1.0


VALUES = {
    "nothing": None,
    "false": False,
    "true": True,
    "zero": 0,
    "one": 1,
    "minus_one": -1,
    "int7": 127,
    "uint7": 128,
    "uint8": 255,
    "over_uint8": 256,
    "below_int8": -129,
    "uint15": 32768,
    "uint16": 65535,
    "over_uint16": 65536,
    "uint31": 2**31,
    "below_int31": -(2**31) - 1,
    "uint32": 2**32 - 1,
    "over_uint32": 2**32,
    "uint63": 2**63,
    "uint64": 2**64 - 1,
    "over_uint64": 2**64,
    "half": 0.5,
    "whole_float": 1.0,
    "over_float": 3.5e38,
    "over_float_too": -1e300,
    "not_a_number": float("nan"),
    "infinity": float("inf"),
    "complex": 1j,
    "own_int": _Whole(3),
    "with_index": _Index(),
    "numpy_int": np.int64(1),
    "numpy_uint8": np.uint8(1),
    "numpy_float": np.float64(0.5),
    "numpy_float32": np.float32(0.5),
    "numpy_bool": np.bool_(True),
    "text": "a",
    "long_text": "a" * 256,
    "own_text": _Text("a"),
    "user_text": UserString("a"),
    "byte": b"a",
    "bytes": b"ab",
    "byte_array": bytearray(b"a"),
    "empty": [],
    "empty_tuple": (),
    "ints": [1, 2, 3],
    "tuple_of_ints": (1, 2, 3),
    "range": range(3),
    "set": {1},
    "four": [1, 2, 3, 4],
    "negative_ints": [-1, 2, 3],
    "large_ints": [300, 2, 3],
    "larger_ints": [2**33, 2, 3],
    "floats": [0.5, 1.5, 2.5],
    "mixed": [1, 0.5, 2],
    "over_floats": [1e39, 0.0, 0.0],
    "infinities": [float("inf"), float("nan"), 0.0],
    "bools": [True, False, True],
    "user_list": UserList([1, 2, 3]),
    "user_floats": UserList([0.5]),
    "deque": deque([1, 2, 3]),
    "generator": (i for i in ()),
    "dictionary": {"a": 1},
    "texts": ["a", "b"],
    "set_of_texts": {"a"},
    "text_and_nothing": ["a", None],
    "list_of_bytes": [b"a", b"b"],
    "list_of_long_bytes": [b"ab"],
    "numpy_ints": np.array([1, 2, 3]),
    "numpy_bytes": np.array([1, 2, 3], np.uint8),
    "numpy_floats": np.array([0.5, 1.5, 2.5]),
    "numpy_short_floats": np.array([0.5], np.float32),
    "numpy_nine": np.zeros(9),
    "numpy_matrix": np.zeros((3, 3)),
    "nine": [0.0] * 9,
    "tuple_of_nine": (0.0,) * 9,
    "twelve": [0.0] * 12,
    "sixteen": [0] * 16,
    "sixteen_bytes": bytes(16),
    "array_of_bytes": array.array("B", [1, 2, 3]),
    "array_of_doubles": array.array("d", [0.5]),
    "array_of_four_doubles": array.array("d", [0.5] * 4),
    "array_of_floats": array.array("f", [0.5]),
    "array_of_ints": array.array("i", [1]),
    "array_of_long_ints": array.array("q", [1]),
    "point": Point(),
    "point32": Point32(),
    "a_class": Point,
    "points": [Point(), Point()],
    "points32": (Point32(),),
    "poses": [PoseStamped()],
    "points_and_nothing": [Point(), None],
    "classes": [Point],
    "markers": [Marker()],
    "stamp": Time(),
    "duration": Duration(),
}


def stored(value: Any) -> Any:
    """Return the type of a stored value, and its items."""
    if isinstance(value, np.ndarray):
        return f"array of {value.dtype}"
    if isinstance(value, array.array):
        return f"array of {value.typecode}"
    return type(value).__name__


def assigned(kind: Any, field: Any) -> Any:
    """Assign each value to a field; return the names of the values by their outcome."""
    found = {}
    for name, value in VALUES.items():
        message = kind(check_fields=True)

        def assign() -> Any:
            setattr(message, field, value)  # noqa: B023  # called at once
            return stored(getattr(message, field))  # noqa: B023

        # pi to 300 digits is in the texts about floats.
        text = outcome(assign).replace(f"{np.finfo(np.float64).max:.6f}", "MAX")
        found.setdefault(text, []).append(name)
    return found


FIELDS = {
    "bool": (Bool, "data"),
    "byte": (Byte, "data"),
    "level": (DiagnosticStatus, "level"),
    "int8": (Int8, "data"),
    "uint8": (UInt8, "data"),
    "int16": (Int16, "data"),
    "uint16": (UInt16, "data"),
    "int32": (Int32, "data"),
    "uint32": (UInt32, "data"),
    "int64": (Int64, "data"),
    "uint64": (UInt64, "data"),
    "float": (ColorRGBA, "r"),
    "double": (Point, "x"),
    "string": (String, "data"),
    "bounded_string": (FieldType, "nested_type_name"),
    "identifier": (State, "id"),
    "service": (NavSatStatus, "service"),
    "timestamp": (TransitionEvent, "timestamp"),
    "bytes": (ByteMultiArray, "data"),
    "bools": (ParameterValue, "bool_array_value"),
    "strings": (ListParametersResult, "names"),
    "bounded_ranges": (ParameterDescriptor, "integer_range"),
    "point": (Pose, "position"),
    "stamp": (GoalInfo, "stamp"),
    "lifetime": (Marker, "lifetime"),
    "points": (Marker, "points"),
    "points32": (Polygon, "points"),
    "poses": (Path, "poses"),
    "markers": (MarkerArray, "markers"),
    "request": (SetBool.Request, "data"),
    "response": (SetBool.Response, "message"),
}
lines(
    "assigned",
    **{name: (lambda where=where: assigned(*where)) for name, where in FIELDS.items()},
)


def unchecked(kind: Any, field: Any, value: Any) -> Any:
    """Assign a value to a message without checks; return what it stores and prints."""
    message = kind(check_fields=False)
    setattr(message, field, value)
    return getattr(message, field), outcome(repr, message), outcome(lambda: message == kind())


lines(
    "unchecked",
    int_for_double=lambda: unchecked(Point, "x", 1),
    text_for_double=lambda: unchecked(Point, "x", "a"),
    nothing_for_message=lambda: unchecked(Pose, "position", None),
    tuple_for_message=lambda: unchecked(Pose, "position", (1, 2, 3)),
    number_for_text=lambda: unchecked(String, "data", 5),
    texts=lambda: unchecked(JointState, "name", "arm"),
    list_for_doubles=lambda: unchecked(JointState, "position", [1, 2]),
    text_for_doubles=lambda: unchecked(JointState, "position", "a"),
    large=lambda: unchecked(UInt8, "data", 300),
    too_many=lambda: unchecked(SolidPrimitive, "dimensions", [0.0] * 4),
    bytes_for_data=lambda: unchecked(Image, "data", b"ab"),
    large_for_data=lambda: unchecked(Image, "data", [300]),
    of_the_constructor=lambda: Point(x="a", check_fields=False),
    unknown=lambda: Point(w=1.0, check_fields=False),
    unknown_checked=lambda: Point(w=1.0, check_fields=True),
    two_unknown=lambda: Point(w=1.0, v=2.0, check_fields=True),
    nested=lambda: Pose(position=Point(x="a", check_fields=False), check_fields=True).position.x,
    nested_is_not_checked=lambda: setattr(Pose(check_fields=False).position, "x", "a"),
    nested_is_checked=lambda: setattr(Pose(check_fields=True).position, "x", "a"),
)


if __name__ == "__main__":
    main()
