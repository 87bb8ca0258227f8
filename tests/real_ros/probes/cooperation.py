# mypy: ignore-errors
"""What ordinary programs do with goals, callback groups, simulated time, executors and timers.

Many of the calls are wrong on purpose.
"""

import threading
import time
from functools import partial
from typing import Any

import rclpy
from action_msgs.msg import GoalStatus
from action_msgs.srv import CancelGoal
from builtin_interfaces.msg import Time as TimeMessage
from probing import Fibonacci, lines, main, outcome, spun
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.clock import Clock, ClockType, JumpThreshold
from rclpy.duration import Duration
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.time import Time
from rosgraph_msgs.msg import Clock as ClockMessage
from std_srvs.srv import Trigger


class Server:
    """A node with an action server and client, spun by several threads."""

    def __init__(self, execute: Any, **options: Any) -> None:
        self.node, self.log = Node("n"), []
        group = ReentrantCallbackGroup()
        self.server = ActionServer(
            self.node, Fibonacci, "fib", lambda h: execute(self, h), callback_group=group, **options
        )
        self.client = ActionClient(self.node, Fibonacci, "fib", callback_group=group)
        self.executor = MultiThreadedExecutor(4)
        self.executor.add_node(self.node)
        self.client.wait_for_server(3.0)

    def wait(self, future: Any, seconds: float = 3.0) -> Any:
        self.executor.spin_until_future_complete(future, seconds)
        return future.result() if future.done() else "pending"

    def send(self, order: int = 3, **options: Any) -> Any:
        goal = Fibonacci.Goal()
        goal.order = order
        return self.wait(self.client.send_goal_async(goal, **options))

    def result(self, handle: Any) -> Any:
        reply = self.wait(handle.get_result_async())
        return "pending" if reply == "pending" else (reply.status, list(reply.result.sequence))


def feedback(execute: Any, order: int = 3) -> Any:
    server, received = Server(execute), []

    def on_feedback(message: Any) -> None:
        received.append((type(message).__name__, list(message.feedback.sequence)))

    handle = server.send(order, feedback_callback=on_feedback)
    result = server.result(handle)
    end = time.monotonic() + 1.0
    while len(received) < order and time.monotonic() < end:
        server.executor.spin_once(timeout_sec=0.05)
    server.executor.shutdown()
    return result, received


def publishes(server: Any, handle: Any) -> Any:
    message = Fibonacci.Feedback()
    for number in range(handle.request.order):
        message.sequence = [*message.sequence, number]
        handle.publish_feedback(message)
        time.sleep(0.05)
    handle.succeed()
    return Fibonacci.Result(sequence=message.sequence)


def publishes_after_the_end(server: Any, handle: Any) -> Any:
    handle.succeed()
    server.log.append(outcome(handle.publish_feedback, Fibonacci.Feedback()))
    return Fibonacci.Result()


def waits_for_cancel(server: Any, handle: Any) -> Any:
    for _ in range(60):
        if handle.is_cancel_requested:
            server.log.append((handle.status, handle.is_active))
            handle.canceled()
            server.log.append((handle.status, handle.is_active))
            return Fibonacci.Result(sequence=[8])
        time.sleep(0.05)
    handle.succeed()
    return Fibonacci.Result(sequence=[1])


def succeeds_though_cancelled(server: Any, handle: Any) -> Any:
    for _ in range(60):
        if handle.is_cancel_requested:
            break
        time.sleep(0.05)
    handle.succeed()
    return Fibonacci.Result(sequence=[5])


def cancelled(execute: Any, accept: Any = CancelResponse.ACCEPT, times: int = 1) -> Any:
    server = Server(execute, cancel_callback=lambda handle: accept)
    handle = server.send()
    replies = []
    for _ in range(times):
        reply = server.wait(handle.cancel_goal_async())
        replies.append((reply.return_code, len(reply.goals_canceling)))
    result = server.result(handle)
    late = server.wait(handle.cancel_goal_async())
    server.executor.shutdown()
    return (
        handle.accepted,
        handle.status,
        replies,
        result,
        (late.return_code, len(late.goals_canceling)),
        server.log,
    )


def returns_quickly(server: Any, handle: Any) -> Any:
    handle.succeed()
    return Fibonacci.Result(sequence=[1])


def with_server(use: Any, execute: Any = returns_quickly, **options: Any) -> Any:
    server = Server(execute, **options)
    try:
        return use(server)
    finally:
        server.executor.shutdown()


