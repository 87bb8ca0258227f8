# mypy: ignore-errors
"""Exceptions in callbacks of all kinds: where they arrive, and what runs afterwards."""

import time
from typing import Any

import rclpy
from action_msgs.srv import CancelGoal
from probing import Fibonacci, lines, main, outcome, probe
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.action import ActionClient, ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.executors import (
    ConditionReachedException,
    ExternalShutdownException,
    MultiThreadedExecutor,
    ShutdownException,
    SingleThreadedExecutor,
    TimeoutException,
)
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.task import Future
from std_msgs.msg import String
from std_srvs.srv import Trigger


class Odd(BaseException):
    pass


class OwnError(Exception):
    def __str__(self) -> Any:
        return "own text"


def thrower(error: Any) -> Any:
    """Return a function that raises an error."""

    def throw(*_: Any) -> None:
        raise error

    return throw


def spins(node: Any, until: Any, kind: Any = SingleThreadedExecutor, seconds: Any = 3.0) -> Any:
    """Spin on through exceptions until a condition is true; return the exceptions."""
    executor, raised = kind(), []
    executor.add_node(node)
    end = time.monotonic() + seconds
    while not until() and time.monotonic() < end:
        try:
            executor.spin_once(timeout_sec=0.1)
        except BaseException as error:
            raised.append(f"{type(error).__name__}: {error}")
    # A thread that has run the last callback may not have reported its exception yet.
    if kind is MultiThreadedExecutor:
        time.sleep(0.05)
        try:
            executor.spin_once(timeout_sec=0.05)
        except BaseException as error:
            raised.append(f"{type(error).__name__}: {error}")
    executor.shutdown()
    return raised


def first_fails(error: Any, calls: Any) -> Any:
    """Return a callback that raises an error in its first call and counts its calls."""

    def callback(*_: Any) -> None:
        calls.append(1)
        if len(calls) == 1:
            raise error

    return callback


def in_timer(error: Any, kind: Any = SingleThreadedExecutor) -> Any:
    node, calls = Node("n"), []
    node.create_timer(0.03, first_fails(error, calls))
    return spins(node, lambda: len(calls) > 2, kind), len(calls) > 2


def in_subscription(error: Any, kind: Any = SingleThreadedExecutor) -> Any:
    node, calls = Node("n"), []
    node.create_subscription(String, "t", first_fails(error, calls), 10)
    publisher = node.create_publisher(String, "t", 10)
    for number in range(3):
        publisher.publish(String(data=str(number)))
    return spins(node, lambda: len(calls) == 3, kind), len(calls)


def in_service(error: Any, kind: Any = SingleThreadedExecutor) -> Any:
    node, calls, found = Node("n"), [], []

    def answer(_: Any, response: Any) -> Any:
        first_fails(error, calls)()
        response.message = str(len(calls))
        return response

    group = ReentrantCallbackGroup()
    node.create_service(Trigger, "s", answer, callback_group=group)
    client = node.create_client(Trigger, "s", callback_group=group)
    client.wait_for_service(2.0)
    futures = [client.call_async(Trigger.Request()) for _ in range(2)]
    found = spins(node, futures[1].done, kind, 1.0)
    return found, futures[0].done(), futures[1].done() and futures[1].result().message


def in_guard(error: Any, kind: Any = SingleThreadedExecutor) -> Any:
    node, calls = Node("n"), []
    guard = node.create_guard_condition(first_fails(error, calls))
    guard.trigger()
    raised = spins(node, lambda: calls, kind)
    guard.trigger()
    return raised, spins(node, lambda: len(calls) > 1, kind), len(calls)


def in_done_callback(error: Any, kind: Any = SingleThreadedExecutor) -> Any:
    node, calls = Node("n"), []
    node.create_service(Trigger, "s", lambda _, response: response)
    client = node.create_client(Trigger, "s")
    client.wait_for_service(2.0)
    future = client.call_async(Trigger.Request())
    future.add_done_callback(first_fails(error, calls))
    return spins(node, lambda: calls, kind), future.done(), len(calls)


def in_task(error: Any, kind: Any = SingleThreadedExecutor) -> Any:
    node, executor = Node("n"), kind()
    executor.add_node(node)
    task = executor.create_task(thrower(error))
    raised = [outcome(executor.spin_once, timeout_sec=0.2) for _ in range(2)]
    executor.shutdown()
    return raised, task.done(), outcome(task.result)


