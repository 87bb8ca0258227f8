"""Learn robot visualization and ROS 2 tooling in JupyterLab, with nothing but pip.

In a notebook: `%load_ext course_lib`, then plain ROS 2 code. The names below are the handful that a lesson
uses; each is loaded when it is first asked for.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell

    from course_lib.course.predict import predict
    from course_lib.course.quiz import quiz
    from course_lib.displays.viewer import Viewer
    from course_lib.errors import CourseError
    from course_lib.grading.check import check
    from course_lib.robots.load import load_robot
    from course_lib.ros.driving import spin_for
    from course_lib.ros.live import run_live
    from course_lib.tools.performance.report import performance_report

__all__ = [
    "CourseError",
    "Viewer",
    "check",
    "load_robot",
    "performance_report",
    "predict",
    "quiz",
    "run_live",
    "spin_for",
]

_MODULES = {
    "CourseError": "course_lib.errors",
    "Viewer": "course_lib.displays.viewer",
    "check": "course_lib.grading.check",
    "load_robot": "course_lib.robots.load",
    "predict": "course_lib.course.predict",
    "quiz": "course_lib.course.quiz",
    "performance_report": "course_lib.tools.performance.report",
    "run_live": "course_lib.ros.live",
    "spin_for": "course_lib.ros.driving",
}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'course_lib' has no attribute {name!r}; it offers {', '.join(__all__)}")
    from course_lib.ros import standin_path

    standin_path.install()
    return getattr(import_module(_MODULES[name]), name)


def load_ipython_extension(shell: "InteractiveShell") -> None:
    """Do what `%load_ext course_lib` does."""
    from course_lib.extension import load

    load(shell)
