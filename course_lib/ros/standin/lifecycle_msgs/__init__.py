"""Stand-in for ROS 2's lifecycle_msgs."""