def in_coroutine(error: Any, kind: Any = SingleThreadedExecutor) -> Any:
    node, calls = Node("n"), []
    future = Future()

    async def callback() -> None:
        calls.append(1)
        if len(calls) == 1:
            await future
            raise error

    node.create_timer(0.03, callback, callback_group=ReentrantCallbackGroup())
    node.create_timer(0.08, lambda: future.set_result(1) if not future.done() else None)
    # Executors with several threads may raise the exception of a coroutine several times.
    raised = spins(node, lambda: len(calls) > 4, kind)
    return sorted(set(raised)), len(calls) > 4


PLACES = {
    "timer": in_timer,
    "subscription": in_subscription,
    "service": in_service,
    "guard": in_guard,
    "done": in_done_callback,
    "task": in_task,
    "coroutine": in_coroutine,
}
ERRORS = {
    "own": lambda: OwnError(1, 2),
    "key": lambda: KeyError("k"),
    "stop_iteration": lambda: StopIteration(3),
    "stop_async": lambda: StopAsyncIteration(3),
    "generator_exit": lambda: GeneratorExit(),
    "exit": lambda: SystemExit(3),
    "interrupt": lambda: KeyboardInterrupt(),
    "base": lambda: Odd("base"),
    "timeout": lambda: TimeoutException(),
    "condition": lambda: ConditionReachedException("c"),
    "shutdown": lambda: ShutdownException("s"),
    "external": lambda: ExternalShutdownException(),
}
for _place, _run in PLACES.items():
    lines(
        f"in_{_place}",
        **{name: (lambda run=_run, make=make: run(make())) for name, make in ERRORS.items()},
    )
    # These raise when the next callback begins: see `in_threads_without_another_callback`.
    if _place in ("done", "task"):
        continue
    lines(
        f"in_threads_of_{_place}",
        **{
            name: (lambda run=_run, name=name: run(ERRORS[name](), MultiThreadedExecutor))
            for name in ("own", "key", "stop_iteration", "timeout")
        },
    )


def slow_thrower() -> None:
    time.sleep(0.1)
    raise OwnError


@probe
def in_threads_without_another_callback() -> Any:
    executor = MultiThreadedExecutor()
    executor.add_node(Node("n"))
    task = executor.create_task(slow_thrower)
    raised = [outcome(executor.spin_once, timeout_sec=0.1) for _ in range(5)]
    executor.shutdown()
    return sorted(set(raised)), task.done(), repr(task.exception())


def goal(client_error: Any = None, **options: Any) -> Any:
    """Send a goal to a server with these callbacks; return the exceptions and the answers."""
    node, found = Node("n"), []
    group = ReentrantCallbackGroup()

    def execute(handle: Any) -> Any:
        handle.publish_feedback(Fibonacci.Feedback())
        handle.succeed()
        return Fibonacci.Result()

    options.setdefault("execute_callback", execute)
    server = ActionServer(node, Fibonacci, "fib", callback_group=group, **options)
    client = ActionClient(node, Fibonacci, "fib", callback_group=group)
    client.wait_for_server(3.0)
    feedback = thrower(client_error) if client_error else None
    sent = client.send_goal_async(Fibonacci.Goal(), feedback_callback=feedback)
    found += spins(node, sent.done, seconds=1.0)
    if not sent.done():
        return found, "no answer"
    if not sent.result().accepted:
        return found, "not accepted"
    result = sent.result().get_result_async()
    found += spins(node, result.done, seconds=1.0)
    status = result.result().status if result.done() else "no result"
    server.destroy()
    return found, status


def canceling(callback: Any) -> Any:
    """Cancel a goal of a server with this cancel callback; return the exceptions and the response."""
    node, group = Node("n"), ReentrantCallbackGroup()
    ActionServer(
        node,
        Fibonacci,
        "fib",
        lambda _: Fibonacci.Result(),
        handle_accepted_callback=lambda _: None,
        cancel_callback=callback,
        callback_group=group,
    )
    client = ActionClient(node, Fibonacci, "fib", callback_group=group)
    client.wait_for_server(3.0)
    sent = client.send_goal_async(Fibonacci.Goal())
    found = [spins(node, sent.done)]
    canceled = sent.result().cancel_goal_async()
    found.append(spins(node, canceled.done, seconds=1.0))
    if not canceled.done():
        return found, "no answer"
    answer = canceled.result()
    counts = answer.return_code, len(answer.goals_canceling)
    return found, counts, type(answer) is CancelGoal.Response


