"""Stand-in for ROS 2's rosgraph_msgs."""
