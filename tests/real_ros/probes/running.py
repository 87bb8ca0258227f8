# mypy: ignore-errors
"""Timers, executors, tasks, waits, services, lifecycle nodes and events while they run.

Many of the calls are wrong on purpose.
"""

import asyncio
import threading
import time
from typing import Any

import rclpy
from probing import Fibonacci, lines, main, outcome, probe
from rclpy.action import ActionClient, ActionServer
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.duration import Duration
from rclpy.event_handler import (
    PublisherEventCallbacks,
    SubscriptionEventCallbacks,
    UnsupportedEventTypeError,
)
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.task import Future, Task
from rclpy.timer import Rate, Timer
from rclpy.wait_for_message import wait_for_message
from std_msgs.msg import Int32, String
from std_srvs.srv import SetBool, Trigger


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


def _spin(node: Any, seconds: Any) -> None:
    _until(lambda: False, node, limit=seconds)


def _timer(change: Any, period: Any = 0.1, seconds: Any = 0.55) -> Any:
    """Count the calls of a timer after `change(timer)`."""
    node, calls = Node("n"), []
    timer = node.create_timer(period, lambda: calls.append(1))
    found = outcome(change, timer)
    _spin(node, seconds)
    return [found, len(calls)]


def _set_period(timer: Any) -> None:
    timer.timer_period_ns = 50_000_000


def _replace_callback(timer: Any) -> None:
    timer.callback = lambda: None


lines(
    "timer",
    unchanged=lambda: _timer(lambda timer: None),
    canceled=lambda: _timer(lambda timer: timer.cancel()),
    canceled_twice=lambda: _timer(lambda timer: (timer.cancel(), timer.cancel(), timer.is_canceled())),
    canceled_and_reset=lambda: _timer(lambda timer: (timer.cancel(), timer.reset(), timer.is_canceled())),
    other_period=lambda: _timer(_set_period),
    other_callback=lambda: _timer(_replace_callback),
    called_by_hand=lambda: _timer(lambda timer: timer.callback()),
    destroyed=lambda: _timer(lambda timer: timer.destroy()),
    reset_again_and_again=lambda: _reset_often(),
    canceled_by_another=lambda: _canceled_by_another(),
    period_ns=lambda: [Node("n").create_timer(p, print).timer_period_ns for p in (0.1, 1 / 3, 1e-9, 2)],
    callback_is_class=lambda: _timer_with(list),
    callback_is_async=lambda: _async_timer(),
    callback_returns=lambda: _timer_with(lambda: 5),
    autostart=lambda: Node("n").create_timer(1.0, print, autostart=False).is_canceled(),
    autostart_reset=lambda: _autostart(),
    keyword_names=lambda: Node("n").create_timer(timer_period_sec=1.0, callback=print).timer_period_ns,
    without_callback=lambda: Node("n").create_timer(1.0),
    numpy_period=lambda: Node("n").create_timer(__import__("numpy").float32(0.5), print).timer_period_ns,
    same_twice=lambda: _removed_twice(),
    kind=lambda: isinstance(Node("n").create_timer(1.0, print), Timer),
    rate_kind=lambda: isinstance(Node("n").create_rate(1.0), Rate),
    raises_in_many_threads=lambda: _raises_in_many_threads(),
)


def _reset_often() -> Any:
    node, calls = Node("n"), []
    slow = node.create_timer(0.3, lambda: calls.append("slow"))
    node.create_timer(0.1, slow.reset)
    _spin(node, 1.0)
    return calls


def _canceled_by_another() -> Any:
    node, calls = Node("n"), []
    first = node.create_timer(0.1, lambda: calls.append("first"))
    node.create_timer(0.25, lambda: first.cancel())
    _spin(node, 0.7)
    return calls


def _timer_with(callback: Any) -> Any:
    node = Node("n")
    node.create_timer(0.05, callback)
    return outcome(_spin, node, 0.2)


