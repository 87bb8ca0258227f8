"""Stand-in for ROS 2's type_description_interfaces."""
