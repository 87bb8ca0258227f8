# mypy: ignore-errors
"""Futures, tasks, guard conditions and the executors that run them.

Many of the calls are wrong on purpose.
"""

import asyncio
import threading
import time
import warnings
from typing import Any

import rclpy
from probing import lines, main, outcome, probe
from rclpy.callback_groups import (
    CallbackGroup,
    MutuallyExclusiveCallbackGroup,
    ReentrantCallbackGroup,
)
from rclpy.executors import (
    MultiThreadedExecutor,
    SingleThreadedExecutor,
    await_or_execute,
)
from rclpy.node import Node
from rclpy.task import Future, Task


def _done(value: Any = 1) -> Future:
    future = Future()
    future.set_result(value)
    return future


def _failed() -> Future:
    future = Future()
    future.set_exception(ValueError("why"))
    return future


def _states(future: Future) -> list[Any]:
    return [future.done(), future.cancelled(), outcome(future.result), outcome(future.exception)]


def _cancelled() -> Future:
    future = Future()
    future.cancel()
    return future


lines(
    "future",
    new=lambda: _states(Future()),
    done=lambda: _states(_done()),
    failed=lambda: _states(_failed()),
    cancelled=lambda: _states(_cancelled()),
    result_twice=lambda: _twice(),
    result_after_cancel=lambda: _after_cancel(),
    cancel_when_done=lambda: _cancel_done(),
    text_exception=lambda: Future().set_exception("text"),
    no_exception=lambda: Future().set_exception(None),
    wrong_executor=lambda: Future(executor=3),
    callback_none=lambda: Future().add_done_callback(None),
    callback_none_when_done=lambda: _done().add_done_callback(None),
    callback_fails_when_done=lambda: _done().add_done_callback(lambda f: 1 / 0),
    remove_unknown=lambda: Future().remove_done_callback(print),
    remove=lambda: _removed(),
    awaited_twice=lambda: asyncio.run(_twice_awaited()),
    text=lambda: str(_done())[:20],
    as_bool=lambda: bool(Future()),
    type_parameter=lambda: Future[int],
    iterated=lambda: list(_done().__await__()),
    iterated_pending=lambda: next(Future().__await__()),
)


def _twice() -> list[Any]:
    future = _done(1)
    future.set_result(2)
    return _states(future)


def _after_cancel() -> list[Any]:
    future = _cancelled()
    future.set_result(2)
    return _states(future)


def _cancel_done() -> list[Any]:
    future = _done()
    future.cancel()
    return _states(future)


def _removed() -> list[Any]:
    future, seen = Future(), []
    future.add_done_callback(seen.append)
    future.add_done_callback(print)
    removed = [future.remove_done_callback(print)]
    future.set_result(1)
    return [removed, len(seen)]


async def _twice_awaited() -> list[Any]:
    future = _done(5)
    return [await future, await future]


@probe
def callbacks_of_a_future_in_order() -> list[str]:
    future, seen = Future(), []
    for name in "abc":
        future.add_done_callback(lambda _, name=name: seen.append(name))
    future.add_done_callback(lambda f: seen.append(f.result()))
    future.set_result("value")
    future.add_done_callback(lambda f: seen.append("late"))
    return seen


@probe
def failing_callback_of_a_future() -> list[Any]:
    future, seen = Future(), []
    future.add_done_callback(lambda _: 1 / 0)
    future.add_done_callback(lambda _: seen.append(1))
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        error = outcome(future.set_result, 1)
    return [error, seen, [str(one.message) for one in warned]]


@probe
def callbacks_of_a_cancelled_future() -> list[Any]:
    future, seen = Future(), []
    future.add_done_callback(lambda f: seen.append(f.cancelled()))
    future.cancel()
    future.cancel()
    return seen


@probe
def callbacks_with_an_executor_wait_for_it() -> list[Any]:
    executor, seen = SingleThreadedExecutor(), []
    future = Future(executor=executor)
    future.add_done_callback(lambda _: seen.append(1))
    future.set_result(1)
    before = list(seen)
    executor.spin_once(timeout_sec=0.1)
    return [before, seen]


