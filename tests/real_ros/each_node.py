"""Runs nodes of the course in the kit or the real rclpy: `each_node.py NODES.json OUTCOMES.json [KITS.json]`.

Each node gets filled messages on its topics, and a request on each of its services. The outcome is
what it publishes, answers and prints. KITS.json has the outcomes of the kit: the real rclpy then
runs each node in a process of its own until it has published as much, and several nodes at the same
time.
"""

import hashlib
import importlib
import io
import json
import os
import re
import signal
import socket
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Iterable
from contextlib import redirect_stderr, redirect_stdout, suppress
from pathlib import Path
from typing import Any

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile

# Maximum number of messages that are compared on a topic.
MESSAGES = 4
# Time for each input, and then for the timers; the real rclpy runs until it has published as much
# [s].
INPUT_SECONDS, SECONDS, REAL_SECONDS = 0.25, 2.2, 1.2
# The real rclpy may take longer on a busy machine [s].
TIME_LIMIT = 20.0
AT_ONCE = 12
# Length up to which the text of a message is stored in addition to its digest.
LENGTH = 160
ACTION = ("send_goal", "cancel_goal", "get_result")
FIRST_SECOND = 1000
TIME = "builtin_interfaces/Time"
OWN_TOPICS = ("/rosout", "/parameter_events")
# Transforms between all frames that the nodes of the course look up but do not broadcast.
FRAMES = {
    "world": "map",
    "odom": "map",
    "base_link": "odom",
    "robot": "map",
    "laser": "robot",
    "camera_link": "base_link",
    "tool0": "base_link",
    "gripper_link": "tool0",
}
Outcome = dict[str, Any]


def fill(message: Any, number: int = 1) -> Any:
    """Set all fields of a message to values that are valid and differ from the defaults; return it."""
    for name, kind in message.get_fields_and_field_types().items():
        value = getattr(message, name)
        element = re.sub(r"^sequence<(.*?)(, \d+)?>$|\[\d*\]$", r"\1", kind)
        if hasattr(value, "get_fields_and_field_types"):
            if kind == "geometry_msgs/Quaternion":
                value.w = 1.0
            elif kind not in (TIME, "builtin_interfaces/Duration"):
                fill(value, number)
        elif name == "frame_id":
            message.frame_id = "map"
        elif kind.startswith("sequence") and "/" in element:
            element_type = _type_of(element)
            setattr(message, name, [fill(element_type(), one) for one in range(1, 3)])
        elif kind.startswith("sequence"):
            setattr(message, name, _numbers(element, 4))
        elif isinstance(value, bool):
            setattr(message, name, True)
        elif isinstance(value, int | float):
            setattr(message, name, type(value)(number))
        elif isinstance(value, str):
            setattr(message, name, str(number) if name == "id" else f"{name}_{number}")
    return message


def _numbers(element: str, count: int) -> list[Any]:
    if element.startswith("string"):
        return [f"name_{number}" for number in range(count)]
    if element == "boolean":
        return [True] * count
    if element in ("octet", "byte"):
        return [b"\x01"] * count
    kind = float if element in ("float", "double") else int
    return [kind(number + 1) for number in range(count)]


def _type_of(name: str) -> Any:
    package, _, kind = name.partition("/")
    return getattr(importlib.import_module(f"{package}.msg"), kind)


def sample(kind: Any) -> Any:
    """Return the message that a node gets on its topics of a type."""
    message = kind()
    if kind.__name__ == "TFMessage":
        from geometry_msgs.msg import TransformStamped

        for child, parent in FRAMES.items():
            transform = TransformStamped(child_frame_id=child)
            transform.header.frame_id = parent
            transform.transform.translation.x, transform.transform.rotation.w = 1.0, 1.0
            message.transforms.append(transform)
        return message
    return fill(message)


def later(message: Any) -> Any:
    """Increase the stamp of a message and of its parts by a second, and its numbers a little; return it."""
    for name, kind in message.get_fields_and_field_types().items():
        value = getattr(message, name)
        if kind == TIME:
            value.sec = max(value.sec, FIRST_SECOND) + 1
        elif kind == "geometry_msgs/Point":
            value.x += 0.25
        elif hasattr(value, "get_fields_and_field_types"):
            later(value)
        elif isinstance(value, list):
            for one in value:
                if hasattr(one, "get_fields_and_field_types"):
                    later(one)
    return message


