"""What a package depends on, from what its modules import."""

import sys
from collections.abc import Iterable

from course_lib.errors import CourseError
from course_lib.ros.standin_path import provided

_ROSDEP = {  # what rosdep calls Python packages, where that is not python3-<name>
    "PIL": "python3-pil",
    "cv2": "python3-opencv",
    "pinocchio": "pinocchio",
    "skimage": "python3-skimage",
    "sklearn": "python3-sklearn",
    "yaml": "python3-yaml",
}


def dependencies(imported: Iterable[str], package: str) -> tuple[list[str], list[str]]:
    """Give the ROS packages, and rosdep's keys of others, among imported top-level packages.

    Raises:
        CourseError: The course's library is among them, which no robot has.
    """
    others = set(imported) - set(sys.stdlib_module_names) - {package, ""}
    if "course_lib" in others:
        raise CourseError(
            "The nodes use course_lib, which is not there on a robot. Keep Viewer, spin_for and check out of "
            "what the nodes need."
        )
    ros = others & set(provided())
    return sorted(ros), sorted(_ROSDEP.get(name, f"python3-{name.lower()}") for name in others - ros)
