"""Arrows, axes and covariances, which several displays draw, and their geometry."""

from collections.abc import Collection, Sequence
from itertools import chain
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from course_lib.arrays import Floats, Matrix, Reals
from course_lib.displays.frames import pose_in_fixed_frame
from course_lib.displays.properties import Property, PropertyHolder, color, flag, number, words
from course_lib.viewer.drawables import Drawable, Solids

# The rotation of the solids' z axis to x.
ALONG_X = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
ALONG_MINUS_X = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
# RViz's colors: x red, y green, z blue.
AXIS_COLORS = np.column_stack([np.eye(3), np.ones(3)])
# RViz's default lengths and diameters of shaft and head, [m].
ARROW = (1.0, 0.05, 0.3, 0.1)


def rotation_to(direction: Floats) -> Floats:
    """Return a rotation that maps z to a unit vector, shape (3, 3)."""
    helper = np.eye(3)[np.argmin(np.abs(direction))]
    x = _cross(helper, direction)
    x /= np.linalg.norm(x)
    return np.column_stack([x, _cross(direction, x), direction])


def _cross(first: Floats, second: Floats) -> Floats:
    """Return the cross product of two vectors, for which `np.cross` takes 30 times as long."""
    (x, y, z), (u, v, w) = first.tolist(), second.tolist()
    return np.array([y * w - z * v, z * u - x * w, x * v - y * u])


def placement(rotation: Floats, size: Any, center: Any) -> Floats:
    """Return the transform that scales a unit shape, rotates it and moves it, shape (..., 4, 4)."""
    transform = np.zeros((*np.shape(rotation)[:-2], 4, 4))
    transform[..., :3, :3] = rotation * np.atleast_1d(size)[..., None, :]
    transform[..., :3, 3] = center
    transform[..., 3, 3] = 1.0
    return transform


def points_of(message: Any) -> Floats:
    """Return the points of a message with a field `points`, shape (N, 3), [m]."""
    return fields_of(message.points, "x", "y", "z")


def fields_of(messages: Collection[Any], *fields: str) -> Floats:
    """Return fields of messages, shape (N, number of fields), even for a million messages."""
    each = chain.from_iterable(map(attrgetter(*fields), messages))
    return np.fromiter(each, float, len(fields) * len(messages)).reshape(-1, len(fields))


def alpha_drawn_twice(alpha: Reals) -> Reals:
    """Return the effective alpha of an object that is drawn twice."""
    return 1 - (1 - alpha) ** 2


def rgba_of(
    holder: PropertyHolder, color_label: str = "Color", alpha_label: str = "Alpha"
) -> tuple[float, ...]:
    """Return the values of two properties as one color, RGBA from 0 to 1.

    Args:
        holder: A display with these properties.
        color_label: The label of the color.
        alpha_label: The label of the alpha.
    """
    return (*(channel / 255 for channel in holder[color_label]), holder[alpha_label])


def shape_properties(below: str = "") -> tuple[Property, ...]:
    """Return RViz's properties of a pose's shape, with a prefix for all labels except Shape."""
    shaft_length, shaft_diameter, head_length, head_diameter = ARROW
    as_arrow, as_axes = (("Shape", "Arrow"),), (("Shape", "Axes"),)
    # RViz calls the diameters Radius.
    return (
        Property("Shape", "Arrow", words("Arrow", "Axes")),
        Property(f"{below}Color", (255, 25, 0), color, shown_if=as_arrow),
        Property(f"{below}Alpha", 1.0, number(0.0, 1.0), shown_if=as_arrow),
        Property(f"{below}Shaft Length", shaft_length, number(), shown_if=as_arrow),
        Property(f"{below}Shaft Radius", shaft_diameter, number(), shown_if=as_arrow),
        Property(f"{below}Head Length", head_length, number(), shown_if=as_arrow),
        Property(f"{below}Head Radius", head_diameter, number(), shown_if=as_arrow),
        Property(f"{below}Axes Length", 1.0, number(), shown_if=as_axes),
        Property(f"{below}Axes Radius", 0.1, number(), shown_if=as_axes),
    )


