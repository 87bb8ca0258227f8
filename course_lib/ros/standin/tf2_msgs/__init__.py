"""Stand-in for ROS 2's tf2_msgs."""
