# mypy: ignore-errors
"""Futures, tasks, guard conditions, callback groups and executors.

Many of the calls are wrong on purpose.
"""

import threading
import time
import warnings
from typing import Any

import rclpy
from probing import lines, main, outcome
from rclpy.callback_groups import (
    CallbackGroup,
    MutuallyExclusiveCallbackGroup,
    ReentrantCallbackGroup,
)
from rclpy.executors import (
    ConditionReachedException,
    MultiThreadedExecutor,
    ShutdownException,
    SingleThreadedExecutor,
    TimeoutException,
    await_or_execute,
)
from rclpy.node import Node
from rclpy.task import Future, Task
from std_msgs.msg import String
from std_srvs.srv import Trigger


def fut(v: Any = None, exc: Any = None) -> Any:
    f = Future()
    if exc:
        f.set_exception(exc)
    else:
        f.set_result(v)
    return f


def order() -> Any:
    f, seen = Future(), []
    f.add_done_callback(lambda x: seen.append(1))
    f.add_done_callback(lambda x: seen.append(2))
    f.set_result(0)
    f.add_done_callback(lambda x: seen.append(3))
    return seen


def ex_order() -> Any:
    e = SingleThreadedExecutor()
    f = Future(executor=e)
    seen = []
    f.add_done_callback(lambda x: seen.append(1))
    f.set_result(0)
    b = list(seen)
    e.spin_once(timeout_sec=0.1)
    return [b, seen]


def cb_raises() -> Any:
    f = Future()
    f.add_done_callback(lambda x: 1 / 0)
    seen = []
    f.add_done_callback(lambda x: seen.append(1))
    return [outcome(f.set_result, 3), f.done(), outcome(f.result), seen]


def cb_late_raises() -> Any:
    f = fut(1)
    return [outcome(f.add_done_callback, lambda x: 1 / 0), f.done()]


def twice() -> Any:
    f = fut(1)
    return [outcome(f.set_result, 2), f.result()]


def res_exc() -> Any:
    f = fut(1)
    return [outcome(f.set_exception, KeyError("k")), outcome(f.result), repr(f.exception())]


def cancel_done() -> Any:
    f = fut(1)
    return [outcome(f.cancel), f.cancelled(), f.done(), outcome(f.result)]


def cancel_then() -> Any:
    f = Future()
    seen = []
    f.add_done_callback(lambda x: seen.append(x.cancelled()))
    f.cancel()
    f.cancel()
    return [
        f.done(),
        f.cancelled(),
        outcome(f.result),
        outcome(f.exception),
        outcome(f.set_result, 5),
        outcome(f.result),
        seen,
    ]


def exc_type(e: Any) -> Any:
    f = Future()
    return [outcome(f.set_exception, e), outcome(f.result), f.done()]


def rm() -> Any:
    f = Future()

    def cb(x: Any) -> None:
        return None

    f.add_done_callback(cb)
    f.add_done_callback(cb)
    return [outcome(f.remove_done_callback, cb), outcome(f.remove_done_callback, cb)]


def reprs() -> Any:
    return [
        type(Future()).__mro__[1].__name__,
        bool(Future()),
        Future() == Future(),
        hash(Future()) != 0,
    ]


def inctx() -> Any:
    f = Future()
    with warnings.catch_warnings(record=True) as w:
        warnings.simplefilter("always")
        r = outcome(f.set_executor, SingleThreadedExecutor()) if hasattr(f, "set_executor") else "no"
    return [r, len(w)]


def task(h: Any, args: Any = (), kw: Any = None, ex: Any = None, n: Any = 1) -> Any:
    t = Task(h, args, kw, ex)
    r = [outcome(t) for _ in range(n)]
    return [r, t.done(), outcome(t.result), t.executing(), t.cancelled()]


async def co(x: Any = 1) -> Any:
    return x


async def co2(f: Any) -> Any:
    return await f


def await_pending() -> Any:
    f = Future()
    t = Task(co2, (f,))
    t()
    a = t.done()
    f.set_result(7)
    t()
    return [a, t.done(), outcome(t.result)]


def await_exc() -> Any:
    f = Future()
    t = Task(co2, (f,))
    t()
    f.set_exception(KeyError("z"))
    t()
    return [t.done(), outcome(t.result)]