def cancel_all(server: Any) -> Any:
    handles = [server.send() for _ in range(2)]
    client = server.node.create_client(
        CancelGoal, "fib/_action/cancel_goal", callback_group=ReentrantCallbackGroup()
    )
    client.wait_for_service(2.0)
    reply = server.wait(client.call_async(CancelGoal.Request()))
    results = [server.result(handle) for handle in handles]
    return reply.return_code, len(reply.goals_canceling), results


def cancel_unknown(server: Any) -> Any:
    client = server.node.create_client(
        CancelGoal, "fib/_action/cancel_goal", callback_group=ReentrantCallbackGroup()
    )
    client.wait_for_service(2.0)
    request = CancelGoal.Request()
    request.goal_info.goal_id.uuid = [7] * 16
    reply = server.wait(client.call_async(request))
    return reply.return_code, len(reply.goals_canceling)


def statuses(server: Any) -> Any:
    from action_msgs.msg import GoalStatusArray

    seen = []
    latched = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)

    def on_status(message: Any) -> None:
        seen.extend(one.status for one in message.status_list)

    server.node.create_subscription(GoalStatusArray, "fib/_action/status", on_status, latched)
    server.result(server.send())
    end = time.monotonic() + 1.0
    while GoalStatus.STATUS_SUCCEEDED not in seen and time.monotonic() < end:
        server.executor.spin_once(timeout_sec=0.05)
    return sorted(set(seen)), seen[-1]


def accepted_later(server: Any) -> Any:
    handle = server.send()
    server.log.append(type(handle.goal_id).__name__)
    pending = server.wait(handle.get_result_async(), 0.3)
    server.kept[0].execute()
    return pending, server.result(handle), server.log


def deferred() -> Any:
    kept: list[Any] = []
    server = Server(returns_quickly, handle_accepted_callback=kept.append)
    server.kept = kept
    try:
        return accepted_later(server)
    finally:
        server.executor.shutdown()


def goal_ids(server: Any) -> Any:
    from unique_identifier_msgs.msg import UUID

    chosen = UUID(uuid=list(range(16)))
    goal = Fibonacci.Goal()
    first = server.wait(server.client.send_goal_async(goal, goal_uuid=chosen))
    second = server.wait(server.client.send_goal_async(goal, goal_uuid=chosen), 1.0)
    return first.accepted, list(first.goal_id.uuid) == list(range(16)), getattr(second, "accepted", second)


def sent_synchronously(server: Any) -> Any:
    thread = threading.Thread(target=server.executor.spin, daemon=True)
    thread.start()
    goal = Fibonacci.Goal()
    goal.order = 2
    reply = server.client.send_goal(goal)
    return type(reply).__name__, reply.status, list(reply.result.sequence)


lines(
    "feedback",
    arrives=lambda: feedback(publishes),
    of_one=lambda: feedback(publishes, 1),
    without_callback=lambda: with_server(lambda s: s.result(s.send(2)), publishes),
    after_the_end=lambda: with_server(lambda s: (s.result(s.send()), s.log), publishes_after_the_end),
    callback_none=lambda: with_server(lambda s: s.result(s.send(1, feedback_callback=None)), publishes),
    fields=lambda: sorted(Fibonacci.Impl.FeedbackMessage.get_fields_and_field_types()),
    goal_request=lambda: sorted(Fibonacci.Impl.SendGoalService.Request.get_fields_and_field_types()),
    result_response=lambda: sorted(Fibonacci.Impl.GetResultService.Response.get_fields_and_field_types()),
)
lines(
    "cancel",
    accepted=lambda: cancelled(waits_for_cancel),
    rejected=lambda: with_server(
        lambda s: (lambda h: (s.wait(h.cancel_goal_async()).return_code, s.result(h)[0]))(s.send()),
        lambda s, h: (time.sleep(0.4), h.succeed(), Fibonacci.Result())[2],
        cancel_callback=lambda h: CancelResponse.REJECT,
    ),
    by_default=lambda: with_server(
        lambda s: (lambda h: (s.wait(h.cancel_goal_async()).return_code, s.result(h)[0]))(s.send()),
        lambda s, h: (time.sleep(0.4), h.succeed(), Fibonacci.Result())[2],
    ),
    twice=lambda: cancelled(waits_for_cancel, times=2)[2][0],
    succeeded_anyway=lambda: cancelled(succeeds_though_cancelled),
    all_goals=lambda: with_server(
        cancel_all, waits_for_cancel, cancel_callback=lambda handle: CancelResponse.ACCEPT
    ),
    unknown_goal=lambda: with_server(cancel_unknown, cancel_callback=lambda handle: CancelResponse.ACCEPT),
    after_the_end=lambda: with_server(
        lambda s: (lambda h: (s.result(h), s.wait(h.cancel_goal_async()).return_code))(s.send()),
        cancel_callback=lambda handle: CancelResponse.ACCEPT,
    ),
    statuses=lambda: with_server(statuses),
    deferred=deferred,
    goal_ids=lambda: with_server(goal_ids),
    sent_synchronously=lambda: with_server(sent_synchronously),
    responses=lambda: [list(GoalResponse), list(CancelResponse)],
    goal_rejected=lambda: with_server(
        lambda s: (lambda h: (h.accepted, h.status))(s.send()), goal_callback=lambda goal: GoalResponse.REJECT
    ),
    handle_text=lambda: with_server(lambda s: type(s.send()).__name__),
    server_ready=lambda: with_server(lambda s: (s.client.server_is_ready(), s.client.wait_for_server(0.1))),
    server_missing=lambda: ActionClient(Node("n"), Fibonacci, "none").wait_for_server(timeout_sec=0.2),
)


