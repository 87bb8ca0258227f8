"""Pictures of a scene: by Chromium or Chrome where one is found, else by numpy."""

import base64
import contextlib
import os
import re
import shutil
import signal
import subprocess
import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Literal, TypeAlias

from course_lib.errors import CourseError
from course_lib.viewer import assets, encoding, zbuffer
from course_lib.viewer.scene import Scene

_NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "msedge")
_PLACES = (
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    "/Applications/Chromium.app/Contents/MacOS/Chromium",
    r"C:\Program Files\Google\Chrome\Application\chrome.exe",
    r"C:\Program Files (x86)\Microsoft\Edge\Application\msedge.exe",
)

# Software GL, as machines without a screen have no other; nothing is fetched and nothing reported.
FLAGS = [
    "--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader", "--disable-background-networking", "--disable-component-update",
    "--disable-sync", "--disable-extensions", "--no-first-run", "--disable-dev-shm-usage",
]  # fmt: skip


@cache
def find_browser() -> str | None:
    """Return the browser's program, or None."""
    found = [shutil.which(name) for name in _NAMES] + [place for place in _PLACES if Path(place).exists()]
    return next((program for program in found if program), None)


def dump_dom(program: str, page: str, timeout: float) -> str:
    """Load a page, let its scripts run, and return what became of it.

    Args:
        program: See `find_browser`.
        page: The page's text; scripts must be done when it has loaded.
        timeout: When to give up, in [s].

    Raises:
        TimeoutError: If the browser took longer; it has been ended.
        OSError: If it cannot be started.
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
            raise TimeoutError(f"{program} did not draw within {timeout:g} s.") from None
        finally:
            _end(process)


def _end(process: subprocess.Popen[bytes]) -> None:
    """End the browser with all its helpers."""
    if os.name == "posix":
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    else:
        process.kill()
    process.wait()


Renderer: TypeAlias = Literal["page", "chromium", "numpy"]

_TIMEOUT = 60.0  # [s]

# Nothing in this page waits, so that it is done when it has loaded.
_PAGE = """\
<!doctype html><meta charset="utf-8"><body><script>%(script)s</script><script>
document.body.dataset.picture = globalThis["%(key)s"].picture("%(scene)s", %(width)d, %(height)d);
</script>"""


@dataclass(frozen=True)
class Picture:
    """A picture of a scene."""

    png: bytes  # the file's content
    renderer: Renderer  # what drew it
    note: str = ""  # why it was not drawn by a browser, or ""

    def save(self, path: str | Path) -> None:
        """Write the file, and the folder that it lies in."""
        path = Path(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(self.png)


def screenshot(
    scene: Scene,
    path: str | Path | None = None,
    size: tuple[int, int] = (800, 600),
    renderer: Literal["auto", "chromium", "numpy"] = "auto",
) -> Picture:
    """Draw a scene as it is now, into a PNG of a size in pixels.

    "auto" takes Chromium or Chrome where found, and numpy if there is none or it fails.

    Raises:
        CourseError: If "chromium" was asked for and could not draw.
    """
    if renderer == "numpy":
        picture = Picture(zbuffer.draw(scene, size), "numpy")
    else:
        try:
            picture = Picture(_by_browser(scene, size), "chromium")
        except (CourseError, OSError) as error:  # TimeoutError is an OSError
            if renderer == "chromium":
                raise CourseError(f"{error} Take renderer='numpy', which needs no browser.") from error
            picture = Picture(zbuffer.draw(scene, size), "numpy", note=str(error))
    if path is not None:
        picture.save(path)
    return picture


def _by_browser(scene: Scene, size: tuple[int, int]) -> bytes:
    program = find_browser()
    if program is None:
        raise CourseError("No Chromium or Chrome was found on this machine.")
    key, script = assets.bundle()
    page = _PAGE % {
        "script": script.replace("</script", r"<\\/script"),
        "key": key,
        "scene": base64.b64encode(encoding.snapshot(scene)).decode(),
        "width": size[0],
        "height": size[1],
    }
    found = re.search(r'data-picture="data:image/png;base64,([^"]+)"', dump_dom(program, page, _TIMEOUT))
    if found is None:
        raise CourseError(f"{program} came back without a picture: is WebGL switched off?")
    return base64.b64decode(found[1])
