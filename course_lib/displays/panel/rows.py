"""The rows of the Displays, Views and Tool Properties panels, for a page that knows nothing of displays."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from math import isfinite
from typing import Any

from course_lib.displays.display import Display, Group
from course_lib.displays.panel.protocol import Editor, EditorKind, LevelMark, PanelRow
from course_lib.displays.properties import (
    Convert,
    Limited,
    Property,
    PropertyHolder,
    booleans,
    color,
    flag,
    frame,
    read_only,
    vector,
)
from course_lib.displays.session import RvizSession
from course_lib.displays.statuses import LEVELS, NOTES, Level, StatusRow

_EDITORS: tuple[tuple[Convert, EditorKind], ...] = (
    (flag, "bool"),
    (color, "color"),
    (vector, "vector"),
    (frame, "frame"),
    (read_only, "none"),
    (booleans, "none"),
)
Edit = Callable[[Any], Any]
_WORST_FIRST: tuple[Level, ...] = ("error", "warn", "hint", "ok")


@dataclass(frozen=True)
class RowEntry:
    """A row that the page draws, and what an edit of it changes."""

    row: PanelRow
    edit: Edit | None = None
    member: Display | Group | None = None  # of the tree, which can be renamed, removed ...


class Rows(dict[str, RowEntry]):
    """Rows by their key, parents first."""

    def put(
        self, key: str, parent: str, label: str, edit: Edit | None = None, member: Any = None, **shown: Any
    ) -> None:
        """Add a row."""
        self[key] = RowEntry(PanelRow(key, parent, label, **shown), edit, member)

    def put_properties(self, holder: PropertyHolder, parent: str) -> None:
        """Add what can be edited of something, but for its check box."""
        for prop in holder.properties:
            if prop.label == "Enabled":
                continue
            above = parent
            for name in prop.path[:-1]:
                key = f"{above}#{name}"
                if key not in self:
                    self.put(key, above, name)
                above = key
            self._put_property(holder, prop, above)

    def put_statuses(self, key: str, parent: str, label: str, rows: list[StatusRow]) -> None:
        """Add statuses, below the worst of them."""
        worst = worst_of(row.level for row in rows)
        self.put(key, parent, f"{label}: {LEVELS[worst][1].capitalize()}", mark=mark_of(worst))
        for index, row in enumerate(rows):
            mark, title = mark_of(row.level), NOTES.get(row.name, "")
            self.put(f"{key}!{index}", key, row.name, text=row.text, mark=mark, title=title)

    def _put_property(self, holder: PropertyHolder, prop: Property, parent: str) -> None:
        def edit(value: Any) -> None:
            holder[prop.label] = value

        key, value = f"{parent}#{prop.path[-1]}", holder[prop.label]
        editor = _editor(prop, holder)
        shown = "" if prop.convert is booleans else value if editor.kind != "none" else str(value)
        self.put(key, parent, prop.path[-1], edit, editor=editor, value=shown)
        if prop.convert is booleans:
            for name, on in value.items():
                tick = partial(self._tick, holder, prop.label, name)
                self.put(f"{key}#{name}", key, name or "(no name)", tick, editor=Editor("bool"), value=on)

    @staticmethod
    def _tick(holder: PropertyHolder, label: str, name: str, ticked: Any) -> None:
        """Tick one of a map of check boxes."""
        holder[label] = {**holder[label], name: ticked}


def display_rows(session: RvizSession) -> Rows:
    """Return the rows of the Displays panel."""
    rows = Rows()
    rows.put("options", "", "Global Options", open=True)
    rows.put_properties(session.options, "options")
    rows.put_statuses("status", "", "Global Status", session.global_rows())
    for member, parent in _members(session.tree, ""):
        _put_member(rows, session, member, parent)
    return rows


def view_rows(session: RvizSession) -> Rows:
    """Return the rows of the Views panel."""
    rows = Rows()
    rows.put_properties(session.view, "view")
    return rows


def tool_rows(session: RvizSession) -> Rows:
    """Return the rows of the Tool Properties panel."""
    rows = Rows()
    for tool in (tool for tool in session.tools if tool.properties):
        rows.put(f"tool {tool}", "", tool.label)
        rows.put_properties(tool, f"tool {tool}")
    return rows


def worst_of(levels: Iterable[Level]) -> Level:
    """Return the level that matters most; hints of ours come after RViz's warnings."""
    return min(levels, key=_WORST_FIRST.index, default="ok")


def _members(group: Group, parent: str) -> Iterator[tuple[Display | Group, str]]:
    for member in group.members:
        yield member, parent
        if isinstance(member, Group):
            yield from _members(member, _key(member))


def _put_member(rows: Rows, session: RvizSession, member: Display | Group, parent: str) -> None:
    key = _key(member)
    if isinstance(member, Group):

        def tick(on: Any) -> None:
            member.ticked = flag(on)
            session.tree.tick()
            session.refresh()

        rows.put(key, parent, member.name, tick, member, checked=member.ticked)
        return

    def enable(on: Any) -> None:
        member["Enabled"] = on

    statuses = session.rows_of(member)
    level = worst_of(row.level for row in statuses)
    shown = {"title": member.class_name, "checked": bool(member["Enabled"])}
    rows.put(key, parent, member.name, enable, member, mark=mark_of(level) if statuses else None, **shown)
    if statuses:
        rows.put_statuses(f"{key}!", key, "Status", statuses)
    rows.put_properties(member, key)


def _key(member: Display | Group) -> str:
    return f"group {id(member)}" if isinstance(member, Group) else member.path


def mark_of(level: Level) -> LevelMark:
    """Return the icon and the word of a level."""
    icon, word, _ = LEVELS[level]
    return LevelMark(level, icon, word)


def _editor(prop: Property, holder: PropertyHolder) -> Editor:
    """Return the control that edits a property, with its limits."""
    if isinstance(prop.convert, Limited):
        low, high = (limit if isfinite(limit) else None for limit in (prop.convert.low, prop.convert.high))
        return Editor(prop.convert.editor, low, high, tuple(prop.convert.options))
    type_name = getattr(holder, "type_name", None)
    if prop.path[-1].endswith("Topic") and type_name:
        return Editor("topic", type=type_name)
    return Editor(next((kind for convert, kind in _EDITORS if convert is prop.convert), "text"))
