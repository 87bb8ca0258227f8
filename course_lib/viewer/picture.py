"""Images of a scene, rendered by Chromium or Chrome if available, else by numpy."""

import base64
import contextlib
import os
import re
import shutil
import signal
import struct
import subprocess
import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Literal, TypeAlias

from course_lib.errors import CourseError
from course_lib.files import write_atomically
from course_lib.viewer import encoding, html
from course_lib.viewer.renderer import draw
from course_lib.viewer.scene import Scene

_NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "msedge")
_PLACES = (
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    "/Applications/Chromium.app/Contents/MacOS/Chromium",
    r"C:\Program Files\Google\Chrome\Application\chrome.exe",
    r"C:\Program Files (x86)\Microsoft\Edge\Application\msedge.exe",
)

# Machines without a screen have only software GL. All network requests and reports are disabled.
FLAGS = [
    "--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader", "--disable-background-networking", "--disable-component-update",
    "--disable-sync", "--disable-extensions", "--no-first-run", "--disable-dev-shm-usage",
]  # fmt: skip


@cache
def find_browser() -> str | None:
    """Return the path of a browser, or None."""
    programs = [shutil.which(name) for name in _NAMES] + [place for place in _PLACES if Path(place).exists()]
    return next((program for program in programs if program), None)


def dump_dom(program: str, page: str, timeout: float) -> str:
    """Load a page, let its scripts run, and return the resulting DOM as text.

    Args:
        program: See `find_browser`.
        page: The text of the page; its scripts must finish while it loads.
        timeout: The timeout [s].

    Raises:
        TimeoutError: The browser took longer and was killed.
        OSError: It cannot be started.
    """
    with tempfile.TemporaryDirectory(prefix="course-", ignore_cleanup_errors=True) as folder:
        path = Path(folder, "scene.html")
        path.write_text(page, encoding="utf-8")
        command = [program, *FLAGS, f"--user-data-dir={folder}/profile", "--dump-dom", path.as_uri()]
        process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        try:
            return process.communicate(timeout=timeout)[0].decode("utf-8", "replace")
        except subprocess.TimeoutExpired:
            raise TimeoutError(f"{program} did not finish within {timeout:g} s.") from None
        finally:
            # Kill the browser with all its helper processes.
            if os.name == "posix":
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(process.pid, signal.SIGKILL)
            else:
                process.kill()
            process.wait()


Renderer: TypeAlias = Literal["page", "chromium", "numpy"]

_TIMEOUT = 60.0  # [s]

# Nothing in this page is asynchronous, so it is complete when it has loaded.
_PAGE = """\
<!doctype html><meta charset="utf-8"><meta http-equiv="Content-Security-Policy" content="%(policy)s">
<body><script>%(script)s</script><script>%(start)s</script>"""
_START = 'document.body.dataset.picture = globalThis["%(key)s"].picture("%(scene)s", %(width)d, %(height)d);'


@dataclass(frozen=True)
class Picture:
    """An image of a scene."""

    # Content of the file.
    png: bytes
    # The program that rendered it.
    renderer: Renderer
    # Reason for not using a browser, or "".
    note: str = ""

    def save(self, path: str | Path) -> None:
        """Write the file, and create its folder."""
        write_atomically(Path(os.path.realpath(path)), self.png)

    def _repr_png_(self) -> bytes:
        """Return the PNG, to display it below a notebook cell."""
        return self.png

    def __repr__(self) -> str:
        # The width and height follow the signature and the head of a PNG file's first chunk.
        width, height = struct.unpack_from(">II", self.png, 16)
        note = f" ({self.note})" if self.note else ""
        return f"<Picture of {width} x {height} pixels, drawn by {self.renderer}{note}>"


def screenshot(
    scene: Scene,
    path: str | Path | None = None,
    size: tuple[int, int] = (800, 600),
    renderer: Literal["auto", "chromium", "numpy"] = "auto",
) -> Picture:
    """Render the current state of a scene as a PNG with a size in pixels.

    "auto" uses Chromium or Chrome if available, and numpy if there is none or if it fails.

    Raises:
        CourseError: "chromium" was requested and failed.
    """
    if renderer == "numpy":
        picture = Picture(draw(scene, size), "numpy")
    else:
        try:
            picture = Picture(_draw_in_browser(scene, size), "chromium")
        # TimeoutError is an OSError.
        except (CourseError, OSError) as error:
            if renderer == "chromium":
                raise CourseError(f"{error} Use renderer='numpy', which needs no browser.") from error
            picture = Picture(draw(scene, size), "numpy", note=str(error))
    if path is not None:
        picture.save(path)
    return picture


def _draw_in_browser(scene: Scene, size: tuple[int, int]) -> bytes:
    program = find_browser()
    if program is None:
        raise CourseError("No Chromium or Chrome was found on this machine.")
    key, script = html.bundle()
    script = script.replace("</script", r"<\\/script")
    encoded_scene = base64.b64encode(encoding.encode_snapshot(scene)).decode()
    start = _START % {"key": key, "scene": encoded_scene, "width": size[0], "height": size[1]}
    page = _PAGE % {"policy": html.content_policy(script, start), "script": script, "start": start}
    match = re.search(r'data-picture="data:image/png;base64,([^"]+)"', dump_dom(program, page, _TIMEOUT))
    if match is None:
        raise CourseError(f"{program} returned no image: is WebGL disabled?")
    return base64.b64decode(match[1])
