from course_lib.ros.tf2_errors import *  # noqa: F403  # all of them