def _async_timer() -> Any:
    node, calls = Node("n"), []

    async def tick() -> None:
        calls.append(1)

    node.create_timer(0.1, tick)
    _spin(node, 0.35)
    return len(calls)


def _autostart() -> Any:
    node, calls = Node("n"), []
    timer = node.create_timer(0.1, lambda: calls.append(1), autostart=False)
    _spin(node, 0.3)
    before = len(calls)
    timer.reset()
    _spin(node, 0.35)
    return [before, len(calls)]


def _removed_twice() -> Any:
    node = Node("n")
    timer = node.create_timer(1.0, print)
    return [node.destroy_timer(timer), node.destroy_timer(timer), len(list(node.timers))]


def _raises_in_many_threads() -> Any:
    node = Node("n")
    node.create_timer(0.05, lambda: 1 / 0)
    executor = MultiThreadedExecutor(2)
    executor.add_node(node)
    found = outcome(executor.spin)
    executor.shutdown()
    return found


def _waiting(limit: Any = 2.0, period: Any = 0.1, qos: Any = 1, **more: Any) -> Any:
    node, other = Node("n"), Node("m")
    publisher = other.create_publisher(Int32, "t", qos)
    node.create_subscription(Int32, "t", lambda m: None, qos)
    stop = threading.Event()

    def publish() -> None:
        number = 0
        while not stop.is_set():
            publisher.publish(Int32(data=number))
            number += 1
            time.sleep(period)

    thread = threading.Thread(target=publish, daemon=True)
    thread.start()
    found = outcome(wait_for_message, Int32, node, "t", time_to_wait=limit, **more)
    stop.set()
    thread.join(2.0)
    return found.replace("data=1)", "data=0)").replace("data=2)", "data=0)")


def _latched() -> Any:
    node = Node("n")
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_publisher(String, "t", latched).publish(String(data="kept"))
    return [
        wait_for_message(String, node, "t", qos_profile=latched, time_to_wait=2.0),
        wait_for_message(String, node, "t", time_to_wait=0.2),
    ]


lines(
    "wait_for_message",
    comes=lambda: _waiting()[:6],
    in_vain=lambda: wait_for_message(Int32, Node("n"), "t", time_to_wait=0.1),
    zero=lambda: wait_for_message(Int32, Node("n"), "t", time_to_wait=0),
    latched=_latched,
    text_limit=lambda: wait_for_message(Int32, Node("n"), "t", time_to_wait="1"),
    bad_topic=lambda: wait_for_message(Int32, Node("n"), "a b", time_to_wait=0.1),
    wrong_type=lambda: wait_for_message(Trigger, Node("n"), "t", time_to_wait=0.1),
    no_node=lambda: wait_for_message(Int32, None, "t", time_to_wait=0.1),
    leaves_nothing=lambda: _leaves_nothing(),
    after_shutdown=lambda: (
        lambda node: (rclpy.shutdown(), wait_for_message(Int32, node, "t", time_to_wait=0.1))
    )(Node("n")),
)


def _leaves_nothing() -> Any:
    node = Node("n")
    wait_for_message(Int32, node, "t", time_to_wait=0.1)
    return len(list(node.subscriptions))


def _task(callback: Any, *args: Any, rounds: Any = 10) -> Any:
    executor = SingleThreadedExecutor()
    task = executor.create_task(callback, *args)
    errors = [outcome(executor.spin_once, timeout_sec=0.02) for _ in range(rounds)]
    return [task.done(), outcome(task.result), sorted({e for e in errors if e != "None"})]


async def _sleeps() -> Any:
    await asyncio.sleep(0)
    return 4


async def _sleeps_long() -> Any:
    await asyncio.sleep(0.01)
    return 4


async def _gathers() -> Any:
    return await asyncio.gather(_sleeps(), _sleeps())


def _generator() -> Any:
    yield 1


