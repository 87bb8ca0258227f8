# mypy: ignore-errors
"""Spinning of executors: several threads, several nodes, time limits, awaiting coroutines."""

import threading
import time
from typing import Any

import rclpy
from probing import lines, main, outcome, probe
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import Int32
from std_srvs.srv import Trigger


def _in_threads(*spins: Any, seconds: Any = 0.6, between: Any = None) -> Any:
    """Run functions in threads, one after the other was started; return what each has raised by then."""
    results: list[Any] = [None] * len(spins)

    def run(index: int) -> None:
        results[index] = outcome(spins[index])

    threads = [threading.Thread(target=run, args=(index,), daemon=True) for index in range(len(spins))]
    for thread in threads:
        thread.start()
        time.sleep(0.2)
    time.sleep(seconds)
    found = [results[index] for index in range(len(spins))]
    if between is not None:
        found.append(between())
    rclpy.try_shutdown()
    for thread in threads:
        thread.join(3.0)
    return [*found, [thread.is_alive() for thread in threads]]


def _ticking(name: Any = "n", period: Any = 0.05) -> Any:
    node = Node(name)
    node.ticks = 0

    def tick() -> None:
        node.ticks += 1

    node.create_timer(period, tick)
    return node


def _two(first: Any, second: Any) -> Any:
    node = _ticking()
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    return _in_threads(lambda: first(executor, node), lambda: second(executor, node))


lines(
    "two",
    spins=lambda: _two(lambda e, n: e.spin(), lambda e, n: e.spin()),
    spin_and_once=lambda: _two(lambda e, n: e.spin(), lambda e, n: e.spin_once()),
    spin_and_limited=lambda: _two(lambda e, n: e.spin(), lambda e, n: e.spin_once(timeout_sec=0.3)),
    spin_and_future=lambda: _two(
        lambda e, n: e.spin(), lambda e, n: e.spin_until_future_complete(Future(), 0.3)
    ),
    one_future=lambda: _one_future(),
    many_threads=lambda: _two_of_many(),
    global_executor=lambda: _two_global(),
    executors=lambda: _two_executors(),
    of_one_node=lambda: _two_of_one_node(),
)


def _one_future() -> Any:
    node, future = _ticking(), Future()
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    spin = lambda: executor.spin_until_future_complete(future)  # noqa: E731
    return _in_threads(spin, spin)


def _two_of_many() -> Any:
    executor = MultiThreadedExecutor(2)
    executor.add_node(_ticking())
    return _in_threads(executor.spin, executor.spin)


def _two_global() -> Any:
    first, second = _ticking("first"), _ticking("second")
    return _in_threads(
        lambda: rclpy.spin(first),
        lambda: rclpy.spin(second),
        between=lambda: [first.ticks > 5, second.ticks > 5],
    )


def _two_executors() -> Any:
    first, second = _ticking("first"), _ticking("second")
    return _in_threads(
        lambda: rclpy.spin(first, SingleThreadedExecutor()),
        lambda: rclpy.spin(second, SingleThreadedExecutor()),
        between=lambda: [first.ticks > 5, second.ticks > 5],
    )


def _two_of_one_node() -> Any:
    node = _ticking()
    return _in_threads(
        lambda: rclpy.spin(node, SingleThreadedExecutor()),
        lambda: rclpy.spin(node, SingleThreadedExecutor()),
        between=lambda: node.ticks > 5,
    )


@probe
def spin_once_beside_a_thread_that_spins() -> Any:
    node = _ticking()

    def beside() -> Any:
        before = node.ticks
        found = [outcome(lambda: rclpy.spin_once(node, timeout_sec=0.3)) for _ in range(2)]
        time.sleep(0.4)
        return [*found, node.ticks > before]

    return _in_threads(lambda: rclpy.spin(node), between=beside)


