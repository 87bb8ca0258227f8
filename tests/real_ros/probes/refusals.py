# mypy: disable-error-code="import-not-found, untyped-decorator, var-annotated"
"""Input that rclpy rejects: two types on one topic, callbacks without a result, values out of range."""

import warnings
from itertools import pairwise
from typing import Any

import rclpy
from probing import main, outcome, probe
from rcl_interfaces.msg import SetParametersResult
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import Int32, String
from std_srvs.srv import SetBool, Trigger


def _made(call: Any, *args: Any) -> Any:
    return outcome(lambda: type(call(*args)).__name__)


@probe
def two_types_on_one_topic() -> list[str]:
    node, found = Node("n"), []
    for first, second in (("pub", "sub"), ("pub", "pub"), ("sub", "sub"), ("sub", "pub")):
        for number, (kind, type_) in enumerate(((first, Int32), (second, String), (second, Int32))):
            topic = f"{first}_{second}"
            if kind == "pub":
                found.append(f"{topic} {number} {_made(node.create_publisher, type_, topic, 1)}")
            else:
                found.append(f"{topic} {number} {_made(node.create_subscription, type_, topic, print, 1)}")
    return found


@probe
def two_types_after_the_first_was_destroyed() -> list[str]:
    node = Node("n")
    publisher = node.create_publisher(Int32, "t", 1)
    node.destroy_publisher(publisher)
    return [_made(node.create_publisher, String, "t", 1)]


@probe
def two_types_in_two_nodes() -> list[str]:
    node, other = Node("n"), Node("m")
    node.create_publisher(Int32, "t", 1)
    return [_made(other.create_subscription, String, "/t", print, 1)]


@probe
def two_types_of_one_service() -> list[str]:
    node = Node("n")
    node.create_service(Trigger, "s", print)
    node.create_client(Trigger, "c")
    return [
        _made(node.create_client, SetBool, "s"),
        _made(node.create_service, SetBool, "s", print),
        _made(node.create_client, SetBool, "c"),
        _made(node.create_service, SetBool, "c", print),
        _made(node.create_client, Trigger, "s"),
    ]


def _set_with(callback: Any) -> list[str]:
    node = Node("n")
    node.declare_parameter("a", 1)
    node.add_on_set_parameters_callback(callback)
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        results = outcome(node.set_parameters, [Parameter("a", value=2)])
        declared = outcome(node.declare_parameter, "b", 3)
    said = sorted({str(one.message) for one in warned})
    return [results, str(node.get_parameter("a").value), declared, *said]


@probe
def parameter_callback_without_a_return() -> list[str]:
    return _set_with(lambda parameters: None)


@probe
def parameter_callback_that_returns_true() -> list[str]:
    return _set_with(lambda parameters: True)


@probe
def parameter_callback_that_refuses() -> list[str]:
    return _set_with(lambda parameters: SetParametersResult(successful=False, reason="no"))


@probe
def parameter_callbacks_that_are_none() -> list[str]:
    node = Node("n")
    return [outcome(node.add_on_set_parameters_callback, 3), outcome(node.list_parameters, [], -1)]


@probe
def on_shutdown_of_something_else() -> list[str]:
    return [outcome(rclpy.get_default_context().on_shutdown, 3)]


@probe
def numbers_of_threads() -> list[str]:
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        found = [_made(MultiThreadedExecutor, number) for number in (1, 0, -1, 2)]
    return [*found, *(str(one.message) for one in warned)]


@probe
def bytes_with_a_tail() -> list[str]:
    from rclpy.serialization import serialize_message

    data = serialize_message(JointState(name=["a"], position=[1.0]))
    return [
        outcome(lambda tail=tail: deserialize_message(data + bytes(tail), JointState).position[0])
        for tail in (0, 3, 8, 24)
    ]


@probe
def cancelled_futures() -> list[str]:
    node = Node("n")
    node.create_service(Trigger, "s", lambda request, response: response)
    client = node.create_client(Trigger, "s")
    client.wait_for_service(5.0)
    future = client.call_async(Trigger.Request())
    future.cancel()
    for _ in range(5):
        rclpy.spin_once(node, timeout_sec=0.1)
    executor, ran = SingleThreadedExecutor(), []
    task = executor.create_task(ran.append, 1)
    task.cancel()
    executor.spin_once(timeout_sec=0.1)
    found: list[Any] = [future.done(), future.cancelled(), future.result(), ran, task.cancelled()]
    waiting = rclpy.Future()
    node.create_timer(0.1, waiting.cancel)
    rclpy.spin_until_future_complete(node, waiting, timeout_sec=30.0)
    found += [waiting.cancelled(), waiting.done()]
    waiting.set_result(3)
    found += [waiting.cancelled(), waiting.done(), waiting.result()]
    return [repr(one) for one in found]


@probe
def coroutine_objects_as_tasks() -> list[str]:
    async def work() -> int:
        return 3

    executor = SingleThreadedExecutor()
    task = executor.create_task(work())
    executor.spin_once(timeout_sec=1.0)
    return [repr(task.done()), repr(task.result())]


@probe
def asyncio_awaits_a_future() -> list[str]:
    import asyncio

    async def work() -> Any:
        future = rclpy.Future()
        asyncio.get_running_loop().call_later(0.05, future.set_result, 7)
        return await future

    return [repr(asyncio.run(work()))]


@probe
def spin_once_keeps_a_node_in_its_executor() -> list[str]:
    node, executor, ran = Node("n"), SingleThreadedExecutor(), []
    executor.add_node(node)
    node.create_timer(0.05, lambda: ran.append(1))
    rclpy.spin_once(node, executor=executor, timeout_sec=0)
    executor.spin_once(timeout_sec=2.0)
    found = [repr(ran), repr(executor.get_nodes() == [node])]
    other = Node("m")
    rclpy.spin_once(other, executor=executor, timeout_sec=0)
    return [*found, repr(other in executor.get_nodes())]


@probe
def done_callbacks() -> list[str]:
    future, called = rclpy.Future(), []
    future.add_done_callback(called.append)
    found = [outcome(future.remove_done_callback, called.append), outcome(future.remove_done_callback, print)]
    future.set_result(1)
    return [*found, repr(called), outcome(future.add_done_callback, None)]


@probe
def polling_takes_every_second_call() -> list[str]:
    node, got = Node("n"), []
    publisher = node.create_publisher(Int32, "t", 100)
    node.create_subscription(Int32, "t", lambda message: got.append(message.data), 100)
    for _ in range(20):
        rclpy.spin_once(node, timeout_sec=0.05)
    for number in range(10):
        publisher.publish(Int32(data=number))
        rclpy.spin_once(node, timeout_sec=0.2) if number == 0 else None
    import time

    time.sleep(0.5)
    before, counts = len(got), []
    for _ in range(8):
        rclpy.spin_once(node, timeout_sec=0)
        counts.append(len(got) - before)
    return [repr(counts)]


@probe
def spin_once_and_rate_in_one_thread() -> list[str]:
    import time

    node = Node("n")
    rate, times = node.create_rate(10.0), []
    for _ in range(4):
        rclpy.spin_once(node)
        rate.sleep()
        times.append(time.monotonic())
    return [repr([round((b - a) * 10) for a, b in pairwise(times)])]


if __name__ == "__main__":
    main()
