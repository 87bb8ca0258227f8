"""Nodes in launch files; the kit's stand-in."""

from launch_ros import event_handlers as event_handlers
