"""Stand-in for ROS 2's statistics_msgs."""
