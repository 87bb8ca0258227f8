"""The book in a lesson's kernel: what a cell shows in 3D becomes a scene of the page, kept in a file."""

from collections.abc import Callable
from dataclasses import dataclass
from html import escape
from io import BytesIO
from pathlib import Path
from typing import Any

from IPython.core.getipython import get_ipython
from PIL import Image

from course_lib.book.compact import compact, script
from course_lib.course.state import write_whole
from course_lib.displays.panel.resting_view import RestingView
from course_lib.displays.viewer import Viewer
from course_lib.viewer import encoding, zbuffer
from course_lib.viewer.film import copied
from course_lib.viewer.scene import Scene
from course_lib.viewer.widget import SceneWidget

HEIGHT = 320  # [px] of a scene in the page
POSTER = (560, 238)  # [px] of the picture that stands there before
TONES = 32  # colours of that picture
SECONDS = 20.0  # [s] of robot time that a scene plays at most
BEFORE = 10.0  # [s] of it that were before its cell was run
ROOM = 36_000  # bytes of a scene's script
STILL = 110_000  # bytes of the film of a view at rest; a larger one becomes its last picture
INTERVALS = (0.0, 0.1, 0.25, 0.5, 1.0, 2.0, 5.0)  # [s] between two pictures of a scene: the first that fits
PLACE = """\
<div class="course-scene" style="height:{height}px;overflow:hidden" data-scene="{folder}/{name}.js" \
data-label="{label}" data-alone="false">\
<img src="{folder}/{name}.png" alt="{label}" loading="lazy"></div>"""


@dataclass
class _Playing:
    """A viewer in its cell, while the next cells run; times in [s] of its film."""

    name: str
    viewer: Viewer
    since: float
    until: float
    scene: Scene  # as the last cell left it

    def follow(self) -> None:
        """Extend the scene until now, if it is not long enough yet."""
        film = self.viewer.film
        if film.time < self.since:  # robot time began again
            self.since = self.until = film.time
        if film.time - self.since <= SECONDS:
            self.viewer.look()
            self.until, self.scene = film.time, copied(film.scene)

    def packed(self, interval: float) -> bytes:
        """Write its film, as pages play it."""
        seconds = min(self.until - self.since + BEFORE, SECONDS)
        return self.viewer.film.packed(seconds, self.until, interval)


class Scenes:
    """The scenes of one lesson, in the order of its cells.

    A viewer goes on in its cell while the next cells run. Its scene ends with the last cell
    before the next view. The files are written in a cell of their own, so that an error ends the lesson.

    Args:
        lesson: The file's name, of which those of its scenes are made.
        folder: Where the scenes are kept.
        link: The same folder, as pages address it.
    """

    def __init__(self, lesson: str, folder: Path, link: str) -> None:
        self._lesson, self._folder, self._link = lesson, folder, link
        self._count = 0
        self._playing: _Playing | None = None
        self._made: list[tuple[str, bytes, Scene]] = []

    def of_viewer(self, viewer: Viewer) -> dict[str, Any]:
        """Begin the scene of a viewer, and return what its cell displays."""
        self.end()
        name, words, film = self._next(), viewer.summary(), viewer.film
        self._playing = _Playing(name, viewer, film.time, film.time, copied(film.scene))
        return self._shown(name, words)

    def of_widget(self, widget: SceneWidget) -> dict[str, Any]:
        """Keep a view at rest, or a scene without a viewer, and return what its cell displays."""
        self.end()
        name = self._next()
        packed = widget.film
        if not packed or len(script(compact(packed)[0])) > STILL:
            packed = encoding.snapshot(widget.scene)
        self._made.append((name, packed, widget.scene))
        return self._shown(name, widget.label)

    def follow(self, *_: object) -> None:
        """Extend the scene of the viewer that is shown to the end of this cell."""
        if self._playing is not None:
            self._playing.follow()

    def end(self) -> None:
        """Keep the scene of the viewer that was shown."""
        if self._playing is not None:
            self._made.append((self._playing.name, _fitting(self._playing.packed), self._playing.scene))
        self._playing = None

    def write(self) -> None:
        """Write all scenes, and their pictures."""
        self.end()
        for name, packed, scene in self._made:
            small, shared = compact(packed)
            for file, content in (shared | {name: small}).items():
                write_whole(self._folder / f"{file}.js", script(content))
            write_whole(self._folder / f"{name}.png", _poster(scene))

    def _next(self) -> str:
        self._count += 1
        return f"{self._lesson}-{self._count:02}"

    def _shown(self, name: str, words: str) -> dict[str, Any]:
        label = escape(" ".join(words.split()))
        place = PLACE.format(height=HEIGHT, folder=self._link, name=name, label=label)
        return {"text/html": place, "text/plain": words}


def _fitting(pack: Callable[[float], bytes]) -> bytes:
    """Return a film with as many pictures as there is room for."""
    for interval in INTERVALS:
        packed = pack(interval)
        if len(script(compact(packed)[0])) <= ROOM:
            break
    return packed


def _poster(scene: Scene) -> bytes:
    """Return a picture of a scene, as a small PNG."""
    picture = Image.open(BytesIO(zbuffer.draw(scene, POSTER))).convert("RGB").quantize(TONES)
    small = BytesIO()
    picture.save(small, "png", optimize=True)
    return small.getvalue()


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
    """Write the scenes, at the lesson's end."""
    _kept.pop().write()


_kept: list[Scenes] = []
