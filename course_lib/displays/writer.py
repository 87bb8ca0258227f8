"""Writing .rviz files in RViz's own format (property.cpp, config.cpp, yaml_config_writer.cpp)."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from course_lib.displays.display import GROUP, Display, Group
from course_lib.displays.layout import LOOK, Options, text_at, yaml_text
from course_lib.displays.panel.tools import Tool
from course_lib.displays.properties import booleans, color, vector
from course_lib.displays.registry import FailedDisplay
from course_lib.displays.session import RvizSession
from course_lib.displays.views import FailedView, ViewController
from course_lib.files import save_as

_Configured = Display | ViewController | Tool | Options
_PANELS = ("Displays", "Selection", "Tool Properties", "Views", "Time")


def save_rviz(session: RvizSession, path: str | Path) -> None:
    """Write a session as an .rviz file. Unknown entries of a loaded file are preserved.

    Raises:
        CourseError: The file cannot be written.
    """
    save_as(path, yaml_text(document(session)).encode(), "the layout")


def document(session: RvizSession) -> dict[str, Any]:
    """Return the whole layout as maps, lists and values, with keys in RViz's order."""
    before = session.layout.document
    manager = _map(before, "Visualization Manager")
    views = {
        "Current": view_config(session.view),
        "Saved": [view_config(view) for view in session.saved_views] or None,
    }
    # Tools keep the order of the loaded layout; without a layout, all tools are written.
    tool_configs = {
        tool.class_name: _with_properties(tool, {"Class": tool.class_name}) for tool in session.tools
    }
    tools = [tool_configs.pop(text_at(config, "Class"), config) for config in session.layout.tools]
    # RViz's own look is not written, because RViz has no such property.
    global_options = _with_properties(session.options, {})
    if session.options[LOOK.label] == LOOK.default:
        del global_options[LOOK.label]
    result: dict[str, Any] = _sort_keys(
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
                "Tools": tools or [*tool_configs.values()],
                "Global Options": global_options,
                "Views": {**_map(manager, "Views"), **views},
            },
        }
    )
    return result


def member_config(member: Display | Group) -> dict[str, Any]:
    """Return the configuration of a display or group."""
    if isinstance(member, Group):
        entries_of_group = {"Class": GROUP, "Name": member.name, "Enabled": member.is_enabled}
        displays = [member_config(inner) for inner in member.members]
        return {**member.config, **entries_of_group, "Displays": displays or None}
    entries = {"Name": member.name, "Enabled": member["Enabled"]}
    if isinstance(member, FailedDisplay):
        return {**member.config, **(entries if "Enabled" in member.config else {"Name": member.name})}
    if len(member.properties) > 1:
        entries["Value"] = member["Enabled"]
    return _with_properties(member, {"Class": member.class_name, **entries})


def view_config(view: ViewController) -> dict[str, Any]:
    """Return the configuration of a view."""
    if isinstance(view, FailedView):
        return {**view.config, "Name": view.name}
    label = f"{view} (rviz_default_plugins)"
    return _with_properties(view, {"Class": view.class_name, "Name": view.name, "Value": label})


def _with_properties(holder: _Configured, entries: Mapping[str, Any]) -> dict[str, Any]:
    """Return the configuration of an object with properties, merged over its loaded one."""
    config: dict[str, Any] = {**holder.config, **entries}
    parents = {prop.path[:-1] for prop in holder.properties}
    for prop in holder.properties:
        if prop.is_read_only or not prop.is_saved:
            continue
        *path, last = prop.path
        place = config
        for name in path:
            place[name] = place = dict(_map(place, name))
        value = holder[prop.label]
        if prop.convert is color:
            value = "; ".join(map(str, value))
        elif prop.convert is vector:
            value = {axis: _float32(number) for axis, number in zip("XYZ", value, strict=True)}
        elif isinstance(value, float):
            value = _float32(value)
        if prop.path in parents or prop.convert is booleans:
            value = {**_map(place, last), **(value if isinstance(value, dict) else {"Value": value})}
        place[last] = value
    return config


def _map(config: Mapping[str, Any], label: str) -> Mapping[str, Any]:
    """Return the map under a label, or an empty one if the value has another type."""
    value = config.get(label)
    return value if isinstance(value, Mapping) else {}


def _float32(number: float) -> float | int:
    """Round to float32, as RViz stores numbers; return an int if the result is integral."""
    short = float(np.float32(number))
    return int(short) if short.is_integer() else short


def _sort_keys(value: Any) -> Any:
    """Return maps and lists with keys sorted by code units, like Qt's maps."""
    if isinstance(value, Mapping):
        return {key: _sort_keys(value[key]) for key in sorted(value)}
    return [_sort_keys(part) for part in value] if isinstance(value, list | tuple) else value
