"""The book in a lesson's kernel: what a cell shows in 3D becomes a scene of the page, kept in a file."""

import base64
import gzip
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import Any

from IPython.core.getipython import get_ipython

from course_lib.course.state import write_whole
from course_lib.displays.panel.resting_view import RestingView
from course_lib.displays.viewer import Viewer
from course_lib.viewer import encoding, zbuffer
from course_lib.viewer.film import copied
from course_lib.viewer.scene import Scene
from course_lib.viewer.widget import SceneWidget

HEIGHT = 320  # [px] of a scene in the page
POSTER = (640, 272)  # [px] of the picture that stands there before
SECONDS = 20.0  # [s] of robot time that a scene plays at most
PLACE = """\
<div class="course-scene" style="height:{height}px;overflow:hidden" data-scene="{folder}/{name}.js" \
data-label="{label}" data-alone="false">\
<img src="{folder}/{name}.png" alt="{label}" loading="lazy"></div>"""


@dataclass
class _Playing:
    """A viewer in its cell, while the next cells run."""

    name: str
    viewer: Viewer
    since: float  # [s] of robot time, when it was shown
    packed: bytes = b""  # its film, as the last cell left it
    scene: Scene = field(default_factory=Scene)  # its last picture


class Scenes:
    """The scenes of one lesson, in the order of its cells.

    A viewer goes on in its cell while the next cells run. Its scene ends with the last cell
    before the next view.

    Args:
        lesson: The file's name, of which those of its scenes are made.
        folder: Where the scenes are kept.
        link: The same folder, as pages address it.
    """

    def __init__(self, lesson: str, folder: Path, link: str) -> None:
        self._lesson, self._folder, self._link = lesson, folder, link
        self._count = 0
        self._playing: _Playing | None = None

    def of_viewer(self, viewer: Viewer) -> dict[str, Any]:
        """Begin the scene of a viewer, and return what its cell displays."""
        self.end()
        name, words = self._next(), viewer.summary()
        self._playing = _Playing(name, viewer, viewer.film.duration)
        return self._shown(name, words)

    def of_widget(self, widget: SceneWidget) -> dict[str, Any]:
        """Keep a view at rest, or a scene without a viewer, and return what its cell displays."""
        self.end()
        name = self._next()
        self._write(name, widget.film or encoding.snapshot(widget.scene), widget.scene)
        return self._shown(name, widget.label)

    def follow(self, *_: object) -> None:
        """Remember the scene of the viewer that is shown as this cell leaves it."""
        now = self._playing
        if now is None:
            return
        now.viewer.look()
        gone_by = now.viewer.film.duration - now.since
        if not now.packed or gone_by < SECONDS:
            now.packed = now.viewer.film.packed(min(gone_by + SECONDS / 2, SECONDS))
            now.scene = copied(now.viewer.scene)

    def end(self) -> None:
        """Keep the scene of the viewer that was shown."""
        if self._playing is not None:
            self._write(self._playing.name, self._playing.packed, self._playing.scene)
        self._playing = None

    def _next(self) -> str:
        self._count += 1
        return f"{self._lesson}-{self._count:02}"

    def _write(self, name: str, packed: bytes, scene: Scene) -> None:
        data = base64.b64encode(gzip.compress(packed, 9, mtime=0)).decode()
        write_whole(self._folder / f"{name}.js", f'document.currentScript.dataset.scene="{data}";'.encode())
        write_whole(self._folder / f"{name}.png", zbuffer.draw(scene, POSTER))

    def _shown(self, name: str, words: str) -> dict[str, Any]:
        label = escape(" ".join(words.split()))
        place = PLACE.format(height=HEIGHT, folder=self._link, name=name, label=label)
        return {"text/html": place, "text/plain": words}


def begin(lesson: str, folder: str, link: str) -> None:
    """Keep each 3D view of this kernel's cells as a scene of a page, from now on."""
    scenes = Scenes(lesson, Path(folder), link)
    shell: Any = get_ipython()
    formatter = shell.display_formatter.mimebundle_formatter
    shell.events.register("post_run_cell", scenes.follow)
    formatter.for_type(Viewer, scenes.of_viewer)
    for kind in (SceneWidget, RestingView):
        formatter.for_type(kind, scenes.of_widget)
    _kept.append(scenes)


def end() -> None:
    """Keep the scene that is open at the lesson's end."""
    _kept.pop().end()


_kept: list[Scenes] = []