lines(
    "task",
    bare_sleep=lambda: _task(_sleeps),
    asyncio_sleep=lambda: _task(_sleeps_long),
    asyncio_gather=lambda: _task(_gathers),
    generator=lambda: _task(_generator)[0],
    class_=lambda: _task(list),
    method=lambda: _task([3, 1].sort),
    lambda_of_coroutine=lambda: _task(lambda: _sleeps())[0],
    returns_future=lambda: _task(lambda: Future())[0],
    cancel_itself=lambda: _cancels_itself(),
    done_callback=lambda: _done_callback(),
    order=lambda: _order_of_tasks(),
    adds_tasks=lambda: _adds_tasks(),
    exception=lambda: _task(lambda: [][1]),
    rounds=lambda: _rounds_of_tasks(),
    polled_order=lambda: _order_of_tasks(limit=0),
    state=lambda: _states_of_a_task(),
    awaits_done_future=lambda: _awaits_done(),
    kind=lambda: isinstance(SingleThreadedExecutor().create_task(print), Task),
)


def _cancels_itself() -> Any:
    executor, kept = SingleThreadedExecutor(), []
    kept.append(executor.create_task(lambda: kept[0].cancel()))
    executor.spin_once(timeout_sec=0.02)
    return [kept[0].cancelled(), kept[0].done()]


def _done_callback() -> Any:
    executor, order = SingleThreadedExecutor(), []
    task = executor.create_task(lambda: order.append("task"))
    task.add_done_callback(lambda t: order.append(t is task))
    for _ in range(4):
        executor.spin_once(timeout_sec=0.02)
    return order


def _order_of_tasks(limit: Any = 0.02) -> Any:
    executor, order = SingleThreadedExecutor(), []
    for at in range(4):
        executor.create_task(order.append, at)
    for _ in range(6):
        executor.spin_once(timeout_sec=limit)
    return order


def _rounds_of_tasks() -> Any:
    executor, order = SingleThreadedExecutor(), []

    async def poll(name: Any) -> None:
        for _ in range(3):
            order.append(name)
            if name == "c" and len(order) == 1:
                executor.create_task(order.append, "new")
            await asyncio.sleep(0)

    for name in "abc":
        executor.create_task(poll, name)
    for _ in range(20):
        executor.spin_once(timeout_sec=0.01)
    return order


def _adds_tasks() -> Any:
    executor, order = SingleThreadedExecutor(), []

    def first() -> None:
        order.append("first")
        executor.create_task(order.append, "third")

    executor.create_task(first)
    executor.create_task(order.append, "second")
    for _ in range(6):
        executor.spin_once(timeout_sec=0.02)
    return order


def _states_of_a_task() -> Any:
    executor = SingleThreadedExecutor()
    task = executor.create_task(lambda: 1)
    before = [task.done(), task.cancelled(), task.executing()]
    executor.spin_once(timeout_sec=0.02)
    return [*before, task.done(), task.cancelled(), task.executing()]


def _awaits_done() -> Any:
    future = Future()
    future.set_result(9)

    async def wait() -> Any:
        return await future

    return _task(wait)


@probe
def polling_coroutine_beside_callbacks() -> Any:
    node, ticks, executor = Node("n"), [], SingleThreadedExecutor()
    executor.add_node(node)
    node.create_timer(0.05, lambda: ticks.append(1))

    async def poll() -> str:
        while len(ticks) < 3:
            await asyncio.sleep(0)
        return "seen"

    task = executor.create_task(poll)
    executor.spin_until_future_complete(task, timeout_sec=3.0)
    return [task.done(), len(ticks)]


def _client(limit: Any = 2.0) -> Any:
    node = Node("n")
    node.create_service(SetBool, "s", lambda request, response: response)
    client = node.create_client(SetBool, "s")
    client.wait_for_service(timeout_sec=limit)
    return node, client


def _asked(change: Any, seconds: Any = 0.4) -> Any:
    node, client = _client()
    future = client.call_async(SetBool.Request())
    found = outcome(change, node, client, future)
    _spin(node, seconds)
    return [found, future.done(), future.cancelled()]


