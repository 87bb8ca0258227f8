import signal
from pathlib import Path

import pytest

from tests.patience import PATIENCE
from tests.ros.zenoh.test_connecting import course

SERVER = """
import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer


def execute(goal):
    sequence = [0, 1]
    while len(sequence) < goal.request.order:
        sequence.append(sequence[-1] + sequence[-2])
        goal.publish_feedback(Fibonacci.Feedback(sequence=sequence))
    goal.succeed()
    return Fibonacci.Result(sequence=sequence)


rclpy.init()
node = rclpy.create_node("server")
server = ActionServer(node, Fibonacci, "fibonacci", execute)
print("up", flush=True)
rclpy.spin(node)
"""
CLIENT = """
import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient

rclpy.init()
node = rclpy.create_node("client")
client = ActionClient(node, Fibonacci, "fibonacci")
assert client.wait_for_server(timeout_sec=60.0)
asked = client.send_goal_async(Fibonacci.Goal(order=6), lambda message: print("feedback", flush=True))
rclpy.spin_until_future_complete(node, asked)
result = asked.result().get_result_async()
rclpy.spin_until_future_complete(node, result)
print(result.result().status, list(result.result().result.sequence))
"""


@pytest.mark.slow
def test_action_server_of_one_kit_executes_the_goal_of_another(router: str, tmp_path: Path) -> None:
    (tmp_path / "server.py").write_text(SERVER)
    (tmp_path / "client.py").write_text(CLIENT)
    link = ("--robot", router, "--call", "/fibonacci")
    server = course("run", str(tmp_path / "server.py"), *link)
    try:
        assert server.read_line() == "up\n"
        client = course("run", str(tmp_path / "client.py"), *link)
        said, complaints = client.communicate(timeout=PATIENCE)
    finally:
        server.send_signal(signal.SIGINT)
        server.communicate(timeout=PATIENCE)
    assert (said.splitlines()[-1], complaints) == ("4 [0, 1, 1, 2, 3, 5]", "")
    assert "feedback" in said
