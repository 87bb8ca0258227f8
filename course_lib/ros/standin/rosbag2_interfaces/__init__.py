"""Stand-in for ROS 2's rosbag2_interfaces."""
