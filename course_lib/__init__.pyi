from .course.identity import ask_identity as ask_identity
from .course.installation import check_versions as check_versions
from .course.questions import compare as compare
from .course.questions import predict as predict
from .course.questions import quiz as quiz
from .displays.viewer import Viewer as Viewer
from .errors import CourseError as CourseError
from .grading.check import check as check
from .grading.personal import my_values as my_values
from .robots.robot import load_robot as load_robot
from .ros.clock import START_NS as START_NS
from .ros.driving import spin_for as spin_for
from .ros.live import run_live as run_live
from .ros.live import stop_all as stop_all
from .tools.performance import performance_report as performance_report

def load_ipython_extension(shell: object) -> None: ...
