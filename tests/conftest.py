"""What every test may rely on: ROS names come from the stand-in."""

from course_lib.ros.standin_path import install

install()