lines(
    "request",
    plain=lambda: _asked(lambda node, client, future: None),
    canceled=lambda: _asked(lambda node, client, future: future.cancel()),
    removed=lambda: _asked(lambda node, client, future: client.remove_pending_request(future)),
    set_by_hand=lambda: _asked(lambda node, client, future: future.set_result(3)),
    client_destroyed=lambda: _asked(lambda node, client, future: node.destroy_client(client)),
    service_destroyed=lambda: _asked(lambda node, client, future: _destroy_services(node)),
    callback_added_later=lambda: _asked_with_callback(),
    result_before=lambda: _asked(lambda node, client, future: future.result()),
    sequence=lambda: _sequence_of_requests(),
    call_in_spin=lambda: _call_with_limit(),
    ready=lambda: [client.service_is_ready() for node, client in [_client()]],
    ready_after_destruction=lambda: _ready_after_destruction(),
    two_services=lambda: _two_services(),
    keyword_names=lambda: Node("n").create_client(srv_type=Trigger, srv_name="s").srv_name,
    service_keyword_names=lambda: (
        Node("n").create_service(srv_type=Trigger, srv_name="s", callback=print) is not None
    ),
    without_callback=lambda: Node("n").create_service(Trigger, "s"),
)


def _destroy_services(node: Any) -> Any:
    return [node.destroy_service(one) for one in list(node.services) if one.srv_name == "s"]


def _asked_with_callback() -> Any:
    node, client = _client()
    future, seen = client.call_async(SetBool.Request()), []
    _until(future.done, node)
    future.add_done_callback(lambda f: seen.append(f is future))
    before = list(seen)
    _spin(node, 0.1)
    return [before, seen]


def _sequence_of_requests() -> Any:
    _node, client = _client()
    futures = [client.call_async(SetBool.Request()) for _ in range(3)]
    return [client.get_pending_request(number) is futures[number - 1] for number in (1, 2, 3)]


def _call_with_limit() -> Any:
    client = Node("n").create_client(Trigger, "nobody")
    return outcome(client.call, Trigger.Request(), timeout_sec=0.1)


def _ready_after_destruction() -> Any:
    node, client = _client()
    _destroy_services(node)
    _spin(node, 0.2)
    return client.service_is_ready()


def _two_services() -> Any:
    node, seen = Node("n"), []
    for name in ("first", "second"):
        node.create_service(
            Trigger, "s", lambda request, response, name=name: (seen.append(name), response)[1]
        )
    client = node.create_client(Trigger, "s")
    client.wait_for_service(timeout_sec=2.0)
    future = client.call_async(Trigger.Request())
    _until(future.done, node)
    _spin(node, 0.2)
    return sorted(set(seen))


class _Managed(LifecycleNode):
    def __init__(self, **results: Any) -> None:
        super().__init__("managed")
        self.results, self.calls = results, []

    def _answer(self, name: Any) -> Any:
        self.calls.append(name)
        result = self.results.get(name, TransitionCallbackReturn.SUCCESS)
        if isinstance(result, Exception):
            raise result
        return result

    def on_configure(self, state: Any) -> Any:
        return self._answer("configure")

    def on_activate(self, state: Any) -> Any:
        self.calls.append(state.label)
        super().on_activate(state)
        return self._answer("activate")

    def on_deactivate(self, state: Any) -> Any:
        super().on_deactivate(state)
        return self._answer("deactivate")

    def on_cleanup(self, state: Any) -> Any:
        return self._answer("cleanup")

    def on_shutdown(self, state: Any) -> Any:
        return self._answer("shutdown")

    def on_error(self, state: Any) -> Any:
        return self._answer("error")


_FAILURE, _ERROR = TransitionCallbackReturn.FAILURE, TransitionCallbackReturn.ERROR


def _life(*steps: Any, **results: Any) -> Any:
    node = _Managed(**results)
    answers = [outcome(getattr(node, f"trigger_{step}")) for step in steps]
    return [answers, node.calls, node._state_machine.current_state]