@probe
def spin_until_beside_a_thread_that_spins() -> Any:
    node = _ticking()
    node.create_service(Trigger, "s", lambda request, response: response)
    client = node.create_client(Trigger, "s")

    def beside() -> Any:
        future = client.call_async(Trigger.Request())
        found = outcome(lambda: rclpy.spin_until_future_complete(node, future, timeout_sec=2.0))
        return [found, future.done()]

    return _in_threads(lambda: rclpy.spin(node), between=beside)


@probe
def changing_time_limits() -> Any:
    node, executor = _ticking(period=0.01), SingleThreadedExecutor()
    executor.add_node(node)
    end, limit = time.monotonic() + 0.5, 0.01
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=limit)
        limit += 0.0001
    return node.ticks > 20


@probe
def changing_time_limits_while_a_coroutine_waits() -> Any:
    node, executor, future = _ticking(), SingleThreadedExecutor(), Future()
    executor.add_node(node)

    async def wait() -> None:
        await future

    executor.create_task(wait)
    end, limit = time.monotonic() + 0.5, 0.01
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=limit)
        limit += 0.0001
    return node.ticks > 5


@probe
def one_time_limit_while_a_coroutine_waits() -> Any:
    node, executor, future = _ticking(), SingleThreadedExecutor(), Future()
    executor.add_node(node)

    async def wait() -> None:
        await future

    executor.create_task(wait)
    end = time.monotonic() + 0.8
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.02)
    return node.ticks > 5


@probe
def calls_of_spin_once_while_a_coroutine_waits() -> Any:
    node, executor, future = _ticking(period=0.02), SingleThreadedExecutor(), Future()
    executor.add_node(node)

    async def wait() -> None:
        await future

    executor.create_task(wait)
    for _ in range(12):
        executor.spin_once(timeout_sec=1.0)
    return node.ticks


def _nodes_of(executor: Any, *counts: Any) -> Any:
    nodes = [_ticking(f"n{index}") for index in range(3)]
    for node in nodes:
        executor.add_node(node)
    end = time.monotonic() + 0.5
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.05)
    ran = [node.ticks > 4 for node in nodes]
    executor.remove_node(nodes[1])
    before = nodes[1].ticks
    end = time.monotonic() + 0.3
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.05)
    stopped = nodes[1].ticks - before <= 1
    names = sorted(node.get_name() for node in executor.get_nodes())
    nodes[2].destroy_node()
    return [ran, stopped, names, len(executor.get_nodes()), outcome(executor.shutdown)]


lines(
    "nodes",
    single=lambda: _nodes_of(SingleThreadedExecutor()),
    many=lambda: _nodes_of(MultiThreadedExecutor(3)),
)


@probe
def node_moves_to_another_executor() -> Any:
    node = _ticking()
    first, second = SingleThreadedExecutor(), SingleThreadedExecutor()
    first.add_node(node)
    added = second.add_node(node)
    return [added, len(first.get_nodes()), len(second.get_nodes()), node.executor is second]


@probe
def node_executor_is_none_again() -> Any:
    node = Node("n")
    executor = SingleThreadedExecutor()
    node.executor = executor
    found = [len(executor.get_nodes()), node.executor is executor]
    node.executor = None
    return [*found, len(executor.get_nodes()), node.executor]


@probe
def callbacks_of_a_mutually_exclusive_group_with_many_threads() -> Any:
    return _overlap(MutuallyExclusiveCallbackGroup())


@probe
def callbacks_of_a_reentrant_group_with_many_threads() -> Any:
    return _overlap(ReentrantCallbackGroup())


@probe
def callbacks_of_the_default_group_with_many_threads() -> Any:
    return _overlap(None)


def _overlap(group: Any) -> Any:
    node, running, most = Node("n"), [0], [0]

    def work() -> None:
        running[0] += 1
        most[0] = max(most[0], running[0])
        time.sleep(0.15)
        running[0] -= 1

    for _ in range(2):
        node.create_timer(0.05, work, callback_group=group)
    executor = MultiThreadedExecutor(4)
    executor.add_node(node)
    end = time.monotonic() + 0.8
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.05)
    executor.shutdown()
    return most[0] > 1


