"""RViz's layout files, .rviz: what is shown, and from where."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

from course_lib.displays.group import GROUP
from course_lib.displays.yaml_file import Parsed, parse_yaml
from course_lib.errors import CourseError

Config: TypeAlias = Mapping[str, Any]  # of one thing in a layout, by RViz's labels


@dataclass(frozen=True)
class Layout:
    """The parts of a layout that say what is drawn, but for what has another shape than in RViz's files."""

    options: Config = field(default_factory=dict)  # RViz's Global Options
    displays: tuple[Config, ...] = ()  # the configuration of each display and group, in order
    view: Config = field(default_factory=dict)  # the configuration of the current view
    saved_views: tuple[Config, ...] = ()  # those of the saved ones
    tools: tuple[Config, ...] = ()  # those of the tools
    document: Config = field(default_factory=dict)  # the whole file
    problems: tuple[str, ...] = ()  # what was left out, with line and column


def read_layout(path: str | Path) -> Layout:
    """Read an .rviz file; like RViz, take of any YAML what is there.

    Raises:
        CourseError: If there is no such file, or if it is no YAML; with line and column.
    """
    try:
        return layout_of(Path(path).read_text(encoding="utf-8"), Path(path).name)
    except OSError as error:
        raise CourseError(f"Cannot read the layout {path}: {error.strerror}.") from None
    except UnicodeDecodeError:
        raise CourseError(f"{path} is no .rviz file: it is not even text.") from None
    except CourseError as error:
        raise CourseError(f"{path}, {error}") from None


def layout_of(text: str, name: str) -> Layout:
    """Read the text of an .rviz file; problems in it call it by a name.

    Raises:
        CourseError: If it is no YAML; begins with line and column.
    """
    return _Parts(parse_yaml(text)).layout(name)


def text_at(config: Config, label: str) -> str:
    """Return a text of a layout; empty if there is none."""
    value = config.get(label)
    return "" if value is None or isinstance(value, Mapping | list | tuple) else str(value)


class _Parts:
    """Looks up the parts of a file, and remembers which are not as RViz writes them."""

    def __init__(self, parsed: Parsed) -> None:
        self._parsed = parsed
        self._problems: list[str] = []

    def layout(self, name: str) -> Layout:
        document = self._parsed.value if isinstance(self._parsed.value, dict) else {}
        if not isinstance(document.get("Visualization Manager"), dict):
            self._problems.append(f"{name} is no .rviz file: it has no map 'Visualization Manager'.")
            return Layout(document=document, problems=tuple(self._problems))
        above = "Visualization Manager"
        return Layout(
            options=self._part(above, "Global Options", kind=dict),
            displays=self._displays(above),
            view=self._part(above, "Views", "Current", kind=dict),
            saved_views=self._maps(above, "Views", "Saved"),
            tools=self._maps(above, "Tools"),
            document=document,
            problems=tuple(self._problems),
        )

    def _displays(self, *group: str | int) -> tuple[Config, ...]:
        """Return the displays and groups that are directly in a group; what is in those is looked at, too."""
        displays = self._maps(*group, "Displays")
        for index, display in enumerate(displays):
            if display.get("Class") == GROUP:
                display["Displays"] = self._displays(*group, "Displays", index)
        return displays

    def _maps(self, *path: str | int) -> tuple[dict[str, Any], ...]:
        """Return the maps of a list; an entry that is none makes an empty one."""
        entries = self._part(*path, kind=list)
        return tuple(self._part(*path, index, kind=dict) for index in range(len(entries)))

    def _part(self, *path: str | int, kind: type) -> Any:
        """Return the map or list at a path; an absent one is empty, and so is what is none."""
        value = self._parsed.value
        for index, key in enumerate(path):
            value = value[key] if isinstance(key, int) else value.get(key)
            wanted = kind if index == len(path) - 1 else (list if isinstance(path[index + 1], int) else dict)
            if not isinstance(value, wanted):
                if value is not None:
                    self._problem(path[: index + 1], value, wanted)
                return kind()
        return value

    def _problem(self, path: tuple[str | int, ...], value: Any, wanted: type) -> None:
        line, column = self._parsed.places.get(path, (1, 1))
        form = "a map (lines like 'Name: value')" if wanted is dict else "a list (lines that begin with '- ')"
        name = path[-1] if isinstance(path[-1], str) else f"{str(path[-2]).removesuffix('s')} {path[-1] + 1}"
        text = f"line {line}, column {column}: {name!r} is {str(value)[:40]!r}, expected {form}."
        if text not in self._problems:
            self._problems.append(text)
