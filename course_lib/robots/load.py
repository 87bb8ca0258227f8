"""Robot models by name."""

import difflib
import sys
from typing import TYPE_CHECKING

from course_lib.errors import CourseError

if TYPE_CHECKING:
    from pinocchio.robot_wrapper import RobotWrapper


def load_robot(name: str) -> "RobotWrapper":
    """Load a robot of example-robot-data by its name, like "ur10".

    Returns:
        Pinocchio's wrapper: `model`, `collision_model`, `visual_model`, `q0` (neutral configuration, [rad]).

    Raises:
        CourseError: If there is no such robot, or robots cannot be loaded on this machine.
    """
    try:
        import example_robot_data
    except ImportError as error:
        raise CourseError(
            f"Robot models need the packages pin and example-robot-data, and {error.name} is missing on this "
            f"machine ({sys.platform}). On Windows run the course in WSL2 or on a JupyterHub; elsewhere run "
            "pip install -e . again."
        ) from error
    known = sorted(example_robot_data.ROBOTS)
    if name not in known:
        close = difflib.get_close_matches(name, known, n=3) or known[:3]
        raise CourseError(
            f"There is no robot {name!r} among the {len(known)} models; close to it: {', '.join(close)}."
        )
    return example_robot_data.load(name)
