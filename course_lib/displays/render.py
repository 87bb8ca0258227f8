"""Render recordings and robots through RViz's displays: images, pages, or `course view`."""

import asyncio
import sys
from collections import Counter
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_lib.displays.frames import NS
from course_lib.displays.layout import read_layout
from course_lib.displays.markers import ADD, MARKER, MARKER_ARRAY
from course_lib.displays.panel.panels import PanelController, Playback, TimePanel
from course_lib.displays.session import TF, RvizSession
from course_lib.displays.statuses import exceptions_as_status
from course_lib.displays.viewer import Viewer
from course_lib.host import announce
from course_lib.recording import Recording, read_bag
from course_lib.ros.graph.graph import use_graph
from course_lib.ros.robot.connect import RobotAddress, link_to
from course_lib.ros.time import virtual_time, wall
from course_lib.ros.time.time_lock import time_lock
from course_lib.viewer.html import save_html
from course_lib.viewer.renderer import screenshot
from course_lib.viewer.scene import Scene
from course_lib.viewer.scene_recording import SceneRecording

if TYPE_CHECKING:
    from course_lib.viewer.page_server import PageServer

_DISPLAYS = {MARKER: "Marker", MARKER_ARRAY: "MarkerArray"}


def scene_of(
    recording: Recording,
    rviz_path: str | Path | None = None,
    at: float | None = None,
) -> Scene:
    """Draw a recording with a layout.

    Args:
        recording: The recording.
        rviz_path: The layout; None shows a grid and all marker topics.
        at: The time [s] after the first message; None means the end.
    """
    return replay(recording, rviz_path, at).context.scene


def replay(
    recording: Recording,
    rviz_path: str | Path | None = None,
    at: float | None = None,
) -> RvizSession:
    """Play a recording up to a time, and return the session with its statuses; see `scene_of`."""
    session = session_for(recording, rviz_path)
    Playback(session, recording).go_to(_end_ns(recording, at))
    return session


