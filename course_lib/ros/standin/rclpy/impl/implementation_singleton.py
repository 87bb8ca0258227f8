"""rclpy's layer in C, of which programs use the exceptions."""

from rclpy import exceptions as rclpy_implementation

__all__ = ["rclpy_implementation"]
