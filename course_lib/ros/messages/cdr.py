"""A compiler from message definitions to functions that serialize and deserialize CDR.

For each type it generates the source code of one function that packs or unpacks as many numbers as
possible with a single call of `struct`. That is much faster than visiting the fields one by one,
which matters for markers with 100,000 points. `CdrLayout` keeps track of the alignment, which is
often known at compile time; `_Reader` and `_Writer` emit the lines.
"""

import struct
from array import array
from collections.abc import Callable, Iterator
from functools import cache
from itertools import count
from struct import error as StructError  # noqa: N812  # a class under a lower-case name
from typing import Any, NamedTuple, TypeVar

import numpy as np

from course_lib.errors import CourseError
from course_lib.ros.messages.definitions import PRIMITIVES, FieldDefinition, definition
from course_lib.ros.messages.message import (
    RosMessage,
    compile_factory,
    compile_function,
    factory_lines,
    message_class,
)

# Byte orders, as `struct` denotes them.
LITTLE, BIG = "<", ">"
CODES = {"bool": "?", "byte": "c", **{name: row.code for name, row in PRIMITIVES.items() if row.code}}
# The code of the length that precedes strings and sequences.
LENGTH = "I"


def size_of(code: str) -> int:
    """Return the size of a number in bytes, which is also its alignment."""
    return struct.calcsize(LITTLE + code)


class PackedRow(NamedTuple):
    """A message of numbers only, which is packed without gaps in a list of such messages.

    Args:
        format: The format for `struct`, without the byte order.
        numbers: Expressions for the numbers of a message `t`.
        size: The alignment.
    """

    format: str
    numbers: tuple[str, ...]
    size: int


@cache
def packed_row(type_name: str) -> PackedRow | None:
    """Return the row of a type, or None if it has other fields or its rows have gaps."""
    numbers = list(_numbers(type_name, "t"))
    codes = [code for code, _ in numbers]
    sizes = {size_of(code) for code in codes if code}
    if "" in codes or len(sizes) != 1:
        return None
    return PackedRow("".join(codes), tuple(name for _, name in numbers), sizes.pop())


def _numbers(type_name: str, path: str) -> Iterator[tuple[str, str]]:
    """Yield (code, path) for each number of a message, nested or not, and ("", "") for other fields."""
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
    """The lines of a generated function, and the position in the bytes modulo a known alignment.

    Args:
        order: The byte order.
        step: The alignment known at the start: 8 at the start of the bytes, else 1.
    """

    def __init__(self, order: str, step: int) -> None:
        self.lines: list[str] = []
        self.scope: dict[str, Any] = {}
        self._name_numbers = count()
        self._order, self._step, self._offset = order, step, 0
        self._format, self._numbers = "", list[str]()

    def add_number(self, code: str, name: str) -> None:
        """Add a number to the row that the next call packs or unpacks."""
        self.align(size_of(code))
        self._format += code
        self._numbers.append(name)
        self._offset = (self._offset + size_of(code)) % self._step

    def align(self, size: int) -> None:
        """Align the position to a multiple of `size`."""
        if size > self._step:
            self.flush()
            self.lines.append(self.pad_line(size))
            self.set_alignment(size)
        pad = -self._offset % size
        self._format += "x" * pad
        self._offset = (self._offset + pad) % self._step

    def flush(self) -> None:
        """Emit the call that packs or unpacks the numbers collected so far."""
        if self._format:
            row = struct.Struct(self._order + self._format)
            self.lines += self.transfer_lines(row, self._numbers)
            self._format, self._numbers = "", []

    def set_alignment(self, step: int) -> None:
        """Record that the position is a multiple of `step`."""
        self._step, self._offset = step, 0

    def add_to_scope(self, value: object) -> str:
        """Add a value to the function's scope and return its name."""
        name = f"k{next(self._name_numbers)}"
        self.scope[name] = value
        return name

    def add_fields(self, type_name: str, name: str) -> None:
        """Add all fields of a message and of its nested messages."""
        for field in definition(type_name).fields:
            kind = message_class(type_name)._KINDS.get(field.name)
            if field.is_message and field.container == "scalar":
                self.add_fields(field.base, self.inner_path(f"{name}._{field.name}"))
            elif field.container != "scalar":
                self.add_container(field, kind, f"{name}._{field.name}")
            elif field.base == "string":
                self.add_text(f"{name}._{field.name}")
            else:
                self.add_scalar(CODES[field.base], f"{name}._{field.name}" if kind else "")

    def pad_line(self, size: int) -> str:
        """Return the line that advances to a multiple of `size`."""
        raise NotImplementedError

    def transfer_lines(self, row: struct.Struct, names: list[str]) -> list[str]:
        """Return the lines that pack or unpack numbers."""
        raise NotImplementedError

    def inner_path(self, path: str) -> str:
        """Return the name by which the fields of a nested message are accessed."""
        return path

    def add_scalar(self, code: str, path: str) -> None:
        """Add a number field.

        Without a path, add the placeholder byte of a message without fields.
        """
        raise NotImplementedError

    def add_text(self, path: str) -> None:
        """Add a string field."""
        raise NotImplementedError

    def add_container(self, field: FieldDefinition, kind: Any, path: str) -> None:
        """Add an array or sequence field."""
        raise NotImplementedError