def draw_shapes(
    poses: npt.ArrayLike,
    holder: PropertyHolder,
    below: str = "",
) -> dict[str, Drawable]:
    """Draw axes or arrows at poses, shape (N, 4, 4), as set by the properties of `shape_properties`."""
    if holder["Shape"] == "Axes":
        return draw_axes(poses, holder[f"{below}Axes Length"], holder[f"{below}Axes Radius"])
    labels = ("Shaft Length", "Shaft Radius", "Head Length", "Head Radius")
    sizes = (holder[f"{below}{label}"] for label in labels)
    return draw_arrows(poses, *sizes, rgba=rgba_of(holder, f"{below}Color", f"{below}Alpha"))


def draw_arrows(
    poses: npt.ArrayLike,
    shaft_length: float,
    shaft_diameter: float,
    head_length: float,
    head_diameter: float,
    *,
    rgba: npt.ArrayLike,
) -> dict[str, Drawable]:
    """Draw arrows of one size [m] at poses, shape (N, 4, 4), in one color or one color each."""
    at, shaft_size = np.asarray(poses, np.float64), (shaft_diameter, shaft_diameter, shaft_length)
    shaft = placement(ALONG_X, shaft_size, (shaft_length / 2, 0.0, 0.0))
    head_size = (head_diameter, head_diameter, head_length)
    head = placement(ALONG_X, head_size, (shaft_length + head_length / 2, 0.0, 0.0))
    return {"shaft": Solids("cylinder", at @ shaft, rgba), "head": Solids("cone", at @ head, rgba)}


def axes(length: float, diameter: float, colors: npt.ArrayLike = AXIS_COLORS) -> Solids:
    """Return cylinders along x, y and z.

    Args:
        length: The length [m].
        diameter: The diameter [m], which RViz calls Radius.
        colors: RGBA of each axis, shape (3, 4).
    """
    placements = np.zeros((3, 4, 4))
    for axis, transform in enumerate(placements):
        # The rotation that maps z to the axis.
        rotation = np.roll(np.eye(3), axis + 1, axis=0)
        transform[:3, :3] = rotation * [diameter, diameter, length]
        transform[axis, 3] = length / 2
        transform[3, 3] = 1.0
    return Solids("cylinder", placements, colors)


def draw_axes(poses: npt.ArrayLike, length: float, diameter: float) -> dict[str, Drawable]:
    """Draw axes of one size [m] at poses, shape (N, 4, 4)."""
    at = np.asarray(poses, np.float64)
    every = (at[:, None] @ axes(length, diameter).placements).reshape(-1, 4, 4)
    return {"axes": Solids("cylinder", every, np.tile(AXIS_COLORS, (len(at), 1)))}


def pose_numbers(poses: Any) -> Floats:
    """Return positions and quaternions (x, y, z, w) of geometry_msgs/msg/Pose messages, shape (N, 7)."""
    rows = [
        (p.x, p.y, p.z, q.x, q.y, q.z, q.w) for p, q in ((pose.position, pose.orientation) for pose in poses)
    ]
    return np.array(rows, np.float64).reshape(-1, 7)


def pose_matrices(poses: Floats, *, is_raw: bool = False) -> Floats:
    """Return poses, shape (N, 7), as transforms, shape (N, 4, 4).

    Like the nodes of Ogre's scenes, they have normalized quaternions. With `is_raw`, columns are
    Ogre's products of quaternions and unit vectors, which are no rotation without unit length. A
    quaternion of zeros is the identity rotation.
    """
    quaternions = poses[:, 3:]
    if not is_raw:
        lengths = np.linalg.norm(quaternions, axis=1, keepdims=True)
        quaternions = quaternions / np.where(lengths > 0, lengths, 1.0)
    x, y, z, w = quaternions.T
    matrices = np.tile(np.eye(4), (len(poses), 1, 1))
    matrices[:, :3, 3] = poses[:, :3]
    matrices[:, 0, 0], matrices[:, 1, 1], matrices[:, 2, 2] = (
        1 - 2 * (a * a + b * b) for a, b in ((y, z), (x, z), (x, y))
    )
    matrices[:, 0, 1], matrices[:, 1, 0] = 2 * (x * y - w * z), 2 * (x * y + w * z)
    matrices[:, 0, 2], matrices[:, 2, 0] = 2 * (x * z + w * y), 2 * (x * z - w * y)
    matrices[:, 1, 2], matrices[:, 2, 1] = 2 * (y * z - w * x), 2 * (y * z + w * x)
    return matrices


