"""Scenes as self-contained web pages."""

import base64
import gzip
import hashlib
import json
import re
from functools import cache
from html import escape
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from course_lib.errors import CourseError
from course_lib.files import save_as
from course_lib.viewer import encoding
from course_lib.viewer.scene import Scene, describe_scene
from course_lib.viewer.scene_recording import SceneRecording

# The JavaScript modules, each after the modules that it imports.
_MODULES = (
    "decode", "encode", "icons", "materials", "quality", "coarse", "studio", "surfaces", "billboards",
    "orbit", "insets", "labels", "mirror", "renderer", "panels/elements", "view", "panels/time",
    "panels/editors", "panels/tree", "panels/gestures", "panels/panels", "panels/frame", "panels/place",
    "recording", "player", "link", "page", "socket",
)  # fmt: skip
_FOLDER = Path(__file__).parent / "js"
# A string, which keeps its spaces, or an operator with spaces around it.
_SPACED = re.compile(r'("[^"]*")| *([=<>?:,;{}()&|[\]]) *')
# Other strings, templates, regular expressions and directives of shaders keep their spaces.
_UNSAFE = re.compile(r"['`/#\\]")

# Defines `module` for meshcat's bundle, and hides a RequireJS that the page may have loaded.
_SCRIPT = b"""\
globalThis["%(key)s"] ??= (() => {
const MeshCat = ((module, exports, define) => { %(meshcat)s
return module.exports; }).call(globalThis, { exports: {} }, {}, undefined);
const { THREE } = MeshCat;
%(ours)s
return { Link, follow, mount, mountAll, picture, unpacked };
})();
"""


class Bundle(NamedTuple):
    """The viewer's global name in a page, and the compressed script that defines it."""

    name: str
    # Uncompressed it would take 2 MB of each kernel.
    zipped: bytes

    @property
    def script(self) -> str:
        """The script as text."""
        return gzip.decompress(self.zipped).decode()


@cache
def bundle() -> Bundle:
    """Return the viewer's script."""
    style = json.dumps(re.sub(r"\s+", " ", (_FOLDER / "panels" / "panels.css").read_text("utf-8")))
    scripts = [f"const PANEL_STYLE = {style};"]
    for name in _MODULES:
        # All modules form one function, so their imports and exports are removed. Comments,
        # blank lines and indentation are removed because each page with a view holds the script.
        text = re.sub(r"/\*\*.*?\*/", "", (_FOLDER / f"{name}.js").read_text("utf-8"), flags=re.S)
        text = re.sub(r"^\s*//.*\n| +// .*$", "", text, flags=re.M)
        text = re.sub(r"^import [^;]*;$", "", text, flags=re.M)
        text = re.sub(r"^(export |\s+)", "", text, flags=re.M)
        scripts += [line if _UNSAFE.search(line) else _SPACED.sub(r"\1\2", line) for line in text.split("\n")]
    # Importing meshcat would take a second, and its script as a string would take twice the memory.
    package = find_spec("meshcat")
    if package is None or package.origin is None:
        raise CourseError("The package meshcat is missing: pip install meshcat==0.3.2")
    meshcat = (Path(package.origin).parent / "viewer" / "dist" / "main.min.js").read_bytes()
    own_script = "\n".join(scripts).encode()
    key = "__courseViewer_" + hashlib.sha256(meshcat + own_script).hexdigest()[:12]
    script = _SCRIPT % {b"key": key.encode(), b"meshcat": meshcat, b"ours": own_script}
    return Bundle(key, gzip.compress(script, 9, mtime=0))


@cache
def widget_module() -> str:
    """Return the module of a widget, which loads the script."""
    return (_FOLDER / "widget.js").read_text("utf-8").replace("__KEY__", bundle().name)


_PAGE = """\
<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<link rel="icon" href="data:,">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>html, body {{ margin: 0; height: 100%; background: rgb{background} }}</style>
{fragment}
<script>{script}</script>
</html>
"""

# Only scripts of the kit can run, identified by their hashes, regardless of students' text,
# and nothing is loaded. In a page with scenes, the viewer needs eval to unpack itself.
_POLICY = (
    "default-src 'none'; script-src {scripts}; style-src 'unsafe-inline'; img-src data: blob:; "
    "font-src data:; connect-src {connect}; base-uri 'none'; form-action 'none'"
)