def plain(message: Any) -> Any:
    """Return a message as lists and numbers, without its stamps: bytes between fields may differ."""
    if not hasattr(message, "get_fields_and_field_types"):
        return [plain(one) for one in message] if isinstance(message, list) else message
    fields = message.get_fields_and_field_types()
    values = {name: getattr(message, name) for name, kind in fields.items() if kind != TIME}
    return {
        name: value.tolist() if hasattr(value, "tolist") else plain(value) for name, value in values.items()
    }


def text_of(message: Any) -> str:
    """Return the type of a message, a digest of its fields without stamps, and the fields if short."""
    text = repr(plain(message))
    digest = hashlib.sha1(text.encode(), usedforsecurity=False).hexdigest()[:12]
    return f"{type(message).__name__} {digest} {text if len(text) <= LENGTH else ''}".strip()


def run(program: str, kits: Outcome) -> Outcome:
    """Run the node that a program creates, and return its outcome."""
    found: dict[str, list[str]] = {}
    answers: dict[str, str] = {}
    publish = Publisher.publish

    def record(publisher: Any, message: Any) -> None:
        topic = publisher.topic_name
        publish(publisher, message)
        if topic not in OWN_TOPICS and topic not in inputs and len(found.get(topic, ())) < MESSAGES:
            found.setdefault(topic, []).append(text_of(message))

    inputs: set[str] = set()
    error = ""
    rclpy.init(args=[])
    Publisher.publish = record  # type: ignore[method-assign, assignment]
    try:
        module: dict[str, Any] = {"__name__": "node"}
        exec(compile(program, "node.py", "exec"), module)
        node = module["create_node"]()
        tester = Node("tester")
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        executor.add_node(tester)
        publishers = [
            (tester.create_publisher(one.msg_type, one.topic_name, qos_of(one)), sample(one.msg_type))
            for one in sorted(node.subscriptions, key=lambda one: not one.topic_name.startswith("/tf"))
        ]
        inputs |= {publisher.topic_name for publisher, _ in publishers}
        begin = time.monotonic()
        while not all(one.get_subscription_count() for one, _ in publishers):
            assert time.monotonic() < begin + TIME_LIMIT
            time.sleep(0.01)

        timers = list(node.timers)
        for timer in timers:
            timer.cancel()
        for _ in range(MESSAGES if publishers else 0):
            for publisher, message in publishers:
                publish(publisher, later(message))
            spin(executor, INPUT_SECONDS, lambda: False)
        # The timers begin when all inputs are there, so that a busy machine does not change their
        # order.
        for timer in timers:
            timer.reset()
        if kits:
            spin(executor, TIME_LIMIT, lambda: is_complete(found, kits["topics"]), at_least=REAL_SECONDS)
        else:
            spin(executor, SECONDS, lambda: False)
        for service in node.services:
            # The services of every node, and of actions.
            if service.srv_name.startswith(f"{node.get_name()}/") or service.srv_name in ACTION:
                continue
            client = tester.create_client(service.srv_type, service.srv_name)
            client.wait_for_service()
            future = client.call_async(fill(service.srv_type.Request()))
            executor.spin_until_future_complete(future, timeout_sec=TIME_LIMIT)
            answers[service.srv_name] = text_of(future.result())
    except Exception as raised:
        error = "".join(traceback.format_exception_only(raised)).strip()
    finally:
        Publisher.publish = publish  # type: ignore[method-assign]
        rclpy.try_shutdown()
    return {"topics": found, "answers": answers, "error": error}


def qos_of(subscription: Any) -> QoSProfile:
    """Return a profile that is compatible with a subscription."""
    is_latched = subscription.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
    return QoSProfile(depth=10, durability=2 - is_latched)


def spin(
    executor: SingleThreadedExecutor, seconds: float, is_done: Callable[[], bool], at_least: float = 0.0
) -> None:
    """Spin for some seconds, or until a condition is met, but at least for a time."""
    begin = time.monotonic()
    while (passed := time.monotonic() - begin) < seconds and not (passed >= at_least and is_done()):
        executor.spin_once(timeout_sec=0.05)


