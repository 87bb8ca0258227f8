"""Stand-in for ROS 2's rcl_interfaces."""