def await_cancelled() -> Any:
    f = Future()
    t = Task(co2, (f,))
    t()
    f.cancel()
    t()
    return [t.done(), outcome(t.result)]


def cancel_task_running() -> Any:
    f = Future()
    t = Task(co2, (f,))
    t()
    t.cancel()
    r = [t.done(), t.cancelled()]
    f.set_result(1)
    t()
    return [r, t.done(), outcome(t.result)]


def task_done_cb() -> Any:
    seen = []
    t = Task(lambda: 4)
    t.add_done_callback(lambda x: seen.append(x.result()))
    t()
    return seen


def await_done() -> Any:
    t = Task(co2, (fut(9),))
    t()
    return [t.done(), t.result()]


def await_exc_done() -> Any:
    t = Task(co2, (fut(exc=KeyError("q")),))
    t()
    return [t.done(), outcome(t.result)]


def chained() -> Any:
    async def a() -> Any:
        return await co(3) + await co(4)

    t = Task(a)
    t()
    return t.result()


def awaitlist() -> Any:
    async def a(fs: Any) -> Any:
        return [await f for f in fs]

    fs = [Future(), Future()]
    t = Task(a, (fs,))
    t()
    fs[1].set_result(2)
    t()
    x = t.done()
    fs[0].set_result(1)
    t()
    return [x, t.done(), t.result()]


lines(
    "future",
    order=order,
    ex_order=ex_order,
    cb_raises=cb_raises,
    cb_late_raises=cb_late_raises,
    twice=twice,
    res_exc=res_exc,
    cancel_done=cancel_done,
    cancel_then=cancel_then,
    exc_cls=lambda: exc_type(KeyError),
    exc_str=lambda: exc_type("x"),
    exc_none=lambda: exc_type(None),
    exc_base=lambda: exc_type(SystemExit(3)),
    exc_ki=lambda: exc_type(KeyboardInterrupt()),
    rm=rm,
    inctx=inctx,
    pending_result=lambda: Future().result(),
    pending_exc=lambda: Future().exception(),
    cb_none=lambda: Future().add_done_callback(None),
    cb_str=lambda: Future().add_done_callback("x"),
    kw_exec=lambda: Future(executor=None).done(),
    pos_exec=lambda: Future(None),
    bad_exec=lambda: fut.__call__ and Future(executor=3).done(),
    rmnone=lambda: Future().remove_done_callback(print),
    set_no=lambda: Future().set_result(),
    repr_done=lambda: type(repr(fut(3))).__name__,
)
lines(
    "task",
    plain=lambda: task(lambda: 1),
    args=lambda: task(lambda a, b=2: (a, b), (1,), {"b": 3}),
    raises=lambda: task(lambda: 1 / 0),
    co=lambda: task(co),
    co_args=lambda: task(co, (5,)),
    twice=lambda: task(lambda: 1, n=2),
    wrong=lambda: task(lambda a: 1),
    none=lambda: Task(None),
    text=lambda: Task("x"),
    coobj=lambda: task(co(6)),
    await_pending=await_pending,
    await_exc=await_exc,
    await_cancelled=await_cancelled,
    cancel_running=cancel_task_running,
    done_cb=task_done_cb,
    await_done=await_done,
    await_exc_done=await_exc_done,
    chained=chained,
    awaitlist=awaitlist,
    args_list=lambda: task(lambda *a: a, [1, 2]),
    kwnone=lambda: task(lambda **k: k, None, {"a": 1}),
    gen=lambda: task(lambda: (i for i in range(2)))[1:2],
)


def guard(n: Any = 1, ex: Any = None, group: Any = None) -> Any:
    node = Node("n")
    seen = []
    g = node.create_guard_condition(lambda: seen.append(1), callback_group=group)
    for _ in range(n):
        g.trigger()
    e = ex or SingleThreadedExecutor()
    e.add_node(node)
    for _ in range(6):
        e.spin_once(timeout_sec=0.02)
    return len(seen)


