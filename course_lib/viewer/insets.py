"""Where the pictures in a view's corner are; insets.js has the same rules."""

from collections.abc import Iterator
from typing import TypeAlias

from course_lib.viewer.drawables import Inset
from course_lib.viewer.scene import Scene

Box: TypeAlias = tuple[int, int, int, int]  # left, top, width, height in [px]

SHARE, GAP = 0.3, 0.01  # of the view's width: how wide a picture is, how far it is from others


def placed_insets(scene: Scene, size: tuple[int, int]) -> Iterator[tuple[Inset, Box]]:
    """Iterate over the pictures that are shown, one below the other at the right; smaller if many are."""
    things = scene.objects().items()
    insets = [thing for path, thing in sorted(things) if isinstance(thing, Inset) and scene.visible(path)]
    width, gap = SHARE * size[0], GAP * size[0]
    needed = sum(width / inset.aspect for inset in insets)
    shrink = min(1.0, (size[1] - gap * (len(insets) + 1)) / needed) if needed else 1.0
    left, top = size[0] - gap - width * shrink, gap
    for inset in insets:
        height = width / inset.aspect * shrink
        yield inset, (round(left), round(top), max(round(width * shrink), 1), max(round(height), 1))
        top += height + gap
