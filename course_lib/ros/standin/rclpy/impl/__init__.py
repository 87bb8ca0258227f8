"""What stands behind the public modules: names as in rclpy, contents the kit's own."""
