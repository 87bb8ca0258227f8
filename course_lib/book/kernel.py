"""The book's code that runs in a lesson's kernel and saves each 3D view as a scene in a file."""

import base64
import gzip
import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from html import escape
from io import BytesIO
from pathlib import Path
from typing import Any

import msgpack
import numpy as np
from IPython.core.getipython import get_ipython
from PIL import Image

from course_lib.arrays import AnyArray
from course_lib.displays.panel.resting_view import RestingView
from course_lib.displays.viewer import Viewer
from course_lib.files import write_atomically
from course_lib.ros.graph.graph import current_graph
from course_lib.ros.time.driving import live_runs, spin_for
from course_lib.viewer import encoding, renderer
from course_lib.viewer.scene import Scene, summary
from course_lib.viewer.scene_recording import copy_of
from course_lib.viewer.widget import SceneWidget

# Numbers of grid cells along a mesh's longest side that simplification tries.
CELLS = (256, 192, 128, 96, 64, 48, 32, 24, 20, 16, 12, 10, 8)
# Number of quantization steps of positions along a mesh's longest side.
STEPS = 2047
# Length of a stored normal, whose components are integers.
TURNS = 16
# Limit on the number of vertices, because index differences are stored as int16.
MOST_CORNERS = 2**15


@dataclass(frozen=True)
class PageMesh:
    """A triangle mesh with a normal and a color per vertex.

    Args:
        vertices: Shape (V, 3).
        faces: Vertex indices, shape (F, 3).
        normals: Unit normals, shape (V, 3).
        colors: Shape (V, 4), 0 to 255.
    """

    vertices: AnyArray
    faces: AnyArray
    normals: AnyArray
    colors: AnyArray