def order_in_group(make: Any, executor: Any) -> Any:
    """Return whether two callbacks of 0.2 s overlap, and whether both ran."""
    node, running, most, runs = Node("n"), [0], [0], []

    def work() -> None:
        running[0] += 1
        most[0] = max(most[0], running[0])
        time.sleep(0.2)
        running[0] -= 1
        runs.append(1)

    groups = make()
    for group in groups:
        node.create_timer(0.05, work, callback_group=group)
    executor.add_node(node)
    end = time.monotonic() + 1.5
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.05)
    executor.shutdown()
    return most[0], len(runs) > 2


def same(kind: Any) -> Any:
    def make() -> Any:
        group = kind()
        return group, group

    return make


def call_in_callback(kind: Any, threads: int) -> Any:
    """Call a service inside a timer's callback, with the client in a group of its own."""
    node, replies = Node("n"), []
    group = kind()
    node.create_service(
        Trigger,
        "t",
        lambda q, r: setattr(r, "message", "done") or r,
        callback_group=MutuallyExclusiveCallbackGroup(),
    )
    client = node.create_client(Trigger, "t", callback_group=MutuallyExclusiveCallbackGroup())

    def on_timer() -> None:
        timer.cancel()
        replies.append(client.call(Trigger.Request()).message)

    timer = node.create_timer(0.05, on_timer, callback_group=group)
    ready = spun(node, lambda: replies, 3.0, MultiThreadedExecutor(threads))
    return ready, replies


def awaited_in_callback() -> Any:
    """Await a service inside an async callback, with one thread."""
    node, replies = Node("n"), []
    node.create_service(Trigger, "t", lambda q, r: setattr(r, "message", "done") or r)
    client = node.create_client(Trigger, "t")

    async def on_timer() -> None:
        timer.cancel()
        reply = await client.call_async(Trigger.Request())
        replies.append(reply.message)

    timer = node.create_timer(0.05, on_timer)
    return spun(node, lambda: replies), replies


def group_of_entities() -> Any:
    node, group = Node("n"), ReentrantCallbackGroup()
    timer = node.create_timer(1.0, print, callback_group=group)
    other = node.create_timer(1.0, print)
    return (
        group.has_entity(timer),
        group.has_entity(other),
        timer.callback_group is group,
        other.callback_group is node.default_callback_group,
        group.can_execute(timer),
        group.beginning_execution(timer),
        type(node.default_callback_group).__name__,
    )


def exclusive_group() -> Any:
    node, group = Node("n"), MutuallyExclusiveCallbackGroup()
    one, two = (node.create_timer(1.0, print, callback_group=group) for _ in range(2))
    out = [
        group.can_execute(one),
        group.beginning_execution(one),
        group.can_execute(two),
        group.beginning_execution(two),
    ]
    group.ending_execution(one)
    return [*out, group.can_execute(two)]


def guard(executor: Any) -> Any:
    node, calls = Node("n"), []
    guard = node.create_guard_condition(lambda: calls.append(1))
    guard.trigger()
    guard.trigger()
    return spun(node, lambda: calls, 1.0, executor), calls, len(list(node.guards))


