"""Setup of every test: ROS names come from the stand-in, and kernels need no port."""

import os

import hypothesis

from course_lib.ros.standin_path import install
from tests.kernels import listen_on_files

install()
if os.name == "posix":  # Windows has no such sockets
    listen_on_files()
hypothesis.settings.register_profile("untimed", deadline=None)  # a busy machine is no mistake
hypothesis.settings.load_profile("untimed")
