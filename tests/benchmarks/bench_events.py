"""1,000 timers and 100,000 messages in one robot minute: `python tests/benchmarks/bench_events.py`.

Printed for a tenth, a half and all of the load, as ratios: the cost per message must not grow with
it.
"""

import time
from functools import partial

from course_lib.ros.graph.graph import START_NS, Graph, use_graph
from course_lib.ros.programs import import_path
from course_lib.ros.time.time_lock import time_lock

SECONDS = 60  # [s] of robot time
PERIOD = 0.6  # [s] of each timer: 100 messages a minute


def run(timers: int) -> tuple[float, int]:
    """Run timers that each publish to one listener. Return the CPU time [s] and the received messages."""
    import rclpy
    from rclpy.node import Node
    from std_msgs.msg import Int32

    heard = 0

    def hear(_: Int32) -> None:
        nonlocal heard
        heard += 1

    start = time.process_time()
    with use_graph(Graph(end_ns=START_NS + SECONDS * 10**9)), time_lock.hold():
        rclpy.init()
        node = Node("bench")
        publisher = node.create_publisher(Int32, "numbers", 10)
        node.create_subscription(Int32, "numbers", hear, timers)
        for number in range(timers):
            node.create_timer(PERIOD, partial(publisher.publish, Int32(data=number)))
        rclpy.spin(node)
    return time.process_time() - start, heard


def main() -> None:
    """Print one line per load."""
    import_path.install()
    peer = None
    for timers in (100, 500, 1_000):
        busy, heard = run(timers)
        cost = busy / heard * 1e6  # [us]
        peer = peer or cost
        print(
            f"{timers:5} timers {heard:6} messages  {busy:6.2f} s CPU  {cost:5.1f} us each {cost / peer:.2f}x"
        )


if __name__ == "__main__":
    main()
