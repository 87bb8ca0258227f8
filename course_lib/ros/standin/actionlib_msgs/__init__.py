"""Stand-in for ROS 2's actionlib_msgs."""
