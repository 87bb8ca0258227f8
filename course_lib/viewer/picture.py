"""Pictures of a scene: by a browser where one is found, else by numpy."""

import base64
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, TypeAlias

from course_lib.errors import CourseError
from course_lib.viewer import assets, encoding, zbuffer
from course_lib.viewer.browser import dump_dom, find_browser
from course_lib.viewer.scene import Scene

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
        Path(path).write_bytes(picture.png)
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
