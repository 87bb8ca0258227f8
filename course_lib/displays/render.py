"""Recordings through RViz's displays: as a scene, as a film, or in a browser's tab (`course view`)."""

import asyncio
import sys
from collections import Counter
from collections.abc import Mapping
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_lib.displays.frames import NS
from course_lib.displays.layout import read_layout
from course_lib.displays.marker.display import MARKER, MARKER_ARRAY
from course_lib.displays.marker.store import ADD
from course_lib.displays.own_topics import TF
from course_lib.displays.panel.desk import Desk
from course_lib.displays.panel.time_panel import Playback, TimePanel
from course_lib.displays.session import RvizSession
from course_lib.recording import Recording, read_bag
from course_lib.ros import wall
from course_lib.surroundings import announce
from course_lib.viewer.film import Film
from course_lib.viewer.html import save_html
from course_lib.viewer.picture import screenshot
from course_lib.viewer.scene import Scene

if TYPE_CHECKING:
    from course_lib.viewer.page_server import PageServer

_DISPLAYS = {MARKER: "Marker", MARKER_ARRAY: "MarkerArray"}


def scene_of(recording: Recording, rviz_path: str | Path | None = None, at: float | None = None) -> Scene:
    """Draw a recording through a layout.

    Args:
        recording: What was published.
        rviz_path: The layout; None shows all topics of markers, and a grid.
        at: When to look, in [s] after the first message; None means at the end.
    """
    return replayed(recording, rviz_path, at).context.scene


def replayed(
    recording: Recording, rviz_path: str | Path | None = None, at: float | None = None
) -> RvizSession:
    """Play a recording to a session up to a time; its statuses are those of RViz, see `scene_of`."""
    session = session_for(recording, rviz_path)
    Playback(session, recording).go_to(_end_ns(recording, at))
    return session


