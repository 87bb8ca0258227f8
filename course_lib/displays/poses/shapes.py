"""Poses as arrows or axes, and covariances as ellipsoids and cones."""

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from course_lib.arrays import Floats, Matrix
from course_lib.displays.frames import placed
from course_lib.displays.marker.drawables import ALONG_MINUS_X, ALONG_X, placement
from course_lib.displays.properties import Property, PropertyHolder, color, flag, number, words
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
        Property(f"{below}Head Radius", head_diameter, number()),  # also a diameter
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
    """Return the values of two properties as one colour, RGBA from 0 to 1.

    Args:
        holder: A display that has them.
        color_label: The property with the colour.
        alpha_label: The property with the alpha.
    """
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


_PLACE, _TURN = "Covariance/Position", "Covariance/Orientation"
COVARIANCE_PROPERTIES = (
    Property("Covariance", True, flag),
    Property(_PLACE, True, flag),
    Property(f"{_PLACE}/Color", (204, 51, 204), color),
    Property(f"{_PLACE}/Alpha", 0.3, number(0.0, 1.0)),
    Property(f"{_PLACE}/Scale", 1.0, number(0.0)),
    Property(_TURN, True, flag),
    Property(f"{_TURN}/Frame", "Local", words("Local", "Fixed")),  # the pose's axes, or its frame's
    Property(f"{_TURN}/Color Style", "Unique", words("Unique", "RGB")),
    Property(f"{_TURN}/Color", (255, 255, 127), color),
    Property(f"{_TURN}/Alpha", 0.5, number(0.0, 1.0)),
    Property(f"{_TURN}/Offset", 1.0, number(0.0)),  # [m], of the discs from the pose, or of the cone's base
    Property(f"{_TURN}/Scale", 1.0, number(0.0)),
)
_THIN = 0.001  # [m]
_STEEPEST = np.radians(89)  # angles are shown as their tangents, up to here
_ROUNDING = 1e-12
_CONE_MIDDLE = 0.49115  # share of its length at which RViz puts the middle of a cone that begins at the pose

# For the discs across x, y and z: which of roll, pitch and yaw they show along their own two axes, and how
# these and the normal lie in the pose's axes, as columns.
_DISCS = (
    ((1, 2), np.array([[0, 0, 1], [0, -1, 0], [1, 0, 0]])),
    ((0, 2), np.array([[0, 1, 0], [0, 0, -1], [-1, 0, 0]])),
    ((0, 1), np.array([[1, 0, 0], [0, -1, 0], [0, 0, -1]])),
)


class Uncertain(NamedTuple):
    """A pose with its covariance."""

    pose: Matrix  # transform from the pose to the fixed frame, shape (4, 4)
    transform_frame_to_fixed: Matrix  # of the frame the pose was given in, shape (4, 4)
    covariance: Matrix  # of x, y, z in that frame [m^2], and of roll, pitch, yaw [rad^2], shape (6, 6)

    @property
    def is_flat(self) -> bool:
        """The covariance is that of a pose in a plane."""
        return bool((self.covariance.diagonal()[2:5] <= 0).all())


def uncertain(message: Any, transform_frame_to_fixed: Matrix) -> Uncertain:
    """Return the pose and the covariance of a geometry_msgs/msg/PoseWithCovariance."""
    covariance = np.asarray(message.covariance, np.float64).reshape(6, 6).T  # Eigen's order
    return Uncertain(placed(transform_frame_to_fixed, message.pose), transform_frame_to_fixed, covariance)


def uncertain_numbers(message: Any) -> Matrix:
    """Return all numbers of a geometry_msgs/msg/PoseWithCovariance, in a row."""
    return np.append(numbers_of([message.pose]), message.covariance)


