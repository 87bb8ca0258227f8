"""Two nodes of the same full name: an oversight in ROS, a re-run cell in a notebook."""

from typing import TYPE_CHECKING

from course_lib.ros.driving import say
from rclpy.impl.run import current_run
from rclpy.logging import get_logger

if TYPE_CHECKING:
    from rclpy.node import Node

_WARNING = (
    "Publisher already registered for node name: '{0}'. If this is due to multiple nodes with the same name "
    "then all logs for the logger named '{0}' will go out over the existing publisher. As soon as any node "
    "with that name is destructed it will unregister the publisher, preventing any further logs for that "
    "name from being published on the rosout topic."
)


def settle_same_names(node: "Node") -> None:
    """Note a new node; one of the same name is replaced in a notebook and warned of elsewhere, as in ROS."""
    nodes = current_run().nodes
    name = node.get_fully_qualified_name()
    namesakes = [other for other in nodes.values() if other.get_fully_qualified_name() == name]
    nodes[node.handle.id] = node
    if namesakes and not node.handle.graph.notebook:
        get_logger("rcl.logging_rosout").warning(_WARNING.format(node.handle.logger_name))
    elif namesakes:
        say(f"The new node {name} replaces the one of the same name.")
        for other in namesakes:
            other.destroy_node()
