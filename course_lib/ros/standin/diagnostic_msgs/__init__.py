"""Stand-in for ROS 2's diagnostic_msgs."""