def guard_destroy() -> Any:
    node = Node("n")
    g = node.create_guard_condition(print)
    a = [
        len(list(node.guards)),
        node.destroy_guard_condition(g),
        len(list(node.guards)),
        node.destroy_guard_condition(g),
    ]
    return [a, outcome(g.trigger)]


def guard_async() -> Any:
    node, seen = Node("n"), []

    async def f() -> Any:
        seen.append(1)

    g = node.create_guard_condition(f)
    g.trigger()
    e = SingleThreadedExecutor()
    e.add_node(node)
    for _ in range(4):
        e.spin_once(timeout_sec=0.02)
    return seen


def guard_in_thread() -> Any:
    node, seen = Node("n"), []
    g = node.create_guard_condition(lambda: seen.append(1))
    threading.Timer(0.1, g.trigger).start()
    rclpy.spin_once(node, timeout_sec=2.0)
    return seen


def guard_retrigger() -> Any:
    node, seen = Node("n"), []

    def f() -> Any:
        seen.append(1)
        if len(seen) < 3:
            g.trigger()

    g = node.create_guard_condition(f)
    g.trigger()
    for _ in range(6):
        rclpy.spin_once(node, timeout_sec=0.02)
    return len(seen)


lines(
    "guard",
    once=guard,
    five=lambda: guard(5),
    destroy=guard_destroy,
    async_=guard_async,
    thread=guard_in_thread,
    retrigger=guard_retrigger,
    group=lambda: guard(1, None, ReentrantCallbackGroup()),
    twice=lambda: (lambda g: [g.destroy(), g.destroy()])(Node("n").create_guard_condition(print)),
)


def group_misc() -> Any:
    g = MutuallyExclusiveCallbackGroup()
    n = Node("n")
    t = n.create_timer(1.0, print, callback_group=g)
    return [
        g.has_entity(t),
        g.can_execute(t),
        g.beginning_execution(t),
        g.can_execute(t),
        g.beginning_execution(t),
        g.ending_execution(t),
        g.can_execute(t),
    ]


def re_group() -> Any:
    g = ReentrantCallbackGroup()
    n = Node("n")
    t = n.create_timer(1.0, print, callback_group=g)
    return [
        g.can_execute(t),
        g.beginning_execution(t),
        g.beginning_execution(t),
        g.ending_execution(t),
    ]


def end_wrong() -> Any:
    g = MutuallyExclusiveCallbackGroup()
    n = Node("n")
    t = n.create_timer(1.0, print, callback_group=g)
    return g.ending_execution(t)


def two_timers(g1: Any, g2: Any, ex: Any, blocking: Any = 0.15) -> Any:
    n = Node("n")
    log = []

    def f(name: Any) -> Any:
        def go() -> Any:
            log.append(name + "(")
            time.sleep(blocking)
            log.append(name + ")")

        return go

    n.create_timer(0.05, f("a"), callback_group=g1)
    n.create_timer(0.05, f("b"), callback_group=g2)
    e = ex()
    e.add_node(n)
    end = time.monotonic() + 0.6
    while time.monotonic() < end:
        e.spin_once(timeout_sec=0.05)
    e.shutdown()
    depth = best = 0
    for x in log:
        depth += 1 if x[1] == "(" else -1
        best = max(best, depth)
    return best


def same_twice_reentrant() -> Any:
    n = Node("n")
    live = []
    best = []

    def go() -> Any:
        live.append(1)
        best.append(len(live))
        time.sleep(0.2)
        live.pop()

    n.create_timer(0.05, go, callback_group=ReentrantCallbackGroup())
    e = MultiThreadedExecutor(4)
    e.add_node(n)
    end = time.monotonic() + 0.8
    while time.monotonic() < end:
        e.spin_once(timeout_sec=0.05)
    e.shutdown()
    return max(best) > 1


M, R = MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup


def shared(g: Any) -> Any:
    return (g, g)


