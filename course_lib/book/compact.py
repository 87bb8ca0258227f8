"""Scenes made small enough for pages: fewer triangles, written as differences, in shared meshes."""

import base64
import gzip
import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import msgpack
import numpy as np

from course_lib.arrays import AnyArray
from course_lib.viewer import encoding

CELLS = (256, 192, 128, 96, 64, 48, 32, 24, 20, 16, 12, 10, 8)  # along a mesh's longest side
STEPS = 2047  # along it, of a written position
TURNS = 16  # of a written normal's length
MOST_CORNERS = 2**15  # of a mesh that can be written


@dataclass(frozen=True)
class PageMesh:
    """A mesh with normals and colours at its V vertices.

    Args:
        vertices: Shape (V, 3).
        faces: Numbers of vertices, shape (F, 3).
        normals: Unit normals, shape (V, 3).
        colors: Shape (V, 4), 0 to 255.
    """

    vertices: AnyArray
    faces: AnyArray
    normals: AnyArray
    colors: AnyArray


def triangles_of(mesh: Mapping[str, Any]) -> PageMesh:
    """Read a mesh of a packed scene; without normals each triangle has its own."""
    faces = np.frombuffer(mesh["faces"].data, np.uint32).reshape(-1, 3)
    vertices = np.frombuffer(mesh["vertices"].data, np.float32).reshape(-1, 3)
    colors = np.frombuffer(mesh["colors"].data, np.uint8).reshape(-1, 4)
    colors = np.broadcast_to(colors, (len(vertices), 4))
    if mesh["normals"] is not None:
        normals = np.frombuffer(mesh["normals"].data, np.float32).reshape(-1, 3)
        return PageMesh(vertices, faces, normals, colors)
    corners = vertices[faces]
    across = _unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    apart = np.arange(faces.size).reshape(-1, 3)
    return PageMesh(corners.reshape(-1, 3), apart, np.repeat(across, 3, axis=0), colors[faces].reshape(-1, 4))


def thinned(mesh: PageMesh, most: int) -> PageMesh:
    """Return a mesh of about so many triangles: near corners of one colour and one side become one."""
    size = float(np.ptp(mesh.vertices, axis=0).max(initial=0.0))
    if len(mesh.faces) <= most or not 0 < size < np.inf:
        return mesh
    shades = np.unique(np.ascontiguousarray(mesh.colors).view(np.uint32), return_inverse=True)[1].reshape(-1)
    axis = np.abs(mesh.normals).argmax(axis=1)
    sides = axis + 3 * (mesh.normals[np.arange(len(axis)), axis] < 0) + 6 * shades
    places = (mesh.vertices - mesh.vertices.min(axis=0)) / size  # 0 to 1
    for cells in CELLS:
        key = np.rint(places * cells).astype(np.int64) @ [1, 512, 512**2] + 512**3 * sides
        _, first, to_new = np.unique(key, return_index=True, return_inverse=True)
        faces = _different(to_new[mesh.faces])
        if len(faces) <= most:
            break
    normals = _unit(_means(mesh.normals, to_new))
    return PageMesh(_means(mesh.vertices, to_new), faces, normals, mesh.colors[first])


def coded(mesh: PageMesh) -> dict[str, Any]:
    """Write a mesh as `static/scenes.js` reads it: column by column, numbers as differences from the last."""
    used, faces = np.unique(mesh.faces, return_inverse=True)
    vertices = mesh.vertices[used]
    corner, size = vertices.min(axis=0), np.ptp(vertices, axis=0).max()
    step = float(size) / STEPS or 1.0
    steps = np.rint((vertices - corner) / step)
    faces = faces.reshape(-1, 3)
    turn = (faces.argmin(axis=1)[:, None] + np.arange(3)) % 3  # the smallest number first
    faces = np.take_along_axis(faces, turn, axis=1)
    faces = faces[np.lexsort(faces.T[::-1])]
    corners = np.column_stack([np.diff(faces[:, 0], prepend=0), faces[:, 1:] - faces[:, :1]])
    return {
        "corner": corner.tolist(),
        "step": step,
        "steps": _bytes(np.diff(steps, axis=0, prepend=0), np.int16),
        "turns": _bytes(np.rint(mesh.normals[used] * TURNS), np.int8),
        "corners": _bytes(corners, np.int16),
        "colors": np.ascontiguousarray(mesh.colors[used]),
    }


def _bytes(rows: AnyArray, kind: Any) -> AnyArray:
    """Return the bytes of a table, column by column."""
    return np.frombuffer(rows.T.astype(kind).tobytes(), np.uint8)


def _different(corners: AnyArray) -> AnyArray:
    """Return the triangles that have three corners, each set of corners once."""
    ordered = np.sort(corners, axis=1).astype(np.int64)
    _, first = np.unique(ordered @ [1, 2**20, 2**40], return_index=True)
    whole = (np.diff(ordered[first], axis=1) > 0).all(axis=1)
    different: AnyArray = corners[first[whole]]
    return different


def _unit(vectors: AnyArray) -> AnyArray:
    """Return vectors of length 1; those of length 0 stay."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    unit: AnyArray = vectors / np.where(lengths, lengths, 1)
    return unit


def _means(values: AnyArray, to_new: AnyArray) -> AnyArray:
    """Return the means of the rows that become one."""
    counts = np.bincount(to_new)[:, None]
    means: AnyArray = np.column_stack([np.bincount(to_new, column) for column in values.T]) / counts
    return means


MOST_FACES = 1000  # of a mesh; a robot has about ten
MANY, FEWER_FACES = 16, 400  # of a mesh, where a scene has more of them
SHARED = 5_000  # bytes; smaller meshes stay in their scenes
Object = dict[str, Any]


def compact(packed: bytes) -> tuple[bytes, dict[str, bytes]]:
    """Return a scene or a film whose large meshes are names, and these meshes by name."""
    content = msgpack.unpackb(packed, strict_map_key=False)
    shared: dict[str, bytes] = {}
    meshes = list(_meshes(content))
    most = FEWER_FACES if len({thing["vertices"].data for thing in meshes}) > MANY else MOST_FACES
    for thing in meshes:
        mesh = thinned(triangles_of(thing), most)
        if len(encoding.pack(thing)) > SHARED and len(mesh.vertices) < MOST_CORNERS:
            part = encoding.pack({"kind": "mesh", "lit": thing["lit"], **coded(mesh)})
            name = "mesh-" + hashlib.sha256(part).hexdigest()[:12]
            shared[name] = part
            thing.clear()
            thing.update(shared=name)
    return encoding.pack(content), shared


def script(content: bytes) -> bytes:
    """Return a script that hands bytes to the page that loads it."""
    text = base64.b64encode(gzip.compress(content, 9, mtime=0)).decode()
    return f'document.currentScript.dataset.content="{text}";\n'.encode()


def _meshes(content: Any) -> Iterator[Object]:
    for batch in content.get("batches", [content]):
        for command in batch.get("commands", ()):
            thing = command.get("object")
            if isinstance(thing, dict) and thing.get("kind") == "mesh":
                yield thing
