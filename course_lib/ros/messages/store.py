"""rosbags' store of compiled functions, for our own classes."""

import re
from collections.abc import Callable
from functools import cache, partial
from typing import Any, NoReturn

from rosbags.interfaces import Msgdef
from rosbags.serde import SerdeError
from rosbags.serde.cdr import generate_deserialize_cdr, generate_getsize_cdr, generate_serialize_cdr
from rosbags.typesys.store import Typestore

from course_lib.ros.messages.kinds import CONVERTED


class CdrStore(Typestore):
    """A store that compiles only what CDR needs, a third of the work.

    rosbags reads a field twice: for the size and for the bytes. A field that is converted for the bytes has
    the same size in its slot.
    """

    malformed = SerdeError  # raised for bytes that are of another type

    def get_msgdef(self, typename: str) -> Msgdef[object]:
        """Return the functions of a type, compiled when it is first asked for."""
        found = self.cache.get(typename)
        if found is None:
            found = self.cache[typename] = self._compiled(typename)
        return found

    def pack(self, message: object, typename: str) -> bytes:
        """Return a message's CDR bytes, little endian."""
        functions = self.get_msgdef(typename)
        data = bytearray(4 + functions.getsize_cdr(0, message, self))
        data[1] = 1  # little endian
        end = functions.serialize_cdr_le(memoryview(data)[4:], 0, message, self)
        if end + 4 != len(data):
            raise ValueError(f"{typename} takes {end} bytes, expected {len(data) - 4}")
        return bytes(data)

    def _compiled(self, typename: str) -> Msgdef[object]:
        entries = self.fielddefs[typename][1]
        slots = [(re.sub(rf"\b{CONVERTED}", "_", name), kind) for name, kind in entries]
        getsize, size = generate_getsize_cdr(slots, self)
        write, read = (
            [generate(entries, self, "le"), _when_called(partial(generate, entries, self, "be"))]
            for generate in (generate_serialize_cdr, generate_deserialize_cdr)
        )
        rest: list[Any] = [*write, *read, 0, *[_no_ros1] * 7]
        return Msgdef(typename, entries, self.types[typename], size, getsize, *rest)


def _when_called(generate: Callable[[], Callable[..., Any]]) -> Callable[..., Any]:
    """Return a function that is compiled when it is first called: hardly a message is big endian."""
    compiled = cache(generate)
    return lambda *arguments: compiled()(*arguments)


def _no_ros1(*_: object) -> NoReturn:
    raise NotImplementedError("messages of ROS 1 are not read or written here")
