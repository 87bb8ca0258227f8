"""Chromium or Chrome, as found on this machine, run once without a window."""

import contextlib
import os
import shutil
import signal
import subprocess
import tempfile
from functools import cache
from pathlib import Path

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
