"""The primitive types of .msg files."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True)
class Primitive:
    """One primitive: its name in ROS's IDL, its Python type, for numbers the range and the array code."""

    ros_name: str
    python: type
    code: str = ""  # of array.array and numpy; "" if ROS keeps sequences of it as lists
    low: float = 0  # the range that ROS checks; numbers only
    high: float = 0
    range_word: str = ""  # "integer" in "an integer in [-128, 127]"; "" if any value fits

    @property
    def dtype(self) -> "np.dtype[np.generic]":
        """The numpy type of one element."""
        return np.dtype(self.code or bool)


def _integer(ros_name: str, code: str) -> Primitive:
    limits = np.iinfo(np.dtype(code))
    word = "integer" if limits.min else "unsigned integer"
    return Primitive(ros_name, int, code, int(limits.min), int(limits.max), word)


PRIMITIVES: Mapping[str, Primitive] = {
    "bool": Primitive("boolean", bool),
    "byte": Primitive("octet", bytes),
    "char": _integer("uint8", "B"),
    "int8": _integer("int8", "b"),
    "uint8": _integer("uint8", "B"),
    "int16": _integer("int16", "h"),
    "uint16": _integer("uint16", "H"),
    "int32": _integer("int32", "i"),
    "uint32": _integer("uint32", "I"),
    "int64": _integer("int64", "q"),
    "uint64": _integer("uint64", "Q"),
    "float32": Primitive("float", float, "f", -3.402823466e38, 3.402823466e38, "float"),
    "float64": Primitive("double", float, "d", -1.7976931348623157e308, 1.7976931348623157e308, "double"),
    "string": Primitive("string", str),
}
