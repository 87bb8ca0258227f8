"""Stand-in for ROS 2's service_msgs."""
