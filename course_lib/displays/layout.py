"""Reading RViz's layout files, .rviz, in its dialect of YAML (yaml_config_reader.cpp, _writer.cpp).

All values are read as strings, so that unknown ones are written unchanged: ``1.0`` stays ``1.0``.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, ClassVar, TypeAlias

from course_lib.displays.display import GROUP
from course_lib.displays.properties import Property, PropertyHolder, color, frame, integer, words
from course_lib.errors import CourseError
from course_lib.third_party import NOT_UTF8, read_text

_NULLS = ("", "~", "null", "Null", "NULL")
_NULL = "tag:yaml.org,2002:null"
# Limit on path components in a file with expanded aliases: 100,000 values ten levels deep.
_MAX_COMPONENTS = 1_000_000
# The path of an entry: its keys and indices.
_Place: TypeAlias = tuple[str | int, ...]


@dataclass
class ParsedYaml:
    """The value of a file, with the position of each entry."""

    value: Any = None
    # Line and column of each entry, from 1.
    places: dict[_Place, tuple[int, int]] = field(default_factory=dict)
    remaining: int = _MAX_COMPONENTS

    def convert(self, node: Any, path: _Place = ()) -> Any:
        """Convert a YAML node to plain values. Of duplicate keys, the last one is used.

        Raises:
            CourseError: With expanded aliases, it is larger than any layout.
        """
        self.remaining -= 1 + len(path)
        if self.remaining < 0:
            line, column = node.start_mark.line + 1, node.start_mark.column + 1
            problem = "with its aliases (*name) expanded, the file has too many values for a layout"
            raise CourseError(
                f"line {line}, column {column}: {problem}. RViz does not write aliases: remove them."
            )
        self.places[path] = (node.start_mark.line + 1, node.start_mark.column + 1)
        if node.id == "mapping":
            nodes_by_name = {str(key.value): value for key, value in node.value}
            items = nodes_by_name.items()
            return {name: self.convert(value, (*path, name)) for name, value in items}
        if node.id == "sequence":
            return [self.convert(value, (*path, index)) for index, value in enumerate(node.value)]
        return None if not node.style and node.value in _NULLS else node.value


def parse_yaml(text: str) -> ParsedYaml:
    """Parse the first document of a string.

    Raises:
        CourseError: The text is not YAML; the message begins with line and column.
    """
    import yaml

    # Some builds of PyYAML lack libyaml.
    parsed, loader = ParsedYaml(), getattr(yaml, "CBaseLoader", yaml.BaseLoader)
    try:
        node = next(yaml.compose_all(text, Loader=loader), None)
        parsed.value = None if node is None else parsed.convert(node)
    except yaml.MarkedYAMLError as error:
        mark, problem = error.problem_mark or error.context_mark, error.problem or error.context
        description = f"found character {text[mark.index : mark.index + 1]!r} that"
        raise _syntax_error(
            mark.line, mark.column, problem.replace("found character that", description)
        ) from None
    except yaml.reader.ReaderError as error:
        before = text[: error.position]
        character = f"the character {error.character!r} is not allowed"
        raise _syntax_error(before.count("\n"), len(before) - before.rfind("\n") - 1, character) from None
    except (RecursionError, UnicodeError) as error:
        reason = "it is nested too deeply" if isinstance(error, RecursionError) else str(error)
        raise _syntax_error(0, 0, reason) from None
    return parsed


def yaml_text(value: Any) -> str:
    """Format maps, lists and values as yaml-cpp does for RViz."""
    import yaml

    options = {"default_flow_style": False, "sort_keys": False, "allow_unicode": True, "width": 10**9}
    text: str = yaml.dump(_to_strings(value), Dumper=_rviz_dumper(), **options)
    # yaml-cpp writes an empty map on the next line.
    empty = re.compile(r"^([ -]*)(\S.*:) \{\}$", re.M)
    return empty.sub(lambda match: f"{match[0][:-3]}\n{' ' * len(match[1])}  {{}}", text)


@cache
def _rviz_dumper() -> Any:
    """Return the class of a dumper that writes only strings and nulls."""
    import yaml

    class RvizDumper(yaml.SafeDumper):  # type: ignore[misc]  # untyped
        yaml_implicit_resolvers: ClassVar[dict[str, Any]] = {}

        def increase_indent(self, flow: bool = False, indentless: bool = False) -> None:
            """Indent lists, too."""
            super().increase_indent(flow, indentless=False)

        def choose_scalar_style(self) -> Any:
            """Use double quotes for strings that need quotes."""
            style = super().choose_scalar_style()
            return '"' if style == "'" else style

    starts = list({null[:1] for null in _NULLS})
    RvizDumper.add_implicit_resolver(_NULL, re.compile(rf"(?:{'|'.join(_NULLS)})\Z"), starts)
    RvizDumper.add_representer(type(None), lambda dumper, _: dumper.represent_scalar(_NULL, "~"))
    return RvizDumper


def _to_strings(value: Any) -> Any:
    """Convert values to strings and nulls, with numbers and flags in RViz's notation."""
    if isinstance(value, Mapping):
        return {str(key): _to_strings(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [_to_strings(part) for part in value]
    if isinstance(value, bool):
        return str(value).lower()
    return None if value is None else str(value)


def _syntax_error(line: int, column: int, reason: str) -> CourseError:
    return CourseError(f"line {line + 1}, column {column + 1}: this is not valid YAML: {reason}.")


# The configuration of an object in a layout, by RViz's labels.
Config: TypeAlias = Mapping[str, Any]


@dataclass(frozen=True)
class Layout:
    """The parts of a layout that determine the picture, without entries of an invalid structure.

    Args:
        options: RViz's Global Options, by label.
        displays: The configuration of each display and group, in order.
        view: The configuration of the current view.
        saved_views: The configurations of the saved views.
        tools: The configurations of the tools.
        document: The whole file.
        problems: Errors about entries that were left out, with line and column.
    """

    options: Config = field(default_factory=dict)
    displays: tuple[Config, ...] = ()
    view: Config = field(default_factory=dict)
    saved_views: tuple[Config, ...] = ()
    tools: tuple[Config, ...] = ()
    document: Config = field(default_factory=dict)
    problems: tuple[str, ...] = ()


LOOK = Property("Look", "RViz", words("RViz", "Studio"))


class Options(PropertyHolder):
    """RViz's Global Options, and the look, which RViz does not have.

    Args:
        values: The values of the properties.
        config: Their part of the layout that was applied last.
        set_option: Called with the label and the value of a changed property.
    """

    _expression = "viewer.options"
    properties = (
        Property("Fixed Frame", "base_link", frame),
        Property("Background Color", (48, 48, 48), color),
        Property("Frame Rate", 30, integer(1)),  # [Hz]
        LOOK,
    )

    def __init__(
        self, values: tuple[Any, ...], config: Config, set_option: Callable[[str, Any], None]
    ) -> None:
        super().__init__()
        self._values = dict(zip(self._values, values, strict=True))
        self._set_option = set_option
        self.config = config

    def __repr__(self) -> str:
        return "Global Options"

    def on_property_change(self, label: str) -> None:
        """Apply the new value."""
        self._set_option(label, self[label])


def read_layout(path: str | Path) -> Layout:
    """Read an .rviz file. Like RViz, read any YAML and use the parts that it contains.

    Args:
        path: The file.

    Raises:
        CourseError: The file does not exist, or is not YAML; the message has line and column.
    """
    try:
        return layout_of(read_text(Path(path)), Path(path).name)
    except OSError as error:
        raise CourseError(
            f"Cannot read the layout {path}: {error.strerror}. Pass the path of an .rviz file."
        ) from None
    except UnicodeDecodeError:
        raise CourseError(f"{path} is not an .rviz file: {NOT_UTF8}.") from None
    except CourseError as error:
        raise CourseError(f"{path}, {error}") from None


def layout_of(text: str, name: str) -> Layout:
    """Parse the text of an .rviz file; error messages refer to it by `name`.

    Raises:
        CourseError: It is not YAML; the message begins with line and column.
    """
    return _LayoutReader(parse_yaml(text)).layout(name)


def text_at(config: Config, label: str) -> str:
    """Return a string of a layout, or "" if it does not exist.

    Args:
        config: A part of a `Layout`.
        label: RViz's key, "Class".
    """
    value = config.get(label)
    return "" if value is None or isinstance(value, Mapping | list | tuple) else str(value)


class _LayoutReader:
    """Reads the parts of a parsed file, and collects errors for parts with an invalid structure."""

    def __init__(self, parsed: ParsedYaml) -> None:
        self._parsed = parsed
        self._problems: list[str] = []

    def layout(self, name: str) -> Layout:
        document = self._parsed.value if isinstance(self._parsed.value, dict) else {}
        if not isinstance(document.get("Visualization Manager"), dict):
            self._problems.append(f"{name} is not an .rviz file: it has no map 'Visualization Manager'.")
            return Layout(document=document, problems=tuple(self._problems))
        above = "Visualization Manager"
        return Layout(
            options=self._entry(above, "Global Options", kind=dict),
            displays=self._displays(above),
            view=self._entry(above, "Views", "Current", kind=dict),
            saved_views=self._maps(above, "Views", "Saved"),
            tools=self._maps(above, "Tools"),
            document=document,
            problems=tuple(self._problems),
        )

    def _displays(self, *group: str | int) -> tuple[Config, ...]:
        """Return the displays and groups directly in a group, and check the contents of its groups."""
        displays = self._maps(*group, "Displays")
        for index, display in enumerate(displays):
            if display.get("Class") == GROUP:
                display["Displays"] = self._displays(*group, "Displays", index)
        return displays

    def _maps(self, *path: str | int) -> tuple[dict[str, Any], ...]:
        """Return the maps of a list. Entries of another type become empty maps."""
        entries = self._entry(*path, kind=list)
        return tuple(self._entry(*path, index, kind=dict) for index in range(len(entries)))

    def _entry(self, *path: str | int, kind: type) -> Any:
        """Return the map or list at a path; empty if it is missing or has another type."""
        value = self._parsed.value
        for index, key in enumerate(path):
            value = value[key] if isinstance(key, int) else value.get(key)
            expected_type = (
                kind if index == len(path) - 1 else (list if isinstance(path[index + 1], int) else dict)
            )
            if isinstance(value, expected_type):
                continue
            if value is not None:
                line, column = self._parsed.places.get(path[: index + 1], (1, 1))
                form = "a list (lines that begin with '- ')"
                if expected_type is dict:
                    form = "a map (lines like 'Name: value')"
                name = key if isinstance(key, str) else f"{str(path[index - 1]).removesuffix('s')} {key + 1}"
                text = f"line {line}, column {column}: {name!r} is {str(value)[:40]!r}, expected {form}."
                if text not in self._problems:
                    self._problems.append(text)
            return kind()
        return value
