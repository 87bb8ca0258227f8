"""Arrows along +x and axes, as RViz's displays of poses have them."""

from typing import Any

import numpy as np
import numpy.typing as npt

from course_lib.arrays import Floats
from course_lib.displays.marker.drawables import ALONG_X, placement
from course_lib.displays.properties import Property, PropertyHolder, color, number, words
from course_lib.displays.reference_display import AXIS_COLORS, axes
from course_lib.viewer.drawables import Drawable, Solids

ARROW = (1.0, 0.05, 0.3, 0.1)  # lengths and diameters of shaft and head, RViz's default, [m]


def shape_properties(
    arrow: tuple[float, float, float, float] = ARROW,
    axis: tuple[float, float] = (1.0, 0.1),
    shapes: tuple[str, ...] = ("Arrow", "Axes"),
    below: str = "",
) -> tuple[Property, ...]:
    """Return RViz's properties of what a pose is shown as.

    Args:
        arrow: Defaults of length and diameter of the shaft, and of the head, [m].
        axis: Defaults of length and diameter of the axes, [m].
        shapes: What it may be.
        below: Put before all labels but that of the shape.
    """
    shaft_length, shaft_diameter, head_length, head_diameter = arrow
    return (
        Property("Shape", shapes[0], words(*shapes)),
        Property(f"{below}Color", (255, 25, 0), color),
        Property(f"{below}Alpha", 1.0, number(0.0, 1.0)),
        Property(f"{below}Shaft Length", shaft_length, number()),
        Property(f"{below}Shaft Radius", shaft_diameter, number()),  # RViz's word, but it is the diameter
        Property(f"{below}Head Length", head_length, number()),
        Property(f"{below}Head Radius", head_diameter, number()),  # the diameter, too
        Property(f"{below}Axes Length", axis[0], number()),
        Property(f"{below}Axes Radius", axis[1], number()),  # the diameter
    )


def shapes(poses: npt.ArrayLike, holder: PropertyHolder, below: str = "") -> dict[str, Drawable]:
    """Draw axes or arrows at poses, shape (N, 4, 4), as the properties of `shape_properties` say."""
    if holder["Shape"] == "Axes":
        return axes_at(poses, holder[f"{below}Axes Length"], holder[f"{below}Axes Radius"])
    sizes = (
        holder[f"{below}{part}"] for part in ("Shaft Length", "Shaft Radius", "Head Length", "Head Radius")
    )
    return arrows(poses, *sizes, rgba=rgba_of(holder, f"{below}Color", f"{below}Alpha"))


def rgba_of(
    holder: PropertyHolder, color_label: str = "Color", alpha_label: str = "Alpha"
) -> tuple[float, ...]:
    """Return the values of two properties as one colour, in 0..1."""
    return (*(channel / 255 for channel in holder[color_label]), holder[alpha_label])


def arrows(
    poses: npt.ArrayLike,
    shaft_length: float,
    shaft_diameter: float,
    head_length: float,
    head_diameter: float,
    *,
    rgba: npt.ArrayLike,
) -> dict[str, Drawable]:
    """Draw arrows of one size in [m] at poses, shape (N, 4, 4); there is one colour, or one for each."""
    at, shaft_size = np.asarray(poses, np.float64), (shaft_diameter, shaft_diameter, shaft_length)
    body = placement(ALONG_X, shaft_size, (shaft_length / 2, 0.0, 0.0))
    head_size = (head_diameter, head_diameter, head_length)
    tip = placement(ALONG_X, head_size, (shaft_length + head_length / 2, 0.0, 0.0))
    return {"shaft": Solids("cylinder", at @ body, rgba), "head": Solids("cone", at @ tip, rgba)}


def axes_at(poses: npt.ArrayLike, length: float, diameter: float) -> dict[str, Drawable]:
    """Draw axes of one size in [m] at poses, shape (N, 4, 4)."""
    at = np.asarray(poses, np.float64)
    every = (at[:, None] @ axes(length, diameter).placements).reshape(-1, 4, 4)
    return {"axes": Solids("cylinder", every, np.tile(AXIS_COLORS, (len(at), 1)))}


def numbers_of(poses: Any) -> Floats:
    """Return positions and quaternions (x, y, z, w) of geometry_msgs/msg/Pose messages, shape (N, 7)."""
    rows = [
        (p.x, p.y, p.z, q.x, q.y, q.z, q.w) for p, q in ((pose.position, pose.orientation) for pose in poses)
    ]
    return np.array(rows, np.float64).reshape(-1, 7)


def matrices(poses: Floats) -> Floats:
    """Return poses, shape (N, 7), as transforms, shape (N, 4, 4); Ogre's: zeros do not turn."""
    x, y, z, w = poses[:, 3:].T
    made = np.tile(np.eye(4), (len(poses), 1, 1))
    made[:, :3, 3] = poses[:, :3]
    made[:, 0, 0], made[:, 1, 1], made[:, 2, 2] = (
        1 - 2 * (a * a + b * b) for a, b in ((y, z), (x, z), (x, y))
    )
    made[:, 0, 1], made[:, 1, 0] = 2 * (x * y - w * z), 2 * (x * y + w * z)
    made[:, 0, 2], made[:, 2, 0] = 2 * (x * z + w * y), 2 * (x * z - w * y)
    made[:, 1, 2], made[:, 2, 1] = 2 * (y * z - w * x), 2 * (y * z + w * x)
    return made