def guard_from_a_thread() -> Any:
    node, calls = Node("n"), []
    guard = node.create_guard_condition(lambda: calls.append(threading.current_thread().name))
    thread = threading.Timer(0.2, guard.trigger)
    thread.start()
    ready = spun(node, lambda: calls, 2.0)
    thread.join()
    return ready, calls


lines(
    "group",
    exclusive=lambda: order_in_group(same(MutuallyExclusiveCallbackGroup), MultiThreadedExecutor(4)),
    reentrant=lambda: order_in_group(same(ReentrantCallbackGroup), MultiThreadedExecutor(4)),
    default=lambda: order_in_group(lambda: (None, None), MultiThreadedExecutor(4)),
    two=lambda: order_in_group(
        lambda: (MutuallyExclusiveCallbackGroup(), MutuallyExclusiveCallbackGroup()), MultiThreadedExecutor(4)
    ),
    single_thread=lambda: order_in_group(same(ReentrantCallbackGroup), SingleThreadedExecutor()),
    call_in_exclusive=lambda: call_in_callback(MutuallyExclusiveCallbackGroup, 3),
    call_in_reentrant=lambda: call_in_callback(ReentrantCallbackGroup, 3),
    awaited=awaited_in_callback,
    entities=group_of_entities,
    exclusive_state=exclusive_group,
    guard_single=lambda: guard(SingleThreadedExecutor()),
    guard_multi=lambda: guard(MultiThreadedExecutor(2)),
    guard_thread=guard_from_a_thread,
)


def with_clock(use: Any, *, stamps: Any = (1.0, 2.0)) -> Any:
    """Use a node in simulated time after it has received stamps on /clock."""
    node = Node("n", parameter_overrides=[Parameter("use_sim_time", value=True)])
    source = Node("source")
    publisher = source.create_publisher(ClockMessage, "/clock", 10)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    end = time.monotonic() + 3.0
    while publisher.get_subscription_count() < 1 and time.monotonic() < end:
        executor.spin_once(timeout_sec=0.05)
    for stamp in stamps:
        publisher.publish(ClockMessage(clock=Time(nanoseconds=round(stamp * 1e9)).to_msg()))
        end = time.monotonic() + 3.0
        while node.get_clock().now().nanoseconds != round(stamp * 1e9) and time.monotonic() < end:
            executor.spin_once(timeout_sec=0.05)
    try:
        return use(node, publisher, executor)
    finally:
        executor.shutdown()


