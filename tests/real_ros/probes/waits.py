# mypy: ignore-errors
"""Waiting with and without a time limit: futures, executors, messages, services, and nested waits.

Many of the calls are wrong on purpose.
"""

import threading
import time
from typing import Any

import rclpy
from probing import lines, main, outcome, probe
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.task import Future
from rclpy.wait_for_message import wait_for_message
from std_msgs.msg import Int32, String
from std_srvs.srv import SetBool, Trigger

SHORT = 0.2  # [s]
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def _completed(value: Any = 5) -> Future:
    future = Future()
    future.set_result(value)
    return future


def _cancelled() -> Future:
    future = Future()
    future.cancel()
    return future


def _waited(future: Any, timeout: Any = SHORT, *, executor: Any = None) -> list[Any]:
    """Return the result of waiting for a future, whether it is done, and whether the wait was short."""
    node = Node("n")
    begin = time.monotonic()
    result = outcome(lambda: rclpy.spin_until_future_complete(node, future, executor, timeout_sec=timeout))
    return [result, getattr(future, "done", bool)(), time.monotonic() - begin < SHORT / 2]


lines(
    "future",
    done=lambda: _waited(_completed()),
    done_without_a_limit=lambda: _waited(_completed(), None),
    done_with_no_time=lambda: _waited(_completed(), 0),
    pending=lambda: _waited(Future()),
    pending_with_no_time=lambda: _waited(Future(), 0),
    pending_with_a_fraction=lambda: _waited(Future(), 0.05),
    cancelled=lambda: _waited(_cancelled()),
    cancelled_with_no_time=lambda: _waited(_cancelled(), 0),
    nothing=lambda: _waited(None),
    text=lambda: _waited("future"),
    time_as_text=lambda: _waited(Future(), "1"),
    time_as_bool=lambda: _waited(Future(), False),
    without_future=lambda: rclpy.spin_until_future_complete(Node("n")),
    node_is_nothing=lambda: rclpy.spin_until_future_complete(None, _completed(), timeout_sec=SHORT),
    executor_is_text=lambda: _waited(_completed(), executor="x"),
    positional_timeout=lambda: rclpy.spin_until_future_complete(Node("n"), _completed(), None, SHORT),
    own_executor=lambda: _waited(_completed(), executor=SingleThreadedExecutor()),
    own_executor_pending=lambda: _waited(Future(), executor=SingleThreadedExecutor()),
    threads_pending=lambda: _waited(Future(), executor=MultiThreadedExecutor(2)),
    threads_done=lambda: _waited(_completed(), executor=MultiThreadedExecutor(2)),
)


def _by_executor(call: str, kind: Any = SingleThreadedExecutor, **options: Any) -> list[Any]:
    """Return the outcome of a method of an executor with one idle node, and whether it was short."""
    executor = kind()
    executor.add_node(Node("n"))
    begin = time.monotonic()
    result = outcome(lambda: getattr(executor, call)(**options))
    was_short = time.monotonic() - begin < SHORT / 2
    executor.shutdown()
    return [result, was_short]


lines(
    "executor",
    spin_once=lambda: _by_executor("spin_once", timeout_sec=SHORT),
    spin_once_no_time=lambda: _by_executor("spin_once", timeout_sec=0),
    spin_once_until_done=lambda: _by_executor(
        "spin_once_until_future_complete", future=_completed(), timeout_sec=SHORT
    ),
    spin_once_until_pending=lambda: _by_executor(
        "spin_once_until_future_complete", future=Future(), timeout_sec=SHORT
    ),
    spin_until_done=lambda: _by_executor("spin_until_future_complete", future=_completed()),
    spin_until_pending=lambda: _by_executor("spin_until_future_complete", future=Future(), timeout_sec=SHORT),
    spin_until_no_time=lambda: _by_executor("spin_until_future_complete", future=Future(), timeout_sec=0),
    threads_spin_once=lambda: _by_executor("spin_once", MultiThreadedExecutor, timeout_sec=SHORT),
    threads_until_pending=lambda: _by_executor(
        "spin_until_future_complete", MultiThreadedExecutor, future=Future(), timeout_sec=SHORT
    ),
    shutdown_twice=lambda: (lambda one: [one.shutdown(), one.shutdown()])(SingleThreadedExecutor()),
    shutdown_with_a_limit=lambda: SingleThreadedExecutor().shutdown(timeout_sec=SHORT),
    nodes_in_order=lambda: _nodes_in_order(),
    same_node_twice=lambda: (lambda one, node: [one.add_node(node), one.add_node(node)])(
        SingleThreadedExecutor(), Node("n")
    ),
    node_of_another=lambda: _node_of_another(),
    remove_unknown=lambda: SingleThreadedExecutor().remove_node(Node("n")),
    add_nothing=lambda: SingleThreadedExecutor().add_node(None),
    task_result=lambda: _task_result(lambda: 7),
    task_error=lambda: _task_result(lambda: 1 / 0),
    task_with_arguments=lambda: _task_result(lambda *args, **named: (args, named), 1, 2, c=3),
    task_of_a_coroutine=lambda: _task_result(_coroutine),
    task_of_text=lambda: _task_result("x"),
    wake=lambda: SingleThreadedExecutor().wake(),
    context=lambda: SingleThreadedExecutor().context is rclpy.get_default_context(),
    with_statement=lambda: _with_statement(),
)