lines(
    "group",
    misc=group_misc,
    re=re_group,
    end_wrong=end_wrong,
    abstract=lambda: CallbackGroup(),
    base_has=lambda: sorted(a for a in dir(M()) if not a.startswith("_")),
    one_m=lambda: two_timers(*shared(M()), lambda: MultiThreadedExecutor(3)),
    two_m=lambda: two_timers(M(), M(), lambda: MultiThreadedExecutor(3)),
    one_r=lambda: two_timers(*shared(R()), lambda: MultiThreadedExecutor(3)),
    two_m_one_thread=lambda: two_timers(M(), M(), lambda: MultiThreadedExecutor(1)),
    two_m_single=lambda: two_timers(M(), M(), SingleThreadedExecutor),
    default=lambda: two_timers(None, None, lambda: MultiThreadedExecutor(3)),
    same_twice=same_twice_reentrant,
    default_type=lambda: type(Node("n").default_callback_group).__name__,
    assign=lambda: setattr(Node("n"), "default_callback_group", R()),
    add_entity=lambda: M().add_entity(3),
    has_unknown=lambda: M().has_entity(3),
    wrong=lambda: Node("n").create_timer(1.0, print, callback_group="x"),
    cls=lambda: Node("n").create_timer(1.0, print, callback_group=M),
    sub_wrong=lambda: Node("n").create_subscription(String, "t", print, 1, callback_group=M),
    srv_wrong=lambda: Node("n").create_service(Trigger, "t", print, callback_group=R),
)


def spin_some(ex: Any) -> Any:
    n = Node("n")
    seen = []
    n.create_timer(0.01, lambda: seen.append(1))
    e = ex()
    e.add_node(n)
    threading.Timer(0.3, e.shutdown).start()
    r = outcome(e.spin)
    return [r, len(seen) > 5, len(list(e.get_nodes()))]


def spin_cancel_task() -> Any:
    e = SingleThreadedExecutor()
    n = Node("n")
    e.add_node(n)
    t = e.create_task(lambda: 1)
    t.cancel()
    e.spin_once(timeout_sec=0.05)
    return [t.done(), t.cancelled()]


def task_in_multi() -> Any:
    e = MultiThreadedExecutor(2)
    n = Node("n")
    e.add_node(n)
    t = e.create_task(co, 8)
    e.spin_until_future_complete(t, 1.0)
    return [t.done(), outcome(t.result)]


def exc_multi() -> Any:
    e = MultiThreadedExecutor(2)
    n = Node("n")
    e.add_node(n)
    n.create_timer(0.02, lambda: 1 / 0)

    def go() -> Any:
        for _ in range(20):
            e.spin_once(timeout_sec=0.05)

    return outcome(go)


def add_during() -> Any:
    e = SingleThreadedExecutor()
    n = Node("n")
    m = Node("m")
    seen = []
    n.create_timer(0.02, lambda: e.add_node(m))
    m.create_timer(0.02, lambda: seen.append(1))
    e.add_node(n)
    for _ in range(15):
        e.spin_once(timeout_sec=0.05)
    return len(seen) > 2


def remove_during() -> Any:
    e = SingleThreadedExecutor()
    n = Node("n")
    m = Node("m")
    seen = []
    m.create_timer(0.03, lambda: seen.append(1))
    n.create_timer(0.1, lambda: e.remove_node(m))
    e.add_node(n)
    e.add_node(m)
    end = time.monotonic() + 0.5
    while time.monotonic() < end:
        e.spin_once(timeout_sec=0.05)
    return [1 < len(seen) < 6, [x.get_name() for x in e.get_nodes()]]


def create_in_cb() -> Any:
    n = Node("n")
    got = []

    def f() -> Any:
        t.cancel()
        n.create_subscription(String, "t", lambda m: got.append(m.data), 10)
        p = n.create_publisher(String, "t", 10)

        def g() -> Any:
            if p.get_subscription_count():
                p.publish(String(data="x"))

        n.create_timer(0.05, g)

    t = n.create_timer(0.02, f)
    end = time.monotonic() + 1.0
    while time.monotonic() < end and not got:
        rclpy.spin_once(n, timeout_sec=0.05)
    return got[:1]


def destroyed_sub() -> Any:
    n = Node("n")
    got = []
    s = n.create_subscription(String, "t", lambda m: got.append(1), 10)
    p = n.create_publisher(String, "t", 10)
    time.sleep(0.3)
    p.publish(String())
    time.sleep(0.1)
    n.destroy_subscription(s)
    for _ in range(4):
        rclpy.spin_once(n, timeout_sec=0.02)
    return got


