"""Scenes made small enough for pages: fewer triangles, and meshes that all scenes of a book share."""

import base64
import gzip
import hashlib
from collections.abc import Iterator
from typing import Any

import msgpack

from course_lib.book.triangles import MOST_CORNERS, coded, thinned, triangles_of
from course_lib.viewer import encoding

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
