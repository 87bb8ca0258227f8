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
from course_lib.ros.driving import spin_for
from course_lib.ros.graph import current_graph
from course_lib.ros.live import live_runs
from course_lib.viewer import encoding, zbuffer
from course_lib.viewer.film import copied
from course_lib.viewer.scene import Scene, summary
from course_lib.viewer.widget import SceneWidget

HEIGHT = 320  # [px] of a scene in the page
POSTER = (560, 238)  # [px] of the picture that stands there before
TONES = 32  # colours of that picture
SECONDS = 20.0  # [s] of robot time that a scene plays at most
BEFORE = 10.0  # [s] of it that were before its cell was run
ROOM = 36_000  # bytes of a scene's script
WATCHED = 2.0  # [s] of robot time that live nodes go on below a view that was just made
INTERVALS = (0.0, 0.1, 0.25, 0.5, 1.0, 2.0, 5.0)  # [s] between two pictures of a scene: the first that fits
PLACE = """\
<div class="course-scene" style="height:{height}px;overflow:hidden" data-scene="{folder}/{name}.js" \
data-label="{label}" data-alone="false">\
<img src="{folder}/{name}.webp" alt="{label}" loading="lazy"></div>"""


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


@dataclass(frozen=True)
class _Scripts:
    """The script of a scene, and the large meshes that it shares with others, by name."""

    scene: bytes
    shared: dict[str, bytes]


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
        self._made: list[tuple[str, _Scripts, Scene]] = []

    def of_viewer(self, viewer: Viewer) -> dict[str, Any]:
        """Begin the scene of a viewer, and return what its cell displays."""
        self.end()
        name, words, film = self._next(), viewer.summary(), viewer.film
        self._playing = _Playing(name, viewer, film.time, film.time, copied(film.scene))
        return self._shown(name, words)

    def of_rest(self, view: RestingView) -> dict[str, Any]:
        """Keep a view at rest with its film, and return what its cell displays."""
        return self._at_once(view, _fitting(view.packed))

    def of_widget(self, widget: SceneWidget) -> dict[str, Any]:
        """Keep a scene without a viewer, and return what its cell displays."""
        return self._at_once(widget, _scripts(encoding.snapshot(widget.scene)))

    def _at_once(self, widget: SceneWidget, scripts: _Scripts) -> dict[str, Any]:
        self.end()
        name = self._next()
        self._made.append((name, scripts, widget.scene))
        return self._shown(name, "\n".join([f"{widget.label}.", *summary(widget.scene)]))

    def follow(self, *_: object) -> None:
        """Extend the scene of the viewer that is shown to the end of this cell.

        Nodes that run live go on while a reader looks at a new view; here they do so for a while.
        """
        if self._playing is not None:
            if not self._playing.viewer.film.duration and live_runs(current_graph()):
                spin_for(WATCHED)
            self._playing.follow()

    def end(self) -> None:
        """Keep the scene of the viewer that was shown."""
        if self._playing is not None:
            self._made.append((self._playing.name, _fitting(self._playing.packed), self._playing.scene))
        self._playing = None

    def write(self) -> None:
        """Write all scenes, and their pictures."""
        self.end()
        for name, scripts, scene in self._made:
            write_whole(self._folder / f"{name}.js", scripts.scene)
            for mesh, content in scripts.shared.items():
                write_whole(self._folder / f"{mesh}.js", script(content))
            write_whole(self._folder / f"{name}.webp", _poster(scene))

    def _next(self) -> str:
        self._count += 1
        return f"{self._lesson}-{self._count:02}"

    def _shown(self, name: str, words: str) -> dict[str, Any]:
        label = escape(" ".join(words.split()))
        place = PLACE.format(height=HEIGHT, folder=self._link, name=name, label=label)
        return {"text/html": place, "text/plain": words}


def _scripts(packed: bytes) -> _Scripts:
    small, shared = compact(packed)
    return _Scripts(script(small), shared)


def _fitting(pack: Callable[[float], bytes]) -> _Scripts:
    """Return a film with as many pictures as there is room for."""
    for interval in INTERVALS:
        scripts = _scripts(pack(interval))
        if len(scripts.scene) <= ROOM:
            break
    return scripts


def _poster(scene: Scene) -> bytes:
    """Return a picture of a scene in few colours, as WebP."""
    picture = Image.open(BytesIO(zbuffer.draw(scene, POSTER))).convert("RGB").quantize(TONES)
    small = BytesIO()
    picture.save(small, "webp", lossless=True, method=6)  # a fifth smaller than a PNG
    return small.getvalue()


def begin(lesson: str, folder: str, link: str) -> None:
    """Keep each 3D view of this kernel's cells as a scene of a page, from now on."""
    scenes = Scenes(lesson, Path(folder), link)
    shell: Any = get_ipython()
    formatter = shell.display_formatter.mimebundle_formatter
    shell.events.register("post_run_cell", scenes.follow)
    formatter.for_type(Viewer, scenes.of_viewer)
    formatter.for_type(SceneWidget, scenes.of_widget)
    formatter.for_type(RestingView, scenes.of_rest)
    _kept.append(scenes)


def end() -> None:
    """Write the scenes, at the lesson's end."""
    _kept.pop().write()


_kept: list[Scenes] = []
