"""Scenes as msgpack for a page, with arrays as meshcat's own decoder reads them."""

from typing import Any

import msgpack
import numpy as np

from course_lib.arrays import AnyArray, Float32s
from course_lib.viewer.drawables import Drawable, Inset, MeshcatObject, Sheet, Solids, Text
from course_lib.viewer.scene import Node, Scene, What
from course_lib.viewer.text import rasterized

_UINT8, _UINT32, _FLOAT32 = 0x12, 0x16, 0x17  # meshcat's msgpack extension types


def pack(value: Any) -> bytes:
    """Write plain values, arrays and meshcat's packed arrays as msgpack."""
    packed: bytes = msgpack.packb(value, default=_extended)
    return packed


def snapshot(scene: Scene) -> bytes:
    """Write a whole scene as one batch."""
    return pack(whole(scene))


def whole(scene: Scene) -> dict[str, Any]:
    """Return the batch that makes a scene out of nothing."""
    with scene.lock:
        batch = commands(scene, "background", "") + commands(scene, "camera", "")
        moved = []
        for node in scene.nodes():
            if node.object is not None:
                batch += commands(scene, "object", node.path)
            if not node.visible:
                batch += commands(scene, "visible", node.path)
            if not np.array_equal(node.matrix, np.eye(4)):
                moved.append(node)
        batch += commands(scene, "animation", "")
        return {"commands": batch, **placements(moved)}


def placements(nodes: list[Node]) -> dict[str, Any]:
    """Write where nodes are; a node that is nowhere (not a number) stays where it was."""
    matrices = np.array([node.matrix for node in nodes], np.float32).reshape(-1, 4, 4)
    somewhere = np.flatnonzero(np.isfinite(matrices).all(axis=(1, 2)))
    if len(somewhere) < len(nodes):
        nodes, matrices = [nodes[number] for number in somewhere], matrices[somewhere]
    return {"paths": [node.path for node in nodes], "matrices": columns(matrices)}


def commands(scene: Scene, what: What, path: str) -> list[dict[str, Any]]:
    """Write the present value of one thing in the scene."""
    node = scene.find(path)
    if what == "delete":
        return [{"type": "delete", "path": path}]
    if what == "background":
        return [{"type": "background", "color": scene.background}]
    if what == "camera":
        return [{"type": "camera", **vars(scene.camera)}]
    if what == "animation" and scene.animation is not None:
        return [{"type": "animation", **scene.animation}]
    if what == "object" and node is not None and node.object is not None:
        return [{"type": "object", "path": path, "object": _described(node.object)}]
    if what == "visible" and node is not None:
        return [{"type": "visible", "path": path, "value": node.visible}]
    return []


def columns(matrices: Float32s) -> Float32s:
    """Return the upper three rows of affine matrices, column by column, shape (N, 4, 3)."""
    return np.ascontiguousarray(matrices[:, :3].transpose(0, 2, 1))


def _extended(value: Any) -> Any:
    """Write what msgpack does not know; meshcat's umsgpack.Ext is recognized by its two fields."""
    if isinstance(value, np.ndarray):
        return _packed_array(value)
    if isinstance(value, np.generic):
        return value.item()
    if hasattr(value, "type") and hasattr(value, "data"):
        return msgpack.ExtType(value.type, value.data)
    raise TypeError(f"A scene cannot hold {value!r}.")


def _packed_array(array: AnyArray) -> Any:
    for dtype, code in ((np.float32, _FLOAT32), (np.uint32, _UINT32), (np.uint8, _UINT8)):
        if array.dtype == dtype:
            return msgpack.ExtType(code, array.tobytes())
    return array.tolist()


def _described(thing: Drawable) -> dict[str, Any]:
    """Name the kind of an object and list its fields, as the page's builders read them."""
    if isinstance(thing, MeshcatObject):
        return {"kind": "meshcat", "json": thing.json}
    fields = dict(vars(thing))
    for name in {"colors", "color"} & fields.keys():
        fields[name] = np.rint(fields[name] * 255).astype(np.uint8)
    if isinstance(thing, Solids):
        fields["placements"] = columns(thing.placements)
    if isinstance(thing, Text):
        fields.update(_glyphs(thing))
    if isinstance(thing, Sheet):
        fields.update(rows=thing.cells.shape[0], columns=thing.cells.shape[1])
    if isinstance(thing, Inset):
        fields.update(rows=thing.pixels.shape[0], columns=thing.pixels.shape[1])
        fields["camera"] = thing.camera and vars(thing.camera)
    return {"kind": type(thing).__name__.lower(), **fields}


def _glyphs(text: Text) -> dict[str, Any]:
    glyphs = rasterized(text.text)
    rows, cols = glyphs.mask.shape
    size = text.height / glyphs.pixels_per_height  # [m] per pixel
    return {"mask": glyphs.mask, "rows": rows, "columns": cols, "pixel": size}
