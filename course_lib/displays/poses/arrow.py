"""Arrows along +x, as RViz's displays of poses have them."""

from typing import Any

import numpy as np
import numpy.typing as npt

from course_lib.displays.marker.shapes import ALONG_X, placement
from course_lib.displays.properties import Property, PropertyHolder, color, number, words
from course_lib.viewer.drawables import Drawable, Solids

INVALID = "Message contained invalid floating point values (nans or infs)"


def arrow_properties(
    shaft_length: float, shaft_radius: float, head_length: float, head_radius: float, *shapes: str
) -> tuple[Property, ...]:
    """Return RViz's properties of an arrow, with its defaults in [m], and the shapes it may be shown as."""
    return (
        Property("Shape", shapes[0], words(*shapes)),
        Property("Color", (255, 25, 0), color),
        Property("Alpha", 1.0, number(0.0, 1.0)),
        Property("Shaft Length", shaft_length, number()),
        Property("Shaft Radius", shaft_radius, number()),  # RViz's word, but it is the diameter
        Property("Head Length", head_length, number()),
        Property("Head Radius", head_radius, number()),  # the diameter, too
    )


def rgba_of(holder: PropertyHolder) -> tuple[float, float, float, float]:
    """Return the properties Color and Alpha, in 0..1."""
    red, green, blue = (channel / 255 for channel in holder["Color"])
    return red, green, blue, holder["Alpha"]


def arrows(placements: npt.ArrayLike, holder: PropertyHolder) -> dict[str, Drawable]:
    """Draw arrows with the properties of a display at poses, shape (N, 4, 4)."""
    poses = np.asarray(placements, np.float64)
    shaft, head = holder["Shaft Length"], holder["Head Length"]
    shaft_size = (holder["Shaft Radius"], holder["Shaft Radius"], shaft)
    head_size = (holder["Head Radius"], holder["Head Radius"], head)
    body = placement(ALONG_X, shaft_size, (shaft / 2, 0.0, 0.0))
    tip = placement(ALONG_X, head_size, (shaft + head / 2, 0.0, 0.0))
    rgba = rgba_of(holder)
    return {"shaft": Solids("cylinder", poses @ body, rgba), "head": Solids("cone", poses @ tip, rgba)}


def is_finite(poses: Any) -> bool:
    """Say whether all numbers of geometry_msgs/msg/Pose messages are finite."""
    return bool(np.isfinite(numbers_of(poses)).all())


def numbers_of(poses: Any) -> npt.NDArray[np.float64]:
    """Return positions and quaternions (x, y, z, w) of geometry_msgs/msg/Pose messages, shape (N, 7)."""
    rows = [
        (p.x, p.y, p.z, q.x, q.y, q.z, q.w) for p, q in ((pose.position, pose.orientation) for pose in poses)
    ]
    return np.array(rows, np.float64).reshape(-1, 7)
