"""Writing .rviz files in RViz's own forms (property.cpp, config.cpp, yaml_config_writer.cpp)."""

import re
from collections.abc import Iterable, Mapping
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np

from course_lib.displays.display import Display
from course_lib.displays.group import GROUP, Group
from course_lib.displays.properties import color, vector
from course_lib.displays.registry import FailedDisplay
from course_lib.displays.session import Session
from course_lib.displays.tools import Tool
from course_lib.displays.views import View
from course_lib.errors import CourseError

_Configured = Display | View | Tool
_PANELS = ("Displays", "Selection", "Tool Properties", "Views", "Time")


def save_rviz(session: Session, path: str | Path) -> None:
    """Write what a session shows as an .rviz file; what came from another file and is not known is kept.

    Raises:
        CourseError: If the file cannot be written.
    """
    try:
        Path(path).write_text(yaml_text(document(session)), encoding="utf-8")
    except OSError as error:
        raise CourseError(f"Cannot write the layout {path}: {error.strerror}.") from None


def document(session: Session) -> dict[str, Any]:
    """Return the whole layout as maps, lists and values; keys in the order in which RViz writes them."""
    before = dict(session.layout.document) if session.layout else {}
    manager = before.get("Visualization Manager") or {}
    options = {
        "Background Color": _saved(color, session.context.scene.background),
        "Fixed Frame": session.fixed_frame,
        "Frame Rate": session.frame_rate,
    }
    views = {
        "Current": view_config(session.view),
        "Saved": [view_config(view) for view in session.saved_views] or None,
    }
    result: dict[str, Any] = _sorted(
        {"Panels": [{"Class": f"rviz_common/{name}", "Name": name} for name in _PANELS]}
        | before
        | {
            "Visualization Manager": {
                "Class": "",
                "Enabled": True,
                "Name": "root",
                "Transformation": {"Current": {"Class": "rviz_default_plugins/TF"}},
                "Value": True,
                **manager,
                "Displays": [member_config(member) for member in session.tree.members],
                "Tools": _tools(session, manager.get("Tools") or ()),
                "Global Options": {**(manager.get("Global Options") or {}), **options},
                "Views": {**(manager.get("Views") or {}), **views},
            }
        }
    )
    return result


def member_config(member: Display | Group) -> dict[str, Any]:
    """Return a display's or a group's part of a layout."""
    if isinstance(member, Group):
        named = {"Class": GROUP, "Name": member.name, "Enabled": member.ticked}
        return {**member.config, **named, "Displays": [member_config(inner) for inner in member.members]}
    known = {"Name": member.name, "Enabled": member["Enabled"]}
    if isinstance(member, FailedDisplay):
        return {**member.config, **(known if "Enabled" in member.config else {"Name": member.name})}
    if len(member.properties) > 1:
        known["Value"] = member["Enabled"]
    return _with_properties(member, {"Class": member.class_name, **known})


def _tools(session: Session, before: Iterable[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Return the tools of the former layout, ours as they are now, and ours that it does not have."""
    ours = {tool.class_name: _with_properties(tool, {"Class": tool.class_name}) for tool in session.tools}
    kept = [ours.pop(str(config.get("Class")), config) for config in before]
    return [*kept, *(() if kept else ours.values())]


def view_config(view: View) -> dict[str, Any]:
    """Return a view's part of a layout."""
    label = f"{view} (rviz_default_plugins)"
    return _with_properties(view, {"Class": view.class_name, "Name": view.name, "Value": label})


def _with_properties(holder: _Configured, known: Mapping[str, Any]) -> dict[str, Any]:
    """Return a holder's part of a layout, over what its former layout said."""
    config: dict[str, Any] = {**holder.config, **known}
    parents = {prop.path[:-1] for prop in holder.properties}
    for prop in holder.properties:
        if prop.is_read_only:
            continue
        *path, last = prop.path
        place = config
        for name in path:
            kept = place.get(name)
            place[name] = place = dict(kept) if isinstance(kept, Mapping) else {}
        value = _saved(prop.convert, holder[prop.label])
        if prop.path in parents:
            kept = place.get(last)
            value = {**(kept if isinstance(kept, Mapping) else {}), "Value": value}
        place[last] = value
    return config


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
    """Return plain maps and lists, keys in the order of their code units as in Qt's maps."""
    if isinstance(value, Mapping):
        return {str(key): _sorted(value[key]) for key in sorted(value, key=str)}
    if isinstance(value, list | tuple):
        return [_sorted(part) for part in value]
    if isinstance(value, float):
        return int(value) if value.is_integer() else float(value)
    if value is None or isinstance(value, bool):
        return value
    return int(value) if isinstance(value, int) else str(value)


def yaml_text(value: Any) -> str:
    """Write plain values as yaml-cpp does for RViz."""
    from ruamel.yaml import YAML
    from ruamel.yaml.emitter import Emitter

    class RvizEmitter(Emitter):
        def choose_scalar_style(self) -> Any:
            """Quote with two strokes what needs quotes."""
            style = super().choose_scalar_style()
            return '"' if style == "'" else style

    yaml = YAML(typ="safe", pure=True)
    yaml.Emitter, yaml.default_flow_style, yaml.width = RvizEmitter, False, 10**9
    yaml.sort_base_mapping_type_on_output = False  # type: ignore[assignment]  # sorted already
    yaml.representer.add_representer(
        type(None), lambda rep, _: rep.represent_scalar("tag:yaml.org,2002:null", "~")
    )
    yaml.indent(mapping=2, sequence=4, offset=2)
    stream = StringIO()
    yaml.dump(value, stream)
    empty = re.compile(r"^([ -]*)(\S.*:) \{\}$", re.M)  # which goes to the next line
    return empty.sub(lambda found: f"{found[0][:-3]}\n{' ' * len(found[1])}  {{}}", stream.getvalue())
