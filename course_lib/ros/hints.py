"""Hints: one line that helps with a common mistake, below the text of ROS or Python.

A hint is keyed by the type of the exception, its text, and the mistake with which the raising code marks it
where the text alone does not tell.
"""

import re
import tomllib
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

from course_lib.ros.messages.definitions import FieldDefinition, definition, type_names
from course_lib.ros.mistakes import Mistake, mistake_of
from course_lib.ros.not_offered import not_offered

MAX_TEXT = 2000  # characters of an error's text


@dataclass(frozen=True)
class Hint:
    """The hint for exceptions whose text matches, and that are marked with `mistake` if there is one."""

    text: str
    hint: str  # may name the text's groups: {1}
    mistake: Mistake | None = None


def _hints() -> dict[str, list[Hint]]:
    """Read the hints by the type of their exception: at the start, as a program may use up all its files."""
    table = tomllib.loads(Path(__file__).with_name("hints.toml").read_text(encoding="utf-8"))
    return {kind: [_hint(*row) for row in rows] for kind, rows in table.items()}


def _hint(text: str, line: str, mistake: str = "") -> Hint:
    return Hint(text, line, Mistake[mistake] if mistake else None)


_HINTS = _hints()


def add_hint(error: BaseException) -> None:
    """Add a line "hint: ..." to an error that is a common mistake, once."""
    found = hint(error)
    if found and not getattr(error, "__notes__", None):
        error.add_note(f"hint: {found}")


def hint(error: BaseException) -> str:
    """Return the hint for an exception; "" if there is none."""
    mistake = mistake_of(error)
    text = _text(error)
    types = _types_named(text) if isinstance(error, NameError) else []
    if types:
        package, kind, name = types[0].split("/")
        return f"import it: from {package}.{kind} import {name}; in a notebook run the first cells again."
    if isinstance(error, ModuleNotFoundError) and (reason := not_offered((error.name or "").split(".")[0])):
        return reason
    for one in _HINTS.get(type(error).__name__, ()):
        match = re.search(one.text, text)
        if match and one.mistake in (None, mistake):
            return one.hint.format(match[0], *match.groups())
    if types := _types_named(text):
        return f"{_meant(text, types)}%ros2 interface show {' or '.join(types)} lists its fields."
    return _of_own_class(error, text)


def _text(error: BaseException) -> str:
    """Return the text of an error; an error of the student's own class may raise another one here."""
    try:
        return str(error)[:MAX_TEXT]
    except (Exception, SystemExit):
        return ""


def _types_named(text: str) -> list[str]:
    """Return the types of messages that have the name of which an error complains."""
    named = re.match(
        r"(?:type object )?'(\w+)' (?:object )?has no attribute|name '(\w+)' is not defined", text
    )
    return [name for name in type_names() if named and name.endswith(f"/{named[1] or named[2]}")]


def _meant(text: str, types: list[str]) -> str:
    """Return a question for the field or constant nearest to the one that is not there, or ""."""
    wanted = text.rpartition("attribute '")[2].partition("'")[0]
    found = [definition(name) for name in types]
    inner = [f"{field.name}.{wanted}" for one in found for field in one.fields if _has(field, wanted)]
    names = [name for one in found for name in (*one.constants, *(field.name for field in one.fields))]
    close = inner or get_close_matches(wanted, names)
    return f"did you mean {close[0]}? " if close else ""


def _has(field: FieldDefinition, wanted: str) -> bool:
    """Return whether a field is a message with a field of this name."""
    scalar = field.is_message and field.container == "scalar"
    return scalar and any(inner.name == wanted for inner in definition(field.base).fields)


def _of_own_class(error: BaseException, text: str) -> str:
    """Return the hint for an attribute that an object of the program's own class has not."""
    named = re.match(r"'(\w+)' object has no attribute '(\w+)'$", text)
    own = named and getattr(type(getattr(error, "obj", None)), "__module__", "") == "__main__"
    return f"set self.{named[2]} in {named[1]}.__init__, spelled the same." if named and own else ""