lines(
    "life",
    configure=lambda: _life("configure"),
    activate=lambda: _life("configure", "activate"),
    around=lambda: _life("configure", "activate", "deactivate", "cleanup", "configure"),
    shutdown_active=lambda: _life("configure", "activate", "shutdown"),
    shutdown_unconfigured=lambda: _life("shutdown"),
    activate_first=lambda: _life("activate"),
    configure_twice=lambda: _life("configure", "configure"),
    configure_fails=lambda: _life("configure", configure=_FAILURE),
    activate_fails=lambda: _life("configure", "activate", activate=_FAILURE),
    deactivate_fails=lambda: _life("configure", "activate", "deactivate", deactivate=_FAILURE),
    cleanup_fails=lambda: _life("configure", "cleanup", cleanup=_FAILURE),
    shutdown_fails=lambda: _life("configure", "shutdown", shutdown=_FAILURE),
    error_recovers=lambda: _life("configure", configure=_ERROR),
    error_fails=lambda: _life("configure", configure=_ERROR, error=_FAILURE),
    error_in_activate=lambda: _life("configure", "activate", activate=_ERROR),
    error_errs=lambda: _life("configure", configure=_ERROR, error=_ERROR),
    raises=lambda: _life("configure", configure=ValueError("why")),
    error_raises=lambda: _life("configure", configure=_ERROR, error=ValueError("why")),
    after_the_end=lambda: _life("shutdown", "configure"),
    text_result=lambda: _life("configure", configure="SUCCESS"),
    bool_result=lambda: _life("configure", configure=True),
)


def _partners(offered: Any, requested: Any) -> Any:
    node, seen = Node("n"), []
    publisher = node.create_publisher(
        Int32,
        "t",
        offered,
        event_callbacks=PublisherEventCallbacks(
            incompatible_qos=lambda info: seen.append(("offered", info.total_count)),
            matched=lambda info: seen.append(("matched", info.current_count)),
        ),
    )
    subscription = node.create_subscription(
        Int32,
        "t",
        print,
        requested,
        event_callbacks=SubscriptionEventCallbacks(
            incompatible_qos=lambda info: seen.append(("requested", info.total_count)),
            matched=lambda info: seen.append(("matched by", info.current_count)),
        ),
    )
    _until(lambda: len(seen) >= 2, node)
    return [sorted(seen), publisher.get_subscription_count(), subscription.get_publisher_count()]


_UNSET = SubscriptionEventCallbacks()
_BEST_EFFORT = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
lines(
    "partners",
    equal=lambda: _partners(1, 1),
    incompatible=lambda: _partners(_BEST_EFFORT, 1),
    better=lambda: _partners(1, _BEST_EFFORT),
    deadline=lambda: _partners(
        QoSProfile(depth=1, deadline=Duration(seconds=2)), QoSProfile(depth=1, deadline=Duration(seconds=1))
    ),
    event_callbacks_of_the_wrong_kind=lambda: Node("n").create_publisher(
        Int32, "t", 1, event_callbacks=SubscriptionEventCallbacks()
    ),
    unsupported=lambda: issubclass(UnsupportedEventTypeError, Exception),
    use_default=lambda: PublisherEventCallbacks(use_default_callbacks=False).incompatible_qos,
    text_callback=lambda: _text_event(),
    old_module=lambda: __import__("rclpy.qos_event").__name__,
    assigned=lambda: _assigned_event(),
    unknown_attribute=lambda: PublisherEventCallbacks().message_lost,
    attributes=lambda: [SubscriptionEventCallbacks(matched=print).matched is print, _UNSET.message_lost],
)


def _assigned_event() -> Any:
    node, seen = Node("n"), []
    events = SubscriptionEventCallbacks()
    events.matched = lambda info: seen.append(info.current_count)
    node.create_subscription(Int32, "t", print, 1, event_callbacks=events)
    node.create_publisher(Int32, "t", 1)
    _until(lambda: seen, node)
    return seen


def _text_event() -> Any:
    node = Node("n")
    events = SubscriptionEventCallbacks(matched="x")
    node.create_subscription(Int32, "t", print, 1, event_callbacks=events)
    node.create_publisher(Int32, "t", 1)
    return outcome(_spin, node, 0.3)


