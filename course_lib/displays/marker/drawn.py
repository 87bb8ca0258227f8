"""What a marker's picture is made of."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from course_lib.displays.statuses import Level
from course_lib.viewer.drawables import Drawable

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Drawn:
    """The picture of one marker, in the frame of its pose."""

    parts: Mapping[str, Drawable] = field(default_factory=dict)  # what is drawn, by name
    status: tuple[Level, str] | None = None  # RViz's status of the marker, if it has one
    refused: bool = False  # the message is so wrong that RViz does not even look for a transform


def refused(text: str) -> Drawn:
    """Return what RViz draws of a message it does not accept: an error."""
    return Drawn(status=("error", text), refused=True)


def rgba(color: Any) -> Floats:
    """Return a std_msgs/msg/ColorRGBA in 0..1, shape (4,)."""
    values: Floats = np.clip([color.r, color.g, color.b, color.a], 0.0, 1.0)
    return values


def scale_of(marker: Any) -> Floats:
    """Return the scale of a marker, shape (3,)."""
    return np.array([marker.scale.x, marker.scale.y, marker.scale.z])


def points(marker: Any) -> Floats:
    """Return the points of a marker, shape (N, 3), [m]."""
    return np.array([(p.x, p.y, p.z) for p in marker.points]).reshape(-1, 3)


def colors(marker: Any) -> Floats:
    """Return the colours of a marker's points, shape (N, 4); NaN counts as 0, RViz does not look."""
    each = np.array([(c.r, c.g, c.b, c.a) for c in marker.colors]).reshape(-1, 4)
    values: Floats = np.clip(np.nan_to_num(each), 0.0, 1.0)
    return values


def label(marker: Any) -> str:
    """Return the name that RViz gives to a marker's status."""
    return f"{marker.ns}/{marker.id}"
