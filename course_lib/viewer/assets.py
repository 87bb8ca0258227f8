"""The viewer's JavaScript: meshcat's own bundle with ours after it, as one script without requests."""

import gzip
import hashlib
import json
import re
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from course_lib.errors import CourseError

# In the order in which they need each other.
_MODULES = (
    "decode", "encode", "icons", "materials", "surfaces", "billboards", "orbit", "insets", "mirror",
    "renderer", "panels/parts", "labels", "view", "panels/time", "panels/editors", "panels/tree",
    "panels/gestures", "panels/panels", "panels/desk", "panels/place", "film", "player", "link",
    "page", "socket",
)  # fmt: skip
_FOLDER = Path(__file__).parent / "js"

# meshcat's bundle finds `module` here, and no RequireJS whatever else the page has loaded.
_SCRIPT = b"""\
globalThis["%(key)s"] ??= (() => {
const MeshCat = ((module, exports, define) => { %(meshcat)s
return module.exports; }).call(globalThis, { exports: {} }, {}, undefined);
const { THREE } = MeshCat;
%(ours)s
return { Link, follow, mount, mountAll, picture, unpacked };
})();
"""


def bundle() -> tuple[str, str]:
    """Return the name under which a page finds the viewer, and the script that puts it there."""
    key, zipped = _zipped()
    return key, gzip.decompress(zipped).decode()


def bundle_name() -> str:
    """Return the name under which a page finds the viewer."""
    return _zipped()[0]


def bundle_zipped() -> bytes:
    """Return the script, compressed."""
    return _zipped()[1]


@cache
def _zipped() -> tuple[str, bytes]:
    """Return the name and the compressed script: as text it would hold 2 MB of each kernel."""
    style = json.dumps((_FOLDER / "panels" / "desk.css").read_text("utf-8"))
    scripts = [f"const DESK_STYLE = {style};", *(_joinable(name) for name in _MODULES)]
    meshcat, ours = _meshcat(), "\n".join(scripts).encode()
    key = "__courseViewer_" + hashlib.sha256(meshcat + ours).hexdigest()[:12]
    script = _SCRIPT % {b"key": key.encode(), b"meshcat": meshcat, b"ours": ours}
    return key, gzip.compress(script, 9, mtime=0)


@cache
def widget_module() -> str:
    """Return the module of a widget, which loads the script."""
    return (_FOLDER / "widget.js").read_text("utf-8").replace("__KEY__", bundle_name())


def _meshcat() -> bytes:
    package = find_spec("meshcat")  # without importing it, which takes a second
    if package is None or package.origin is None:
        raise CourseError("The package meshcat is missing: pip install meshcat==0.3.2")
    path = Path(package.origin).parent / "viewer" / "dist" / "main.min.js"
    return path.read_bytes()  # as text it takes twice the memory


def _joinable(name: str) -> str:
    """Return a module's text without types, imports and exports: together all are one function."""
    text = re.sub(r"/\*\*.*?\*/", "", (_FOLDER / f"{name}.js").read_text("utf-8"), flags=re.S)
    return re.sub(r"^export ", "", re.sub(r"^import [^;]*;$", "", text, flags=re.M), flags=re.M)