lines(
    "goal",
    succeeds=lambda: goal(),
    goal_callback=lambda: goal(goal_callback=thrower(OwnError())),
    goal_callback_stops=lambda: goal(goal_callback=thrower(StopIteration(1))),
    accepted_callback=lambda: goal(handle_accepted_callback=thrower(OwnError())),
    execute=lambda: goal(execute_callback=thrower(OwnError())),
    execute_stops=lambda: goal(execute_callback=thrower(StopIteration(1))),
    execute_ends=lambda: goal(execute_callback=thrower(TimeoutException("t"))),
    feedback=lambda: goal(client_error=OwnError()),
    cancel=lambda: canceling(thrower(OwnError())),
    cancel_stops=lambda: canceling(thrower(StopIteration(1))),
    cancel_accept=lambda: canceling(lambda _: CancelResponse.ACCEPT),
    cancel_reject=lambda: canceling(lambda _: CancelResponse.REJECT),
    cancel_true=lambda: canceling(lambda _: True),
    cancel_nothing=lambda: canceling(lambda _: None),
    cancel_number=lambda: canceling(lambda _: 2),
)


def changing(callback: Any, kind: Any = SetParameters, what: Any = "on_set") -> Any:
    """Set a parameter by its service in a node whose callback fails."""
    node = Node("n")
    node.declare_parameter("a", 1)
    getattr(node, f"add_{what}_parameters_callback")(callback)
    client = node.create_client(
        kind, f"n/{'set_parameters' if kind is SetParameters else 'set_parameters_atomically'}"
    )
    client.wait_for_service(2.0)
    value = ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=2)
    request = kind.Request(parameters=[ParameterMessage(name="a", value=value)])
    future = client.call_async(request)
    raised = spins(node, future.done, seconds=1.0)
    answer = future.result() if future.done() else "no answer"
    return raised, answer, node.get_parameter("a").value


lines(
    "changing",
    on_set=lambda: changing(thrower(OwnError())),
    on_set_atomically=lambda: changing(thrower(OwnError()), SetParametersAtomically),
    on_set_nothing=lambda: changing(lambda _: None),
    on_set_true=lambda: changing(lambda _: True),
    post_set=lambda: changing(thrower(OwnError()), what="post_set"),
    post_set_atomically=lambda: changing(thrower(OwnError()), SetParametersAtomically, "post_set"),
    pre_set=lambda: changing(thrower(OwnError()), what="pre_set"),
    pre_set_nothing=lambda: changing(lambda _: None, what="pre_set"),
    pre_set_empty=lambda: changing(lambda _: [], what="pre_set"),
    pre_set_empty_atomically=lambda: changing(lambda _: [], SetParametersAtomically, "pre_set"),
    pre_set_other=lambda: changing(lambda _: [Parameter("b", value=3)], what="pre_set"),
    pre_set_text=lambda: changing(lambda _: [Parameter("a", value="x")], what="pre_set"),
)


def matching(side: Any) -> Any:
    """Fail in the callback of a match; return the exceptions and how often it was called."""
    node, calls = Node("n"), []
    callback = first_fails(OwnError(), calls)
    if side == "publisher":
        events = PublisherEventCallbacks(matched=callback)
        node.create_publisher(String, "t", 1, event_callbacks=events)
        node.create_subscription(String, "t", print, 1)
    else:
        events = SubscriptionEventCallbacks(matched=callback)
        node.create_subscription(String, "t", print, 1, event_callbacks=events)
        node.create_publisher(String, "t", 1)
    return spins(node, lambda: calls), len(calls)


def global_spin(error: Any, call: Any) -> Any:
    """Return the outcome of a function that spins while a timer fails, and of a second call."""
    node, calls = Node("n"), []
    node.create_timer(0.03, first_fails(error, calls))
    first = outcome(call, node)
    second = outcome(rclpy.spin_once, node, timeout_sec=1.0)
    return first, second, len(calls), rclpy.ok(), node.executor is None


def later(node: Any) -> None:
    rclpy.spin_until_future_complete(node, Future(), timeout_sec=1.0)


lines(
    "event",
    publisher=lambda: matching("publisher"),
    subscription=lambda: matching("subscription"),
)
for _name, _call in {
    "spin": rclpy.spin,
    "spin_once": rclpy.spin_once,
    "spin_until": later,
}.items():
    lines(
        _name,
        **{
            name: (lambda call=_call, name=name: global_spin(ERRORS[name](), call))
            for name in ("own", "stop_iteration", "exit", "interrupt", "external", "timeout")
        },
    )


if __name__ == "__main__":
    main()
