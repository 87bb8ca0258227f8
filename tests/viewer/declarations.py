"""TypeScript declarations of the messages to and from a page; run this file to write them again."""

import inspect
from collections.abc import Mapping
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, get_args, get_origin, get_type_hints

from msgspec import NODEFAULT
from msgspec.structs import fields

from course_lib.displays.panel import panels, protocol
from course_lib.displays.views import DragRules
from course_lib.viewer import html
from course_lib.viewer.encoding import Message
from course_lib.viewer.page_link import Click

PATH = Path(html.__file__).parent / "js" / "protocol.d.ts"
_PLAIN = {str: "string", float: "number", int: "number", bool: "boolean", Any: "any", NoneType: "null"}
_HEAD = "// Generated from Python's messages: python -m tests.viewer.declarations\n"


def declarations() -> str:
    """Return the declarations of all messages, and of the union of the commands."""
    written = [Click, DragRules, *_own(protocol), *_own(panels)]
    names = [kind.__name__ for kind in get_args(protocol.AnyCommand)]
    commands = "".join(f'\n  | ({{ act: "{name}" }} & {name})' for name in names)
    return "\n".join([_HEAD, *map(_interface, written), f"export type Command ={commands};\n"])


def _own(module: Any) -> list[type]:
    """Return the messages that a module defines, in its order."""
    return [kind for kind in vars(module).values() if isinstance(kind, type) and _is_own(kind, module)]


def _is_own(kind: type, module: Any) -> bool:
    return issubclass(kind, Message) and kind.__module__ == module.__name__ and kind is not protocol.Command


def _interface(kind: type) -> str:
    hints = get_type_hints(kind, include_extras=True)
    lines = [
        f"/** {' '.join((inspect.getdoc(kind) or '').split())} */",
        f"export interface {kind.__name__} {{",
    ]
    for field in fields(kind):
        wanted, has_default = hints[field.name], field.default is not NODEFAULT
        if has_default and isinstance(wanted, UnionType):  # left out instead of null
            wanted = get_args(wanted)[0]
        lines.append(f"  {field.encode_name}{'?' * has_default}: {_type(wanted)};")
    return "\n".join([*lines, "}", ""])


def _type(wanted: Any) -> str:
    origin, arguments = get_origin(wanted), get_args(wanted)
    if origin is Annotated:
        return str(arguments[1])
    if origin is Literal:
        return " | ".join(f'"{value}"' for value in arguments)
    if isinstance(wanted, UnionType):
        return " | ".join(map(_type, arguments))
    if origin is Mapping:
        return f"Record<{_type(arguments[0])}, {_type(arguments[1])}>"
    if origin is tuple and arguments[-1] is ...:
        return f"{_type(arguments[0])}[]"
    if origin is tuple:
        return f"[{', '.join(map(_type, arguments))}]"
    return _PLAIN.get(wanted) or str(wanted.__name__)


if __name__ == "__main__":
    PATH.write_text(declarations(), "utf-8")