def _nodes_in_order() -> list[str]:
    executor = SingleThreadedExecutor()
    for name in "cab":
        executor.add_node(Node(name))
    return sorted(node.get_name() for node in executor.get_nodes())


def _node_of_another() -> list[Any]:
    first, second, node = SingleThreadedExecutor(), SingleThreadedExecutor(), Node("n")
    added = [first.add_node(node), second.add_node(node)]
    return [*added, node.executor is second, len(first.get_nodes()), len(second.get_nodes())]


def _task_result(callback: Any, *args: Any, **named: Any) -> list[Any]:
    executor = SingleThreadedExecutor()
    task = executor.create_task(callback, *args, **named)
    ran = outcome(lambda: executor.spin_until_future_complete(task, timeout_sec=SHORT))
    return [ran, task.done(), outcome(task.result), outcome(task.exception)]


async def _coroutine() -> int:
    return 9


def _with_statement() -> Any:
    with SingleThreadedExecutor() as executor:
        executor.add_node(Node("n"))
        return type(executor).__name__


def _latched(value: int) -> Node:
    node = Node("source")
    node.create_publisher(Int32, "/value", LATCHED).publish(Int32(data=value))
    return node


def _message(*args: Any, **options: Any) -> Any:
    source, node = _latched(5), Node("n")
    options.setdefault("time_to_wait", 2.0)
    result = wait_for_message(Int32, node, *(args or ("/value",)), **options)
    assert source is not None
    return [result, len(list(node.subscriptions))]


lines(
    "message",
    latched=lambda: _message(qos_profile=LATCHED),
    none_arrives=lambda: _message("/nothing", time_to_wait=SHORT),
    no_time=lambda: _message("/nothing", time_to_wait=0),
    volatile=lambda: _message(time_to_wait=SHORT),
    relative_name=lambda: _message("value", qos_profile=LATCHED),
    bad_name=lambda: _message("bad name"),
    depth=lambda: _message("/nothing", qos_profile=3, time_to_wait=SHORT),
    qos_text=lambda: _message("/nothing", qos_profile="10", time_to_wait=SHORT),
    time_text=lambda: _message("/nothing", time_to_wait="1"),
    positional_time=lambda: wait_for_message(Int32, Node("n"), "/value", 1.0),
    type_is_text=lambda: wait_for_message("std_msgs/msg/Int32", Node("n"), "/value", time_to_wait=SHORT),
    type_is_a_module=lambda: wait_for_message(rclpy, Node("n"), "/value", time_to_wait=SHORT),
    node_is_nothing=lambda: wait_for_message(Int32, None, "/value", time_to_wait=SHORT),
    node_is_text=lambda: wait_for_message(Int32, "n", "/value", time_to_wait=SHORT),
)


@probe
def message_during_a_spin_of_another_thread() -> list[Any]:
    source, node = _latched(8), Node("n")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin, daemon=True)
    thread.start()
    is_received, message = wait_for_message(Int32, node, "/value", qos_profile=LATCHED, time_to_wait=2.0)
    executor.shutdown()
    thread.join(2.0)
    assert source is not None
    # Which of the two takes the message is a race in rclpy.
    return [type(is_received), thread.is_alive(), type(message).__name__ in ("Int32", "NoneType")]