def record_bag(
    recording: Recording,
    rviz_path: str | Path | None = None,
    at: float | None = None,
    frame_rate: int | None = None,
) -> tuple[SceneRecording, RvizSession]:
    """Record a replay from the beginning to a time, at RViz's frame rate by default; see `scene_of`."""
    session = session_for(recording, rviz_path)
    thinned = {"interval": 1 / frame_rate} if frame_rate else {}
    context = session.context
    scene_recording = SceneRecording(
        context.scene, lambda: context.now_ns / NS, seconds=inf, megabytes=200, **thinned
    )
    playback, end_ns = Playback(session, recording), _end_ns(recording, at)
    for now_ns in range(recording.start_ns, end_ns, NS // (frame_rate or session.time.frame_rate)):
        playback.go_to(now_ns)
    playback.go_to(end_ns)
    scene_recording.stop()
    return scene_recording, session


def session_for(recording: Recording, rviz_path: str | Path | None = None) -> RvizSession:
    """Return a session with a layout, or displays that suit a recording, before its first message."""
    session = RvizSession(Scene(), start_ns=recording.start_ns, match_qos=False)
    session.is_replay = True
    if rviz_path is None:
        session.add("rviz_default_plugins/Grid", "Grid", {})
        topics = {topic.name: topic.type_name for topic in recording.topics() if topic.type_name in _DISPLAYS}
        for topic, type_name in topics.items():
            if topics.get(topic.removesuffix("_array")) != MARKER or type_name == MARKER:
                name = _DISPLAYS[type_name]
                session.add(f"rviz_default_plugins/{name}", name, {"Topic": topic})
        if not topics and any(sample.type_name == TF for sample in recording.samples):
            session.add("rviz_default_plugins/TF", "TF", {"Show Names": True, "Marker Scale": 3.0})
        session.fixed_frame = _likely_fixed_frame(session, recording)
        guess = f"no layout was given: {session.fixed_frame!r} is the root of the displayed frames."
        session.statuses.hint("Fixed Frame", guess)
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
    """Render a bag as an image with a size in [px], a page, or both; see `scene_of`.

    Returns:
        Lines about the written files, the renderer, and statuses that are not ok.
    """
    recording, lines = read_bag(bag), []
    if html:
        scene_recording, session = record_bag(recording, rviz, at)
        save_html(scene_recording, html, title=bag.name)
        lines.append(f"Wrote {html}. {scene_recording.missing_part_notice()}".rstrip())
    else:
        session = replay(recording, rviz, at)
    if png:
        picture = screenshot(session.context.scene, png, size=size)
        lines.append(f"Wrote {png}, drawn by {picture.renderer}.")
    complaints = (row for row in session.rows() if row.level != "ok")
    lines += [f"{row.display} / {row.name}: {row.level}: {row.text}" for row in complaints]
    return "\n".join(lines)


def _end_ns(recording: Recording, at: float | None) -> int:
    return recording.end_ns if at is None else recording.start_ns + round(at * NS)


def _likely_fixed_frame(session: RvizSession, recording: Recording) -> str:
    """Return the most frequent root frame of the markers, else of the transforms, else ``map``."""
    parents, marker_frames = dict[str, str](), list[str]()
    for sample in recording.samples:
        message: Any = None
        if sample.type_name in (TF, *_DISPLAYS):
            # An invalid message becomes a status of the displays of its topic.
            with exceptions_as_status(session.statuses, "Message"):
                message = sample.message()
        if message is None:
            continue
        if sample.type_name == TF:
            parents |= {t.child_frame_id: t.header.frame_id for t in message.transforms}
        else:
            markers = [message] if sample.type_name == MARKER else message.markers
            marker_frames += [marker.header.frame_id for marker in markers if marker.action == ADD]
    roots = Counter[str]()
    for frame in marker_frames or parents:
        root = frame
        # In a cycle, each frame is visited once.
        for _ in parents:
            root = parents.get(root, root)
        roots[root] += 1
    return roots.most_common(1)[0][0] if roots else "map"


def view(
    bag: Path | None = None,
    rviz: Path | None = None,
    *,
    port: int = 0,
    token: str | None = None,
    browser: bool = True,
) -> None:
    """Show a layout, and play a bag through it, until Ctrl+C.

    The bag starts playing when a page is open. Without a layout, a grid and all marker topics are
    shown. `port` and `token` determine the URL: 0 selects a free port, None generates a secret
    token.

    Raises:
        CourseError: The bag or the layout cannot be read, or the port is in use.
    """
    # Imported here because tornado is slow to load.
    from course_lib.viewer.page_server import PageServer

    recording = Recording(()) if bag is None else read_bag(bag)
    session = session_for(recording, rviz)
    session.refresh()
    server = PageServer(session.context.scene, f"course view: {bag or rviz or 'a grid'}", port, token)
    PanelController(session, server.link)
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
    """Serve indefinitely, and let time advance while a page is open."""
    serving = asyncio.create_task(server.serve())
    last = wall.monotonic()
    while not serving.done():
        await asyncio.sleep(1 / 30)
        before, last = last, wall.monotonic()
        if server.link.is_ready:
            playback.advance(last - before)
            if time_panel:
                time_panel.refresh()
    await serving


STEP_NS = 10**8  # [ns]


def view_robot(
    robot: RobotAddress,
    rviz: Path | None,
    *,
    port: int = 0,
    token: str | None = None,
    browser: bool = True,
    use_sim_time: bool = False,
) -> None:
    """Show a robot through a layout, or its frames without one, until Ctrl+C.

    `port` and `token` determine the URL: 0 selects a free port, None generates a secret token.
    With `use_sim_time` the view's time is the time on the robot's /clock.

    Raises:
        CourseError: The robot cannot be reached, the layout cannot be read, or the port is in use.
    """
    graph = link_to(robot)
    virtual_time.install()
    try:
        with use_graph(graph):
            if rviz is None:
                viewer = Viewer(use_sim_time=use_sim_time)
                viewer.add("TF", show_names=True)
            else:
                viewer = Viewer.from_rviz(rviz, use_sim_time=use_sim_time)
            viewer.open(browser=browser, port=port, token=token)
            sys.stdout.write("Ctrl+C ends it.\n")
            sys.stdout.flush()
            with time_lock.hold():
                while True:
                    time_lock.sleep_until(graph.now_ns + STEP_NS, "Ctrl+C")
    except KeyboardInterrupt:
        sys.stdout.write("\nThe viewer has ended.\n")
    finally:
        graph.close()
