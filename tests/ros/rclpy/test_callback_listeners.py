import time
from typing import Any

import rclpy
from rclpy.node import Node
from std_msgs.msg import String

from course_lib.ros.graph.graph import START_NS, Graph


def test_callback_listener_receives_entity_ready_time_and_start_time(
    started_graph: Graph, node: Node
) -> None:
    received: list[tuple[str, float, float]] = []

    def listen(entity: Any, since_ns: int, start_ns: int, processor: float) -> None:
        assert 0 <= processor < 1
        received.append(
            (
                type(entity).__name__,
                round((since_ns - START_NS) * 1e-9, 3),
                round((start_ns - START_NS) * 1e-9, 3),
            )
        )

    started_graph.callback_listeners.append(listen)
    publisher = node.create_publisher(String, "words", 10)

    def slow() -> None:
        publisher.publish(String())
        time.sleep(2.0)

    node.create_timer(4.0, slow)
    node.create_subscription(String, "words", lambda _: None, 10)
    rclpy.spin(node)
    assert received == [
        ("Timer", 4.0, 4.0),
        ("Subscription", 4.001, 6.0),  # it arrived while the timer's callback slept
        ("Timer", 8.0, 8.0),
        ("Subscription", 8.001, 10.0),
    ]