def is_complete(outputs: dict[str, list[str]], expected_outputs: dict[str, list[str]]) -> bool:
    """Return whether as many messages were published on each topic as the kit's node publishes."""
    return all(len(outputs.get(topic, ())) >= len(messages) for topic, messages in expected_outputs.items())


def plain_lines(text: str) -> list[str]:
    """Return the lines of an output, each once, without times and the kit's hints, in alphabetical order."""
    text = re.sub(r"\[\d+\.\d+\] ", "", text)
    return sorted({line for line in text.splitlines() if line.strip() and not line.startswith("hint: ")})


def outcome(program: str, kits: Outcome) -> Outcome:
    """Return the outcome of a node: published messages and printed lines."""
    with tempfile.TemporaryFile("w+") as file:
        kept = [os.dup(number) for number in (1, 2)]
        sys.stdout.flush()
        for number in (1, 2):
            os.dup2(file.fileno(), number)
        output = io.StringIO()
        try:
            with redirect_stdout(output), redirect_stderr(output):
                found = run(program, kits)
        finally:
            for number, one in zip((1, 2), kept, strict=True):
                os.dup2(one, number)
                os.close(one)
        file.seek(0)
        return found | {"lines": plain_lines(output.getvalue() + file.read())}


def next_free_domain(domain: int) -> int:
    """Return the next domain, of 1 to 100, in which no other test's participant is."""
    for _ in range(100):
        domain = domain % 100 + 1
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe, suppress(OSError):
            probe.bind(("", 7410 + 250 * domain))
            return domain
    raise AssertionError("Other programs use the DDS domains 1 to 100.")


def start(program: str, kits: Outcome, file: Path, domain: int) -> int:
    """Run a node in a separate process and domain, which writes its outcome. Return the process ID."""
    child = os.fork()
    if child == 0:
        os.environ["ROS_DOMAIN_ID"] = str(domain)
        signal.alarm(round(1.5 * TIME_LIMIT))
        try:
            file.write_text(json.dumps(outcome(program, kits)), encoding="utf-8")
        finally:
            # Neither exit handlers nor threads of the middleware may change the outcome.
            os._exit(0)
    return child


def outcomes_in_processes(programs: dict[str, str], kits: dict[str, Outcome]) -> dict[str, Outcome]:
    """Return the outcomes of nodes that run in separate processes, several at the same time."""
    # Programs that fail in the kit are first: one of them hangs in ROS, until its time limit.
    waiting = sorted(programs, key=lambda name: bool(kits[name]["error"]))
    domain = int(os.environ["ROS_DOMAIN_ID"])
    running: dict[int, str] = {}
    found: dict[str, Outcome] = {}
    with tempfile.TemporaryDirectory() as folder:
        while waiting or running:
            while waiting and len(running) < AT_ONCE:
                name = waiting.pop()
                domain = next_free_domain(domain)
                running[start(programs[name], kits[name], Path(folder, name), domain)] = name
            child, status = os.wait()
            name = running.pop(child)
            if os.WIFSIGNALED(status):
                number = signal.Signals(os.WTERMSIG(status))
                error = "waits for ever" if number == signal.SIGALRM else number.name
                found[name] = {"topics": {}, "answers": {}, "error": error, "lines": []}
            else:
                found[name] = json.loads(Path(folder, name).read_text(encoding="utf-8"))
    return {name: found[name] for name in programs}


def import_modules(programs: Iterable[str]) -> None:
    """Import all modules that programs use: types without a wheel take seconds, once."""
    for name in sorted(set(re.findall(r"^(?:from|import) ([\w.]+)", "\n".join(programs), re.MULTILINE))):
        importlib.import_module(name)


def main() -> None:
    """Run all nodes."""
    nodes, outcomes, *kits = (Path(word) for word in sys.argv[1:])
    programs: dict[str, str] = json.loads(nodes.read_text(encoding="utf-8"))
    found: dict[str, Outcome] = {}
    if kits:
        import_modules(programs.values())
        expected = json.loads(kits[0].read_text(encoding="utf-8"))
        found = outcomes_in_processes(programs, expected)
    else:
        found = {name: outcome(program, {}) for name, program in programs.items()}
    outcomes.write_text(json.dumps(found), encoding="utf-8")


if __name__ == "__main__":
    main()
