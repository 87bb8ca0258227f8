# mypy: ignore-errors
"""Small subjects: what is printed or raised at the edges of names, arguments, messages, actions and contexts.

Many of the calls are wrong on purpose.
"""

import gc
import os
import re
import tempfile
import time
from typing import Any

import rclpy
from action_msgs.msg import GoalStatusArray
from nav_msgs.msg import Goals
from probing import Fibonacci, captured, lines, main, outcome, probe
from rclpy.action import ActionClient, ActionServer
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.expand_topic_name import expand_topic_name
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Int32, String
from std_srvs.srv import Trigger


def _until(ready: Any, *nodes: Any, limit: Any = 5.0) -> Any:
    executor = SingleThreadedExecutor()
    for node in nodes:
        executor.add_node(node)
    end = time.monotonic() + limit
    while not ready() and time.monotonic() < end:
        executor.spin_once(timeout_sec=0.02)
    for node in nodes:
        executor.remove_node(node)
    return bool(ready())


def _stderr(call: Any) -> Any:
    """Return the outcome of a call and the lines that it writes to stderr."""
    found, text = captured(call)
    return [found, *re.sub(r"\[\d+\.\d+\]", "[time]", text).splitlines()]


def _init(*words: Any, **options: Any) -> Any:
    context = Context()
    rclpy.init(args=list(words), context=context, **options)
    return type(context.get_domain_id()).__name__


def _lost_exception() -> None:
    future = rclpy.Future()
    future.set_exception(ValueError("why"))
    del future
    gc.collect()


def _seen_exception() -> None:
    future = rclpy.Future()
    future.set_exception(ValueError("why"))
    future.exception()
    del future
    gc.collect()


lines(
    "name",
    tilde_without_a_slash=lambda: Node("node", namespace="/ns").resolve_topic_name("~a"),
    topic_with_a_tilde=lambda: Node("node", namespace="/ns").create_publisher(String, "~a", 1).topic_name,
    info_of_a_bad_name=lambda: Node("n").get_publishers_info_by_topic("a b"),
    subscriptions_of_a_bad_name=lambda: Node("n").get_subscriptions_info_by_topic("1a"),
    expanded_with_a_space=lambda: expand_topic_name("a b", "n", "/ns"),
    expanded_with_a_digit=lambda: expand_topic_name("1a", "n", "/ns"),
    expanded_of_a_bad_node=lambda: expand_topic_name("a", "n m", "/ns"),
    expanded_of_a_bad_namespace=lambda: expand_topic_name("a", "n", "ns"),
    expanded=lambda: expand_topic_name("~/a", "n", "/ns"),
)
lines(
    "init",
    twice=lambda: _stderr(rclpy.init),
    unknown=lambda: _init("--ros-args", "--nothing"),
    bad_rule=lambda: _init("--ros-args", "-r", "a:b"),
    bad_parameter=lambda: _init("--ros-args", "-p", "a"),
    missing_file=lambda: _init("--ros-args", "--params-file", "/nowhere.yaml"),
    domain_none=lambda: _init(domain_id=None),
    domain_negative=lambda: _init(domain_id=-1),
    domain_float=lambda: _init(domain_id=1.5),
    tuple_of_words=lambda: rclpy.init(args=("a", "b"), context=Context()),
    text=lambda: rclpy.init(args="ab", context=Context()),
    number=lambda: rclpy.init(args=3, context=Context()),
    context_text=lambda: rclpy.init(args=[], context="x"),
    bad_handlers=lambda: rclpy.init(args=[], context=Context(), signal_handler_options=7),
    returns=lambda: rclpy.init(args=[], context=Context()),
    global_node_name=lambda: _remapped_by_init("-r", "__node:=other"),
    global_namespace=lambda: _remapped_by_init("-r", "__ns:=/x"),
    global_topic=lambda: _remapped_by_init("-r", "a:=b"),
    global_rule_for_a_node=lambda: _remapped_by_init("-r", "n:a:=b"),
    global_rule_for_another_node=lambda: _remapped_by_init("-r", "m:a:=b"),
    global_off=lambda: _remapped_by_init("-r", "a:=b", use_global_arguments=False),
    own_rule_first=lambda: _remapped_by_init("-r", "a:=b", cli_args=["--ros-args", "-r", "a:=c"]),
    parameter=lambda: _parameter_by_init(["-p", "a:=3"]),
    parameter_of_a_node=lambda: _parameter_by_init(["-p", "n:a:=4"]),
    parameter_off=lambda: _parameter_by_init(["-p", "a:=3"], use_global_arguments=False),
    parameter_override_wins=lambda: _parameter_by_init(
        ["-p", "a:=3"], parameter_overrides=[rclpy.parameter.Parameter("a", value=9)]
    ),
    parameter_own_wins=lambda: _parameter_by_init(["-p", "a:=3"], cli_args=["--ros-args", "-p", "a:=5"]),
    bad_rule_printed=lambda: _stderr(lambda: _init("--ros-args", "-r", "a:b"))[1:],
    words_are_numbers=lambda: rclpy.init(args=[1], context=Context()),
    domain=lambda: _domain(7),
    domain_after_shutdown=lambda: _domain_after_shutdown(),
    removed_bad_rule=lambda: rclpy.utilities.remove_ros_args(["x", "--ros-args", "-r", "a:b"]),
    removed_dashes=lambda: rclpy.utilities.remove_ros_args(["x", "--", "y", "--ros-args", "--", "z", "--"]),
    removed_tuple=lambda: rclpy.utilities.remove_ros_args(("x", "--ros-args")),
    removed=lambda: rclpy.utilities.remove_ros_args(["x", "--ros-args", "-r", "a:=b", "--", "y"]),
    removed_without_end=lambda: rclpy.utilities.remove_ros_args(["x", "--ros-args", "-r", "a:=b"]),
    removed_nothing=lambda: rclpy.utilities.remove_ros_args([]),
    removed_old_style=lambda: rclpy.utilities.remove_ros_args(["x", "a:=b", "y"]),
    removed_unknown=lambda: rclpy.utilities.remove_ros_args(["--ros-args", "--nothing"]),
)


