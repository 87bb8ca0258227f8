"""Verbs of ros2cli itself, over nodes of the kit's rclpy: what they print and how they end.

`course run tests/tools/ros2cli_verbs.py -- SOURCES` writes the outcomes to tests/data, where SOURCES
is a checkout of github.com/ros2/ros2cli, branch jazzy.
"""

import argparse
import contextlib
import importlib
import io
import json
import re
import sys
import threading
import time
from pathlib import Path
from typing import Any

import rclpy
import rclpy.action
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.action import ActionServer
from rclpy.executors import MultiThreadedExecutor
from rclpy.lifecycle import LifecycleNode, State, TransitionCallbackReturn
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger

FILE = Path(__file__).parents[1] / "data" / "ros2cli_outputs.json"
INVALID = "std_msgs/msg/Nothing"
FIBONACCI = "/fib example_interfaces/action/Fibonacci"
# A last argument in braces has spaces.
COMMANDS = [
    *("node list", "node list -c", "node info /demo/talker", "node info /managed", "node info /nothing"),
    *("param list", "param list /demo/talker", "param list /nothing"),
    *("param list --param-type /demo/talker", "param list --filter s.* /demo/talker"),
    *(f"param get /demo/talker {name}" for name in ("speed", "names", "raw", "nothing", "empty")),
    *("param get --hide-type /demo/talker flags", "param get /nothing speed"),
    *("param describe /demo/talker speed count fixed", "param describe /demo/talker nothing"),
    *("param dump /managed", "param dump /demo/talker", "param dump /nothing"),
    *(
        "param set /demo/talker speed 2.0",
        "param set /demo/talker speed 9.0",
        "param set /demo/talker fixed 9",
    ),
    *("param set /demo/talker nothing 9", "param set /demo/talker label 5", "param delete /demo/talker none"),
    *("action list", "action list -t", "action list -c", "action type /fib"),
    *("action info /fib", "action info /fib -t", "action info /fib -c", "action info /nothing"),
    *(f"action send_goal {FIBONACCI} {{order: 4}}", f"action send_goal -f {FIBONACCI} {{order: 4}}"),
    *(f"action send_goal {FIBONACCI} {{wrong: 4}}", "action send_goal /fib example_interfaces/action/No {}"),
    *("service list", "service list -t", "service list -c", "service type /add", "service info /add"),
    *("service info /nothing", "service find std_srvs/srv/SetBool", "service find -c std_srvs/srv/SetBool"),
    *(f"service call /add example_interfaces/srv/AddTwoInts {{{values}}}" for values in ("a: 1", "", "c: 1")),
    *("service call /add example_interfaces/srv/No {}", "service call /add AddTwoInts {}"),
    *("topic list", "topic list -t", "topic list -c", "topic info /demo/chatter", "topic info /nothing"),
    *("topic type /demo/chatter", "topic find std_msgs/msg/String", "topic find -c std_msgs/msg/String"),
    *("topic pub --once /demo/chatter std_msgs/msg/String {data: hi}", f"topic pub --once /x {INVALID} {{}}"),
    *("lifecycle nodes", "lifecycle nodes -a", "lifecycle nodes -c", "lifecycle get"),
    *("lifecycle get /managed", "lifecycle get /nothing", "lifecycle get /listener"),
    *("lifecycle list /managed", "lifecycle list -a /managed", "lifecycle list /listener"),
    *("lifecycle set /managed configure", "lifecycle set /managed configure", "lifecycle set /nothing 1"),
    *("interface package std_srvs", "interface package nothing"),
    *("interface proto std_srvs/srv/SetBool", "interface proto geometry_msgs/msg/PoseStamped"),
    *("interface proto --no-quotes sensor_msgs/msg/JointState", f"interface proto {INVALID}"),
    "interface proto example_interfaces/action/Fibonacci",
]