class Server(Node):
    """A node with a service and a client of it, in a group each or in one."""

    def __init__(self, group: Any = None, *, own_groups: bool = False) -> None:
        super().__init__("server")
        first = group or (MutuallyExclusiveCallbackGroup() if own_groups else None)
        second = group or (MutuallyExclusiveCallbackGroup() if own_groups else None)
        self.create_service(Trigger, "run", self._on_run, callback_group=first)
        self.client = self.create_client(Trigger, "run", callback_group=second)
        self.steps: list[Any] = []

    def _on_run(self, request: Any, response: Any) -> Any:
        response.success, response.message = True, "ran"
        return response

    def call_in_timer(self, wait: Any, group: Any = None) -> None:
        """Call the service from a timer's callback, and wait for the reply in the given way."""

        def on_timer() -> None:
            timer.cancel()
            future = self.client.call_async(Trigger.Request())
            self.steps.append(outcome(lambda: wait(self, future)))
            self.steps.append(future.done())

        timer = self.create_timer(0.01, on_timer, callback_group=group)


def _spun(node: Any, executor: Any, seconds: float = 1.0) -> list[Any]:
    executor.add_node(node)
    end = time.monotonic() + seconds
    while time.monotonic() < end and len(node.steps) < 2:
        executor.spin_once(timeout_sec=0.05)
    executor.shutdown()
    return node.steps


def _poll(node: Any, future: Any) -> str:
    end = time.monotonic() + SHORT
    while not future.done() and time.monotonic() < end:
        time.sleep(0.01)
    return "replied" if future.done() else "no reply"


def _spin_in_callback(node: Any, future: Any) -> Any:
    return rclpy.spin_until_future_complete(node, future, timeout_sec=SHORT)


def _deadlock(executor: Any, wait: Any, group: Any = None, timer_group: Any = None, **options: Any) -> Any:
    node = Server(group, **options)
    node.call_in_timer(wait, timer_group)
    return _spun(node, executor)


lines(
    "callback",
    poll_in_one_thread=lambda: _deadlock(SingleThreadedExecutor(), _poll),
    poll_in_one_group=lambda: _deadlock(MultiThreadedExecutor(3), _poll),
    poll_in_own_groups=lambda: _deadlock(
        MultiThreadedExecutor(3), _poll, None, MutuallyExclusiveCallbackGroup(), own_groups=True
    ),
    poll_in_reentrant_group=lambda: (lambda group: _deadlock(MultiThreadedExecutor(3), _poll, group, group))(
        ReentrantCallbackGroup()
    ),
    poll_with_one_of_many_threads=lambda: (
        lambda group: _deadlock(MultiThreadedExecutor(1), _poll, group, group)
    )(ReentrantCallbackGroup()),
)


@probe
def call_of_a_service_that_is_absent() -> list[Any]:
    client = Node("n").create_client(Trigger, "absent")
    return [client.wait_for_service(timeout_sec=SHORT), client.service_is_ready()]


@probe
def call_with_a_time_limit() -> list[Any]:
    client = Node("n").create_client(Trigger, "absent")
    return [outcome(lambda: client.call(Trigger.Request(), timeout_sec=SHORT))]


@probe
def call_of_another_type() -> Any:
    return Node("n").create_client(Trigger, "absent").call_async(SetBool.Request())


@probe
def call_of_a_class() -> Any:
    return Node("n").create_client(Trigger, "absent").call_async(Trigger.Request)


lines(
    "service",
    wait_no_time=lambda: Node("n").create_client(Trigger, "absent").wait_for_service(timeout_sec=0),
    wait_positional=lambda: Node("n").create_client(Trigger, "absent").wait_for_service(0.01),
    wait_text=lambda: Node("n").create_client(Trigger, "absent").wait_for_service("1"),
    call_nothing=lambda: Node("n").create_client(Trigger, "absent").call_async(None),
    call_without=lambda: Node("n").create_client(Trigger, "absent").call_async(),
    remove_unknown_request=lambda: Node("n").create_client(Trigger, "a").remove_pending_request(Future()),
    name_of_a_client=lambda: Node("n").create_client(Trigger, "absent").srv_name,
    name_of_a_private_client=lambda: Node("n").create_client(Trigger, "~/absent").service_name,
    type_of_a_client=lambda: Node("n").create_client(Trigger, "absent").srv_type,
    client_in_with=lambda: _client_in_with(),
)


def _client_in_with() -> str:
    with Node("n").create_client(Trigger, "absent") as client:
        return type(client).__name__


@probe
def coroutine_awaits_a_reply() -> list[Any]:
    node = Server()

    async def on_timer() -> None:
        timer.cancel()
        reply = await node.client.call_async(Trigger.Request())
        node.steps += [reply.message, reply.success]

    timer = node.create_timer(0.01, on_timer)
    return _spun(node, SingleThreadedExecutor())