def _in_executor(use: Any, threads: Any = 0) -> Any:
    node = Node("n")
    executor = MultiThreadedExecutor(threads) if threads else SingleThreadedExecutor()
    executor.add_node(node)
    found = outcome(use, executor, node)
    executor.shutdown()
    return found


lines(
    "executor",
    remove_twice=lambda: _in_executor(lambda e, n: (e.remove_node(n), e.remove_node(n), e.get_nodes())),
    node_of_executor=lambda: _in_executor(lambda e, n: [n.executor is e, e.remove_node(n), n.executor]),
    shutdown_forgets=lambda: _in_executor(lambda e, n: (e.shutdown(), len(list(e.get_nodes())))),
    spin_once_after_shutdown=lambda: _in_executor(lambda e, n: (e.shutdown(), e.spin_once(timeout_sec=0.1))),
    create_task_without_callable=lambda: _in_executor(lambda e, n: e.create_task(3).done()),
    spin_until_condition=lambda: _in_executor(lambda e, n: e.spin_until_future_complete(None)),
    spin_once_until=lambda: _in_executor(
        lambda e, n: e.spin_once_until_future_complete(Future(), timeout_sec=0.05)
    ),
    many_spin_once_until=lambda: _in_executor(
        lambda e, n: e.spin_once_until_future_complete(Future(), timeout_sec=0.05), 2
    ),
    destroyed_node_stays=lambda: _in_executor(lambda e, n: (n.destroy_node(), len(list(e.get_nodes())))),
    destroyed_node_spun=lambda: _in_executor(lambda e, n: (n.destroy_node(), e.spin_once(timeout_sec=0.05))),
    add_destroyed=lambda: _add_destroyed(),
    context_of_another=lambda: SingleThreadedExecutor(context=rclpy.get_default_context()).context.ok(),
    threads_zero=lambda: MultiThreadedExecutor(0),
    threads_keyword=lambda: (
        MultiThreadedExecutor(num_threads=3)._num_threads
        if hasattr(MultiThreadedExecutor(num_threads=3), "_num_threads")
        else 3
    ),
    wake=lambda: _in_executor(lambda e, n: e.wake()),
    spin_global=lambda: rclpy.get_global_executor() is rclpy.get_global_executor(),
    spin_until_with_node_none=lambda: rclpy.spin_until_future_complete(None, Future(), timeout_sec=0.1),
    group_default=lambda: isinstance(Node("n").default_callback_group, MutuallyExclusiveCallbackGroup),
    group_of_two_nodes=lambda: _group_of_two_nodes(),
)


def _add_destroyed() -> Any:
    node = Node("n")
    node.destroy_node()
    executor = SingleThreadedExecutor()
    return [outcome(executor.add_node, node), outcome(executor.spin_once, timeout_sec=0.05)]


def _group_of_two_nodes() -> Any:
    group, calls = ReentrantCallbackGroup(), []
    nodes = [Node("a"), Node("b")]
    for node in nodes:
        node.create_timer(0.05, lambda: calls.append(1), callback_group=group)
    _until(lambda: len(calls) >= 4, *nodes)
    return len(calls) >= 4


def _guarded(use: Any) -> Any:
    node, calls = Node("n"), []
    guard = node.create_guard_condition(lambda: calls.append(1))
    found = outcome(use, node, guard)
    _spin(node, 0.1)
    return [found, len(calls), len(list(node.guards))]


lines(
    "guard",
    triggered=lambda: _guarded(lambda node, guard: guard.trigger()),
    group=lambda: Node("n").create_guard_condition(print).callback_group is not None,
    destroyed=lambda: _guarded(lambda node, guard: node.destroy_guard_condition(guard)),
    destroyed_and_triggered=lambda: _guarded(
        lambda node, guard: (node.destroy_guard_condition(guard), guard.trigger())
    ),
    triggered_and_destroyed=lambda: _guarded(
        lambda node, guard: (guard.trigger(), node.destroy_guard_condition(guard))
    ),
    foreign=lambda: Node("n").destroy_guard_condition(Node("m").create_guard_condition(print)),
    argument=lambda: _guarded(lambda node, guard: guard.trigger(1)),
)


