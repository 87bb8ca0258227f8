import threading

import rclpy
from rclpy.node import Node
from rclpy.wait_for_message import wait_for_message
from std_msgs.msg import String

from course_lib.ros.graph import Graph


def test_the_next_message_is_returned_without_spinning_the_own_node(begun: Graph, node: Node) -> None:
    other = Node("other")
    publisher = other.create_publisher(String, "/chatter", 10)
    other.create_timer(1.0, lambda: publisher.publish(String(data="hi")))
    threading.Thread(target=rclpy.spin, args=(other,), daemon=True).start()
    assert wait_for_message(String, node, "/chatter") == (True, String(data="hi"))
    assert list(node.subscriptions) == []
    rclpy.shutdown()


def test_without_one_it_ends_in_time(begun: Graph, node: Node) -> None:
    start_ns = begun.now_ns
    assert wait_for_message(String, node, "/chatter", time_to_wait=0.5) == (False, None)
    assert begun.now_ns - start_ns == 500_000_000