def film_of(
    recording: Recording,
    rviz_path: str | Path | None = None,
    at: float | None = None,
    frame_rate: int | None = None,
) -> tuple[Film, RvizSession]:
    """Film a recording from its beginning to a time, in frames a second as RViz shows it; see `scene_of`."""
    session = session_for(recording, rviz_path)
    thinned = {"interval": 1 / frame_rate} if frame_rate else {}
    context = session.context
    film = Film(context.scene, lambda: context.now_ns / NS, seconds=inf, megabytes=200, **thinned)
    playback, end_ns = Playback(session, recording), _end_ns(recording, at)
    for now_ns in range(recording.start_ns, end_ns, NS // (frame_rate or session.time.frame_rate)):
        playback.go_to(now_ns)
    playback.go_to(end_ns)
    film.stop()
    return film, session


def session_for(recording: Recording, rviz_path: str | Path | None = None) -> RvizSession:
    """Return a session with a layout, or one that fits a recording, before its first message."""
    session = RvizSession(Scene(), start_ns=recording.start_ns, match_qos=False)
    if rviz_path is None:
        _show_all(session, recording)
    else:
        session.apply(read_layout(rviz_path))
    return session


def render_bag(
    bag: Path,
    *,
    rviz: Path | None = None,
    at: float | None = None,
    size: tuple[int, int] = (800, 600),
    png: Path | None = None,
    html: Path | None = None,
) -> str:
    """Draw the bag in a folder into a picture of a size in [px], a page, or both; see `scene_of`.

    Returns:
        What was written, what drew it, and what the statuses complain about.
    """
    recording, lines = read_bag(bag), []
    if html:
        film, session = film_of(recording, rviz, at)
        save_html(film, html, title=bag.name)
        lines.append(f"Wrote {html}. {film.note()}".rstrip())
    else:
        session = replayed(recording, rviz, at)
    if png:
        picture = screenshot(session.context.scene, png, size=size)
        lines.append(f"Wrote {png}, drawn by {picture.renderer}.")
    complaints = (row for row in session.rows() if row.level != "ok")
    lines += [f"{row.display} / {row.name}: {row.level}: {row.text}" for row in complaints]
    return "\n".join(lines)


def _end_ns(recording: Recording, at: float | None) -> int:
    return recording.end_ns if at is None else recording.start_ns + round(at * NS)


def _show_all(session: RvizSession, recording: Recording) -> None:
    """Show a grid and all topics of markers, without any the frames, in a frame that fits them."""
    session.add("rviz_default_plugins/Grid", "Grid", {})
    topics = {topic.name: topic.type_name for topic in recording.topics() if topic.type_name in _DISPLAYS}
    for topic, type_name in topics.items():
        if topics.get(topic.removesuffix("_array")) != MARKER or type_name == MARKER:
            name = _DISPLAYS[type_name]
            session.add(f"rviz_default_plugins/{name}", name, {"Topic": topic})
    if not topics and any(sample.type_name == TF for sample in recording.samples):
        session.add("rviz_default_plugins/TF", "TF", {"Show Names": True, "Marker Scale": 3.0})
    session.fixed_frame = _likely_fixed_frame(recording)
    guess = f"no layout was given: {session.fixed_frame!r} is the root of what is shown."
    session.statuses.hint("Fixed Frame", guess)


def _likely_fixed_frame(recording: Recording) -> str:
    """Return the root of most frames that markers are in, or of the transforms, or ``map``."""
    parents, used = dict[str, str](), list[str]()
    for sample in recording.samples:
        message: Any = sample.message() if sample.type_name in (TF, *_DISPLAYS) else None
        if sample.type_name == TF:
            parents |= {t.child_frame_id: t.header.frame_id for t in message.transforms}
        elif message is not None:
            markers = [message] if sample.type_name == MARKER else message.markers
            used += [marker.header.frame_id for marker in markers if marker.action == ADD]
    roots = Counter(_root(frame, parents) for frame in used or parents)
    return roots.most_common(1)[0][0] if roots else "map"


def _root(frame: str, parents: Mapping[str, str]) -> str:
    """Follow parents up to the root of a tree, or once around a loop."""
    for _ in parents:
        frame = parents.get(frame, frame)
    return frame


def view(
    bag: Path | None = None,
    rviz: Path | None = None,
    *,
    port: int = 0,
    token: str | None = None,
    browser: bool = True,
) -> None:
    """Show a layout, and play a bag through it, until Ctrl+C.

    The bag plays as soon as a page is open; without a layout a grid is shown, and all its topics of markers.
    `port` and `token` make the address: 0 lets the system choose a free port, None makes a secret part up.

    Raises:
        CourseError: If the bag or the layout cannot be read, or the port is taken.
    """
    from course_lib.viewer.page_server import PageServer  # here: tornado is slow to load

    recording = Recording(()) if bag is None else read_bag(bag)
    session = session_for(recording, rviz)
    session.refresh()
    server = PageServer(session.context.scene, f"course view: {bag or rviz or 'a grid'}", port, token)
    Desk(session, server.link)
    playback = Playback(session, recording)
    time_panel = TimePanel(session, server.link, playback) if bag else None
    server.listen()
    announce("The viewer", server.url, browser=browser)
    sys.stdout.write("Ctrl+C ends it.\n")
    sys.stdout.flush()
    try:
        asyncio.run(_serve(server, playback, time_panel))
    except KeyboardInterrupt:
        sys.stdout.write("\nThe viewer has ended.\n")


async def _serve(server: "PageServer", playback: Playback, time_panel: TimePanel | None) -> None:
    """Serve for ever, and let time go on while a page is open."""
    serving = asyncio.create_task(server.serve())
    last = wall.monotonic()
    while not serving.done():
        await asyncio.sleep(1 / 30)
        before, last = last, wall.monotonic()
        if server.link.ready:
            playback.advance(last - before)
            if time_panel:
                time_panel.refresh()
    await serving
