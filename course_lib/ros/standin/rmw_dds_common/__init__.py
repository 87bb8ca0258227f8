"""Stand-in for ROS 2's rmw_dds_common."""
