"""RViz's layout files, .rviz: what is shown, and from where."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from course_lib.displays.group import GROUP
from course_lib.displays.properties import Color, color
from course_lib.errors import CourseError


@dataclass(frozen=True)
class Layout:
    """The parts of a layout that say what is drawn."""

    fixed_frame: str  # RViz's Fixed Frame
    background: Color  # colour behind everything
    frame_rate: int  # [Hz]
    displays: tuple[Mapping[str, Any], ...]  # the configuration of each display and group, in order
    view: Mapping[str, Any]  # the configuration of the current view
    saved_views: tuple[Mapping[str, Any], ...]  # those of the saved ones
    tools: tuple[Mapping[str, Any], ...]  # those of the tools
    document: Mapping[str, Any]  # the whole file


def read_layout(path: str | Path) -> Layout:
    """Read an .rviz file.

    Raises:
        CourseError: If there is no such file, if it is no YAML (with line and column), or if something in it
            has another shape than in RViz's files.
    """
    document = _parsed(Path(path))
    manager = _part(path, document, "Visualization Manager", dict, required=True)
    options = _part(path, manager, "Global Options", dict)
    displays = _displays(path, manager)
    views = _part(path, manager, "Views", dict)
    view, saved = _part(path, views, "Current", dict), _maps(path, views, "Saved")
    try:
        background = color(options.get("Background Color", "48; 48; 48"))
        frame_rate = max(int(options.get("Frame Rate", 30)), 1)
    except (TypeError, ValueError, OverflowError) as error:
        raise CourseError(f"{path}: a value of Global Options is wrong: {error}.") from None
    fixed_frame = str(options.get("Fixed Frame", "base_link")).removeprefix("/")
    return Layout(
        fixed_frame, background, frame_rate, displays, view, saved, _maps(path, manager, "Tools"), document
    )


def _displays(path: str | Path, group: Any) -> tuple[Mapping[str, Any], ...]:
    """Return the displays and groups that are directly in a group; all below are looked at too."""
    displays = _maps(path, group, "Displays")
    for display in displays:
        if display.get("Class") == GROUP:
            _displays(path, display)
    return displays


def _maps(path: str | Path, parent: Any, name: str) -> tuple[Mapping[str, Any], ...]:
    """Return a part of the layout that must be a list of maps."""
    entries = _part(path, parent, name, list)
    for index, entry in enumerate(entries):
        if not isinstance(entry, dict):
            raise _misshapen(path, entry, entries, index, f"{name.removesuffix('s')} {index + 1}", dict)
    return tuple(entries)


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
