"""Stand-in for ROS 2's stereo_msgs."""
