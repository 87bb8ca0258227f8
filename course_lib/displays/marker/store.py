"""The life of markers: from message to scene, to their end (RViz2's MarkerCommon)."""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from course_lib.arrays import Matrix
from course_lib.displays.display import Context, node_name
from course_lib.displays.frames import NS, is_unit, nanoseconds, placed
from course_lib.displays.marker.drawables import DRAW, Drawn, label
from course_lib.displays.marker.hints import hints
from course_lib.displays.statuses import Statuses

ADD, DELETE, DELETEALL = 0, 2, 3
FOREVER_NS = 100_000  # a lifetime up to this one never ends, [ns]
_MOVED = 0.01  # [m], and about as much of a turn

Key: TypeAlias = tuple[str, int]  # (namespace, id)


@dataclass
class Live:
    """A marker in the scene."""

    marker: Any  # its last message
    drawn: Drawn  # its picture
    path: str  # its node
    received_ns: int  # when the message came, [ns]
    shown: bool = True  # whether its node is visible
    transform_frame_to_fixed: Matrix | None = None  # what it was last placed with; None if that was not known

    @property
    def expires_ns(self) -> float:
        """Robot time of its removal, [ns]; its lifetime counts from reception, not from its stamp."""
        lifetime_ns = nanoseconds(self.marker.lifetime)
        return self.received_ns + lifetime_ns if lifetime_ns > FOREVER_NS else math.inf