def read_mesh(mesh: Mapping[str, Any]) -> PageMesh:
    """Read a mesh of a packed scene. If it has no normals, compute a normal for each triangle."""
    faces = np.frombuffer(mesh["faces"].data, np.uint32).reshape(-1, 3)
    vertices = np.frombuffer(mesh["vertices"].data, np.float32).reshape(-1, 3)
    colors = np.frombuffer(mesh["colors"].data, np.uint8).reshape(-1, 4)
    colors = np.broadcast_to(colors, (len(vertices), 4))
    if mesh["normals"] is not None:
        normals = np.frombuffer(mesh["normals"].data, np.float32).reshape(-1, 3)
        return PageMesh(vertices, faces, normals, colors)
    corners = vertices[faces]
    across = _normalize(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    separate_faces = np.arange(faces.size).reshape(-1, 3)
    return PageMesh(
        corners.reshape(-1, 3), separate_faces, np.repeat(across, 3, axis=0), colors[faces].reshape(-1, 4)
    )


def simplify(mesh: PageMesh, max_faces: int) -> PageMesh:
    """Simplify a mesh to at most `max_faces` triangles, if possible.

    Vertices in the same grid cell are merged if they have the same color and face the same side.
    """
    size = float(np.ptp(mesh.vertices, axis=0).max(initial=0.0))
    if len(mesh.faces) <= max_faces or not 0 < size < np.inf:
        return mesh
    shades = np.unique(np.ascontiguousarray(mesh.colors).view(np.uint32), return_inverse=True)[1].reshape(-1)
    axis = np.abs(mesh.normals).argmax(axis=1)
    sides = axis + 3 * (mesh.normals[np.arange(len(axis)), axis] < 0) + 6 * shades
    # Normalized to 0..1.
    places = (mesh.vertices - mesh.vertices.min(axis=0)) / size
    for cells in CELLS:
        key = np.rint(places * cells).astype(np.int64) @ [1, 512, 512**2] + 512**3 * sides
        _, first, to_new = np.unique(key, return_index=True, return_inverse=True)
        faces = _unique_triangles(to_new[mesh.faces])
        if len(faces) <= max_faces:
            break
    normals = _normalize(_means(mesh.normals, to_new))
    return PageMesh(_means(mesh.vertices, to_new), faces, normals, mesh.colors[first])


def encode(mesh: PageMesh) -> dict[str, Any]:
    """Encode a mesh for `static/scenes.js`.

    Arrays are stored by column, and positions and indices as differences, because that compresses
    better.
    """
    used_vertices, faces = np.unique(mesh.faces, return_inverse=True)
    vertices = mesh.vertices[used_vertices]
    corner, size = vertices.min(axis=0), np.ptp(vertices, axis=0).max()
    step = float(size) / STEPS or 1.0
    steps = np.rint((vertices - corner) / step)
    faces = faces.reshape(-1, 3)
    # Each triangle starts at its smallest index.
    turn = (faces.argmin(axis=1)[:, None] + np.arange(3)) % 3
    faces = np.take_along_axis(faces, turn, axis=1)
    faces = faces[np.lexsort(faces.T[::-1])]
    corners = np.column_stack([np.diff(faces[:, 0], prepend=0), faces[:, 1:] - faces[:, :1]])
    return {
        "corner": corner.tolist(),
        "step": step,
        "steps": _bytes(np.diff(steps, axis=0, prepend=0), np.int16),
        "turns": _bytes(np.rint(mesh.normals[used_vertices] * TURNS), np.int8),
        "corners": _bytes(corners, np.int16),
        "colors": np.ascontiguousarray(mesh.colors[used_vertices]),
    }


def _bytes(rows: AnyArray, kind: Any) -> AnyArray:
    """Return the bytes of a two-dimensional array in column order."""
    return np.frombuffer(rows.T.astype(kind).tobytes(), np.uint8)


def _unique_triangles(corners: AnyArray) -> AnyArray:
    """Return the triangles with three different vertices, without duplicates."""
    ordered = np.sort(corners, axis=1).astype(np.int64)
    _, first = np.unique(ordered @ [1, 2**20, 2**40], return_index=True)
    is_proper = (np.diff(ordered[first], axis=1) > 0).all(axis=1)
    different: AnyArray = corners[first[is_proper]]
    return different


def _normalize(vectors: AnyArray) -> AnyArray:
    """Normalize vectors. Zero vectors are returned unchanged."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    unit: AnyArray = vectors / np.where(lengths, lengths, 1)
    return unit


def _means(values: AnyArray, to_new: AnyArray) -> AnyArray:
    """Return the means of the rows that are merged into the same new row."""
    counts = np.bincount(to_new)[:, None]
    means: AnyArray = np.column_stack([np.bincount(to_new, column) for column in values.T]) / counts
    return means


# Maximum number of triangles of a mesh. A robot has about ten meshes.
MOST_FACES = 1000
# Maximum number of triangles of each mesh in a scene with more than MANY meshes.
MANY, FEWER_FACES = 16, 400
# Size [bytes] above which a mesh is stored in a file of its own, which scenes share.
SHARED = 5_000
Object = dict[str, Any]


def compact(scene_bytes: bytes) -> tuple[bytes, dict[str, bytes]]:
    """Move large meshes out of a packed scene or recording.

    Returns:
        The scene with references in place of these meshes, and the encoded meshes by name.
    """
    content = msgpack.unpackb(scene_bytes, strict_map_key=False)
    shared: dict[str, bytes] = {}
    commands = [
        command for batch in content.get("batches", [content]) for command in batch.get("commands", ())
    ]
    objects = [command["object"] for command in commands if isinstance(command.get("object"), dict)]
    meshes: list[Object] = [made for made in objects if made.get("kind") == "mesh"]
    max_faces = (
        FEWER_FACES if len({mesh_command["vertices"].data for mesh_command in meshes}) > MANY else MOST_FACES
    )
    for mesh_command in meshes:
        mesh = simplify(read_mesh(mesh_command), max_faces)
        if len(encoding.pack(mesh_command)) > SHARED and len(mesh.vertices) < MOST_CORNERS:
            part = encoding.pack({"kind": "mesh", "lit": mesh_command["lit"], **encode(mesh)})
            name = "mesh-" + hashlib.sha256(part).hexdigest()[:12]
            shared[name] = part
            mesh_command.clear()
            mesh_command.update(shared=name)
    return encoding.pack(content), shared


def script(content: bytes) -> bytes:
    """Return a script that passes the bytes to the page that loads it.

    Pages opened as local files may load scripts, but not other files.
    """
    text = base64.b64encode(gzip.compress(content, 9, mtime=0)).decode()
    return f'document.currentScript.dataset.content="{text}";\n'.encode()


# Height of a scene in the page [px].
HEIGHT = 320
# Size of the picture shown before the scene is loaded [px].
POSTER = (560, 238)
# Number of colors in the picture shown before the scene is loaded.
TONES = 32
# Maximum duration of a scene in robot time [s].
SECONDS = 20.0
# Robot time [s] that the scene may include from before the run of its cell.
BEFORE = 10.0
# Maximum size of a scene's script [bytes].
ROOM = 36_000
# Robot time [s] for which live nodes run after a view was created.
WATCHED = 2.0
# Candidate intervals [s] between pictures of a scene; the first that fits is used.
INTERVALS = (0.0, 0.1, 0.25, 0.5, 1.0, 2.0, 5.0)
PLACE = """\
<div class="course-scene" style="height:{height}px;overflow:hidden" data-scene="{folder}/{name}.js" \
data-label="{label}" data-alone="false" data-plays="{plays}">\
<img src="{folder}/{name}.webp" alt="{label}" loading="lazy"></div>"""


@dataclass
class _LiveScene:
    """A viewer that is updated while the following cells run."""

    name: str
    viewer: Viewer
    # Start and end of the scene, in the time of the viewer's recording [s].
    since: float
    end: float
    # The scene after the last cell.
    scene: Scene

    def extend(self) -> None:
        """Extend the scene to the current time, unless it has its maximum duration already."""
        recording = self.viewer.scene_recording
        # The robot time was reset in between.
        if recording.time < self.since:
            self.since = self.end = recording.time
        if recording.time - self.since <= SECONDS:
            self.viewer.refresh()
            self.end, self.scene = recording.time, copy_of(recording.scene)

    def pack(self, interval: float) -> bytes:
        """Return the scene's recording, packed for pages, with a frame every `interval` [s]."""
        seconds = min(self.end - self.since + BEFORE, SECONDS)
        return self.viewer.scene_recording.pack(seconds, self.end, interval)


@dataclass(frozen=True)
class _Scripts:
    """The script of a scene, and the large shared meshes by name."""

    scene: bytes
    shared: dict[str, bytes]


class Scenes:
    """The scenes of a lesson, in the order of its cells.

    A viewer is updated while the following cells run. Its scene ends with the last cell before the
    next view. The files are written by an additional cell, so that an error there fails the lesson.

    Args:
        lesson: The lesson's file name without suffix, which the names of its scenes begin with.
        folder: The folder for the scenes.
        link: The relative URL of this folder in pages.
    """

    def __init__(self, lesson: str, folder: Path, link: str) -> None:
        self._lesson, self._folder, self._link = lesson, folder, link
        self._count = 0
        self._live_scene: _LiveScene | None = None
        self._saved_scenes: list[tuple[str, _Scripts, Scene]] = []

    def add_viewer(self, viewer: Viewer) -> dict[str, Any]:
        """Start the scene of a viewer and return the HTML that its cell displays."""
        self.end()
        name, summary, recording = self._next(), viewer.summary(), viewer.scene_recording
        self._live_scene = _LiveScene(name, viewer, recording.time, recording.time, copy_of(recording.scene))
        return self._scene_html(name, summary)

    def add_resting_view(self, view: RestingView) -> dict[str, Any]:
        """Save a frozen view with its recording and return the HTML that its cell displays."""
        return self._save_picture(view, _fit(view.pack), plays=view.plays)

    def add_widget(self, widget: SceneWidget) -> dict[str, Any]:
        """Save a scene without a viewer and return the HTML that its cell displays."""
        return self._save_picture(widget, _make_scripts(encoding.snapshot(widget.scene)))

    def _save_picture(
        self,
        widget: SceneWidget,
        scripts: _Scripts,
        *,
        plays: bool = False,
    ) -> dict[str, Any]:
        self.end()
        name = self._next()
        self._saved_scenes.append((name, scripts, widget.scene))
        return self._scene_html(name, "\n".join([f"{widget.label}.", *summary(widget.scene)]), plays=plays)

    def extend_live_scene(self, *_: object) -> None:
        """Extend the scene of the current viewer to the end of this cell.

        In JupyterLab, live nodes run on while the user looks at a new view. Here they run for
        WATCHED seconds.
        """
        if self._live_scene is not None:
            if not self._live_scene.viewer.scene_recording.duration and live_runs(current_graph()):
                spin_for(WATCHED)
            self._live_scene.extend()

    def end(self) -> None:
        """Finish the scene of the current viewer."""
        if self._live_scene is not None:
            self._saved_scenes.append(
                (self._live_scene.name, _fit(self._live_scene.pack), self._live_scene.scene)
            )
        self._live_scene = None

    def write(self) -> None:
        """Write the files of all scenes, with their meshes and preview pictures."""
        self.end()
        for name, scripts, scene in self._saved_scenes:
            write_atomically(self._folder / f"{name}.js", scripts.scene)
            for mesh, content in scripts.shared.items():
                write_atomically(self._folder / f"{mesh}.js", script(content))
            picture = Image.open(BytesIO(renderer.draw(scene, POSTER))).convert("RGB").quantize(TONES)
            small = BytesIO()
            # WebP is a fifth smaller than PNG.
            picture.save(small, "webp", lossless=True, method=6)
            write_atomically(self._folder / f"{name}.webp", small.getvalue())

    def _next(self) -> str:
        self._count += 1
        return f"{self._lesson}-{self._count:02}"

    def _scene_html(self, name: str, summary: str, *, plays: bool = False) -> dict[str, Any]:
        label = escape(" ".join(summary.split()))
        place = PLACE.format(
            height=HEIGHT, folder=self._link, name=name, label=label, plays=str(plays).lower()
        )
        return {"text/html": place, "text/plain": summary}


def _make_scripts(scene_bytes: bytes) -> _Scripts:
    small, shared = compact(scene_bytes)
    return _Scripts(script(small), shared)


def _fit(pack: Callable[[float], bytes]) -> _Scripts:
    """Return a recording with the smallest picture interval whose script is small enough."""
    for interval in INTERVALS:
        scripts = _make_scripts(pack(interval))
        if len(scripts.scene) <= ROOM:
            break
    return scripts


def begin(lesson: str, folder: str, link: str) -> None:
    """Begin to save the 3D views of this kernel's cells as scenes. Called in the first cell."""
    scenes = Scenes(lesson, Path(folder), link)
    shell: Any = get_ipython()
    formatter = shell.display_formatter.mimebundle_formatter
    shell.events.register("post_run_cell", scenes.extend_live_scene)
    formatter.for_type(Viewer, scenes.add_viewer)
    formatter.for_type(SceneWidget, scenes.add_widget)
    formatter.for_type(RestingView, scenes.add_resting_view)
    _kept.append(scenes)


def end() -> None:
    """Write the scenes. Called in the last cell."""
    _kept.pop().write()


_kept: list[Scenes] = []
