from tf2_sensor_msgs.tf2_sensor_msgs import *  # noqa: F403  # as in ROS