# By the first two bytes of the encapsulation header.
ORDERS = {b"\0\1": LITTLE, b"\0\0": BIG}
# The exceptions raised for bytes of another type.
MALFORMED = (struct.error, ValueError, IndexError)
TOO_SHORT = "raise ValueError('they end in a list')"


class _Reader(CdrLayout):
    """Generates a function that reads the bytes `data` from `pos`.

    `values` are the names of the values read.
    """

    def __init__(self, order: str, step: int) -> None:
        super().__init__(order, step)
        self.values: list[str] = []
        self.scope |= {"array": array, "frombuffer": np.frombuffer, "text_at": _text_at}
        self.scope["length_at"] = struct.Struct(order + LENGTH).unpack_from

    def pad_line(self, size: int) -> str:
        return "pos = (pos + 3 & -8) + 4" if size == 8 else f"pos = pos + {size - 1} & -{size}"

    def transfer_lines(self, row: struct.Struct, names: list[str]) -> list[str]:
        targets = f"{', '.join(names)}, = " if names else ""
        return [f"{targets}{self.add_to_scope(row.unpack_from)}(data, pos)", f"pos += {row.size}"]

    def add_scalar(self, code: str, path: str) -> None:
        self.add_number(code, self._value())

    def add_text(self, path: str) -> None:
        value = self._value()
        self.add_number(LENGTH, "n")
        self.flush()
        self.lines += [f"{value} = text_at(data, pos, n)", "pos += n"]
        self.set_alignment(1)

    def add_container(self, field: FieldDefinition, kind: Any, path: str) -> None:
        value, code = self._value(), CODES.get(field.base, "")
        if field.container == "array":
            self.align(size_of(code) if code else 1)
            self.flush()
            self.lines.append(f"n = {field.size}")
        else:
            self.add_number(LENGTH, "n")
            self.flush()
        if not code:
            self._add_elements(field, value)
            return
        if field.container == "sequence" and size_of(code) == 8:
            self.lines.append(f"if n: {self.pad_line(8)}")
        self.lines.append(f"end = pos + n * {size_of(code)}")
        primitive, swaps = PRIMITIVES[field.base], self._order == BIG
        if primitive.code and field.container == "array":
            copy = ".byteswap()" if swaps else ".copy()"
            self.lines.append(f"{value} = frombuffer(data, {code!r}, n, pos){copy}")
        else:
            octets = f"array({code!r}, data[pos:end])" if primitive.code else "data[pos:end]"
            self.lines += [f"if end > len(data): {TOO_SHORT}", f"{value} = {octets}"]
            if swaps and primitive.code:
                self.lines.append(f"{value}.byteswap()")
        self.lines.append("pos = end")
        self.set_alignment(min(size_of(code), 4))

    def _add_elements(self, field: FieldDefinition, value: str) -> None:
        """Read n strings or messages."""
        row = packed_row(field.base) if field.is_message else None
        if row is not None:
            make = self.add_to_scope(compile_factory(message_class(field.base)))
            rows = self.add_to_scope(struct.Struct(self._order + row.format))
            self.lines += [f"if n: {self.pad_line(row.size)}"] * (row.size > 1)
            self.lines += [f"end = pos + n * {rows}.size"]
            self.lines += [f"if end > len(data): {TOO_SHORT}"]
            self.lines += [f"{value} = [{make}(*t) for t in {rows}.iter_unpack(data[pos:end])]", "pos = end"]
        else:
            self.lines += [f"{value} = []", "for _ in range(n):"]
            if field.is_message:
                reader = self.add_to_scope(_reader_at(field.base, self._order))
                self.lines += [f"    t, pos = {reader}(data, pos)"]
            else:
                self.lines += [f"    {self.pad_line(4)}", "    n, = length_at(data, pos)"]
                self.lines += ["    t = text_at(data, pos + 4, n)", "    pos += 4 + n"]
            self.lines += [f"    {value}.append(t)"]
        self.set_alignment(1)

    def _value(self) -> str:
        self.values.append(f"v{len(self.values)}")
        return self.values[-1]


