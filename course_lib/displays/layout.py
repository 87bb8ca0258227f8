"""RViz's layout files, .rviz: what is shown, and from where."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from course_lib.displays.properties import Color, color
from course_lib.errors import CourseError


@dataclass(frozen=True)
class Layout:
    """The parts of a layout that say what is drawn."""

    fixed_frame: str  # RViz's Fixed Frame
    background: Color  # colour behind everything
    frame_rate: int  # [Hz]
    displays: tuple[Mapping[str, Any], ...]  # the configuration of each display, in order; groups are opened
    view: Mapping[str, Any]  # the configuration of the current view


def read_layout(path: str | Path) -> Layout:
    """Read an .rviz file.

    Raises:
        CourseError: If there is no such file, if it is no YAML (with line and column), or if something in it
            has another shape than in RViz's files.
    """
    document = _parsed(Path(path))
    manager = _part(path, document, "Visualization Manager", dict, required=True)
    options = _part(path, manager, "Global Options", dict)
    displays = tuple(_displays(path, manager))
    view = _part(path, _part(path, manager, "Views", dict), "Current", dict)
    try:
        background = color(options.get("Background Color", "48; 48; 48"))
        frame_rate = max(int(options.get("Frame Rate", 30)), 1)
    except (TypeError, ValueError, OverflowError) as error:
        raise CourseError(f"{path}: a value of Global Options is wrong: {error}.") from None
    fixed_frame = str(options.get("Fixed Frame", "base_link")).removeprefix("/")
    return Layout(fixed_frame, background, frame_rate, displays, view)


def _displays(path: str | Path, group: Any, ticked: bool = True) -> Iterator[Mapping[str, Any]]:
    """Yield the displays of a group, and those of the groups in it."""
    displays = _part(path, group, "Displays", list)
    for index, display in enumerate(displays):
        if not isinstance(display, dict):
            raise _misshapen(path, display, displays, index, f"Display {index + 1}", dict)
        if display.get("Class") == "rviz_common/Group":
            yield from _displays(path, display, ticked and display.get("Enabled") is not False)
        else:
            yield display if ticked else {**display, "Enabled": False}


def _parsed(path: Path) -> dict[str, Any]:
    """Parse YAML so that it can be written again as it was."""
    from ruamel.yaml import YAML
    from ruamel.yaml.error import MarkedYAMLError, YAMLError

    yaml = YAML()
    yaml.allow_duplicate_keys = True
    try:
        document = yaml.load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise CourseError(f"Cannot read the layout {path}: {error.strerror}.") from None
    except UnicodeDecodeError:
        raise CourseError(f"{path} is no .rviz file: it is not even text.") from None
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        where = f", line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        raise CourseError(f"{path}{where}: this is no YAML: {error.problem or error.context}.") from None
    except YAMLError as error:
        raise CourseError(f"{path}: this is no YAML: {error}.") from None
    if not isinstance(document, dict):
        raise CourseError(f"{path} is no .rviz file: it has no 'Visualization Manager'.")
    return document


def _part(path: str | Path, parent: Any, name: str, kind: type, required: bool = False) -> Any:
    """Return a part of the layout that must be a map or a list; an absent one is empty."""
    value = parent.get(name)
    if value is None and not required:
        return kind()
    if not isinstance(value, kind):
        raise _misshapen(path, value, parent, name, name, kind)
    return value


def _misshapen(path: str | Path, value: Any, parent: Any, key: Any, name: str, kind: type) -> CourseError:
    """Say where a part of the layout is not what RViz writes."""
    wanted = "a map (lines like 'Name: value')" if kind is dict else "a list (lines that begin with '- ')"
    if value is None:
        return CourseError(f"{path} is no .rviz file: it has no {name!r}.")
    line, column = parent.lc.item(key) if isinstance(key, int) else parent.lc.value(key)
    return CourseError(
        f"{path}, line {line + 1}, column {column + 1}: {name!r} is {str(value)[:40]!r}, expected {wanted}."
    )