@probe
def coroutine_awaits_two_replies_in_order() -> list[Any]:
    node = Server()

    async def on_timer() -> None:
        timer.cancel()
        first, second = (node.client.call_async(Trigger.Request()) for _ in "ab")
        node.steps.append((await second).message)
        node.steps.append(first.done())

    timer = node.create_timer(0.01, on_timer)
    return _spun(node, SingleThreadedExecutor())


@probe
def future_completed_by_a_timer() -> list[Any]:
    node, future = Node("n"), Future()
    node.create_timer(0.02, lambda: future.set_result("by the timer"))
    rclpy.spin_until_future_complete(node, future, timeout_sec=1.0)
    return [future.done(), future.result()]


@probe
def future_completed_by_a_thread() -> list[Any]:
    node, future = Node("n"), Future()
    node.create_timer(0.02, lambda: None)
    thread = threading.Timer(0.1, lambda: future.set_result("by a thread"))
    thread.start()
    rclpy.spin_until_future_complete(node, future, timeout_sec=2.0)
    thread.join()
    return [future.done(), future.result()]


@probe
def future_that_fails_while_it_is_awaited() -> list[Any]:
    node, future = Node("n"), Future()
    node.create_timer(0.02, lambda: future.set_exception(KeyError("lost")))
    result = outcome(lambda: rclpy.spin_until_future_complete(node, future, timeout_sec=1.0))
    return [result, outcome(future.result), repr(future.exception())]


@probe
def exception_in_a_timer_during_the_wait() -> list[Any]:
    node, future = Node("n"), Future()
    node.create_timer(0.02, lambda: 1 / 0)
    return [
        outcome(lambda: rclpy.spin_until_future_complete(node, future, timeout_sec=1.0)),
        future.done(),
        node.executor is None,
    ]


@probe
def wait_in_a_callback_by_spinning() -> list[Any]:
    node = Server()
    node.call_in_timer(_spin_in_callback)
    executor = SingleThreadedExecutor()
    return [type(one) for one in _spun(node, executor)]


@probe
def shutdown_during_a_wait() -> list[Any]:
    node, future = Node("n"), Future()
    node.create_timer(0.05, rclpy.shutdown)
    result = outcome(lambda: rclpy.spin_until_future_complete(node, future, timeout_sec=2.0))
    return [result, future.done(), rclpy.ok()]


@probe
def node_destroyed_during_a_wait() -> list[Any]:
    node, other, future = Node("n"), Node("other"), Future()
    node.create_timer(0.02, other.destroy_node)
    node.create_timer(0.1, lambda: future.set_result(1))
    rclpy.spin_until_future_complete(node, future, timeout_sec=2.0)
    return [future.done(), outcome(other.get_name)]


@probe
def text_published_during_a_wait() -> list[Any]:
    node, texts = Node("n"), []
    publisher = node.create_publisher(String, "text", 10)
    node.create_subscription(String, "text", lambda message: texts.append(message.data), 10)
    future = Future()

    def on_text(message: Any) -> None:
        if not future.done():
            future.set_result(message.data)

    node.create_subscription(String, "text", on_text, 10)
    node.create_timer(0.05, lambda: publisher.publish(String(data="hello")))
    rclpy.spin_until_future_complete(node, future, timeout_sec=2.0)
    return [future.result(), set(texts) <= {"hello"}]


lines(
    "ok",
    default=lambda: rclpy.ok(),
    with_context=lambda: rclpy.ok(context=rclpy.get_default_context()),
    of_a_new_context=lambda: rclpy.ok(context=rclpy.Context()),
    of_nothing=lambda: rclpy.ok(context=None),
    after_shutdown=lambda: [rclpy.shutdown(), rclpy.ok()],
    try_shutdown_twice=lambda: [rclpy.try_shutdown(), rclpy.try_shutdown()],
    shutdown_twice=lambda: [rclpy.shutdown(), rclpy.shutdown()],
    init_twice=lambda: rclpy.init(),
    domain_of_context=lambda: type(rclpy.get_default_context().get_domain_id()),
    rmw=lambda: type(rclpy.get_rmw_implementation_identifier()),
    global_executor=lambda: type(rclpy.get_global_executor()).__name__,
    create_node=lambda: rclpy.create_node("made", namespace="/a").get_fully_qualified_name(),
    create_node_without_name=lambda: rclpy.create_node(),
    create_node_of_a_number=lambda: rclpy.create_node(5),
)


if __name__ == "__main__":
    main()
