"""Stand-in for rclpy's C extension. Programs use only its exceptions."""

from rclpy import exceptions as rclpy_implementation

__all__ = ["rclpy_implementation"]
