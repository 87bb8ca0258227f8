"""Actions: long-running goals that report feedback and can be cancelled."""

from rclpy.action.client import ActionClient as ActionClient
from rclpy.action.client import get_action_names_and_types as get_action_names_and_types
from rclpy.action.server import ActionServer as ActionServer
from rclpy.action.server import CancelResponse as CancelResponse
from rclpy.action.server import GoalResponse as GoalResponse

# As in rclpy, `from rclpy.action import ActionClient` makes `rclpy.node.Node` available.
from rclpy.node import Node as _Node  # noqa: F401
