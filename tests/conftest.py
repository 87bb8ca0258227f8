"""Setup of every test: ROS names come from the stand-in."""

import hypothesis

from course_lib.ros.standin_path import install

install()
hypothesis.settings.register_profile("untimed", deadline=None)  # a busy machine is no mistake
hypothesis.settings.load_profile("untimed")
