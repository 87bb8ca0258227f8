"""Stand-in for ROS 2's nav_msgs."""
