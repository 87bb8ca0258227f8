"""`course view`: RViz in a browser's tab, on this machine."""

import asyncio
import sys
import webbrowser
from pathlib import Path

from course_lib.displays.panel.desk import Desk
from course_lib.displays.panel.time_panel import Playback, TimePanel
from course_lib.displays.render import session_for
from course_lib.recording import Recording, read_bag
from course_lib.ros import wall
from course_lib.viewer.page_server import PageServer


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
    recording = Recording(()) if bag is None else read_bag(bag)
    session = session_for(recording, rviz)
    session.refresh()
    server = PageServer(session.context.scene, f"course view: {bag or rviz or 'a grid'}", port, token)
    Desk(session, server.link)
    playback = Playback(session, recording)
    time_panel = TimePanel(session, server.link, playback) if bag else None
    server.listen()
    sys.stdout.write(f"The viewer is at {server.url}\nCtrl+C ends it.\n")
    sys.stdout.flush()
    if browser:
        webbrowser.open(server.url)
    try:
        asyncio.run(_serve(server, playback, time_panel))
    except KeyboardInterrupt:
        sys.stdout.write("\nThe viewer has ended.\n")


async def _serve(server: PageServer, playback: Playback, time_panel: TimePanel | None) -> None:
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
