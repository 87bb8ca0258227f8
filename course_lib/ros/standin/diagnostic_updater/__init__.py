from diagnostic_updater._diagnostic_updater import *  # noqa: F403  # as ROS's own does