def _run(*args: Any, **kwargs: Any) -> list[Any]:
    executor = SingleThreadedExecutor()
    task = executor.create_task(*args, **kwargs)
    errors = [outcome(executor.spin_once, timeout_sec=0.05) for _ in range(0)]
    for _ in range(3):
        errors.append(outcome(lambda: executor.spin_once(timeout_sec=0.05)))
    return [task.done(), outcome(task.result), [error for error in errors if error != "None"]]


async def _coroutine(value: Any = 4) -> Any:
    return value


async def _failing() -> None:
    raise ValueError("inside")


async def _nested() -> Any:
    return [await _coroutine(1), await _done(2)]


async def _cancelled_inside() -> Any:
    return await _cancelled()


lines(
    "task",
    function=lambda: _run(lambda: 3),
    with_arguments=lambda: _run(lambda a, b: a + b, 1, b=2),
    wrong_arguments=lambda: _run(lambda a: a),
    coroutine_function=lambda: _run(_coroutine, 7),
    coroutine=lambda: _run(_coroutine(8)),
    coroutine_with_arguments=lambda: _run(_coroutine(8), 3),
    failing=lambda: _run(lambda: 1 / 0),
    failing_coroutine=lambda: _run(_failing),
    nested=lambda: _run(_nested),
    awaits_a_cancelled_one=lambda: _run(_cancelled_inside),
    no_callable=lambda: _run(3),
    none=lambda: _run(None),
    kind=lambda: type(SingleThreadedExecutor().create_task(print)).__name__,
    executing=lambda: SingleThreadedExecutor().create_task(print).executing(),
    called_by_hand=lambda: _by_hand(),
    own_task=lambda: Task(lambda: 3).done(),
    exit=lambda: _run(lambda: (_ for _ in ()).throw(SystemExit(3))),
)


def _by_hand() -> list[Any]:
    task = Task(lambda: 3)
    task()
    task()
    return [task.done(), task.result()]


@probe
def await_or_execute_both() -> list[Any]:
    async def run() -> list[Any]:
        return [await await_or_execute(lambda: 1), await await_or_execute(_coroutine, 2)]

    return asyncio.run(run())


@probe
def task_that_waits_for_a_future() -> list[Any]:
    executor, future = SingleThreadedExecutor(), Future()

    async def wait() -> Any:
        return await future

    task = executor.create_task(wait)
    executor.spin_once(timeout_sec=0.05)
    before = task.done()
    future.set_result(6)
    for _ in range(3):
        executor.spin_once(timeout_sec=0.05)
    return [before, task.done(), task.result()]


@probe
def spin_until_a_task_is_done() -> list[Any]:
    executor = SingleThreadedExecutor()
    task = executor.create_task(_coroutine, 9)
    executor.spin_until_future_complete(task, timeout_sec=1.0)
    return [task.done(), task.result()]


@probe
def spin_until_complete_times_out() -> list[Any]:
    node, future = Node("n"), Future()
    begin = time.monotonic()
    result = rclpy.spin_until_future_complete(node, future, timeout_sec=0.2)
    return [result, future.done(), 0.15 < time.monotonic() - begin < 0.6]


@probe
def spin_until_complete_with_zero() -> list[Any]:
    node, future = Node("n"), Future()
    return [rclpy.spin_until_future_complete(node, future, timeout_sec=0), future.done()]


@probe
def spin_until_a_done_future_runs_nothing() -> list[Any]:
    node, calls = Node("n"), []
    node.create_timer(0.0, lambda: calls.append(1))
    rclpy.spin_until_future_complete(node, _done())
    return calls


@probe
def spin_until_something_else() -> str:
    return outcome(rclpy.spin_until_future_complete, Node("n"), 3)


