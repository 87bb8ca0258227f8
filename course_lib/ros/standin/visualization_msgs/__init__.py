"""Stand-in for ROS 2's visualization_msgs."""