@probe
def service_called_by_a_timer_in_another_group() -> Any:
    node, found = Node("n"), []
    node.create_service(Trigger, "s", lambda request, response: Trigger.Response(success=True))
    client = node.create_client(Trigger, "s", callback_group=MutuallyExclusiveCallbackGroup())

    def ask() -> None:
        timer.cancel()
        found.append(client.call(Trigger.Request()).success)

    timer = node.create_timer(0.1, ask, callback_group=MutuallyExclusiveCallbackGroup())
    executor = MultiThreadedExecutor(3)
    executor.add_node(node)
    end = time.monotonic() + 3.0
    while time.monotonic() < end and not found:
        executor.spin_once(timeout_sec=0.05)
    executor.shutdown()
    return found


def _error_in(create: Any) -> Any:
    node = Node("n")
    create(node)
    executor = SingleThreadedExecutor()
    executor.add_node(node)

    def spin() -> None:
        end = time.monotonic() + 3.0
        while time.monotonic() < end:
            executor.spin_once(timeout_sec=0.05)

    first = outcome(spin)
    again = outcome(lambda: executor.spin_once(timeout_sec=0.02))
    return [first, again.partition(":")[0]]


def _raises(*_: Any) -> None:
    raise RuntimeError("boom")


def _publishes_to_itself(node: Any) -> None:
    publisher = node.create_publisher(Int32, "t", 1)
    node.create_subscription(Int32, "t", _raises, 1)
    node.create_timer(0.1, lambda: publisher.publish(Int32()))


def _asks_itself(node: Any) -> None:
    node.create_service(Trigger, "s", _raises)
    client = node.create_client(Trigger, "s")

    def ask() -> None:
        timer.cancel()
        client.call_async(Trigger.Request())

    timer = node.create_timer(0.3, ask)


def _guards(node: Any) -> None:
    guard = node.create_guard_condition(_raises)
    guard.trigger()


lines(
    "error",
    timer=lambda: _error_in(lambda node: node.create_timer(0.05, _raises)),
    subscription=lambda: _error_in(_publishes_to_itself)[:1],
    service=lambda: _error_in(_asks_itself),
    guard=lambda: _error_in(_guards)[:1],
    system_exit=lambda: _error_in(lambda node: node.create_timer(0.05, lambda: exit(3))),
    stop_iteration=lambda: _error_in(lambda node: node.create_timer(0.05, lambda: next(iter([])))),
    interrupt=lambda: _error_in(lambda node: node.create_timer(0.05, lambda: _interrupt())),
)


def _interrupt() -> None:
    raise KeyboardInterrupt


@probe
def error_with_many_threads() -> Any:
    node = Node("n")
    node.create_timer(0.05, _raises)
    executor = MultiThreadedExecutor(2)
    executor.add_node(node)
    return outcome(executor.spin)


@probe
def rate_beside_a_thread_that_spins() -> Any:
    node, ticks = Node("n"), [0]
    thread = threading.Thread(target=rclpy.spin, args=(node,), daemon=True)
    thread.start()
    rate = node.create_rate(20)
    begin = time.monotonic()
    for _ in range(10):
        rate.sleep()
        ticks[0] += 1
    took = time.monotonic() - begin
    found = [ticks, 0.4 < took < 0.7, outcome(rate.destroy), outcome(rate.sleep)]
    rclpy.try_shutdown()
    thread.join(2.0)
    return found


@probe
def rate_that_is_shut_down() -> Any:
    node = Node("n")
    rate = node.create_rate(0.2)
    threading.Timer(0.3, rclpy.try_shutdown).start()
    return outcome(rate.sleep)


@probe
def rate_whose_timer_is_destroyed() -> Any:
    node = Node("n")
    rate = node.create_rate(5)
    node.destroy_rate(rate)
    return [outcome(rate.sleep), len(list(node.timers))]


if __name__ == "__main__":
    main()