@probe
def spin_until_a_failed_future() -> list[Any]:
    future = _failed()
    return [outcome(rclpy.spin_until_future_complete, Node("n"), future), outcome(future.result)]


def _executor(node: Any = None, threads: int = 0) -> Any:
    executor = MultiThreadedExecutor(threads) if threads else SingleThreadedExecutor()
    if node is not None:
        executor.add_node(node)
    return executor


lines(
    "executor",
    add=lambda: _executor().add_node(Node("n")),
    add_twice=lambda: _added_twice(),
    add_none=lambda: _executor().add_node(None),
    add_text=lambda: _executor().add_node("n"),
    remove_unknown=lambda: _executor().remove_node(Node("n")),
    remove_none=lambda: _executor().remove_node(None),
    nodes=lambda: [node.get_name() for node in _executor(Node("n")).get_nodes()],
    of_node=lambda: _of_node(),
    set_executor=lambda: _set_executor(),
    spin_nothing=lambda: _executor().spin_once(timeout_sec=0.05),
    spin_negative=lambda: _with_timer(lambda e: e.spin_once(timeout_sec=-1)),
    spin_text=lambda: _executor(Node("n")).spin_once(timeout_sec="1"),
    shutdown=lambda: _executor().shutdown(),
    shutdown_twice=lambda: _shut_twice(),
    shutdown_with_limit=lambda: _executor().shutdown(timeout_sec=0.1),
    shutdown_many=lambda: _executor(threads=2).shutdown(timeout_sec=0.1),
    spin_after_shutdown=lambda: _after_shutdown(lambda e: e.spin_once(timeout_sec=0.1)),
    spin_for_ever_after_shutdown=lambda: _after_shutdown(lambda e: e.spin()),
    add_after_shutdown=lambda: _after_shutdown(lambda e: e.add_node(Node("n"))),
    task_after_shutdown=lambda: _after_shutdown(lambda e: e.create_task(print).done()),
    wake_after_shutdown=lambda: _after_shutdown(lambda e: e.wake()),
    in_with=lambda: _executor_in_with(),
    context=lambda: _executor().context is rclpy.get_default_context(),
    wait_nothing=lambda: _executor().wait_for_ready_callbacks(timeout_sec=0.05),
    threads_text=lambda: MultiThreadedExecutor("2"),
    threads_float=lambda: MultiThreadedExecutor(2.5),
)


def _added_twice() -> list[Any]:
    node, executor = Node("n"), _executor()
    return [executor.add_node(node), executor.add_node(node), len(executor.get_nodes())]


def _of_node() -> list[Any]:
    node = Node("n")
    first, second = _executor(), _executor()
    found = [node.executor]
    first.add_node(node)
    found.append(node.executor is first)
    second.add_node(node)
    found += [node.executor is second, len(first.get_nodes())]
    second.remove_node(node)
    return [*found, node.executor]


def _set_executor() -> list[Any]:
    node, executor = Node("n"), _executor()
    node.executor = executor
    found = [len(executor.get_nodes()), node.executor is executor]
    node.executor = None
    return [*found, len(executor.get_nodes()), node.executor]


def _with_timer(call: Any) -> list[Any]:
    node, calls = Node("n"), []
    node.create_timer(0.05, lambda: calls.append(1))
    call(_executor(node))
    return calls


def _shut_twice() -> list[Any]:
    executor = _executor(Node("n"))
    return [executor.shutdown(), outcome(executor.shutdown), len(executor.get_nodes())]


def _after_shutdown(call: Any) -> str:
    executor = _executor(Node("n"))
    executor.shutdown()
    return outcome(call, executor)


def _executor_in_with() -> list[Any]:
    with _executor(Node("n")) as executor:
        inside = len(executor.get_nodes())
    return [inside, outcome(lambda: executor.spin_once(timeout_sec=0.05))]


