"""Scenes as web pages that need nothing but themselves."""

import base64
import gzip
from html import escape
from pathlib import Path

from course_lib.viewer import assets, encoding
from course_lib.viewer.film import Film
from course_lib.viewer.scene import Scene, described

_PAGE = """\
<!doctype html>
<html lang="en">
<meta charset="utf-8">
<link rel="icon" href="data:,">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>html, body {{ margin: 0; height: 100%; background: rgb{background} }}</style>
{fragment}
{script}
</html>
"""

_FRAGMENT = """\
<div class="course-scene" style="height:{height};overflow:hidden" data-label="{words}" data-alone="{alone}">\
<noscript>{label}: needs JavaScript.</noscript><script type="text/plain">{scene}</script></div>"""

_MAIN = """\
<style>
body, main { display: flex; flex-direction: column; overflow: hidden }
main, main > .course-viewer { flex: 1; min-height: 0 }
</style>
<main class="course-page"></main>"""

MOUNT_ALL = "(viewer) => viewer.mountAll()"
_CODE = """\
(async () => {{
  const zipped = Uint8Array.from(atob("{zipped}"), (sign) => sign.charCodeAt(0));
  const stream = new Blob([zipped]).stream().pipeThrough(new DecompressionStream("gzip"));
  (0, eval)(await new Response(stream).text());
  await ({start})(globalThis["{key}"]);
}})().catch((error) => document.body.append("The 3D view could not start: " + error));
"""


def save_html(scene: Scene | Film, path: str | Path, title: str = "3D view") -> Path:
    """Write one page that shows a scene, or plays a film, also offline and from a file."""
    fragment = scene_fragment(scene, height="100%", label=title, alone=True)
    shown = scene.scene if isinstance(scene, Film) else scene
    background = str(shown.background)
    page = _PAGE.format(title=escape(title), background=background, fragment=fragment, script=bundle_script())
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(page, encoding="utf-8")
    return path


def scene_fragment(
    scene: Scene | Film, *, height: str = "300px", label: str = "3D view", alone: bool = False
) -> str:
    """Return the element that shows a scene in a page; `bundle_script` comes once, after the last one.

    Args:
        scene: What to show as it is now, or what to play; then a time bar is below.
        height: In any of CSS's units.
        label: What it is; for those who cannot see it, a list of what is drawn follows.
        alone: Whether the wheel may zoom without a click before, as nothing else needs it.
    """
    packed = scene.packed() if isinstance(scene, Film) else encoding.snapshot(scene)
    zipped = base64.b64encode(gzip.compress(packed, 6, mtime=0)).decode()
    words = escape(described(scene.scene if isinstance(scene, Film) else scene, label))
    return _FRAGMENT.format(
        height=height, label=escape(label), words=words, alone=str(alone).lower(), scene=zipped
    )


def live_page(title: str) -> str:
    """Return a page that follows the scene of the program that it comes from, over a WebSocket."""
    script = bundle_script('(viewer) => viewer.follow(document.querySelector("main"))')
    return _PAGE.format(title=escape(title), background=Scene().background, fragment=_MAIN, script=script)


def bundle_script(start: str = MOUNT_ALL) -> str:
    """Return the element that starts all scenes of a page."""
    return f"<script>\n{bundle_code(start)}</script>"


def bundle_code(start: str = MOUNT_ALL) -> str:
    """Return what that element does, for pages that share one file of it; `start` is given the viewer."""
    zipped = base64.b64encode(assets.bundle_zipped()).decode()
    return _CODE.format(zipped=zipped, key=assets.bundle_name(), start=start)
