"""A robot: its description, and Pinocchio's models of it."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from course_lib.robots.resources import resolve
from course_lib.robots.urdf import Urdf, parse_urdf

if TYPE_CHECKING:
    import pinocchio as pin


@dataclass(frozen=True, eq=False)
class Robot:
    """A robot.

    Args:
        name: What it was loaded as, or its name in the URDF.
        model: Pinocchio's model; with it go its shapes for collisions and for the eye.
        q0: Its rest posture as a configuration of the model, shape (nq,).
        urdf: The text of its description, what /robot_description carries; path is the file that it is from.
    """

    name: str
    model: "pin.Model"
    collision_model: "pin.GeometryModel"
    visual_model: "pin.GeometryModel"
    q0: npt.NDArray[np.float64]
    urdf: str
    path: Path | None = None

    @property
    def tree(self) -> Urdf:
        """The description's links and joints."""
        return parse_urdf(self.urdf)

    def resolve(self, uri: str) -> Path:
        """Return the file of a ``package://`` or ``file://`` address in the description."""
        return resolve(uri, self.path)