@probe
def guard_condition_runs_once_per_trigger() -> list[Any]:
    node, calls = Node("n"), []
    guard = node.create_guard_condition(lambda: calls.append(1))
    rclpy.spin_once(node, timeout_sec=0.05)
    before = len(calls)
    guard.trigger()
    guard.trigger()
    for _ in range(3):
        rclpy.spin_once(node, timeout_sec=0.05)
    return [before, len(calls), node.destroy_guard_condition(guard), node.destroy_guard_condition(guard)]


@probe
def guard_condition_after_its_destruction() -> list[str]:
    node = Node("n")
    guard = node.create_guard_condition(print)
    node.destroy_guard_condition(guard)
    return [outcome(guard.trigger), outcome(guard.destroy)]


@probe
def guard_condition_triggered_by_a_thread() -> list[Any]:
    node, calls = Node("n"), []
    guard = node.create_guard_condition(lambda: calls.append(1))
    thread = threading.Thread(target=lambda: (time.sleep(0.1), guard.trigger()))
    thread.start()
    rclpy.spin_once(node, timeout_sec=2.0)
    thread.join()
    return calls


@probe
def groups_decide() -> list[Any]:
    exclusive, reentrant = MutuallyExclusiveCallbackGroup(), ReentrantCallbackGroup()
    found: list[Any] = []
    for group in (exclusive, reentrant):
        entity = Node("n").create_timer(1.0, print, callback_group=group)
        found += [group.has_entity(entity), group.can_execute(entity), group.beginning_execution(entity)]
        found += [group.can_execute(entity), group.beginning_execution(entity)]
        found += [group.ending_execution(entity), group.can_execute(entity)]
    return found


lines(
    "group",
    abstract=lambda: CallbackGroup(),
    not_one=lambda: Node("n").create_timer(1.0, print, callback_group="x"),
    own_entity=lambda: MutuallyExclusiveCallbackGroup().has_entity(3),
    foreign_end=lambda: MutuallyExclusiveCallbackGroup().ending_execution(3),
)


@probe
def shutdown_ends_spin_in_a_thread() -> list[Any]:
    node, found = Node("n"), []
    executor = _executor(node)
    thread = threading.Thread(target=lambda: found.append(outcome(executor.spin)))
    thread.start()
    time.sleep(0.2)
    rclpy.shutdown()
    thread.join(timeout=3.0)
    return [thread.is_alive(), found]


@probe
def executor_shutdown_ends_spin_in_a_thread() -> list[Any]:
    node, found = Node("n"), []
    executor = _executor(node)
    thread = threading.Thread(target=lambda: found.append(outcome(executor.spin)))
    thread.start()
    time.sleep(0.2)
    executor.shutdown()
    thread.join(timeout=3.0)
    return [thread.is_alive(), found]


@probe
def shutdown_in_a_callback() -> list[Any]:
    node = Node("n")
    node.create_timer(0.05, rclpy.shutdown)
    return [outcome(rclpy.spin, node), rclpy.ok()]


@probe
def executor_shutdown_in_a_callback() -> list[Any]:
    node = Node("n")
    executor = _executor(node)
    node.create_timer(0.05, executor.shutdown)
    return [outcome(executor.spin), rclpy.ok()]


@probe
def node_destroyed_in_a_callback() -> list[Any]:
    node, calls = Node("n"), []
    node.create_timer(0.05, lambda: (calls.append(1), node.destroy_node()))
    executor = _executor(node)
    found = [outcome(lambda: executor.spin_once(timeout_sec=0.1)) for _ in range(3)]
    return [found, calls]


@probe
def exceptions_of_many_threads_come_out() -> str:
    node = Node("n")
    node.create_timer(0.05, lambda: 1 / 0)
    executor = _executor(node, threads=2)
    return outcome(executor.spin)


@probe
def tasks_of_many_threads() -> list[Any]:
    executor = _executor(threads=2)
    tasks = [executor.create_task(lambda n=n: n) for n in range(4)]
    for task in tasks:
        executor.spin_until_future_complete(task, timeout_sec=1.0)
    return [task.result() for task in tasks]


if __name__ == "__main__":
    main()
