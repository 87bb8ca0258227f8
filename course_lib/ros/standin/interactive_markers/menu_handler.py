"""Context menus of interactive markers."""

# ruff: noqa: N802 - the names are ROS's

import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from visualization_msgs.msg import InteractiveMarkerFeedback, MenuEntry

from interactive_markers.interactive_marker_server import InteractiveMarkerServer


@dataclass
class EntryContext:
    """An entry of a menu."""

    title: str
    command: str
    command_type: int
    feedback_cb: Callable[[InteractiveMarkerFeedback], object] | None
    # Handles of the entries below this one.
    sub_entries: list[int] = field(default_factory=list)
    visible: bool = True
    check_state: int = 0


class MenuHandler:
    """A menu that any number of markers share, and the callbacks of its entries."""

    NO_CHECKBOX, CHECKED, UNCHECKED = range(3)
    # Prefixes of the titles, which show the check state.
    _MARKS = ("", "[x] ", "[ ] ")

    def __init__(self) -> None:
        self.top_level_handles_: list[int] = []
        self.entry_contexts_: dict[int, EntryContext] = {}
        self.managed_markers_: set[str] = set()

    def insert(
        self,
        title: str,
        parent: int | None = None,
        command_type: int = MenuEntry.FEEDBACK,
        command: str = "",
        callback: Callable[[InteractiveMarkerFeedback], object] | None = None,
    ) -> int | None:
        """Add an entry at the top level or below another entry. Return its handle."""
        if parent is not None and parent not in self.entry_contexts_:
            print(f"Parent menu entry '{parent}' not found", file=sys.stderr)  # noqa: T201 - as ROS does
            return None
        handle = len(self.entry_contexts_) + 1
        self.entry_contexts_[handle] = EntryContext(title, command, command_type, callback)
        above = self.top_level_handles_ if parent is None else self.entry_contexts_[parent].sub_entries
        above.append(handle)
        return handle

    def setVisible(self, handle: int, visible: bool) -> bool:
        """Show or hide an entry with all entries below it."""
        if handle in self.entry_contexts_:
            self.entry_contexts_[handle].visible = visible
        return handle in self.entry_contexts_

    def setCheckState(self, handle: int, check_state: int) -> bool:
        """Check or uncheck an entry, or remove its check box."""
        if handle in self.entry_contexts_:
            self.entry_contexts_[handle].check_state = check_state
        return handle in self.entry_contexts_

    def getCheckState(self, handle: int) -> int | None:
        """Return the state of an entry's check box; None if there is no such entry."""
        return self.entry_contexts_[handle].check_state if handle in self.entry_contexts_ else None

    def getTitle(self, handle: int) -> str | None:
        """Return an entry's title; None if there is no such entry."""
        return self.entry_contexts_[handle].title if handle in self.entry_contexts_ else None

    def apply(self, server: InteractiveMarkerServer, marker_name: str) -> bool:
        """Write the current menu into a marker and register for its selections."""
        marker = server.get(marker_name)
        if marker is None:
            self.managed_markers_.discard(marker_name)
            return False
        marker.menu_entries = list(self._entries(self.top_level_handles_, 0))
        choice = InteractiveMarkerFeedback.MENU_SELECT
        server.insert(marker, feedback_callback=self.processFeedback, feedback_type=choice)
        self.managed_markers_.add(marker_name)
        return True

    def reApply(self, server: InteractiveMarkerServer) -> bool:
        """Write the menu into all markers that use it. Return whether all of them still exist."""
        applied = [self.apply(server, name) for name in sorted(self.managed_markers_)]
        return all(applied)

    def processFeedback(self, feedback: InteractiveMarkerFeedback) -> None:
        """Call the callback of the selected entry."""
        entry = self.entry_contexts_.get(feedback.menu_entry_id)
        if entry is not None and entry.feedback_cb is not None:
            entry.feedback_cb(feedback)

    def _entries(self, handles: list[int], parent: int) -> Iterator[MenuEntry]:
        """Yield the visible entries as messages, each followed by the entries below it."""
        for handle, entry in ((handle, self.entry_contexts_[handle]) for handle in handles):
            if entry.visible:
                yield MenuEntry(
                    id=handle,
                    parent_id=parent,
                    title=self._MARKS[entry.check_state] + entry.title,
                    command=entry.command,
                    command_type=entry.command_type,
                )
                yield from self._entries(entry.sub_entries, handle)
