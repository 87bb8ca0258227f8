"""YAML as RViz reads and writes it: maps, lists, text and nulls (yaml_config_reader.cpp and _writer.cpp).

All values are read as text, so that what nobody here knows is written as it came: ``1.0`` stays ``1.0``.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from io import StringIO
from typing import Any

from course_lib.errors import CourseError

_NULLS = ("", "~", "null", "Null", "NULL")
_NULL = "tag:yaml.org,2002:null"
_MOST = 1_000_000  # labels of all paths in a file, its aliases written out: 100,000 values ten levels deep
Path = tuple[str | int, ...]  # of keys and indices


@dataclass
class Parsed:
    """The value of a file, and where its parts are written."""

    value: Any = None
    places: dict[Path, tuple[int, int]] = field(default_factory=dict)  # line and column, from 1
    room: int = _MOST

    def take(self, node: Any, path: Path = ()) -> Any:
        """Return a node of YAML as plain values; of a key that comes twice, the last one counts.

        Raises:
            CourseError: With its aliases written out, it is larger than any layout.
        """
        self.room -= 1 + len(path)
        if self.room < 0:
            line, column = node.start_mark.line + 1, node.start_mark.column + 1
            what = "with its aliases (*name) written out the file has too many values for a layout"
            raise CourseError(f"line {line}, column {column}: {what}. RViz writes no aliases: remove them.")
        self.places[path] = (node.start_mark.line + 1, node.start_mark.column + 1)
        if node.id == "mapping":
            named = {str(key.value): value for key, value in node.value}
            return {name: self.take(value, (*path, name)) for name, value in named.items()}
        if node.id == "sequence":
            return [self.take(value, (*path, index)) for index, value in enumerate(node.value)]
        return None if node.tag == _NULL else node.value


def parse_yaml(text: str) -> Parsed:
    """Read the first document of a text.

    Raises:
        CourseError: If it is no YAML; the text begins with line and column.
    """
    from ruamel.yaml.error import MarkedYAMLError, YAMLStreamError
    from ruamel.yaml.reader import ReaderError

    parsed = Parsed()
    try:
        node = next(_yaml().compose_all(text), None)
        parsed.value = None if node is None else parsed.take(node)
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        raise _no_yaml(mark.line, mark.column, error.problem or error.context) from None
    except ReaderError as error:
        before = text[: error.position]
        character = f"the character {error.character!r} cannot be there"
        raise _no_yaml(before.count("\n"), len(before) - before.rfind("\n") - 1, character) from None
    except (RecursionError, YAMLStreamError, ValueError) as error:
        reason = "it is nested too deeply" if isinstance(error, RecursionError) else str(error)
        raise _no_yaml(0, 0, reason) from None
    return parsed


def yaml_text(value: Any) -> str:
    """Write maps, lists and values as yaml-cpp does for RViz."""
    stream = StringIO()
    _yaml().dump(_texts(value), stream)
    empty = re.compile(r"^([ -]*)(\S.*:) \{\}$", re.M)  # which goes to the next line
    return empty.sub(lambda found: f"{found[0][:-3]}\n{' ' * len(found[1])}  {{}}", stream.getvalue())


def _yaml() -> Any:
    """Make a reader and writer that knows text and nulls only."""
    from ruamel.yaml import YAML
    from ruamel.yaml.emitter import Emitter
    from ruamel.yaml.nodes import ScalarNode
    from ruamel.yaml.resolver import VersionedResolver
    from ruamel.yaml.tag import Tag

    class TextResolver(VersionedResolver):
        def resolve(self, kind: Any, value: Any, implicit: Any) -> Any:
            """Say that all that is written without quotes is text, but for null."""
            if kind is ScalarNode and implicit[0] and value in _NULLS:
                return Tag(suffix=_NULL)
            return super().resolve(kind, "text" if kind is ScalarNode else value, implicit)

    class RvizEmitter(Emitter):
        def choose_scalar_style(self) -> Any:
            """Quote with two strokes what needs quotes."""
            style = super().choose_scalar_style()
            return '"' if style == "'" else style

    yaml: Any = YAML(typ="safe", pure=True)
    yaml.Emitter, yaml.Resolver = RvizEmitter, TextResolver
    yaml.default_flow_style, yaml.width = False, 10**9
    yaml.sort_base_mapping_type_on_output = False  # sorted already
    yaml.representer.add_representer(type(None), lambda rep, _: rep.represent_scalar(_NULL, "~"))
    yaml.indent(mapping=2, sequence=4, offset=2)
    return yaml


def _texts(value: Any) -> Any:
    """Return plain maps and lists of text and nulls; numbers and flags as RViz writes them."""
    if isinstance(value, Mapping):
        return {str(key): _texts(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [_texts(part) for part in value]
    if isinstance(value, bool):
        return str(value).lower()
    return None if value is None else str(value)


def _no_yaml(line: int, column: int, reason: str) -> CourseError:
    return CourseError(f"line {line + 1}, column {column + 1}: this is no YAML: {reason}.")
