"""Stand-in for ROS 2's geometry_msgs."""
