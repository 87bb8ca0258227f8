from tf2_geometry_msgs.tf2_geometry_msgs import *  # noqa: F403  # as in ROS