_FRAGMENT = """\
<div class="course-scene" style="height:{height};overflow:hidden" data-label="{words}" data-alone="{alone}">\
<noscript><p style="margin:0;padding:1em;font:1rem sans-serif;background:#222;color:#eee">\
{label}: needs JavaScript.{trust}</p></noscript><script type="text/plain">{scene}</script></div>"""

_MAIN = """\
<style>
body, main { display: flex; flex-direction: column; overflow: hidden }
main, main > .course-viewer { flex: 1; min-height: 0 }
</style>
<main class="course-page"></main>"""

# JupyterLab opens a page without its scripts.
_TRUST = " In JupyterLab, press <b>Trust HTML</b> above, or open the file in a browser tab."

MOUNT_ALL = "(viewer) => viewer.mountAll()"
_CODE = """\
(async () => {{
  const zipped = Uint8Array.from(atob("{zipped}"), (sign) => sign.charCodeAt(0));
  const stream = new Blob([zipped]).stream().pipeThrough(new DecompressionStream("gzip"));
  (0, eval)(await new Response(stream).text());
  await ({start})(globalThis["{key}"]);
}})().catch((error) => document.body.append("The 3D view could not start: " + error));
"""


def save_html(scene: Scene | SceneRecording, path: str | Path, title: str = "3D view") -> Path:
    """Write a page that shows a scene or plays a recording, offline and as a local file, too.

    Raises:
        CourseError: The page cannot be written.
    """
    save_as(path, static_page(scene, title).encode(), "the page")
    return Path(path)


def static_page(scene: Scene | SceneRecording, title: str = "3D view") -> str:
    """Return the HTML of a page that shows a scene, or plays a recording."""
    fragment = scene_fragment(scene, height="100%", label=title, alone=True)
    shown_scene = scene.scene if isinstance(scene, SceneRecording) else scene
    background = str(shown_scene.background)
    return _page(title, background, fragment, bundle_code())


def content_policy(
    *scripts: str, has_scenes: bool = True, loads_viewer: bool = False, connect: str = "'none'"
) -> str:
    """Return the Content-Security-Policy of a page, which also applies to a page opened as a file.

    Args:
        scripts: The exact texts of its script elements.
        has_scenes: Whether the viewer runs in it.
        loads_viewer: Whether these scripts load the viewer from another file.
        connect: Where scripts may connect to.
    """
    hashes = [base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in scripts]
    sources = [f"'sha256-{digest}'" for digest in hashes]
    sources += ["'unsafe-eval'"] * has_scenes + ["'strict-dynamic'"] * loads_viewer
    return _POLICY.format(scripts=" ".join(sources) or "'none'", connect=connect)


def _page(
    title: str,
    background: object,
    fragment: str,
    script: str,
    connect: str = "'none'",
) -> str:
    policy = content_policy(script, connect=connect)
    return _PAGE.format(
        title=escape(title), background=background, fragment=fragment, script=script, policy=policy
    )


def scene_fragment(
    scene: Scene | SceneRecording,
    *,
    height: str = "300px",
    label: str = "3D view",
    alone: bool = False,
) -> str:
    """Return the element that shows a scene in a page. The page needs `bundle_code` at its end.

    Args:
        scene: A scene to show in its current state, or a recording to play with a time bar.
        height: A CSS length.
        label: A name for screen readers; a list of the drawn objects is appended.
        alone: Whether the wheel zooms without a previous click, because nothing else in the page
            needs it.
    """
    scene_bytes = scene.pack() if isinstance(scene, SceneRecording) else encoding.snapshot(scene)
    zipped = base64.b64encode(gzip.compress(scene_bytes, 6, mtime=0)).decode()
    description = escape(describe_scene(scene.scene if isinstance(scene, SceneRecording) else scene, label))
    return _FRAGMENT.format(
        height=height,
        label=escape(label),
        trust=_TRUST if alone else "",
        words=description,
        alone=str(alone).lower(),
        scene=zipped,
    )


def live_page(title: str) -> str:
    """Return a page that shows the scene of the serving program, over a WebSocket."""
    script = bundle_code('(viewer) => viewer.follow(document.querySelector("main"))')
    return _page(title, Scene().background, _MAIN, script, connect="'self' ws: wss:")


def bundle_code(start: str = MOUNT_ALL) -> str:
    """Return the script that starts all scenes of a page.

    `start` is a function that is given the viewer.
    """
    zipped = base64.b64encode(bundle().zipped).decode()
    return _CODE.format(zipped=zipped, key=bundle().name, start=start)