_POSITION, _ORIENTATION = "Covariance/Position", "Covariance/Orientation"
COVARIANCE_PROPERTIES = (
    Property("Covariance", True, flag),
    Property(_POSITION, True, flag),
    Property(f"{_POSITION}/Color", (204, 51, 204), color),
    Property(f"{_POSITION}/Alpha", 0.3, number(0.0, 1.0)),
    Property(f"{_POSITION}/Scale", 1.0, number(0.0)),
    Property(_ORIENTATION, True, flag),
    # The axes of the pose, or of its reference frame.
    Property(f"{_ORIENTATION}/Frame", "Local", words("Local", "Fixed")),
    Property(f"{_ORIENTATION}/Color Style", "Unique", words("Unique", "RGB")),
    Property(
        f"{_ORIENTATION}/Color",
        (255, 255, 127),
        color,
        shown_if=((f"{_ORIENTATION}/Color Style", "Unique"),),
    ),
    Property(f"{_ORIENTATION}/Alpha", 0.5, number(0.0, 1.0)),
    # Distance of the discs, or of the cone's base, from the pose, [m].
    Property(f"{_ORIENTATION}/Offset", 1.0, number(0.0)),
    Property(f"{_ORIENTATION}/Scale", 1.0, number(0.0)),
)
_THICKNESS = 0.001  # [m]
# Angles are drawn as tangents, up to this limit.
_MAX_ANGLE = np.radians(89)
_ROUNDING = 1e-12
# RViz's position of a cone's center, as a fraction of its length from the pose.
_CONE_CENTER = 0.49115

# For the discs perpendicular to x, y and z: the indices of roll, pitch and yaw shown along the
# disc's two axes, and the rotation from the disc to the pose's axes.
_DISCS = (
    ([1, 2], np.array([[0, 0, 1], [0, -1, 0], [1, 0, 0]])),
    ([0, 2], np.array([[0, 1, 0], [0, 0, -1], [-1, 0, 0]])),
    ([0, 1], np.array([[1, 0, 0], [0, -1, 0], [0, 0, -1]])),
)


class UncertainPose(NamedTuple):
    """A pose with its covariance."""

    # Transform from the pose to the fixed frame, shape (4, 4).
    pose: Matrix
    # Transform of the pose's reference frame, shape (4, 4).
    transform_frame_to_fixed: Matrix
    # x, y, z in the reference frame [m^2], roll, pitch, yaw [rad^2], shape (6, 6).
    covariance: Matrix


def uncertain_pose(message: Any, transform_frame_to_fixed: Matrix) -> UncertainPose:
    """Convert a geometry_msgs/msg/PoseWithCovariance."""
    # RViz reads the numbers column by column, as Eigen stores a matrix.
    covariance = np.asarray(message.covariance, np.float64).reshape(6, 6).T
    pose = pose_in_fixed_frame(transform_frame_to_fixed, message.pose)
    return UncertainPose(pose, transform_frame_to_fixed, covariance)


