"""Messages as plain Python values."""

from array import array
from typing import Any

import numpy as np

from course_lib.ros.messages.message import Message


def to_plain(value: Any, truncate: int | None = None) -> Any:
    """Turn a message, or a field's value, into dicts, lists, strings and numbers, in the fields' order.

    Follows rosidl_runtime_py.convert: bytes become a string of as many characters; lists and strings longer
    than `truncate` end in "...".
    """
    if isinstance(value, Message):
        return {name: to_plain(getattr(value, name), truncate) for name in value._KINDS}
    if isinstance(value, bytes | bytearray):
        value = value.decode("latin-1")
    long = truncate is not None and not isinstance(value, bool | int | float) and len(value) > truncate
    if isinstance(value, str):
        return value[:truncate] + "..." if long else value
    if isinstance(value, list | tuple | array | np.ndarray):
        shown = value[:truncate] if long else value
        return [*_elements(shown, truncate), *(["..."] if long else [])]
    return value.item() if isinstance(value, np.generic) else value


def _elements(values: Any, truncate: int | None) -> list[Any]:
    if isinstance(values, array | np.ndarray):
        return list(values.tolist())
    return [to_plain(value, truncate) for value in values]
