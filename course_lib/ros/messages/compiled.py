"""Functions compiled for one message class, for messages that come by the million: points, colours."""

import os
from collections.abc import Callable, Iterable, Mapping
from keyword import iskeyword
from typing import Any

from course_lib.ros.messages.kinds import Kind

# To check each assignment is the kit's default, as it was Humble's; Jazzy leaves it to publishing.
CHECKED = os.environ.get("ROS_PYTHON_CHECK_FIELDS", "1") != "0"
_UNSET = object()  # stands for a field that was not given


def constructor(kinds: Mapping[str, Kind], general: Callable[..., None]) -> Callable[..., None]:
    """Return an `__init__` that does what `general` does; what it needs no check for, it keeps at once."""
    if any(map(iskeyword, kinds)):
        return general
    scope: dict[str, Any] = {
        "_unset": _UNSET,
        "_general": general,
        "_type": type,
    }  # a field may be called type
    body = ["if _args or _unknown or check_fields is not True:"]
    given = "".join(f"{name!r}: {name}, " for name in kinds)
    body += [
        f"    _given = {{name: value for name, value in {{{given}}}.items() if value is not _unset}}",
        "    return _general(_self, *_args, check_fields=check_fields, **_given, **_unknown)",
        "_self._check_fields = True",
    ]
    for name, kind in kinds.items():
        shares = kind.exact in (bool, float, str) or kind.default is int  # the same value for all messages
        scope |= {
            f"_{name}_default": kind.default() if shares else kind.default,
            f"_{name}_exact": kind.exact,
            f"_{name}_of": kind.construct,
        }
        body += [f"if {name} is _unset: _self._{name} = _{name}_default{'' if shares else '()'}"]
        if kind.exact is not None:
            body += [f"elif _type({name}) is _{name}_exact: _self._{name} = {name}"]
        body += [f"else: _self.{name} = {name if kind.construct is None else f'_{name}_of({name})'}"]
    named = (f"check_fields={CHECKED}", *(f"{name}=_unset" for name in kinds))
    return compiled("__init__", f"_self, *_args, {', '.join(named)}, **_unknown", body, scope)


def maker(cls: type) -> Callable[..., Any]:
    """Return a function that makes a message of all values as sent, and the messages in its fields."""
    scope: dict[str, Any] = {}
    values: list[str] = []
    body = making(cls, "m", scope, values)
    return compiled("make", ", ".join(values), [*body, "return m"], scope)


def making(cls: Any, name: str, scope: dict[str, Any], values: list[str]) -> list[str]:
    """Return the lines that make one message under a name, and note what they need."""
    scope |= {f"{name}_new": cls.__new__, f"{name}_cls": cls}
    body = [f"{name} = {name}_new({name}_cls)", f"{name}._check_fields = {CHECKED}"]
    for field, kind in cls._KINDS.items():
        inner = f"{name}_{field}"
        if hasattr(kind.exact, "_KINDS"):
            body += [*making(kind.exact, inner, scope, values), f"{name}._{field} = {inner}"]
            continue
        values.append(f"v{len(values)}")
        scope[f"{inner}_of"] = kind.from_wire
        body += [f"{name}._{field} = {values[-1] if kind.from_wire is None else f'{inner}_of({values[-1]})'}"]
    if not cls._KINDS:
        values.append(f"v{len(values)}")  # the placeholder of a message without fields
    return body


def compiled(name: str, arguments: str, body: Iterable[str], scope: dict[str, Any]) -> Callable[..., Any]:
    """Return the function with these lines, which finds `scope` as its globals."""
    lines = "\n".join(f"    {line}" for line in body)
    source = f"def {name}({arguments}):\n{lines}"  # the names are those of a checked definition
    exec(compile(source, f"{__file__}:{name}", "exec"), scope)  # a file of the kit: left out of tracebacks
    function: Callable[..., Any] = scope[name]
    return function
