"""Functions that write the CDR bytes of one message type, compiled from its fields.

Neighbouring numbers are written by one call of `struct`, also across the messages in fields.
"""

import struct
from collections.abc import Callable
from functools import cache
from typing import Any

from course_lib.ros.messages.cdr_layout import CODES, LENGTH, LITTLE, CdrLayout, even_row, size_of
from course_lib.ros.messages.compiled import compiled
from course_lib.ros.messages.definitions import PRIMITIVES, FieldDefinition

FRONT = b"\0\1\0\0"  # little endian; places are counted from behind it
PADS = {  # by size of what follows: the zeros before it, by the remainder of the bytes so far
    size: tuple(bytes((4 - before) % size) for before in range(size)) for size in (2, 4, 8)
}


class _Writer(CdrLayout):
    """A function that appends to the bytearray `out`."""

    def __init__(self, step: int) -> None:
        super().__init__(LITTLE, step)
        self.scope |= {"length": struct.Struct(LITTLE + LENGTH).pack, "front": FRONT}
        self.scope |= {f"pad{size}": pads for size, pads in PADS.items()}

    def pad(self, size: int) -> str:
        return f"out += pad{size}[len(out) & {size - 1}]"

    def move(self, row: struct.Struct, names: list[str]) -> list[str]:
        return [f"out += {self.keep(row.pack)}({', '.join(names)})"]

    def inner(self, path: str) -> str:
        return self._local(path)

    def scalar(self, code: str, path: str) -> None:
        self.number(code, path or "0")

    def text(self, path: str) -> None:
        octets = self._local(f"({path} + '\\0').encode()")
        self.number(LENGTH, f"len({octets})")
        self._append(octets, 1)

    def container(self, field: FieldDefinition, kind: Any, path: str) -> None:
        code, is_array = CODES.get(field.base, ""), field.container == "array"
        if PRIMITIVES.get(field.base) and PRIMITIVES[field.base].code:
            values = self._local(f"{path}.tobytes()" if is_array else path)
            size = field.size * size_of(code)
            wrong = f"len({values}) != {size}" if is_array else f"{values}.typecode != {code!r}"
        else:
            values = self._local(f"{self.keep(kind.to_wire)}({path})")
            wrong = f"len({values}) != {field.size}" if is_array else ""
        if wrong:
            self.lines.append(f"if {wrong}: raise TypeError({field.name!r})")
        if not is_array:
            self.number(LENGTH, f"len({values})")
        if not code:
            self._each(field, values)
        elif is_array:
            self.align(size_of(code))
            self._append(values, size_of(code))
        else:
            self.flush()
            self.lines += [f"if {values}: {self.pad(8)}"] * (size_of(code) == 8)
            self._append(values, min(size_of(code), 4))

    def _each(self, field: FieldDefinition, values: str) -> None:
        """Add strings or messages."""
        self.flush()
        row = even_row(field.base) if field.is_message else None
        if row is not None:
            pack = self.keep(struct.Struct(LITTLE + row.format).pack)
            self.lines += [f"if {values}: {self.pad(row.size)}"] * (row.size > 1)
            self.lines.append(f"out += b''.join([{pack}({', '.join(row.numbers)}) for t in {values}])")
        elif field.is_message:
            self.lines.append(f"for t in {values}: {self.keep(_appender(field.base))}(out, t)")
        else:
            self.lines += [f"for t in {values}:", "    t = (t + '\\0').encode()", f"    {self.pad(4)}"]
            self.lines += ["    out += length(len(t))", "    out += t"]
        self.known(1)

    def _local(self, expression: str) -> str:
        name = f"v{next(self.names)}"
        self.lines.append(f"{name} = {expression}")
        return name

    def _append(self, octets: str, step: int) -> None:
        self.flush()
        self.lines.append(f"out += {octets}")
        self.known(step)


@cache
def packer(type_name: str) -> Callable[[Any], bytes]:
    """Return the function that writes a message, little endian."""
    writer = _Writer(8)
    writer.fields(type_name, "m")
    writer.flush()
    body = ["out = bytearray(front)", *writer.lines, "return bytes(out)"]
    return compiled("pack", "m", body, writer.scope)


@cache
def _appender(type_name: str) -> Callable[[bytearray, Any], None]:
    """Return the function that appends a message of a list to bytes."""
    writer = _Writer(1)
    writer.fields(type_name, "m")
    writer.flush()
    return compiled("append", "out, m", writer.lines, writer.scope)