def covariances(poses: Sequence[Uncertain], holder: PropertyHolder) -> dict[str, Drawable]:
    """Draw what the properties ask for."""
    parts: dict[str, Drawable] = {}
    if not holder["Covariance"] or not poses:
        return parts
    if holder[_PLACE]:
        places = [_place(pose, holder[f"{_PLACE}/Scale"]) for pose in poses]
        parts["place"] = Solids("sphere", places, rgba_of(holder, f"{_PLACE}/Color", f"{_PLACE}/Alpha"))
    discs = [disc for pose in poses if not pose.is_flat for disc in _discs(pose, holder)]
    cones = [_cone(pose, holder) for pose in poses if pose.is_flat]
    if holder[_TURN] and discs:
        colors = np.tile([_turn_color(holder, axis) for axis in range(3)], (len(discs) // 3, 1))
        parts["discs"] = Solids("cylinder", discs, colors)
    if holder[_TURN] and cones:
        parts["cones"] = Solids("cone", cones, _turn_color(holder, 2))
    return parts


def _turn_color(holder: PropertyHolder, axis: int) -> tuple[float, ...]:
    rgba = rgba_of(holder, f"{_TURN}/Color", f"{_TURN}/Alpha")
    return (*np.eye(3)[axis], rgba[3]) if holder[f"{_TURN}/Color Style"] == "RGB" else rgba


def _place(uncertain: Uncertain, scale: float) -> Matrix:
    """Place the unit sphere: along the axes of the frame, whatever the pose's."""
    size, turned = np.array([0.0, 0.0, _THIN]), np.eye(3)
    across = 2 if uncertain.is_flat else 3
    size[:across], turned[:across, :across] = _deviations(uncertain.covariance[:across, :across])
    size[:across] *= scale
    rotation = uncertain.transform_frame_to_fixed[:3, :3] @ turned
    return placement(rotation, size, uncertain.pose[:3, 3])


def _discs(uncertain: Uncertain, holder: PropertyHolder) -> Iterator[Matrix]:
    """Place the unit cylinder across each axis, as wide as the tip of the axis may move."""
    offset, base = holder[f"{_TURN}/Offset"], _base(uncertain, holder)
    for axis, (angles, turned) in enumerate(_DISCS):
        some = np.ix_(angles, angles)
        spread, within = _deviations(uncertain.covariance[3:, 3:][some])
        width = offset * _tangents(spread * holder[f"{_TURN}/Scale"])
        rotation = turned @ np.block([[within, np.zeros((2, 1))], [np.zeros((1, 2)), np.ones((1, 1))]])
        yield base @ placement(rotation, (*width, _THIN), offset * np.eye(3)[axis])


def _cone(uncertain: Uncertain, holder: PropertyHolder) -> Matrix:
    """Place the unit cone with its tip at the pose, open along x as wide as the yaw may be."""
    offset = holder[f"{_TURN}/Offset"]
    spread = 2 * np.sqrt(np.maximum(uncertain.covariance[5, 5], 0.0)) * holder[f"{_TURN}/Scale"]
    size = (_THIN, offset * float(_tangents(spread)), offset)
    return _base(uncertain, holder) @ placement(ALONG_MINUS_X, size, (_CONE_MIDDLE * offset, 0.0, 0.0))


def _base(uncertain: Uncertain, holder: PropertyHolder) -> Matrix:
    """Return where the orientation is shown: at the pose, along its own axes or those of its frame."""
    if holder[f"{_TURN}/Frame"] == "Local":
        return uncertain.pose
    return placement(uncertain.transform_frame_to_fixed[:3, :3], 1.0, uncertain.pose[:3, 3])


def _deviations(covariance: Matrix) -> tuple[Matrix, Matrix]:
    """Return two standard deviations along the axes of an ellipse, and these as columns of a rotation.

    Like Eigen it looks at the lower triangle alone; a covariance with a negative eigenvalue has no extent.
    """
    variances, axes = np.linalg.eigh(covariance)
    if variances[0] < -_ROUNDING * variances[-1]:
        return np.zeros(len(variances)), np.eye(len(variances))
    axes[:, 0] *= np.sign(np.linalg.det(axes))  # right-handed
    return 2 * np.sqrt(variances.clip(0)), axes


def _tangents(angles: Matrix) -> Matrix:
    """Return the width of what opens by angles, one metre away."""
    return 2 * np.tan(np.minimum(angles / 2, _STEEPEST))