def sim_timer(node: Any, publisher: Any, executor: Any) -> Any:
    calls: list[int] = []
    node.create_timer(1.0, lambda: calls.append(node.get_clock().now().nanoseconds // 10**9))
    for stamp in (2.5, 3.0, 3.5, 4.1, 9.0):
        publisher.publish(ClockMessage(clock=Time(nanoseconds=round(stamp * 1e9)).to_msg()))
        end = time.monotonic() + 0.3
        while time.monotonic() < end:
            executor.spin_once(timeout_sec=0.05)
    return calls


def sim_jumps(node: Any, publisher: Any, executor: Any) -> Any:
    jumps: list[Any] = []
    threshold = JumpThreshold(
        min_forward=Duration(seconds=5), min_backward=Duration(nanoseconds=-1), on_clock_change=True
    )
    handle = node.get_clock().create_jump_callback(
        threshold, post_callback=lambda jump: jumps.append((jump.clock_change.name, jump.delta.nanoseconds))
    )
    for stamp in (3.0, 20.0, 1.0):
        publisher.publish(ClockMessage(clock=Time(nanoseconds=round(stamp * 1e9)).to_msg()))
        end = time.monotonic() + 3.0
        while node.get_clock().now().nanoseconds != round(stamp * 1e9) and time.monotonic() < end:
            executor.spin_once(timeout_sec=0.05)
    handle.unregister()
    return jumps


def switched_off(node: Any, publisher: Any, executor: Any) -> Any:
    before = node.get_clock().ros_time_is_active
    node.set_parameters([Parameter("use_sim_time", value=False)])
    after = node.get_clock().ros_time_is_active
    return (
        before,
        after,
        node.get_clock().now().nanoseconds > 10**18,
        outcome(node.set_parameters, [Parameter("use_sim_time", value="yes")]),
    )


def rate_in_a_thread() -> Any:
    node = Node("n")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin, daemon=True)
    thread.start()
    rate = node.create_rate(20.0)
    began = time.monotonic()
    for _ in range(10):
        rate.sleep()
    passed = time.monotonic() - began
    node.destroy_rate(rate)
    after = outcome(rate.sleep)
    executor.shutdown()
    return 0.4 < passed < 0.9, after


def sleeping(seconds: Any, **options: Any) -> Any:
    clock = Clock(**options)
    began = time.monotonic()
    slept = clock.sleep_for(Duration(seconds=seconds))
    return slept, time.monotonic() - began >= max(seconds, 0.0) - 0.01


lines(
    "clock",
    sim_now=lambda: with_clock(lambda n, p, e: n.get_clock().now().nanoseconds),
    sim_type=lambda: with_clock(
        lambda n, p, e: (n.get_clock().clock_type.name, n.get_clock().ros_time_is_active)
    ),
    sim_timer=lambda: with_clock(sim_timer),
    sim_jumps=lambda: with_clock(sim_jumps),
    sim_off=lambda: with_clock(switched_off),
    sim_text=lambda: with_clock(lambda n, p, e: str(n.get_clock())[:60]),
    rate=rate_in_a_thread,
    sleep_system=lambda: sleeping(0.1, clock_type=ClockType.SYSTEM_TIME),
    sleep_steady=lambda: sleeping(0.1, clock_type=ClockType.STEADY_TIME),
    sleep_ros=lambda: sleeping(0.1, clock_type=ClockType.ROS_TIME),
    sleep_past=lambda: sleeping(-1.0, clock_type=ClockType.STEADY_TIME),
    sleep_until_other=lambda: outcome(
        Clock(clock_type=ClockType.STEADY_TIME).sleep_until, Time(seconds=1, clock_type=ClockType.ROS_TIME)
    ),
    sleep_text=lambda: outcome(Clock(clock_type=ClockType.STEADY_TIME).sleep_for, 1.0),
    age=lambda: (Time(seconds=5) - Time(seconds=2)).nanoseconds,
    from_message=lambda: Time.from_msg(TimeMessage(sec=3, nanosec=5)).nanoseconds,
    from_message_type=lambda: Time.from_msg(TimeMessage(sec=3)).clock_type.name,
    difference_of_types=lambda: outcome(
        lambda: Time(seconds=1) - Time(seconds=1, clock_type=ClockType.ROS_TIME)
    ),
    compare_of_types=lambda: outcome(
        lambda: Time(seconds=1) < Time(seconds=1, clock_type=ClockType.ROS_TIME)
    ),
    duration_seconds=lambda: Duration(seconds=1.5, nanoseconds=5).nanoseconds,
    threshold_zero=lambda: outcome(
        JumpThreshold, min_forward=Duration(seconds=0), min_backward=None, on_clock_change=False
    ),
    threshold_none=lambda: outcome(JumpThreshold, min_forward=None, min_backward=None, on_clock_change=True),
)


def nodes_of(executor: Any, *steps: Any) -> Any:
    """Return the results of steps with an executor and two nodes."""
    one, two = Node("one"), Node("two")
    out = [outcome(step, executor, one, two) for step in steps]
    executor.shutdown()
    return out


def names(executor: Any, *_: Any) -> Any:
    return sorted(node.get_name() for node in executor.get_nodes())


def tasks(executor: Any, one: Any, two: Any) -> Any:
    log: list[Any] = []

    async def coroutine(value: Any) -> Any:
        log.append(value)
        return value * 2

    results = [
        executor.create_task(coroutine, 2),
        executor.create_task(lambda: "plain"),
        executor.create_task(coroutine(5)),
    ]
    for task in results:
        executor.spin_until_future_complete(task, 1.0)
    return log, [task.result() for task in results]


def failing_task(executor: Any, *_: Any) -> Any:
    async def fail() -> Any:
        raise KeyError("x")

    task = executor.create_task(fail)
    return outcome(executor.spin_until_future_complete, task, 1.0), task.done(), outcome(task.result)


def shut_down_while_spinning(executor: Any, one: Any, two: Any) -> Any:
    executor.add_node(one)
    thread = threading.Thread(target=executor.spin)
    thread.start()
    time.sleep(0.2)
    stopped = executor.shutdown(timeout_sec=2.0)
    thread.join(3.0)
    return stopped, thread.is_alive()


def futures_until(executor: Any, *_: Any) -> Any:
    future = rclpy.task.Future()
    began = time.monotonic()
    executor.spin_until_future_complete(future, 0.3)
    return future.done(), 0.25 < time.monotonic() - began < 1.5


def chained(executor: Any, *_: Any) -> Any:
    first = rclpy.task.Future(executor=executor)

    async def second() -> Any:
        return await first + 1

    task = executor.create_task(second)
    executor.create_task(lambda: first.set_result(4))
    executor.spin_until_future_complete(task, 1.0)
    return task.result()


def in_context(kind: Any) -> Any:
    node = Node("n")
    with kind() as executor:
        executor.add_node(node)
        inside = names(executor)
    return inside, outcome(executor.spin_once, 0.1)


def destroyed_while_added(executor: Any, one: Any, two: Any) -> Any:
    executor.add_node(one)
    executor.add_node(two)
    one.destroy_node()
    return names(executor), outcome(executor.spin_once, 0.1)


def removed_from(executor: Any, one: Any, two: Any) -> Any:
    added = executor.add_node(one), executor.add_node(one)
    executor.remove_node(two)
    executor.remove_node(one)
    return added, names(executor), one.executor is None


def moved(executor: Any, one: Any, two: Any) -> Any:
    other = SingleThreadedExecutor()
    executor.add_node(one)
    one.executor = other
    result = names(executor), names(other)
    other.shutdown()
    return result


for kind in (SingleThreadedExecutor, MultiThreadedExecutor):
    lines(
        f"executor.{kind.__name__}",
        tasks=partial(lambda k: nodes_of(k(), tasks), kind),
        failing=partial(lambda k: nodes_of(k(), failing_task), kind),
        shut_down=partial(lambda k: nodes_of(k(), shut_down_while_spinning), kind),
        until=partial(lambda k: nodes_of(k(), futures_until), kind),
        chained=partial(lambda k: nodes_of(k(), chained), kind),
        context=partial(in_context, kind),
        destroyed=partial(lambda k: nodes_of(k(), destroyed_while_added), kind),
        removed=partial(lambda k: nodes_of(k(), removed_from), kind),
        moved=partial(lambda k: nodes_of(k(), moved), kind),
    )


def counted(period: float, executor: Any, *, cancels: int = 0, resets: bool = False) -> Any:
    """Return how often a timer is called in a second."""
    node, calls = Node("n"), []

    def on_timer() -> None:
        calls.append(time.monotonic())
        if cancels and len(calls) == cancels:
            timer.cancel()

    timer = node.create_timer(period, on_timer)
    spun(node, lambda: False, 1.05, executor)
    if resets:
        timer.reset()
    return (
        len(calls) if cancels else abs(len(calls) - round(1.0 / period)) <= 2,
        timer.is_canceled(),
        timer.timer_period_ns,
    )


lines(
    "timer",
    tenth=lambda: counted(0.1, SingleThreadedExecutor()),
    tenth_in_threads=lambda: counted(0.1, MultiThreadedExecutor(2)),
    cancelled=lambda: counted(0.1, SingleThreadedExecutor(), cancels=3),
    reset=lambda: counted(0.1, SingleThreadedExecutor(), cancels=2, resets=True),
    autostart=lambda: outcome(Node("n").create_timer, 1.0, print, autostart=False),
    clock=lambda: Node("n").create_timer(1.0, print, clock=Clock()).clock.clock_type.name,
    period=lambda: Node("n").create_timer(0.25, print).timer_period_ns,
    negative=lambda: outcome(Node("n").create_timer, -1.0, print),
    zero=lambda: Node("n").create_timer(0.0, print).timer_period_ns,
    text=lambda: outcome(Node("n").create_timer, "1", print),
    since=lambda: Node("n").create_timer(5.0, print).time_since_last_call() >= 0,
    until=lambda: 4.0e9 < Node("n").create_timer(5.0, print).time_until_next_call() <= 5.0e9,
    until_cancelled=lambda: (lambda t: (t.cancel(), outcome(t.time_until_next_call)))(
        Node("n").create_timer(5.0, print)
    ),
    canceled_ready=lambda: (lambda t: (t.cancel(), t.is_ready(), t.is_canceled()))(
        Node("n").create_timer(0.0, print)
    ),
)
if __name__ == "__main__":
    main()
