"""Scenes made small enough for pages: fewer triangles, and meshes that all scenes of a book share."""

import base64
import gzip
import hashlib
from collections.abc import Iterator, Mapping
from typing import Any

import msgpack
import numpy as np

from course_lib.arrays import AnyArray
from course_lib.viewer import encoding

MOST_FACES = 1500  # of a mesh; a robot has about ten
CELLS = (256, 192, 128, 96, 64, 48, 32, 24, 20, 16, 12)  # along a mesh's longest side
SHARED = 5_000  # bytes; smaller meshes stay in their scenes
Object = dict[str, Any]


def compact(packed: bytes) -> tuple[bytes, dict[str, bytes]]:
    """Return a scene or a film whose large meshes are names, and these meshes by name."""
    content = msgpack.unpackb(packed, strict_map_key=False)
    shared: dict[str, bytes] = {}
    for thing in _meshes(content):
        mesh = encoding.pack(thinned(thing))
        if len(mesh) > SHARED:
            name = "mesh-" + hashlib.sha256(mesh).hexdigest()[:12]
            shared[name] = mesh
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


def thinned(mesh: Mapping[str, Any]) -> Object:
    """Return a mesh of at most MOST_FACES triangles: near corners of one colour and one side become one."""
    faces = np.frombuffer(mesh["faces"].data, np.uint32).reshape(-1, 3)
    if len(faces) <= MOST_FACES:
        return dict(mesh)
    vertices = np.frombuffer(mesh["vertices"].data, np.float32).reshape(-1, 3)
    normals = _normals(mesh, vertices, faces)
    colors = np.frombuffer(mesh["colors"].data, np.uint8).reshape(-1, 4)
    colors = np.broadcast_to(colors, (len(vertices), 4))
    shades = np.unique(np.ascontiguousarray(colors).view(np.uint32), return_inverse=True)[1].reshape(-1)
    axis = np.abs(normals).argmax(axis=1)
    sides = axis + 3 * (normals[np.arange(len(normals)), axis] < 0) + 6 * shades
    corner, longest = vertices.min(axis=0), np.ptp(vertices, axis=0).max()
    for cells in CELLS:
        size = longest / cells
        key = np.rint((vertices - corner) / size).astype(np.int64) @ [1, 512, 512**2] + 512**3 * sides
        _, first, to_new = np.unique(key, return_index=True, return_inverse=True)
        corners = to_new[faces]
        corners = corners[_different(corners)]
        if len(corners) <= MOST_FACES:
            break
    places = _means(np.rint(vertices * 16 / size), to_new) * size / 16
    turned = _means(normals, to_new)
    lengths = np.linalg.norm(turned, axis=1, keepdims=True)
    turned = np.rint(32 * turned / np.where(lengths, lengths, 1)) / 32
    return {
        **mesh,
        "vertices": places.astype(np.float32),
        "faces": corners.astype(np.uint32),
        "normals": turned.astype(np.float32),
        "colors": colors[first],
    }


def _different(corners: AnyArray) -> AnyArray:
    """Return the numbers of triangles that have three corners, each set of corners once."""
    ordered = np.sort(corners, axis=1).astype(np.int64)
    _, first = np.unique(ordered @ [1, 2**20, 2**40], return_index=True)
    return np.sort(first[(np.diff(ordered[first], axis=1) > 0).all(axis=1)])


def _normals(mesh: Mapping[str, Any], vertices: AnyArray, faces: AnyArray) -> AnyArray:
    """Return unit normals at the vertices; those of the triangles, where a mesh has none."""
    if mesh["normals"] is not None:
        return np.frombuffer(mesh["normals"].data, np.float32).reshape(-1, 3)
    sides = vertices[faces]
    across = np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0])
    lengths = np.linalg.norm(across, axis=1, keepdims=True)
    normals = np.zeros_like(vertices)
    normals[faces] = (across / np.where(lengths, lengths, 1))[:, None]
    return normals


def _means(values: AnyArray, to_new: AnyArray) -> AnyArray:
    """Return the means of rows that become one."""
    counts = np.bincount(to_new)
    sums = [np.bincount(to_new, values[:, column]) for column in range(values.shape[1])]
    return np.rint(np.column_stack(sums) / counts[:, None] * 64) / 64