def spin_thread_two_nodes() -> Any:
    a, b = Node("a"), Node("b")
    seen = set()
    a.create_timer(0.02, lambda: seen.add("a"))
    b.create_timer(0.02, lambda: seen.add("b"))
    e = MultiThreadedExecutor(2)
    e.add_node(a)
    e.add_node(b)
    t = threading.Thread(target=e.spin, daemon=True)
    t.start()
    time.sleep(0.3)
    e.shutdown()
    t.join(2)
    return [sorted(seen), t.is_alive()]


def use_after() -> Any:
    e = SingleThreadedExecutor()
    e.shutdown()
    n = Node("n")
    return [
        outcome(e.add_node, n),
        outcome(e.spin_once, timeout_sec=0.01),
        outcome(e.create_task, print),
        outcome(e.spin),
        outcome(e.wake),
    ]


def until_timeout_multi() -> Any:
    e = MultiThreadedExecutor(2)
    e.add_node(Node("n"))
    f = Future()
    t = time.monotonic()
    e.spin_until_future_complete(f, 0.2)
    return [f.done(), 0.1 < time.monotonic() - t < 1.0]


def timer_in_task() -> Any:
    n = Node("n")
    e = SingleThreadedExecutor()
    e.add_node(n)
    seen = []

    async def f() -> Any:
        fu = Future()
        t = n.create_timer(0.05, lambda: fu.set_result(3) if not fu.done() else None)
        seen.append(await fu)
        n.destroy_timer(t)

    t = e.create_task(f)
    e.spin_until_future_complete(t, 2.0)
    return [seen, t.done(), len(list(n.timers))]


def gen_aoe() -> Any:
    async def f() -> Any:
        return [await await_or_execute(lambda: 3), await await_or_execute(co, 4)]

    t = Task(f)
    t()
    return t.result()


lines(
    "executor",
    spin_single=lambda: spin_some(SingleThreadedExecutor),
    spin_multi=lambda: spin_some(lambda: MultiThreadedExecutor(2)),
    cancel_task=spin_cancel_task,
    task_multi=task_in_multi,
    exc_multi=exc_multi,
    add_during=add_during,
    remove_during=remove_during,
    create_in_cb=create_in_cb,
    destroyed_sub=destroyed_sub,
    two_nodes=spin_thread_two_nodes,
    use_after=use_after,
    until_timeout_multi=until_timeout_multi,
    timer_in_task=timer_in_task,
    aoe=gen_aoe,
    neg=lambda: MultiThreadedExecutor(-2),
    text=lambda: MultiThreadedExecutor("2"),
    flt=lambda: type(MultiThreadedExecutor(2.0)).__name__,
    timeouts=lambda: [
        issubclass(TimeoutException, Exception),
        issubclass(ShutdownException, Exception),
        issubclass(ConditionReachedException, Exception),
    ],
    node_exec=lambda: Node("n").executor,
    assign_text=lambda: setattr(Node("n"), "executor", "x"),
    spin_once_pos=lambda: SingleThreadedExecutor().spin_once(0.01),
    spin_neg=lambda: SingleThreadedExecutor().spin_once(timeout_sec=0.0),
    rm_twice=lambda: (lambda e, n: [e.add_node(n), e.remove_node(n), e.remove_node(n)])(
        SingleThreadedExecutor(), Node("n")
    ),
    add_text=lambda: SingleThreadedExecutor().add_node("x"),
    get_empty=lambda: SingleThreadedExecutor().get_nodes(),
    spin_global=lambda: rclpy.spin_once(Node("n"), timeout_sec=0.01),
    spin_none=lambda: rclpy.spin_once(None),
    spin_text=lambda: rclpy.spin_once("x", timeout_sec=0.1),
    spin_timeout_text=lambda: rclpy.spin_once(Node("n"), timeout_sec="1"),
    spin_nan=lambda: rclpy.spin_once(Node("n"), timeout_sec=float("nan")),
    spin_int=lambda: rclpy.spin_once(Node("n"), timeout_sec=0),
    spin_exec_bad=lambda: rclpy.spin_once(Node("n"), executor=3, timeout_sec=0.1),
)
if __name__ == "__main__":
    main()
