"""Functions that read the CDR bytes of one message type, compiled from its fields."""

import struct
from array import array
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from course_lib.ros.messages.cdr_layout import BIG, CODES, LENGTH, LITTLE, CdrLayout, even_row, size_of
from course_lib.ros.messages.compiled import compiled, maker, making
from course_lib.ros.messages.definitions import PRIMITIVES, FieldDefinition
from course_lib.ros.messages.registry import message_class

ORDERS = {b"\0\1": LITTLE, b"\0\0": BIG}  # by the first two of the four bytes in front
MALFORMED = (struct.error, ValueError, IndexError)  # raised for bytes of another type
TOO_SHORT = "raise ValueError('they end in a list')"


class _Reader(CdrLayout):
    """A function that reads the bytes `data` from `pos` on; `values` are the names of what it has read."""

    def __init__(self, order: str, step: int) -> None:
        super().__init__(order, step)
        self.values: list[str] = []
        self.scope |= {"array": array, "frombuffer": np.frombuffer, "text_at": _text_at}
        self.scope["length_at"] = struct.Struct(order + LENGTH).unpack_from

    def pad(self, size: int) -> str:
        return "pos = (pos + 3 & -8) + 4" if size == 8 else f"pos = pos + {size - 1} & -{size}"

    def move(self, row: struct.Struct, names: list[str]) -> list[str]:
        targets = f"{', '.join(names)}, = " if names else ""
        return [f"{targets}{self.keep(row.unpack_from)}(data, pos)", f"pos += {row.size}"]

    def inner(self, path: str) -> str:
        return path

    def scalar(self, code: str, path: str) -> None:
        self.number(code, self._value())

    def text(self, path: str) -> None:
        value = self._value()
        self.number(LENGTH, "n")
        self.flush()
        self.lines += [f"{value} = text_at(data, pos, n)", "pos += n"]
        self.known(1)

    def container(self, field: FieldDefinition, kind: Any, path: str) -> None:
        value, code = self._value(), CODES.get(field.base, "")
        if field.container == "array":
            self.align(size_of(code) if code else 1)
            self.flush()
            self.lines.append(f"n = {field.size}")
        else:
            self.number(LENGTH, "n")
            self.flush()
        if not code:
            self._each(field, value)
            return
        if field.container == "sequence" and size_of(code) == 8:
            self.lines.append(f"if n: {self.pad(8)}")
        self.lines.append(f"end = pos + n * {size_of(code)}")
        self.lines += self._block(field, value, code)
        self.lines.append("pos = end")
        self.known(min(size_of(code), 4))

    def _block(self, field: FieldDefinition, value: str, code: str) -> list[str]:
        """Return the lines that read n numbers, up to `end`, as their kind is made of them."""
        primitive, swaps = PRIMITIVES[field.base], self._order == BIG
        if primitive.code and field.container == "array":
            read = f"{value} = frombuffer(data, {code!r}, n, pos)"
            return [f"{read}{'.byteswap()' if swaps else '.copy()'}"]
        octets = f"array({code!r}, data[pos:end])" if primitive.code else "data[pos:end]"
        swap = [f"{value}.byteswap()"] * (swaps and bool(primitive.code))
        return [f"if end > len(data): {TOO_SHORT}", f"{value} = {octets}", *swap]

    def _each(self, field: FieldDefinition, value: str) -> None:
        """Read n strings or messages."""
        row = even_row(field.base) if field.is_message else None
        if row is not None:
            make = self.keep(maker(message_class(field.base)))
            rows = self.keep(struct.Struct(self._order + row.format))
            self.lines += [f"if n: {self.pad(row.size)}"] * (row.size > 1)
            self.lines += [f"end = pos + n * {rows}.size"]
            self.lines += [f"if end > len(data): {TOO_SHORT}"]
            self.lines += [f"{value} = [{make}(*t) for t in {rows}.iter_unpack(data[pos:end])]", "pos = end"]
        else:
            self.lines += [f"{value} = []", "for _ in range(n):"]
            if field.is_message:
                read = self.keep(_reader_at(field.base, self._order))
                self.lines += [f"    t, pos = {read}(data, pos)"]
            else:
                self.lines += [f"    {self.pad(4)}", "    n, = length_at(data, pos)"]
                self.lines += ["    t = text_at(data, pos + 4, n)", "    pos += 4 + n"]
            self.lines += [f"    {value}.append(t)"]
        self.known(1)

    def _value(self) -> str:
        self.values.append(f"v{len(self.values)}")
        return self.values[-1]


def _text_at(data: bytes, pos: int, size: int) -> str:
    """Return the string of so many bytes, of which the last is 0."""
    end = pos + size
    if size == 0 or data[end - 1]:
        raise ValueError(f"a string of {size} bytes does not end with 0")
    return data[pos : end - 1].decode()


@cache
def unpacker(type_name: str, order: str) -> Callable[[bytes], Any]:
    """Return the function that reads a message; it raises one of `MALFORMED` for bytes of another type."""
    reader = _Reader(order, 8)
    lines = ["pos = 4", *_reading(reader, type_name)]
    lines += ["if pos + 3 < len(data): raise ValueError(f'it has {pos} bytes')", "return m"]
    return compiled("unpack", "data", lines, reader.scope)


@cache
def _reader_at(type_name: str, order: str) -> Callable[[bytes, int], tuple[Any, int]]:
    """Return the function that reads a message of a list; it returns the place behind it, too."""
    reader = _Reader(order, 1)
    lines = [*_reading(reader, type_name), "return m, pos"]
    return compiled("read", "data, pos", lines, reader.scope)


def _reading(reader: _Reader, type_name: str) -> list[str]:
    reader.fields(type_name, "m")
    reader.flush()
    values: list[str] = []
    made = making(message_class(type_name), "m", reader.scope, values)
    return [*reader.lines, *made]
