"""The colours of occupancy (palette_builder.cpp): RGBA of each byte that a cell may have; -1 is 255."""

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Bytes: TypeAlias = npt.NDArray[np.uint8]

# Of binary maps: the colours of cells below the threshold, and from there on.
_BINARY = {
    "map": ((255, 255, 255), (0, 0, 0)),
    "costmap": ((0, 0, 255), (255, 0, 0)),
    "raw": ((0, 0, 0), (255, 255, 255)),
}
SCHEMES = tuple(_BINARY)


def palette(scheme: str, threshold: int | None = None) -> Bytes:
    """Return the colours of one of RViz's schemes, shape (256, 4); two of them if there is a threshold."""
    colors = np.full((256, 4), 255, np.uint8)
    value = np.arange(256)
    if threshold is not None:
        below, above = _BINARY[scheme]
        colors[:, :3] = np.where((value < threshold)[:, None], below, above)
    elif scheme == "costmap":
        share = 255 * value[:101] // 100
        colors[:101, :3] = np.column_stack([share, 0 * share, 255 - share])
        colors[99, :3] = 0, 255, 255
        colors[100, :3] = 255, 0, 255
        colors[0] = 0
    else:
        grey = 255 - 255 * value[:101] // 100 if scheme == "map" else value
        colors[: len(grey), :3] = grey[:, None]
    return colors if scheme == "raw" else _with_illegal(colors)


def _with_illegal(colors: Bytes) -> Bytes:
    """Colour what no cell should have: from 101 on green, negative from red to yellow; and -1."""
    colors[101:128, :3] = 0, 255, 0
    shades = 255 * np.arange(127) // 126
    colors[128:255, :3] = np.column_stack([np.full(127, 255), shades, 0 * shades])
    colors[255, :3] = 0x70, 0x89, 0x86
    return colors