def _text_at(data: bytes, pos: int, size: int) -> str:
    """Return a string of `size` bytes, including the terminating 0."""
    end = pos + size
    if size == 0 or data[end - 1]:
        raise ValueError(f"a string of {size} bytes does not end with 0")
    return data[pos : end - 1].decode()


@cache
def unpacker(type_name: str, order: str) -> Callable[[bytes], Any]:
    """Return the function that deserializes a message.

    It raises one of `MALFORMED` for bytes of another type.
    """
    reader = _Reader(order, 8)
    lines = ["pos = 4", *_read_lines(reader, type_name)]
    # rclpy serializes into a buffer of an estimated size, which leaves up to 8 unused bytes at the
    # end for each sequence of 8-byte numbers.
    tail = 3 + 8 * _count_wide_sequences(type_name)
    lines.append(f"if pos + {tail} < len(data): raise ValueError(f'it has {{pos}} bytes')")
    lines.append("return m")
    return compile_function("unpack", "data", lines, reader.scope)


# Stands for the number of sequences in a list of messages that contain some, so that any tail is
# accepted.
_MANY = 2**40


@cache
def _count_wide_sequences(type_name: str) -> int:
    """Count the sequences of 8-byte numbers in a message and its nested messages."""
    count = 0
    for field in definition(type_name).fields:
        if field.is_message:
            inner = _count_wide_sequences(field.base)
            count += inner if field.container == "scalar" else inner and _MANY
        elif field.container == "sequence" and (code := PRIMITIVES[field.base].code):
            count += size_of(code) == 8
    return count


@cache
def _reader_at(type_name: str, order: str) -> Callable[[bytes, int], tuple[Any, int]]:
    """Return the function that reads a message of a list, to (message, next position)."""
    reader = _Reader(order, 1)
    lines = [*_read_lines(reader, type_name), "return m, pos"]
    return compile_function("read", "data, pos", lines, reader.scope)


def _read_lines(reader: _Reader, type_name: str) -> list[str]:
    reader.add_fields(type_name, "m")
    reader.flush()
    values: list[str] = []
    construction = factory_lines(message_class(type_name), "m", reader.scope, values)
    return [*reader.lines, *construction]


# The encapsulation header for little endian. Positions are counted after it.
FRONT = b"\0\1\0\0"
# Padding by the alignment of the next value, then by the number of bytes so far modulo the
# alignment.
PADS = {size: tuple(bytes((4 - before) % size) for before in range(size)) for size in (2, 4, 8)}


class _Writer(CdrLayout):
    """Generates a function that appends to the bytearray `out`."""

    def __init__(self, step: int) -> None:
        super().__init__(LITTLE, step)
        self.scope |= {"length": struct.Struct(LITTLE + LENGTH).pack, "front": FRONT}
        self.scope |= {f"pad{size}": pads for size, pads in PADS.items()}

    def pad_line(self, size: int) -> str:
        return f"out += pad{size}[len(out) & {size - 1}]"

    def transfer_lines(self, row: struct.Struct, names: list[str]) -> list[str]:
        return [f"out += {self.add_to_scope(row.pack)}({', '.join(names)})"]

    def inner_path(self, path: str) -> str:
        return self._local(path)

    def add_scalar(self, code: str, path: str) -> None:
        self.add_number(code, path or "0")

    def add_text(self, path: str) -> None:
        octets = self._local(f"({path} + '\\0').encode()")
        self.add_number(LENGTH, f"len({octets})")
        self._append(octets, 1)

    def add_container(self, field: FieldDefinition, kind: Any, path: str) -> None:
        code, is_array = CODES.get(field.base, ""), field.container == "array"
        if PRIMITIVES.get(field.base) and PRIMITIVES[field.base].code:
            values = self._local(f"{path}.tobytes()" if is_array else path)
            size = field.size * size_of(code)
            wrong = f"len({values}) != {size}" if is_array else f"{values}.typecode != {code!r}"
        else:
            values = self._local(f"{self.add_to_scope(kind.to_wire)}({path})")
            wrong = f"len({values}) != {field.size}" if is_array else ""
        if wrong:
            self.lines.append(f"if {wrong}: raise TypeError({field.name!r})")
        if not is_array:
            self.add_number(LENGTH, f"len({values})")
        if not code:
            self._add_elements(field, values)
        elif is_array:
            self.align(size_of(code))
            self._append(values, size_of(code))
        else:
            self.flush()
            self.lines += [f"if {values}: {self.pad_line(8)}"] * (size_of(code) == 8)
            self._append(values, min(size_of(code), 4))

    def _add_elements(self, field: FieldDefinition, values: str) -> None:
        """Write strings or messages."""
        self.flush()
        row = packed_row(field.base) if field.is_message else None
        if row is not None:
            pack = self.add_to_scope(struct.Struct(LITTLE + row.format).pack)
            self.lines += [f"if {values}: {self.pad_line(row.size)}"] * (row.size > 1)
            self.lines.append(f"out += b''.join([{pack}({', '.join(row.numbers)}) for t in {values}])")
        elif field.is_message:
            self.lines.append(f"for t in {values}: {self.add_to_scope(_appender(field.base))}(out, t)")
        else:
            self.lines += [f"for t in {values}:", "    t = (t + '\\0').encode()", f"    {self.pad_line(4)}"]
            self.lines += ["    out += length(len(t))", "    out += t"]
        self.set_alignment(1)

    def _local(self, expression: str) -> str:
        name = f"v{next(self._name_numbers)}"
        self.lines.append(f"{name} = {expression}")
        return name

    def _append(self, octets: str, step: int) -> None:
        self.flush()
        self.lines.append(f"out += {octets}")
        self.set_alignment(step)


