"""The motors of a simulated robot."""

from collections.abc import Mapping

import numpy as np

from course_lib.errors import CourseError
from course_lib.robots.spline import Floats
from course_lib.robots.urdf import MOVING, Urdf


class SimulatedJoints:
    """Joints that go where they are told within a period, as far as the limits in the URDF let them.

    Args:
        tree: The robot; joints that mimic others are left out.
        start: Positions by name, [rad] or [m]; joints without one begin at 0.

    Raises:
        CourseError: If a joint does not exist, or would begin outside of its limits.
    """

    def __init__(self, tree: Urdf, start: Mapping[str, float]) -> None:
        joints = [j for j in tree.joints.values() if j.kind in MOVING and not j.mimic]
        self.names = [joint.name for joint in joints]
        self.lower = np.array([joint.limits.get("lower", -np.inf) for joint in joints])
        self.upper = np.array([joint.limits.get("upper", np.inf) for joint in joints])
        in_model = [tree.model.joints[tree.model.getJointId(name)] for name in self.names]
        self.speed = np.array([tree.model.velocityLimit[joint.idx_v] for joint in in_model])
        for name, position in start.items():
            if name not in self.names:
                raise CourseError(f"There is no joint {name!r} to start; there are {', '.join(self.names)}.")
            i = self.names.index(name)
            if not self.lower[i] <= position <= self.upper[i]:
                limits = f"{self.lower[i]:.3f} … {self.upper[i]:.3f}"
                raise CourseError(f"{name} cannot start at {position!r}; its limits are {limits}.")
        self.positions: Floats = np.array([start.get(name, 0.0) for name in self.names])
        self.velocities: Floats = np.zeros(len(joints))

    def follow(self, command: Floats, period: float) -> list[str]:
        """Go to positions within a period [s]; says, as ROS does, which limits stand in the way."""
        inside = np.clip(command, self.lower, self.upper)
        reach = self.speed * period
        reached = np.clip(inside, self.positions - reach, self.positions + reach)
        limited = {"position": inside != command, "velocity": np.abs(reached - inside) > 1e-9}
        self.velocities, self.positions = (reached - self.positions) / period, reached
        names = {kind: " ".join(np.array(self.names)[which]) for kind, which in limited.items()}
        return [f"Joint(s) [{n}] would exceed {kind} limits, limiting" for kind, n in names.items() if n]
