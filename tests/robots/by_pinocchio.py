"""Pinocchio's answers, which the kit's kinematics is compared with."""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

pin: Any = pytest.importorskip("pinocchio")


@lru_cache(maxsize=1)
def model_of(urdf: str) -> Any:
    """Return the model of a description, whose root stands still."""
    return pin.buildModelFromXML(urdf)


def configuration(model: Any, positions: Mapping[str, float]) -> npt.NDArray[np.float64]:
    """Return positions by name, [rad] or [m], as a model's configuration; other joints are neutral."""
    values: npt.NDArray[np.float64] = pin.neutral(model)
    for name, position in positions.items():
        joint = model.joints[model.getJointId(name)]
        # A joint without limits is a point on the unit circle.
        numbers = (position,) if joint.nq == 1 else (np.cos(position), np.sin(position))
        values[joint.idx_q : joint.idx_q + joint.nq] = numbers
    return values


def placed(model: Any, positions: Mapping[str, float]) -> Any:
    """Return the data of a model with all frames at positions."""
    data = model.createData()
    pin.framesForwardKinematics(model, data, configuration(model, positions))
    return data


def link_poses(model: Any, positions: Mapping[str, float]) -> dict[str, Any]:
    """Return transform_link_to_model of all links as SE3."""
    frames = zip(model.frames, placed(model, positions).oMf, strict=True)
    return {frame.name: pin.SE3(pose) for frame, pose in frames if frame.type == pin.FrameType.BODY}
