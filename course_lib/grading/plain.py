"""Values as plain data: the only form in which they leave a student's code."""

from itertools import islice
from typing import Any

import numpy as np

MAX_ITEMS = 200_000
MAX_DEPTH = 20
MAX_TEXT = 100_000  # characters
MAX_INT = 2**63
RAISED = {"object": "nothing, as the call raised an exception"}  # in place of a returned value


def plain(value: Any) -> Any:
    """Turn numbers, texts, arrays, messages and containers of them into plain Python values.

    What is none of these, or too large, becomes `{"object": what it is}`, which no check expects.
    """
    return _plain(value, MAX_DEPTH, [MAX_ITEMS])


def is_plain(value: Any, depth: int = MAX_DEPTH + 3) -> bool:
    """Whether a value from outside is what `plain` makes."""
    if depth < 0:
        return False
    if type(value) is list:
        return len(value) <= MAX_ITEMS and all(is_plain(item, depth - 1) for item in value)
    if type(value) is dict:
        items = value.items()
        return all(type(key) is str and is_plain(item, depth - 1) for key, item in items)
    if type(value) is str:
        return len(value) <= MAX_TEXT
    return value is None or type(value) in (bool, int, float)


def _plain(value: Any, depth: int, room: list[int]) -> Any:
    room[0] -= 1
    if depth < 0 or room[0] < 0:
        return {"object": "a value too deep or too large"}
    if isinstance(value, np.generic):
        value = value.item()
    if value is None or type(value) in (bool, float):
        return value
    if type(value) is int:
        return value if abs(value) < MAX_INT else {"object": "an integer of more than 63 bits"}
    if isinstance(value, str):
        return str(value)[:MAX_TEXT].encode("utf-8", "replace").decode()
    if isinstance(value, np.ndarray):
        value = value.tolist() if value.size <= room[0] else None
        return _plain(value, depth, room) if value is not None else {"object": "an array too large"}
    if isinstance(value, (list, tuple)):
        return [_plain(item, depth - 1, room) for item in islice(value, max(room[0], 0))]
    if isinstance(value, dict):
        return {str(key): _plain(item, depth - 1, room) for key, item in value.items()}
    return _message(value, depth, room)


def _message(value: Any, depth: int, room: list[int]) -> Any:
    from course_lib.ros.messages import Message, to_plain

    if isinstance(value, Message):
        return _plain(to_plain(value), depth - 1, room)
    return {"object": f"a {type(value).__name__}"}