def _domain(number: Any) -> Any:
    context = Context()
    rclpy.init(args=[], context=context, domain_id=number)
    return context.get_domain_id()


def _domain_after_shutdown() -> Any:
    context = Context()
    rclpy.init(args=[], context=context)
    context.shutdown()
    return context.get_domain_id()


def _with_context(words: Any, use: Any) -> Any:
    context = Context()
    rclpy.init(args=["program", "--ros-args", *words], context=context)
    try:
        return use(context)
    finally:
        context.shutdown()


def _remapped_by_init(*words: Any, **options: Any) -> Any:
    def use(context: Any) -> Any:
        node = Node("n", context=context, **options)
        return [node.get_fully_qualified_name(), node.resolve_topic_name("a")]

    return _with_context(words, use)


def _parameter_by_init(words: Any, **options: Any) -> Any:
    return _with_context(words, lambda c: Node("n", context=c, **options).declare_parameter("a", 0).value)


FILES = {
    "any_node": "/**:\n  ros__parameters:\n    a: 1\n",
    "any_node_one_level": "/*:\n  ros__parameters:\n    a: 1\n",
    "any_node_of_a_namespace": "/ns/*:\n  ros__parameters:\n    a: 1\n",
    "any_below_a_namespace": "/ns/**:\n  ros__parameters:\n    a: 1\n",
    "any_namespace": "/**/n:\n  ros__parameters:\n    a: 1\n",
    "one_namespace": "/*/n:\n  ros__parameters:\n    a: 1\n",
    "nested": "ns:\n  n:\n    ros__parameters:\n      a: 1\n",
    "nested_wildcard": "ns:\n  '*':\n    ros__parameters:\n      a: 1\n",
    "without_slash": "ns/n:\n  ros__parameters:\n    a: 1\n",
    "name_only": "n:\n  ros__parameters:\n    a: 1\n",
    "other_namespace": "/x/n:\n  ros__parameters:\n    a: 1\n",
    "both_general_last": "/ns/n:\n  ros__parameters:\n    a: 2\n/**:\n  ros__parameters:\n    a: 1\n",
    "both_general_first": "/**:\n  ros__parameters:\n    a: 1\n/ns/n:\n  ros__parameters:\n    a: 2\n",
    "group": "/ns/n:\n  ros__parameters:\n    b:\n      a: 3\n",
    "partial_wildcard": "/ns/n*:\n  ros__parameters:\n    a: 1\n",
    "quoted_wildcard": "'/**':\n  ros__parameters:\n    a: 1\n",
    "two_stars_in_the_middle": "/**/ns/n:\n  ros__parameters:\n    a: 1\n",
    "number_of_another_type": "/**:\n  ros__parameters:\n    a: 1.0\n",
    "list": "/**:\n  ros__parameters:\n    a: [1, 2]\n",
    "list_of_blocks": "/**:\n  ros__parameters:\n    a:\n    - 1\n    - 2\n",
    "anchors": "/**:\n  ros__parameters:\n    b: &x 1\n    a: *x\n",
    "twice": "/**:\n  ros__parameters:\n    a: 1\n    a: 2\n",
    "exponent": "/**:\n  ros__parameters:\n    a: 1e2\n",
    "octal": "/**:\n  ros__parameters:\n    a: 010\n",
    "yes": "/**:\n  ros__parameters:\n    a: yes\n",
    "off": "/**:\n  ros__parameters:\n    a: Off\n",
    "tagged": "/**:\n  ros__parameters:\n    a: !!str 1\n",
    "folded": "/**:\n  ros__parameters:\n    a: >-\n      x\n      y\n",
    "empty_value": "/**:\n  ros__parameters:\n    a:\n",
    "null_in_a_list": "/**:\n  ros__parameters:\n    a: [1, null]\n",
    "misspelt": "/**:\n  ros_parameters:\n    a: 1\n",
    "only_parameters": "a: 1\n",
    "list_of_lists": "/**:\n  ros__parameters:\n    a: [[1], [2]]\n",
    "text_that_is_no_yaml": "/**: {",
}


