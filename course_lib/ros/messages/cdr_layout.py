"""The layout of CDR bytes: which numbers of a message lie side by side, and where they are aligned."""

import struct
from collections.abc import Iterator
from functools import cache
from itertools import count
from typing import Any, NamedTuple

from course_lib.ros.messages.definitions import PRIMITIVES, FieldDefinition, definition
from course_lib.ros.messages.registry import message_class

LITTLE, BIG = "<", ">"  # orders of the bytes in a number
CODES = {"bool": "?", "byte": "c", **{name: row.code for name, row in PRIMITIVES.items() if row.code}}
LENGTH = "I"  # before strings and sequences


def size_of(code: str) -> int:
    """Return the bytes of a number, which is also what it is aligned to."""
    return struct.calcsize(LITTLE + code)


class EvenRow(NamedTuple):
    """A message of numbers only that lies in a list without gaps between it and the next.

    Args:
        format: Of `struct`, without the order of bytes.
        numbers: The expressions of its numbers, of a message `t`.
        size: Of what it is aligned to.
    """

    format: str
    numbers: tuple[str, ...]
    size: int


@cache
def even_row(type_name: str) -> EvenRow | None:
    """Return the row of a type's messages; None for one with other fields, or whose rows have gaps."""
    numbers = list(_numbers(type_name, "t"))
    codes = [code for code, _ in numbers]
    sizes = {size_of(code) for code in codes if code}
    if "" in codes or len(sizes) != 1:
        return None
    return EvenRow("".join(codes), tuple(name for _, name in numbers), sizes.pop())


def _numbers(type_name: str, path: str) -> Iterator[tuple[str, str]]:
    """Yield code and path of each number of a message, also in its fields; ("", "") for what is none."""
    if not message_class(type_name)._KINDS:
        yield "B", "0"
        return
    for field in definition(type_name).fields:
        inner = f"{path}._{field.name}"
        if field.container != "scalar" or field.base == "string":
            yield "", ""
        elif field.is_message:
            yield from _numbers(field.base, inner)
        else:
            yield CODES[field.base], inner


class CdrLayout:
    """Lines of a function, and what is known of the place in the bytes: its remainder by a step.

    Args:
        order: Of the bytes in a number.
        step: Of the alignment known at the begin: 8 where the bytes begin, else 1.
    """

    def __init__(self, order: str, step: int) -> None:
        self.lines: list[str] = []
        self.scope: dict[str, Any] = {}
        self.names = count()
        self._order, self._step, self._rest = order, step, 0
        self._format, self._numbers = "", list[str]()

    def number(self, code: str, name: str) -> None:
        """Add a number to those that are written or read by the next call."""
        self.align(size_of(code))
        self._format += code
        self._numbers.append(name)
        self._rest = (self._rest + size_of(code)) % self._step

    def align(self, size: int) -> None:
        """Go on at a multiple of a size."""
        if size > self._step:
            self.flush()
            self.lines.append(self.pad(size))
            self.known(size)
        pad = -self._rest % size
        self._format += "x" * pad
        self._rest = (self._rest + pad) % self._step

    def flush(self) -> None:
        """Write or read the numbers that wait."""
        if self._format:
            row = struct.Struct(self._order + self._format)
            self.lines += self.move(row, self._numbers)
            self._format, self._numbers = "", []

    def known(self, step: int) -> None:
        """Note that the place is a multiple of a step."""
        self._step, self._rest = step, 0

    def keep(self, value: object) -> str:
        """Return the name of a value in the function's scope."""
        name = f"k{next(self.names)}"
        self.scope[name] = value
        return name

    def fields(self, type_name: str, name: str) -> None:
        """Add all fields of a message, also of the messages in its fields."""
        for field in definition(type_name).fields:
            kind = message_class(type_name)._KINDS.get(field.name)
            if field.is_message and field.container == "scalar":
                self.fields(field.base, self.inner(f"{name}._{field.name}"))
            elif field.container != "scalar":
                self.container(field, kind, f"{name}._{field.name}")
            elif field.base == "string":
                self.text(f"{name}._{field.name}")
            else:
                self.scalar(CODES[field.base], f"{name}._{field.name}" if kind else "")

    def pad(self, size: int) -> str:
        """Return the line that goes on at a multiple of a size."""
        raise NotImplementedError

    def move(self, row: struct.Struct, names: list[str]) -> list[str]:
        """Return the lines that write or read a row of numbers."""
        raise NotImplementedError

    def inner(self, path: str) -> str:
        """Return the name under which the fields of a message in a field are found."""
        raise NotImplementedError

    def scalar(self, code: str, path: str) -> None:
        """Add a field that is a number; without a path, the byte of a message without fields."""
        raise NotImplementedError

    def text(self, path: str) -> None:
        """Add a field that is a string."""
        raise NotImplementedError

    def container(self, field: FieldDefinition, kind: Any, path: str) -> None:
        """Add a field that holds several of its kind."""
        raise NotImplementedError
