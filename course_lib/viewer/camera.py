"""The camera of a scene."""

from dataclasses import dataclass
from math import pi, tan

import numpy as np

from course_lib.arrays import Floats, Matrix, Reals, Vector
from course_lib.errors import CourseError

FAR = 1000.0  # [m]


@dataclass(frozen=True)
class Camera:
    """A view of the scene, all in the scene's own frame and [m]."""

    eye: Vector = (5.0, 5.0, 7.071068)  # where the camera is
    target: Vector = (0.0, 0.0, 0.0)  # what it looks at and turns around
    up: Vector = (0.0, 0.0, 1.0)  # direction that is up in the picture
    vertical_fov: float = pi / 4  # opening angle in [rad]; RViz's is 45 degrees
    near: float = 0.01  # nearest distance that is drawn
    # pixels per metre of a view without perspective; None for perspective
    orthographic_scale: float | None = None
    # where it looks at, right of and below the middle of the picture, in heights of the picture
    shift: tuple[float, float] = (0.0, 0.0)
    far: float = FAR  # farthest distance that is drawn

    def __post_init__(self) -> None:
        for name in ("eye", "target", "up"):
            value = tuple(float(number) for number in getattr(self, name))
            if len(value) != 3 or not np.isfinite(value).all():
                raise CourseError(
                    f"Camera({name}={value}) is not a point: give three finite numbers (x, y, z)."
                )
            object.__setattr__(self, name, value)
        if self.eye == self.target:
            raise CourseError(f"The camera's eye and target are both {self.eye}: it looks nowhere.")

    def view_matrix(self) -> Matrix:
        """Return the transform from the scene to the camera (x right, y up, -z ahead), shape (4, 4)."""
        ahead = _unit(np.subtract(self.target, self.eye))
        side = np.cross(ahead, self.up)
        if np.linalg.norm(side) < 1e-6:  # looking along `up`: any other direction may be up
            side = np.cross(ahead, (0.0, 1.0, 0.0) if abs(ahead[1]) < 0.9 else (1.0, 0.0, 0.0))
        right = _unit(side)
        rotation = np.stack([right, np.cross(right, ahead), -ahead])
        transform_scene_to_camera = np.eye(4)
        transform_scene_to_camera[:3, :3] = rotation
        transform_scene_to_camera[:3, 3] = -rotation @ np.asarray(self.eye)
        return transform_scene_to_camera

    def pixels_per_metre(self, depth: Reals, height: int) -> Reals:
        """Return the pixels per metre at depths ahead of the eye, in a picture of some height in pixels."""
        if self.orthographic_scale is not None:
            return np.full_like(depth, self.orthographic_scale)
        return 0.5 * height / tan(self.vertical_fov / 2) / depth


def _unit(vector: Floats) -> Floats:
    length: float = np.linalg.norm(vector).item()
    return vector / length
