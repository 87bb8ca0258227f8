# mypy: ignore-errors
"""Nodes without `super().__init__()`, contexts of other types, names, and strangers."""

import importlib
import time
from typing import Any

import rclpy
from probing import lines, main, outcome
from rclpy import event_handler
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.guard_condition import GuardCondition
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.type_hash import TypeHash
from std_msgs.msg import String
from std_srvs.srv import Trigger


def before(call: Any, base: Any = Node) -> Any:
    """Return a probe that uses a node before its constructor has run."""

    class Early(base):
        def __init__(self) -> None:
            call(self)
            super().__init__("n")

    return Early


def never(call: Any) -> Any:
    """Return a probe that uses a node whose constructor never runs."""

    class Never(Node):
        def __init__(self) -> None:
            pass

    return lambda: call(Never())


CALLS = {
    "publisher": lambda s: s.create_publisher(String, "t", 1),
    "subscription": lambda s: s.create_subscription(String, "t", print, 1),
    "timer": lambda s: s.create_timer(1.0, print),
    "client": lambda s: s.create_client(Trigger, "t"),
    "service": lambda s: s.create_service(Trigger, "t", print),
    "rate": lambda s: s.create_rate(1),
    "guard": lambda s: s.create_guard_condition(print),
    "declare": lambda s: s.declare_parameter("a", 1),
    "declares": lambda s: s.declare_parameters("", [("a", 1)]),
    "undeclare": lambda s: s.undeclare_parameter("a"),
    "get": lambda s: s.get_parameter("a"),
    "gets": lambda s: s.get_parameters(["a"]),
    "get_or": lambda s: s.get_parameter_or("a"),
    "has": lambda s: s.has_parameter("a"),
    "prefix": lambda s: s.get_parameters_by_prefix("a"),
    "set": lambda s: s.set_parameters([Parameter("a", value=1)]),
    "set_at": lambda s: s.set_parameters_atomically([Parameter("a", value=1)]),
    "describe": lambda s: s.describe_parameter("a"),
    "describes": lambda s: s.describe_parameters(["a"]),
    "list": lambda s: s.list_parameters([], 0),
    "on_set": lambda s: s.add_on_set_parameters_callback(print),
    "pre_set": lambda s: s.add_pre_set_parameters_callback(print),
    "post_set": lambda s: s.add_post_set_parameters_callback(print),
    "rem_set": lambda s: s.remove_on_set_parameters_callback(print),
    "setdesc": lambda s: s.set_descriptor("a", None),
    "ptype": lambda s: s.get_parameter_type("a"),
    "ptypes": lambda s: s.get_parameter_types(["a"]),
    "pubs": lambda s: list(s.publishers),
    "subs": lambda s: list(s.subscriptions),
    "timers": lambda s: list(s.timers),
    "clients": lambda s: list(s.clients),
    "services": lambda s: list(s.services),
    "guards": lambda s: list(s.guards),
    "waitables": lambda s: list(s.waitables),
    "logger": lambda s: s.get_logger(),
    "clock": lambda s: s.get_clock(),
    "name": lambda s: s.get_name(),
    "ns": lambda s: s.get_namespace(),
    "fqn": lambda s: s.get_fully_qualified_name(),
    "topics": lambda s: s.get_topic_names_and_types(),
    "dest": lambda s: s.destroy_node(),
    "handle": lambda s: s.handle,
    "context": lambda s: s.context,
    "executor": lambda s: s.executor,
    "group": lambda s: s.default_callback_group,
    "count": lambda s: s.count_publishers("t"),
    "resolve": lambda s: s.resolve_topic_name("t"),
    "nodes": lambda s: s.get_node_names(),
    "services_n": lambda s: s.get_service_names_and_types(),
    "destroy_pub": lambda s: s.destroy_publisher(None),
    "destroy_timer": lambda s: s.destroy_timer(None),
    "destroy_rate": lambda s: s.destroy_rate(None),
    "destroy_sub": lambda s: s.destroy_subscription(None),
    "destroy_client": lambda s: s.destroy_client(None),
    "destroy_service": lambda s: s.destroy_service(None),
    "destroy_gc": lambda s: s.destroy_guard_condition(None),
    "addw": lambda s: s.add_waitable(None),
    "remw": lambda s: s.remove_waitable(None),
    "set_executor": lambda s: setattr(s, "executor", None),
    "info": lambda s: s.get_publishers_info_by_topic("t"),
    "infos": lambda s: s.get_subscriptions_info_by_topic("t"),
    "wait": lambda s: s.wait_for_node("a", 0.2),
    "repr": lambda s: repr(s),
    "eq": lambda s: s == s,
    "hash_": lambda s: hash(s) == hash(s),
    "spin": lambda s: rclpy.spin_once(s, timeout_sec=0.1),
    "spin2": lambda s: SingleThreadedExecutor().add_node(s),
    "by_node": lambda s: s.get_publisher_names_and_types_by_node("a", "/"),
    "csub": lambda s: s.count_subscribers("t"),
    "pubs_p": lambda s: s._publishers,
    "subs_p": lambda s: s._subscriptions,
    "with_": lambda s: s.__enter__(),
}