def draw_covariances(poses: Sequence[UncertainPose], holder: PropertyHolder) -> dict[str, Drawable]:
    """Draw the covariances that the properties request.

    Positions are ellipsoids along the axes of the reference frame, independent of the pose's
    orientation. Orientations are three discs, whose extent is the uncertainty of the tip of an
    axis; a covariance in a plane is a cone along x, whose opening is the uncertainty of the yaw.
    """
    drawables: dict[str, Drawable] = {}
    if not holder["Covariance"] or not poses:
        return drawables
    at, frames, covariances = (np.stack(matrices) for matrices in zip(*poses, strict=True))
    # Whether a covariance is restricted to a plane.
    is_flat = (np.diagonal(covariances, axis1=1, axis2=2)[:, 2:5] <= 0).all(axis=1)
    if holder[_POSITION]:
        sizes = np.full((len(at), 3), (0.0, 0.0, _THICKNESS))
        axes = np.tile(np.eye(3), (len(at), 1, 1))
        for count, chosen in ((2, is_flat), (3, ~is_flat)):
            extents, directions = _deviations(covariances[chosen, :count, :count])
            sizes[chosen, :count] = extents * holder[f"{_POSITION}/Scale"]
            axes[chosen, :count, :count] = directions
        ellipsoids = placement(frames[:, :3, :3] @ axes, sizes, at[:, :3, 3])
        rgba = rgba_of(holder, f"{_POSITION}/Color", f"{_POSITION}/Alpha")
        drawables["place"] = Solids("sphere", ellipsoids, rgba)
    if not holder[_ORIENTATION]:
        return drawables
    rgba = rgba_of(holder, f"{_ORIENTATION}/Color", f"{_ORIENTATION}/Alpha")
    is_unique = holder[f"{_ORIENTATION}/Color Style"] != "RGB"
    colors = [rgba if is_unique else (*np.eye(3)[axis], rgba[3]) for axis in range(3)]
    offset, scale = holder[f"{_ORIENTATION}/Offset"], holder[f"{_ORIENTATION}/Scale"]
    is_local = holder[f"{_ORIENTATION}/Frame"] == "Local"
    # The frames of the discs and cones: the pose, or its position with the reference axes.
    bases = at if is_local else placement(frames[:, :3, :3], 1.0, at[:, :3, 3])
    if not is_flat.all():
        discs = _discs(covariances[~is_flat, 3:, 3:], offset, scale)
        placements = (bases[~is_flat, None] @ discs).reshape(-1, 4, 4)
        drawables["discs"] = Solids("cylinder", placements, np.tile(colors, (len(discs), 1)))
    if is_flat.any():
        spreads = 2 * np.sqrt(np.maximum(covariances[is_flat, 5, 5], 0.0)) * scale
        cone_sizes = np.full((len(spreads), 3), (_THICKNESS, 0.0, offset))
        cone_sizes[:, 1] = offset * _base_widths(spreads)
        rotations = np.tile(ALONG_MINUS_X, (len(spreads), 1, 1))
        cones = placement(rotations, cone_sizes, (_CONE_CENTER * offset, 0.0, 0.0))
        drawables["cones"] = Solids("cone", bases[is_flat] @ cones, colors[2])
    return drawables


def _discs(covariances: Matrix, offset: float, scale: float) -> Matrix:
    """Return the placements of the unit cylinders for the axes of each pose, shape (N, 3, 4, 4).

    Args:
        covariances: Of roll, pitch and yaw [rad^2], shape (N, 3, 3).
        offset: The distance of the discs [m].
        scale: The factor of the angles.
    """
    discs = np.empty((len(covariances), 3, 4, 4))
    for axis, (angles, rotation) in enumerate(_DISCS):
        spreads, directions = _deviations(covariances[:, angles][:, :, angles])
        sizes = np.full((len(covariances), 3), _THICKNESS)
        sizes[:, :2] = offset * _base_widths(spreads * scale)
        within = np.tile(np.eye(3), (len(covariances), 1, 1))
        within[:, :2, :2] = directions
        discs[:, axis] = placement(rotation @ within, sizes, offset * np.eye(3)[axis])
    return discs


def _deviations(covariances: Matrix) -> tuple[Matrix, Matrix]:
    """Return two standard deviations along the axes of ellipses, and the axes as columns.

    Like Eigen, it reads only the lower triangle. A covariance with a negative eigenvalue has no
    extent.

    Args:
        covariances: Shape (N, k, k).

    Returns:
        The deviations, shape (N, k), and the axes, shape (N, k, k).
    """
    variances, axes = np.linalg.eigh(covariances)
    # Make the axes right-handed.
    axes[:, :, 0] *= np.sign(np.linalg.det(axes))[:, None]
    is_invalid = variances[:, 0] < -_ROUNDING * variances[:, -1]
    variances[is_invalid], axes[is_invalid] = 0.0, np.eye(variances.shape[1])
    return 2 * np.sqrt(variances.clip(0)), axes


def _base_widths(angles: Matrix) -> Matrix:
    """Return the base diameters, at a distance of 1 m, of cones with these opening angles [rad]."""
    return 2 * np.tan(np.minimum(angles / 2, _MAX_ANGLE))
