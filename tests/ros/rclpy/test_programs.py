"""Whole programs, run as `course run` runs them."""

from pathlib import Path

import pytest

from course_lib.ros.clock import START_NS
from course_lib.ros.graph import Graph, Sample, use_graph
from course_lib.ros.program import run_files

MANY_THREADS = """
import time, random, threading
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String

class Worker(Node):
    def __init__(self):
        super().__init__("worker")
        self.publisher = self.create_publisher(String, "done", 10)
        for number in range(3):
            self.create_timer(0.1, lambda n=number: self.work(n), callback_group=ReentrantCallbackGroup())

    def work(self, number):
        time.sleep(random.random() / 3)
        self.publisher.publish(String(data=f"{number} {threading.active_count() > 1}"))

rclpy.init()
rclpy.spin(Worker(), MultiThreadedExecutor(4))
"""

ENDPOINT = """
import rclpy
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node("{name}")
{create}
rclpy.spin(node)
"""


def run(tmp_path: Path, *sources: str) -> list[Sample]:
    files = [tmp_path / f"program{number}.py" for number in range(len(sources))]
    for file, source in zip(files, sources, strict=True):
        file.write_text(source)
    samples: list[Sample] = []
    with use_graph(Graph(end_ns=START_NS + 3 * 10**9)) as graph:
        graph.tap(samples.append)
        assert run_files(files, seed=1) == 0
    return samples


def test_a_program_with_many_threads_does_the_same_each_time(tmp_path: Path) -> None:
    runs = [run(tmp_path, MANY_THREADS) for _ in range(5)]
    assert len(runs[0]) > 50
    assert all(samples == runs[0] for samples in runs)


def test_two_programs_each_have_their_own_init_and_hear_of_incompatible_partners(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    talker = ENDPOINT.format(
        name="talker", create='node.create_publisher(String, "x", qos_profile_sensor_data)'
    )
    listener = ENDPOINT.format(name="listener", create='node.create_subscription(String, "x", print, 10)')
    run(tmp_path, talker, listener)
    err = capsys.readouterr().err
    assert "[talker]: New subscription discovered on topic 'x', requesting incompatible QoS." in err
    assert "[listener]: New publisher discovered on topic 'x', offering incompatible QoS." in err
