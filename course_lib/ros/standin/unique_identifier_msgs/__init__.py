"""Stand-in for ROS 2's unique_identifier_msgs."""