def _parameters_of(use: Any) -> Any:
    server, user = Node("server"), Node("user")
    server.declare_parameter("a", 1)
    client = AsyncParameterClient(user, "server")
    client.wait_for_services(timeout_sec=2.0)
    future = use(client)
    _until(future.done, server, user)
    return future.result()


lines(
    "parameter_client",
    get=lambda: _parameters_of(lambda c: c.get_parameters(["a"])).values[0].integer_value,
    get_missing=lambda: len(_parameters_of(lambda c: c.get_parameters(["b"])).values),
    set=lambda: _parameters_of(lambda c: c.set_parameters([Parameter("a", value=2)])).results[0].successful,
    set_wrong_type=lambda: (
        _parameters_of(lambda c: c.set_parameters([Parameter("a", value="x")])).results[0].reason
    ),
    set_undeclared=lambda: (
        _parameters_of(lambda c: c.set_parameters([Parameter("b", value=1)])).results[0].reason
    ),
    types=lambda: _parameters_of(lambda c: c.get_parameter_types(["a"])).types.tolist(),
    describe=lambda: _parameters_of(lambda c: c.describe_parameters(["a"])).descriptors[0].type,
    listed=lambda: _parameters_of(lambda c: c.list_parameters(["a"], 1)).result.names,
    deleted=lambda: _parameters_of(lambda c: c.delete_parameters(["a"])).results[0].reason,
    atomically=lambda: (
        _parameters_of(lambda c: c.set_parameters_atomically([Parameter("a", value=3)])).result.successful
    ),
    no_server=lambda: AsyncParameterClient(Node("n"), "nobody").wait_for_services(timeout_sec=0.1),
    ready=lambda: AsyncParameterClient(Node("n"), "nobody").services_are_ready(),
    get_text=lambda: AsyncParameterClient(Node("n"), "nobody").get_parameters("a").done(),
)

_ACTION = "f"


def _server_of(**more: Any) -> Any:
    return ActionServer(Node("n"), Fibonacci, _ACTION, lambda handle: Fibonacci.Result(), **more)


lines(
    "action",
    two_servers=lambda: _two_servers(),
    destroy_twice=lambda: (lambda server: [server.destroy(), outcome(server.destroy)])(_server_of()),
    client_destroy_twice=lambda: (lambda client: [client.destroy(), outcome(client.destroy)])(
        ActionClient(Node("n"), Fibonacci, _ACTION)
    ),
    timeout_negative=lambda: _server_of(result_timeout=-1) is not None,
    timeout_text=lambda: _server_of(result_timeout="x"),
    keyword_names=lambda: (
        ActionServer(node=Node("n"), action_type=Fibonacci, action_name=_ACTION, execute_callback=print)
        is not None
    ),
    node_none=lambda: ActionServer(None, Fibonacci, _ACTION, print),
    client_node_none=lambda: ActionClient(None, Fibonacci, _ACTION),
    wait_text=lambda: ActionClient(Node("n"), Fibonacci, _ACTION).wait_for_server(timeout_sec="1"),
    wait_negative=lambda: ActionClient(Node("n"), Fibonacci, _ACTION).wait_for_server(timeout_sec=0.05),
    send_without_server=lambda: (
        ActionClient(Node("n"), Fibonacci, _ACTION).send_goal_async(Fibonacci.Goal()).done()
    ),
    send_none=lambda: ActionClient(Node("n"), Fibonacci, _ACTION).send_goal_async(None),
)


def _two_servers() -> Any:
    node = Node("n")
    first = ActionServer(node, Fibonacci, _ACTION, print)
    second = outcome(lambda: ActionServer(node, Fibonacci, _ACTION, print) is not None)
    return [first is not None, second]


if __name__ == "__main__":
    main()
