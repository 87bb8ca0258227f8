"""Stand-in for ROS 2's action_msgs."""