def _from_file(text: Any, name: Any = "n", namespace: Any = "/ns") -> Any:
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "p.yaml")
        with open(path, "w") as file:
            file.write(text)
        node = Node(
            name,
            namespace=namespace,
            cli_args=["--ros-args", "--params-file", path],
            automatically_declare_parameters_from_overrides=True,
        )
    own = ("use_sim_time", "start_type_description_service")
    return sorted((p, node.get_parameter(p).value) for p in node._parameters if p not in own)


lines("yaml", **{name: lambda text=text: _from_file(text) for name, text in FILES.items()})
lines(
    "yaml_root",
    **{
        name: lambda text=text: _from_file(text, namespace="/")
        for name, text in FILES.items()
        if name in ("any_node_one_level", "any_namespace", "one_namespace", "nested", "name_only", "any_node")
    },
)
lines(
    "printed",
    goals=lambda: str(Goals()),
    exception_that_nobody_retrieved=lambda: _stderr(_lost_exception),
    exception_that_was_retrieved=lambda: _stderr(_seen_exception),
    old_remap=lambda: _stderr(lambda: Node("n", cli_args=["chatter:=other"]).resolve_topic_name("chatter")),
    second_node_of_a_name=lambda: _second_node(),
)


def _second_node() -> Any:
    node = Node("n")
    found = _stderr(lambda: Node("n").get_name())
    return [node.get_name(), found[0]]


@probe
def status_of_a_goal_is_published_when_it_is_accepted() -> Any:
    node, seen = Node("n"), []

    def execute(handle: Any) -> Any:
        handle.succeed()
        return Fibonacci.Result()

    ActionServer(node, Fibonacci, "f", execute)
    latched = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_subscription(
        GoalStatusArray,
        "f/_action/status",
        lambda m: seen.extend(one.status for one in m.status_list),
        latched,
    )
    client = ActionClient(node, Fibonacci, "f")
    client.wait_for_server(timeout_sec=5.0)
    client.send_goal_async(Fibonacci.Goal(order=1))
    _until(lambda: 4 in seen, node)
    return sorted(set(seen))


def _once(*args: Any, **options: Any) -> Any:
    node, ticks = Node("n"), []
    node.create_timer(0.02, lambda: ticks.append(1))
    found = outcome(rclpy.spin_once, node, *args, **options)
    return [found, len(ticks)]


lines(
    "once",
    negative=lambda: _once(timeout_sec=-2),
    minus_one=lambda: _once(timeout_sec=-1),
    tiny=lambda: _once(timeout_sec=1e-12),
    none=lambda: _once(timeout_sec=None),
    of_a_bool=lambda: _once(timeout_sec=True),
    text=lambda: _once(timeout_sec="1"),
    infinite=lambda: _once(timeout_sec=float("inf")),
    nan=lambda: _once(timeout_sec=float("nan")),
)


@probe
def counts_after_shutdown() -> Any:
    node = Node("n")
    publisher = node.create_publisher(String, "t", 1)
    subscription = node.create_subscription(String, "t", print, 1)
    client = node.create_client(Trigger, "s")
    rclpy.shutdown()
    return [
        outcome(publisher.get_subscription_count),
        outcome(subscription.get_publisher_count),
        outcome(client.service_is_ready),
        outcome(node.count_publishers, "t"),
        outcome(node.count_subscribers, "t"),
    ]


@probe
def counts_after_destruction() -> Any:
    node = Node("n")
    publisher = node.create_publisher(String, "t", 1)
    subscription = node.create_subscription(String, "t", print, 1)
    node.destroy_node()
    return [outcome(publisher.get_subscription_count), outcome(subscription.get_publisher_count)]


lines(
    "fresh_context",
    executor=lambda: SingleThreadedExecutor(context=Context()),
    many_threads=lambda: rclpy.executors.MultiThreadedExecutor(2, context=Context()),
    node=lambda: Node("n", context=Context()),
    ok=lambda: rclpy.ok(context=Context()),
    shutdown=lambda: rclpy.shutdown(context=Context()),
    try_shutdown=lambda: rclpy.try_shutdown(context=Context()),
    guard=lambda: Context().ok(),
    on_shutdown=lambda: Context().on_shutdown(print),
    domain=lambda: Context().get_domain_id(),
    spin_once=lambda: rclpy.spin_once(
        Node("n"), executor=SingleThreadedExecutor(context=Context()), timeout_sec=0.0
    ),
)
lines(
    "can_execute",
    none=lambda: SingleThreadedExecutor().can_execute(None),
    text=lambda: SingleThreadedExecutor().can_execute("x"),
    node=lambda: SingleThreadedExecutor().can_execute(Node("n")),
    timer=lambda: SingleThreadedExecutor().can_execute(Node("n").create_timer(1.0, print)),
    subscription=lambda: SingleThreadedExecutor().can_execute(
        Node("n").create_subscription(Int32, "t", print, 1)
    ),
)

if __name__ == "__main__":
    main()
