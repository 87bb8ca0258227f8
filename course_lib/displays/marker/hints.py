"""Hints at markers that RViz draws oddly, or not at all, without a status."""

from collections.abc import Callable
from typing import Any, NamedTuple

from course_lib.displays.frames import is_unit
from course_lib.displays.marker.drawables import LINE_LIST, LINE_STRIP, POINTS, has_colors, has_face_colors

_TEXT, _MESH, _TRIANGLES = 9, 10, 11  # the last one that RViz draws; 12 is in the message only
_MANY = 100_000  # points, which take a tenth of a second to make and as long to draw
_LISTS = (LINE_STRIP, LINE_LIST, 6, 7, POINTS)


class Rule(NamedTuple):
    """A silent case: when it holds, and what to say; the text may name fields of the marker."""

    holds: Callable[[Any], bool]
    text: str


def hints(marker: Any) -> tuple[str, ...]:
    """Return what RViz2 does not say about a marker."""
    words = {"m": marker, "q": marker.pose.orientation, "n": len(marker.points)}
    return tuple(rule.text.format(**words) for rule in _RULES if rule.holds(marker))


def _one_color(marker: Any) -> bool:
    """Return whether the marker's own colour is used."""
    own = marker.type == _MESH and marker.mesh_use_embedded_materials
    each = marker.type in (*_LISTS, _TRIANGLES) and bool(marker.colors) and _colors_fit(marker)
    return not own and not each


def _colors_fit(marker: Any) -> bool:
    return has_colors(marker) or (marker.type == _TRIANGLES and has_face_colors(marker))


def _zero(marker: Any) -> bool:
    q = marker.pose.orientation
    return not any((q.x, q.y, q.z, q.w))


def _long(marker: Any) -> bool:
    q = marker.pose.orientation
    return not is_unit(q, 1e-3) and not _zero(marker)


_RULES = (
    Rule(
        lambda m: not 0 <= m.type <= _TRIANGLES,
        "type {m.type} is none that RViz2 draws: it logs 'Unknown marker type: {m.type}' and shows nothing.",
    ),
    Rule(
        lambda m: _one_color(m) and m.color.a == 0.0,
        "color.a is 0, so the marker is invisible. Set color.a = 1.0 (0 is the default).",
    ),
    Rule(
        lambda m: m.type in (*_LISTS, _TRIANGLES) and bool(m.colors) and not _colors_fit(m),
        "colors does not have one entry for each point, so RViz2 ignores it and uses color.",
    ),
    Rule(
        lambda m: len(m.points) > _MANY,
        "{n:,} points make every message slow, as each is a Python object. Publish fewer, or a PointCloud2 "
        "made of a numpy array.",
    ),
    Rule(
        lambda m: m.type in _LISTS and not m.points,
        "points is empty: nothing to draw.",
    ),
    Rule(
        lambda m: m.type in (LINE_STRIP, LINE_LIST) and not m.scale.x,
        "scale.x, the width of the line in metres, is 0: nothing to see.",
    ),
    Rule(
        lambda m: m.type == POINTS and not (m.scale.x and m.scale.y),
        "scale.x and scale.y, the size of the points in metres, must not be 0: nothing to see.",
    ),
    Rule(
        lambda m: m.type in (6, 7) and not (m.scale.x and m.scale.y and m.scale.z),
        "scale is 0 in one of x/y/z: nothing or something flat is drawn.",
    ),
    Rule(
        lambda m: m.type == _TEXT and not m.scale.z,
        "scale.z, the height of the letters in metres, is 0: nothing to see.",
    ),
    Rule(lambda m: m.type == _TEXT and not m.text, "text is empty: nothing to see."),
    Rule(lambda m: m.type == _MESH and not m.mesh_resource, "mesh_resource is empty: nothing to see."),
    Rule(
        lambda m: m.type == _TRIANGLES and bool(m.texture_resource),
        "textures are not drawn here; RViz2 draws them.",
    ),
    Rule(
        _zero,
        "orientation is (0, 0, 0, 0), no rotation at all: RViz2 turns it into half a turn about z of the "
        "fixed frame. Set orientation.w = 1.0.",
    ),
    Rule(
        _long,
        "orientation ({q.x:g}, {q.y:g}, {q.z:g}, {q.w:g}) is not of length 1: RViz2 draws another rotation "
        "than you mean. Divide it by its length.",
    ),
)
