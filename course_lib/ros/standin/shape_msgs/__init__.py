"""Stand-in for ROS 2's shape_msgs."""