class Talker(Node):
    """A node with parameters of all kinds, services and an uninitialized parameter."""

    def __init__(self) -> None:
        super().__init__("talker", namespace="/demo")
        self.create_publisher(String, "chatter", 10)
        self.create_subscription(String, "chatter", lambda msg: None, 10)
        limits = [FloatingPointRange(from_value=0.0, to_value=5.0, step=0.5)]
        self.declare_parameter(
            "speed", 1.5, ParameterDescriptor(description="How fast", floating_point_range=limits)
        )
        counts = [IntegerRange(from_value=0, to_value=10, step=1)]
        even = ParameterDescriptor(integer_range=counts, additional_constraints="even")
        self.declare_parameter("count", 3, even)
        self.declare_parameter("fixed", 7, ParameterDescriptor(read_only=True))
        self.declare_parameters(
            "",
            [
                ("label", "hi: there"),
                ("flags", [True, False]),
                ("names", ["a", "b c"]),
                ("group.inner", "x"),
                ("raw", [b"a", b"b"]),
            ],
        )
        self.declare_parameter("empty", rclpy.Parameter.Type.DOUBLE)
        self.create_service(SetBool, "toggle", lambda request, response: response)
        self.create_service(AddTwoInts, "/add", self.on_add)
        self.create_client(Trigger, "/start")

    def on_add(self, request: Any, response: Any) -> Any:
        response.sum = request.a + request.b
        return response


class Managed(LifecycleNode):
    """A lifecycle node."""

    def on_configure(self, state: State) -> TransitionCallbackReturn:
        return TransitionCallbackReturn.SUCCESS


def on_fibonacci(goal: Any) -> Any:
    sequence = [0, 1]
    for _ in range(1, goal.request.order):
        sequence.append(sequence[-1] + sequence[-2])
        goal.publish_feedback(Fibonacci.Feedback(sequence=sequence))
    goal.succeed()
    return Fibonacci.Result(sequence=sequence)


def make_nodes() -> list[Node]:
    """Return the nodes that the commands are about."""
    listener = Node("listener")
    ActionServer(listener, Fibonacci, "/fib", on_fibonacci)
    return [Talker(), Managed("managed"), listener]


def split(command: str) -> list[str]:
    """Split a command into arguments."""
    words, brace, rest = command.partition("{")
    return [*words.split(), *([brace + rest] if brace else [])]


def without_ids(text: str) -> str:
    """Return an output without the random IDs of goals."""
    return re.sub(r"[0-9a-f]{32}", "ID", text)


def _actions(method: str) -> Any:
    """Return a function that the kit's rclpy lacks: the actions of a node."""
    end = "/_action/send_goal"

    def find(node: Node, name: str, namespace: str) -> list[tuple[str, list[str]]]:
        found = getattr(node, method)(name, namespace)
        return [
            (n.removesuffix(end), [t.removesuffix("_SendGoal") for t in ts]) for n, ts in found if end in n
        ]

    return find


def _outcome(command: str) -> dict[str, str]:
    group, verb, *arguments = split(command)
    module = importlib.import_module(f"ros2{group}.verb.{verb}")
    kinds = {name: value for name, value in vars(module).items() if name.endswith("Verb")}
    kind = next(value for value in kinds.values() if value.__module__ == module.__name__)
    extension = kind.__new__(kind)
    parser = argparse.ArgumentParser()
    extension.add_arguments(parser, "ros2")
    has_daemon = "--no-daemon" in parser.format_help()
    namespace = parser.parse_args([*(["--no-daemon"] if has_daemon else []), *arguments])
    for option in ("include_hidden_services", "include_hidden_topics"):
        setattr(namespace, option, getattr(namespace, option, False))
    out, err, error = io.StringIO(), io.StringIO(), ""
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            result = extension.main(args=namespace)
            error = result if isinstance(result, str) else ""
        except Exception as raised:
            error = f"{raised}"
    return {"stdout": without_ids(out.getvalue()), "stderr": err.getvalue(), "error": error}


def main() -> None:
    """Write the outcomes of ros2cli."""
    sys.path += [str(path) for path in Path(sys.argv[1]).iterdir() if (path / path.name).is_dir()]
    rclpy.init()
    executor = MultiThreadedExecutor()
    for node in make_nodes():
        executor.add_node(node)
    threading.Thread(target=executor.spin, daemon=True).start()
    time.sleep(0.5)
    # The verbs start and stop rclpy themselves.
    for name in ("init", "shutdown", "try_shutdown"):
        setattr(rclpy, name, lambda **_: None)
    action: Any = rclpy.action
    action.get_action_server_names_and_types_by_node = _actions("get_service_names_and_types_by_node")
    action.get_action_client_names_and_types_by_node = _actions("get_client_names_and_types_by_node")
    outcomes = [[command, _outcome(command)] for command in COMMANDS]
    FILE.write_text(f"{json.dumps({'ros2cli': '0.32.2', 'outcomes': outcomes}, indent=1)}\n", "utf-8")


if __name__ == "__main__":
    main()