del CALLS["waitables"], CALLS["repr"], CALLS["with_"]
OF_LIFECYCLE = {
    "publisher": CALLS["publisher"],
    "declare": CALLS["declare"],
    "lifecycle_publisher": lambda s: s.create_lifecycle_publisher(String, "t", 1),
    "configure": lambda s: s.trigger_configure(),
    "machine": lambda s: s._state_machine,
}
lines("before", **{name: before(call) for name, call in CALLS.items()})
lines("lifecycle", **{name: before(call, LifecycleNode) for name, call in OF_LIFECYCLE.items()})
lines("never", **{name: never(call) for name, call in CALLS.items()})
lines(
    "context",
    **{
        f"{kind.__name__}_{name}": lambda kind=kind, context=context: kind(context=context())
        for kind in (SingleThreadedExecutor, MultiThreadedExecutor)
        for name, context in (("number", lambda: 3), ("text", lambda: "x"), ("node", lambda: Node("n")))
    },
    node=lambda: Node("n", context=3),
    guard=lambda: GuardCondition(None, None, context=3),
)


def matched() -> Any:
    received, node = [], Node("n")
    node.create_publisher(
        String, "t", 1, event_callbacks=event_handler.PublisherEventCallbacks(matched=received.append)
    )
    node.create_subscription(String, "t", print, 1)
    end = time.monotonic() + 5
    while not received and time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.2)
    return received[0], str(type(received[0])), f"{received[0]}", received[0].total_count


def hashes() -> Any:
    node = Node("n")
    node.create_publisher(String, "t", 1)
    found = node.get_publishers_info_by_topic("t")[0].topic_type_hash
    wrong = [outcome(setattr, found, name, "x") for name in ("version", "value")]
    return found, str(found), TypeHash(), outcome(TypeHash, "x", "y"), TypeHash._TYPE_HASH_SIZE, wrong


lines(
    "names",
    matched=matched,
    hashes=hashes,
    infos=lambda: sorted((k, v.__name__) for k, v in vars(event_handler).items() if k.endswith("Info")),
    message_info=lambda: importlib.import_module("rclpy.subscription").MessageInfo,
    of_client=lambda: Node("n").create_client(Trigger, "a").configure_introspection(),
    of_service=lambda: Node("n").create_service(Trigger, "a", print).configure_introspection(),
)


def spun(value: Any) -> Any:
    """Return a probe that spins something that may not be a node, once."""
    return lambda: rclpy.spin_once(value(), timeout_sec=0.0)


class Stranger:
    """A class that should have had the base Node."""

    def __init__(self) -> None:
        self.count = 0


class Unfinished(Node):
    """A node without `super().__init__()`."""

    def __init__(self) -> None:
        pass


lines(
    "spun",
    stranger=spun(Stranger),
    unfinished=spun(Unfinished),
    of_class=spun(lambda: Stranger),
    publisher=spun(lambda: Node("n").create_publisher(String, "t", 1)),
    number=spun(lambda: 3),
    nothing=spun(lambda: None),
)


def destroyed(create: Any) -> Any:
    """Return a probe that spins a node after an endpoint was destroyed by its own method."""

    def run() -> Any:
        node = Node("n")
        create(node).destroy()
        first = outcome(rclpy.spin_once, node, timeout_sec=0.0)
        return first, outcome(rclpy.spin_once, node, timeout_sec=0.0)

    return run


lines(
    "destroyed",
    publisher=destroyed(lambda node: node.create_publisher(String, "t", 1)),
    subscription=destroyed(lambda node: node.create_subscription(String, "t", print, 1)),
)

if __name__ == "__main__":
    main()