@cache
def packer(type_name: str) -> Callable[[Any], bytes]:
    """Return the function that serializes a message, in little endian."""
    writer = _Writer(8)
    writer.add_fields(type_name, "m")
    writer.flush()
    body = ["out = bytearray(front)", *writer.lines, "return bytes(out)"]
    return compile_function("pack", "m", body, writer.scope)


@cache
def _appender(type_name: str) -> Callable[[bytearray, Any], None]:
    """Return the function that appends a message of a list to a bytearray."""
    writer = _Writer(1)
    writer.add_fields(type_name, "m")
    writer.flush()
    return compile_function("append", "out, m", writer.lines, writer.scope)


M = TypeVar("M", bound=RosMessage)


def serialize(message: RosMessage) -> bytes:
    """Serialize a message to CDR (little endian, with the 4 bytes of encapsulation header).

    Raises an AssertionError for an invalid value that bypassed the setters, for example by
    ``append``.
    """
    pack = packer(message._TYPE_NAME)
    try:
        return pack(message)
    except (AttributeError, TypeError, ValueError, StructError):
        # A valid value can bypass the setters, too, such as a list in `_data` instead of an array.
        try:
            complete = _set_again(message)
        except AssertionError as complaint:
            raise complaint from None
        return pack(complete)


def deserialize(cdr: bytes, cls: type[M]) -> M:
    """Deserialize a message from CDR. Raise a CourseError if the bytes are of another type."""
    data = bytes(cdr)
    try:
        order = ORDERS.get(data[:2])
        if order is None:
            raise ValueError("unknown encapsulation header")
        message: M = unpacker(cls._TYPE_NAME, order)(data)
    except MALFORMED as error:
        raise CourseError(f"These {len(cdr)} bytes are not a valid {cls._TYPE_NAME}: {error}") from error
    return message


def compile_wire(type_name: str) -> None:
    """Compile a type's functions now, so that forks of this process find them compiled."""
    packer(type_name)
    unpacker(type_name, LITTLE)


def _set_again(message: RosMessage) -> RosMessage:
    """Return a copy whose values went through the checks of the setters, the innermost first."""

    def inner(value: Any) -> Any:
        if isinstance(value, list | tuple):
            return [inner(item) for item in value]
        return _set_again(value) if isinstance(value, RosMessage) else value

    copy = type(message)(check_fields=True)
    for name in message._KINDS:
        setattr(copy, name, inner(getattr(message, name)))
    return copy


def to_plain(value: Any, truncate: int | None = None) -> Any:
    """Convert a message or a field's value to dicts, lists, strings and numbers, in the fields' order.

    Follows rosidl_runtime_py.convert: bytes become a string with one character per byte; lists and
    strings longer than `truncate` end in "...".
    """
    if isinstance(value, RosMessage):
        return {name: to_plain(getattr(value, name), truncate) for name in value._KINDS}
    if isinstance(value, bytes | bytearray):
        value = value.decode("latin-1")
    long = truncate is not None and not isinstance(value, bool | int | float) and len(value) > truncate
    if isinstance(value, str):
        return value[:truncate] + "..." if long else value
    if isinstance(value, list | tuple | array | np.ndarray):
        head = value[:truncate] if long else value
        if isinstance(head, array | np.ndarray):
            items: list[Any] = head.tolist()
        else:
            items = [to_plain(item, truncate) for item in head]
        return [*items, "..."] if long else items
    return value.item() if isinstance(value, np.generic) else value
