"""Stand-in for ROS 2's trajectory_msgs."""