class MarkerStore:
    """The markers of one display, below its node of the scene."""

    def __init__(self, context: Context, path: str, statuses: Statuses) -> None:
        self._context = context
        self._path = path
        self._statuses = statuses
        self._queue: list[tuple[Any, int]] = []
        self.live: dict[Key, Live] = {}
        self.namespaces: dict[str, bool] = {}

    def add(self, markers: Iterable[Any]) -> None:
        """Queue messages for the next frame."""
        self._queue += [(marker, self._context.now_ns) for marker in markers]

    def add_array(self, array: Any) -> None:
        """Queue the messages of a MarkerArray; two of one name are an error, but both are shown."""
        name = "Duplicate Marker Check"
        self._statuses.delete(name)
        seen: set[Key] = set()
        for ns, number in ((marker.ns, marker.id) for marker in array.markers):
            if (ns, number) in seen:
                problem = "Multiple Markers in the same MarkerArray message had the same ns and id"
                self._statuses.set("error", name, f"{problem}: ({ns}, {number})")
                break
            seen.add((ns, number))
        self.add(array.markers)

    def update(self) -> None:
        """Show what has come, remove what has expired, move what is locked to its frame."""
        queue, self._queue = self._queue, []
        for marker, received_ns in queue:
            self._process(marker, received_ns)
        for key, live in list(self.live.items()):
            if live.expires_ns <= self._context.now_ns:
                self._expire(key, live)
            elif live.marker.frame_locked and self._moved(live):
                self._place(live)

    def clear(self) -> None:
        """Forget all markers; the display deletes their common node itself."""
        for live in self.live.values():
            self._context.scene.delete(live.path)
        self.live.clear()
        self._queue.clear()

    def tick(self, namespaces: Mapping[str, bool]) -> None:
        """Show or hide namespaces: hidden ones lose their markers."""
        self.namespaces |= namespaces
        self._statuses.hint("Namespaces")
        for key in list(self.live):
            if not self.namespaces.get(key[0], True):
                self._delete(key)

    def behind(self) -> Iterator[tuple[str, str]]:
        """Yield name and hint of each marker that stays where its frame was, a while after it came."""
        for live in self.live.values():
            frame, then = live.marker.header.frame_id, live.transform_frame_to_fixed
            now = self._context.frames.transform(frame)
            fresh = self._context.now_ns < live.received_ns + NS
            if fresh or live.marker.frame_locked or then is None or now is None:
                continue
            if np.abs(now - then).max() > _MOVED:
                text = "has moved since this marker came; RViz2 places it once. frame_locked = True follows."
                yield label(live.marker), f"{frame} {text}"

    def _process(self, marker: Any, received_ns: int) -> None:
        key = (marker.ns, marker.id)
        if not _finite(marker):
            problem = "Contains invalid floating point values (nans or infs)"
            self._statuses.set("error", label(marker), problem)
        elif marker.action == ADD:
            self._show(key, marker, received_ns)
        elif marker.action == DELETE:
            self._delete(key)
        elif marker.action == DELETEALL:
            for other in list(self.live):
                if marker.ns in ("", other[0]):
                    self._delete(other)
        else:
            self._statuses.hint(label(marker), f"RViz's log: Unknown marker action: {marker.action}")

    def _show(self, key: Key, marker: Any, received_ns: int) -> None:
        if not self.namespaces.setdefault(marker.ns, True):
            self._statuses.hint("Namespaces", f"{marker.ns!r} is not ticked: its markers are not shown.")
            return
        name = label(marker)
        self._statuses.delete(name)
        self._statuses.hint("Lifetime")
        before = self.live.get(key)
        live = self.live[key] = self._drawn(marker, received_ns, before)
        if live.drawn.refused:
            self._say(live)
        else:
            self._place(live)
        self._statuses.hint(name, *hints(marker), *_reused(before, live))

    def _drawn(self, marker: Any, received_ns: int, before: Live | None) -> Live:
        """Put a marker's picture into the scene, or keep the one that is there if it is the same."""
        path = self._node(marker)
        scene = self._context.scene
        if before and before.path == path and _look(marker) and _look(marker) == _look(before.marker):
            return Live(marker, before.drawn, path, received_ns, before.shown)
        if before:
            scene.delete(before.path)
        drawn = DRAW[marker.type](marker) if marker.type in DRAW else Drawn()
        for part, drawable in drawn.parts.items():
            scene.set_object(f"{path}/{part}", drawable)
        return Live(marker, drawn, path, received_ns)

    def _node(self, marker: Any) -> str:
        """Return the path of a marker: below its frame if it follows that."""
        base = f"{self._path}/{node_name(marker.ns)}/{marker.id}"
        frame = marker.header.frame_id.removeprefix("/")
        return f"frames/{node_name(frame)}/{base}" if marker.frame_locked else base

    def _place(self, live: Live) -> None:
        """Place a marker in the fixed frame by the transform at its stamp, or in its own frame if locked."""
        marker, scene = live.marker, self._context.scene
        frame, stamp_ns = marker.header.frame_id, nanoseconds(marker.header.stamp)
        transform = self._transform(live)
        if live.shown != (transform is not None):
            live.shown = not live.shown
            scene.set_visible(live.path, live.shown)
        first, live.transform_frame_to_fixed = live.transform_frame_to_fixed is None, transform
        if transform is None:
            problem = self._context.frames.problem(frame, stamp_ns) or ""
            self._statuses.set("error", label(marker), problem)
            return
        self._say(live)
        pose = placed(transform, marker.pose)
        if not marker.frame_locked:
            scene.set_transform(live.path, pose)
        elif first or not is_unit(marker.pose.orientation):
            scene.set_transform(live.path, np.linalg.inv(transform) @ pose)

    def _transform(self, live: Live) -> Matrix | None:
        header = live.marker.header
        if not live.marker.frame_locked:
            return self._context.frames.transform(header.frame_id, nanoseconds(header.stamp))
        followed = self._context.follow(header.frame_id)
        return followed[1] if followed else None

    def _moved(self, live: Live) -> bool:
        return not live.drawn.refused and self._transform(live) is not live.transform_frame_to_fixed

    def _say(self, live: Live) -> None:
        if live.drawn.status:
            level, text = live.drawn.status
            self._statuses.set(level, label(live.marker), text)

    def _expire(self, key: Key, live: Live) -> None:
        self._delete(key)
        if not self.live:
            lifetime = nanoseconds(live.marker.lifetime) / NS  # [s]
            self._statuses.hint("Lifetime", f"the last marker expired: its lifetime is {lifetime:g} s.")

    def _delete(self, key: Key) -> None:
        self._statuses.delete(f"{key[0]}/{key[1]}")
        live = self.live.pop(key, None)
        if live:
            self._context.scene.delete(live.path)


def _look(marker: Any) -> tuple[Any, ...] | None:
    """Return what a marker's picture depends on; None if comparing would cost as much as drawing."""
    if len(marker.points) or len(marker.colors):
        return None
    s, c = marker.scale, marker.color
    return (
        (marker.type, s.x, s.y, s.z, c.r, c.g, c.b, c.a),
        (marker.text, marker.mesh_resource, marker.mesh_use_embedded_materials),
    )


def _reused(before: Live | None, now: Live) -> tuple[str, ...]:
    if before is None or before.received_ns != now.received_ns:
        return ()
    if before.marker.header.stamp != now.marker.header.stamp:
        return ()  # they waited together for a transform
    return ("two markers with this ns and id came together: only the last is seen. Give each its own id.",)


def _finite(marker: Any) -> bool:
    """Check the numbers that RViz checks: not those of colors."""
    pose, s, c = marker.pose, marker.scale, marker.color
    p, q = pose.position, pose.orientation
    numbers = (p.x, p.y, p.z, q.x, q.y, q.z, q.w, s.x, s.y, s.z, c.r, c.g, c.b, c.a)
    return all(map(math.isfinite, numbers)) and all(
        math.isfinite(point.x + point.y + point.z) for point in marker.points
    )
