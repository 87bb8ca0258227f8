"""Writing .rviz files in RViz's own forms (property.cpp, config.cpp, yaml_config_writer.cpp)."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from course_lib.displays.display import GROUP, Display, Group
from course_lib.displays.layout import Options, text_at, yaml_text
from course_lib.displays.panel.tools import Tool
from course_lib.displays.properties import booleans, color, vector
from course_lib.displays.registry import FailedDisplay
from course_lib.displays.session import RvizSession
from course_lib.displays.views import FailedView, ViewController
from course_lib.errors import CourseError

_Configured = Display | ViewController | Tool | Options
_PANELS = ("Displays", "Selection", "Tool Properties", "Views", "Time")


def save_rviz(session: RvizSession, path: str | Path) -> None:
    """Write what a session shows as an .rviz file; what came from another file and is not known is kept.

    Raises:
        CourseError: If the file cannot be written.
    """
    path = Path(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(yaml_text(document(session)), encoding="utf-8")
    except OSError as error:
        raise CourseError(f"Cannot write the layout {path}: {error.strerror}.") from None


def document(session: RvizSession) -> dict[str, Any]:
    """Return the whole layout as maps, lists and values; keys in the order in which RViz writes them."""
    before = session.layout.document
    manager = _map(before, "Visualization Manager")
    views = {
        "Current": view_config(session.view),
        "Saved": [view_config(view) for view in session.saved_views] or None,
    }
    result: dict[str, Any] = _sorted(
        {
            "Panels": [{"Class": f"rviz_common/{name}", "Name": name} for name in _PANELS],
            **before,
            "Visualization Manager": {
                "Class": "",
                "Enabled": True,
                "Name": "root",
                "Transformation": {"Current": {"Class": "rviz_default_plugins/TF"}},
                "Value": True,
                **manager,
                "Displays": [member_config(member) for member in session.tree.members] or None,
                "Tools": _tools(session),
                "Global Options": _with_properties(session.options, {}),
                "Views": {**_map(manager, "Views"), **views},
            },
        }
    )
    return result


def member_config(member: Display | Group) -> dict[str, Any]:
    """Return a display's or a group's part of a layout."""
    if isinstance(member, Group):
        named = {"Class": GROUP, "Name": member.name, "Enabled": member.ticked}
        displays = [member_config(inner) for inner in member.members]
        return {**member.config, **named, "Displays": displays or None}
    known = {"Name": member.name, "Enabled": member["Enabled"]}
    if isinstance(member, FailedDisplay):
        return {**member.config, **(known if "Enabled" in member.config else {"Name": member.name})}
    if len(member.properties) > 1:
        known["Value"] = member["Enabled"]
    return _with_properties(member, {"Class": member.class_name, **known})


def _tools(session: RvizSession) -> list[Mapping[str, Any]]:
    """Return the tools of the former layout, ours as they are now; all of ours if there were none."""
    ours = {tool.class_name: _with_properties(tool, {"Class": tool.class_name}) for tool in session.tools}
    kept = [ours.pop(text_at(config, "Class"), config) for config in session.layout.tools]
    return [*kept, *(() if kept else ours.values())]


def view_config(view: ViewController) -> dict[str, Any]:
    """Return a view's part of a layout."""
    if isinstance(view, FailedView):
        return {**view.config, "Name": view.name}
    label = f"{view} (rviz_default_plugins)"
    return _with_properties(view, {"Class": view.class_name, "Name": view.name, "Value": label})


def _with_properties(holder: _Configured, known: Mapping[str, Any]) -> dict[str, Any]:
    """Return a holder's part of a layout, over its part of the former layout."""
    config: dict[str, Any] = {**holder.config, **known}
    parents = {prop.path[:-1] for prop in holder.properties}
    for prop in holder.properties:
        if prop.is_read_only:
            continue
        *path, last = prop.path
        place = config
        for name in path:
            place[name] = place = dict(_map(place, name))
        value = _saved(prop.convert, holder[prop.label])
        if prop.path in parents or prop.convert is booleans:
            value = {**_map(place, last), **(value if isinstance(value, dict) else {"Value": value})}
        place[last] = value
    return config


def _map(config: Mapping[str, Any], label: str) -> Mapping[str, Any]:
    """Return a map of a layout, empty if there is something else."""
    value = config.get(label)
    return value if isinstance(value, Mapping) else {}


def _saved(convert: Any, value: Any) -> Any:
    """Return a value in the form in which RViz writes it."""
    if convert is color:
        return "; ".join(map(str, value))
    if convert is vector:
        return {axis: _float32(number) for axis, number in zip("XYZ", value, strict=True)}
    return _float32(value) if isinstance(value, float) else value


def _float32(number: float) -> float | int:
    """Return the number that RViz has: of four bytes, and without a point if it is whole."""
    short = float(np.float32(number))
    return int(short) if short.is_integer() else short


def _sorted(value: Any) -> Any:
    """Return maps and lists, keys in the order of their code units as in Qt's maps."""
    if isinstance(value, Mapping):
        return {key: _sorted(value[key]) for key in sorted(value)}
    return [_sorted(part) for part in value] if isinstance(value, list | tuple) else value
