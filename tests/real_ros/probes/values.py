# mypy: disable-error-code="import-not-found, untyped-decorator"
"""Values that numeric arrays accept, and the values after deserialization."""

from array import array
from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np
from geometry_msgs.msg import PoseWithCovariance
from probing import lines, main
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState, LaserScan
from std_msgs.msg import Int32MultiArray, UInt8MultiArray

FIELDS: tuple[tuple[Any, str], ...] = (
    (JointState, "position"),
    (LaserScan, "ranges"),
    (Int32MultiArray, "data"),
    (UInt8MultiArray, "data"),
)
NUMBERS: dict[str, Any] = {
    "ints": [1, 2],
    "tuple": (1, 2),
    "range": range(2),
    "numpy_ints": np.array([1, 2]),
    "numpy_uint8": np.array([1, 2], dtype=np.uint8),
    "list_of_numpy_ints": [np.int64(1), np.int32(2)],
    "array_of_ints": array("i", [1]),
    "empty": [],
}
FLOATS: dict[str, Any] = {
    "mixed": [0.5, 0, 0],
    "bools": [True, False],
    "numpy_float32": np.array([1, 2], dtype=np.float32),
    "numpy_float64": np.array([1.0, 2.0]),
    "list_of_numpy_floats": [np.float32(1), np.float64(2)],
    "array_of_doubles": array("d", [1.5]),
    "array_of_floats": array("f", [1.5]),
    "deque": deque([1.5]),
    "values": {"a": 1.5}.values(),
    "large": [300, -1],
}
COVARIANCES: dict[str, Any] = {
    "ints": [3] * 36,
    "tuple": (3,) * 36,
    "mixed": [0.5, *[0] * 35],
    "numpy_ints": np.arange(36),
    "numpy_float32": np.arange(36, dtype=np.float32),
    "numpy_float64": np.arange(36.0),
}


def _sent(kind: Any, field: str, value: Any) -> Callable[[], object]:
    def run() -> object:
        message = kind()
        setattr(message, field, value)
        received = getattr(deserialize_message(serialize_message(message), kind), field)
        return type(received).__name__, received.tolist()

    return run


for _kind, _field in FIELDS:
    _values = NUMBERS | (FLOATS if _field != "data" else {})
    lines(_kind.__name__, **{name: _sent(_kind, _field, value) for name, value in _values.items()})
lines("covariance", **{n: _sent(PoseWithCovariance, "covariance", v) for n, v in COVARIANCES.items()})
# Programs that misspell an attribute pass by the setters: C then reads any sequence, and a buffer as it is.
for _name in ("ints", "tuple", "range", "empty"):
    lines(
        "slot",
        **{
            f"{_kind.__name__}.{_name}": _sent(_kind, f"_{_field}", NUMBERS[_name])
            for _kind, _field in FIELDS[2:]
        },
    )
lines("slot", doubles=_sent(JointState, "_position", [1.5, 2.5]), floats=_sent(LaserScan, "_ranges", (1.5,)))
lines("slot", octets=_sent(UInt8MultiArray, "_data", b"ab"))

if __name__ == "__main__":
    main()
