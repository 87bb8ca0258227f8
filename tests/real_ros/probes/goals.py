# mypy: ignore-errors
"""Goals of actions from the request to the result, and their cancellation.

Many of the calls are wrong on purpose.
"""

import threading
import time
from typing import Any

from action_msgs.msg import GoalStatus
from action_msgs.srv import CancelGoal
from probing import Fibonacci, lines, main, outcome
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


def setup(execute: Any = None, n_threads: Any = 3, **kw: Any) -> Any:
    n = Node("n")
    g = ReentrantCallbackGroup()

    def ex(h: Any) -> Any:
        for i in range(20):
            if h.is_cancel_requested:
                h.canceled()
                r = Fibonacci.Result()
                r.sequence = [i * 0 + 9]
                return r
            time.sleep(0.05)
        h.succeed()
        r = Fibonacci.Result()
        r.sequence = [1, 2]
        return r

    s = ActionServer(n, Fibonacci, "fib", execute or ex, callback_group=g, **kw)
    c = ActionClient(n, Fibonacci, "fib", callback_group=g)
    e = MultiThreadedExecutor(n_threads)
    e.add_node(n)
    assert c.wait_for_server(3.0)
    return n, s, c, e


def wait(e: Any, f: Any, t: Any = 3.0) -> Any:
    e.spin_until_future_complete(f, t)
    return f.result() if f.done() else "pending"


def goal(order: Any = 3) -> Any:
    g = Fibonacci.Goal()
    g.order = order
    return g


def run(cancel_after: Any = None, accept_cancel: Any = True, what: Any = None, **kw: Any) -> Any:
    if accept_cancel is not None:
        kw.setdefault(
            "cancel_callback",
            lambda h: CancelResponse.ACCEPT if accept_cancel else CancelResponse.REJECT,
        )
    n, s, c, e = setup(**kw)
    h = wait(e, c.send_goal_async(goal()))
    out = [h.accepted]
    if cancel_after is not None:
        end = time.monotonic() + cancel_after
        while time.monotonic() < end:
            e.spin_once(timeout_sec=0.02)
        cr = wait(e, h.cancel_goal_async())
        out += [cr.return_code, len(cr.goals_canceling)]
    r = wait(e, h.get_result_async())
    out += [r.status, list(r.result.sequence)] if r != "pending" else [r]
    if what:
        out.append(outcome(what, n, s, c, e, h))
    e.shutdown()
    return out


def raises(exc: Any) -> Any:
    def ex(h: Any) -> Any:
        raise exc

    return ex


def with_(f: Any) -> Any:
    def ex(h: Any) -> Any:
        r = f(h)
        return Fibonacci.Result() if r is None else r

    return ex


def states(h: Any) -> Any:
    out = [h.is_active, h.status, h.is_cancel_requested, type(h).__name__]
    h.succeed()
    out += [h.is_active, h.status]
    STATES.append(out)


STATES = []


def after_terminal(h: Any) -> Any:
    h.succeed()
    STATES.append([outcome(h.abort), outcome(h.canceled), outcome(h.succeed)])


def st(f: Any) -> Any:
    STATES.clear()
    r = run(execute=with_(f))
    return [r, list(STATES)]


def reject() -> Any:
    _n, _s, c, e = setup(goal_callback=lambda g: GoalResponse.REJECT)
    h = wait(e, c.send_goal_async(goal()))
    r = [
        h.accepted,
        outcome(lambda: wait(e, h.get_result_async()).status),
        outcome(lambda: wait(e, h.cancel_goal_async()).return_code),
    ]
    e.shutdown()
    return r


def goalcb(v: Any) -> Any:
    _n, _s, c, e = setup(goal_callback=lambda g: v)

    def go() -> Any:
        f = c.send_goal_async(goal())
        h = wait(e, f, 1.0)
        return [h.accepted] if f.done() else h

    r = outcome(go)
    e.shutdown()
    return r


def cancelcb(v: Any) -> Any:
    _n, _s, c, e = setup(cancel_callback=lambda h: v)
    h = wait(e, c.send_goal_async(goal()))

    def go() -> Any:
        r = wait(e, h.cancel_goal_async(), 1.0)
        return r if r == "pending" else [r.return_code, len(r.goals_canceling)]

    r = outcome(go)
    e.shutdown()
    return r


def cancel_all() -> Any:
    n, _s, c, e = setup(cancel_callback=lambda h: CancelResponse.ACCEPT)
    hs = [wait(e, c.send_goal_async(goal())) for _ in range(2)]
    k = n.create_client(CancelGoal, "fib/_action/cancel_goal")
    k.wait_for_service(2.0)
    r = wait(e, k.call_async(CancelGoal.Request()))
    out = [
        r.return_code,
        len(r.goals_canceling),
        [wait(e, h.get_result_async()).status for h in hs],
    ]
    e.shutdown()
    return out


def cancel_unknown() -> Any:
    n, _s, _c, e = setup()
    k = n.create_client(CancelGoal, "fib/_action/cancel_goal")
    k.wait_for_service(2.0)
    q = CancelGoal.Request()
    q.goal_info.goal_id.uuid = [7] * 16
    r = wait(e, k.call_async(q))
    e.shutdown()
    return [r.return_code, len(r.goals_canceling)]


def cancel_twice() -> Any:
    return run(0.1, what=lambda n, s, c, e, h: [wait(e, h.cancel_goal_async()).return_code])


def feedback(count: Any = 3) -> Any:
    got = []

    def ex(h: Any) -> Any:
        for i in range(count):
            f = Fibonacci.Feedback()
            setattr(f, "sequence" if hasattr(f, "sequence") else "partial_sequence", [i])
            h.publish_feedback(f)
            time.sleep(0.05)
        h.succeed()
        return Fibonacci.Result()

    _n, _s, c, e = setup(ex)
    h = wait(
        e,
        c.send_goal_async(
            goal(),
            feedback_callback=lambda m: got.append(
                (
                    list(m.feedback.sequence),
                    bytes(m.goal_id.uuid) == bytes(h0[0].goal_id.uuid) if h0 else True,
                )
            ),
        ),
    )
    h0.append(h)
    wait(e, h.get_result_async())
    e.shutdown()
    return [g[0] for g in got]


h0 = []


def fb_wrong() -> Any:
    def ex(h: Any) -> Any:
        STATES.append(outcome(h.publish_feedback, Fibonacci.Result()))
        h.succeed()
        return Fibonacci.Result()

    STATES.clear()
    run(execute=ex)
    return list(STATES)


def fb_after() -> Any:
    def ex(h: Any) -> Any:
        h.succeed()
        STATES.append(outcome(h.publish_feedback, Fibonacci.Feedback()))
        return Fibonacci.Result()

    STATES.clear()
    run(execute=ex)
    return list(STATES)


def destroyed_client() -> Any:
    _n, _s, c, e = setup()
    c.destroy()
    r = [outcome(c.send_goal_async, goal()), outcome(c.server_is_ready), outcome(c.destroy)]
    e.shutdown()
    return r


def wrong_goal(g: Any) -> Any:
    _n, _s, c, e = setup()
    r = outcome(c.send_goal_async, g)
    e.shutdown()
    return r


def sync_send() -> Any:
    _n, _s, c, e = setup()
    t = threading.Thread(target=e.spin, daemon=True)
    t.start()
    r = outcome(lambda: (lambda x: [x.status, list(x.result.sequence)])(c.send_goal(goal())))
    e.shutdown()
    return r


def handle_accepted() -> Any:
    kept = []

    def acc(h: Any) -> Any:
        kept.append(h)

    _n, _s, c, e = setup(handle_accepted_callback=acc)
    h = wait(e, c.send_goal_async(goal()))
    f = h.get_result_async()
    wait(e, f, 0.3)
    a = f.done()
    kept[0].execute()
    r = wait(e, f)
    e.shutdown()
    return [a, r.status]


def execute_other() -> Any:
    kept = []
    _n, _s, c, e = setup(handle_accepted_callback=kept.append)
    h = wait(e, c.send_goal_async(goal()))

    def ex(hh: Any) -> Any:
        hh.abort()
        return Fibonacci.Result()

    kept[0].execute(ex)
    r = wait(e, h.get_result_async())
    e.shutdown()
    return r.status


def result_timeout(t: Any) -> Any:
    _n, _s, c, e = setup(with_(lambda h: h.succeed()), result_timeout=t)
    h = wait(e, c.send_goal_async(goal()))
    end = time.monotonic() + 0.5
    while time.monotonic() < end:
        e.spin_once(timeout_sec=0.05)
    r = wait(e, h.get_result_async(), 1.0)
    e.shutdown()
    return r if r == "pending" else [r.status, h.status]


def async_ex() -> Any:
    async def ex(h: Any) -> Any:
        h.succeed()
        r = Fibonacci.Result()
        r.sequence = [4]
        return r

    return run(execute=ex)


def async_goal() -> Any:
    async def g(x: Any) -> Any:
        return GoalResponse.ACCEPT

    return run(goal_callback=g)


def async_cancel() -> Any:
    async def k(h: Any) -> Any:
        return CancelResponse.ACCEPT

    return run(0.1, cancel_callback=k)


def goal_repr() -> Any:
    _n, _s, c, e = setup()
    h = wait(e, c.send_goal_async(goal()))
    r = [
        repr(h).split(" at ")[0].split("(")[0][:30],
        sorted(a for a in dir(h) if not a.startswith("_")),
        len(h.goal_id.uuid),
        h.stamp.sec > 0,
    ]
    e.shutdown()
    return r


def given_uuid() -> Any:
    from unique_identifier_msgs.msg import UUID

    _n, _s, c, e = setup()
    u = UUID(uuid=list(range(16)))
    h = wait(e, c.send_goal_async(goal(), goal_uuid=u))
    h2 = c.send_goal_async(goal(), goal_uuid=u)
    r2 = wait(e, h2)
    r = [list(h.goal_id.uuid), h.accepted, r2.accepted]
    e.shutdown()
    return r


def eq() -> Any:
    _n, _s, c, e = setup()
    h = wait(e, c.send_goal_async(goal()))
    r = [h == h, h == 3]
    e.shutdown()
    return r


def statuses() -> Any:
    from action_msgs.msg import GoalStatusArray
    from rclpy.qos import qos_profile_action_status_default as q

    n, _s, c, e = setup(with_(lambda h: h.succeed()))
    seen = []
    n.create_subscription(
        GoalStatusArray,
        "fib/_action/status",
        lambda m: seen.append([x.status for x in m.status_list]),
        q,
    )
    time.sleep(0.3)
    h = wait(e, c.send_goal_async(goal()))
    wait(e, h.get_result_async())
    end = time.monotonic() + 0.3
    while time.monotonic() < end:
        e.spin_once(timeout_sec=0.05)
    e.shutdown()
    return seen[-1]


def server_attrs() -> Any:
    _n, s, c, e = setup()
    r = [
        sorted(a for a in dir(s) if not a.startswith("_")),
        sorted(a for a in dir(c) if not a.startswith("_")),
    ]
    e.shutdown()
    return r


def graph_counts() -> Any:
    n, _s, _c, e = setup()
    r = [
        n.count_services("fib/_action/send_goal"),
        n.count_publishers("fib/_action/feedback"),
        n.count_subscribers("fib/_action/status"),
        n.count_clients("fib/_action/get_result"),
    ]
    e.shutdown()
    return r


def two_servers() -> Any:
    n = Node("n")
    ActionServer(n, Fibonacci, "x", print)
    return outcome(lambda: type(ActionServer(n, Fibonacci, "x", print)).__name__)


def late_result() -> Any:
    _n, _s, c, e = setup(with_(lambda h: h.succeed()))
    h = wait(e, c.send_goal_async(goal()))
    a = wait(e, h.get_result_async()).status
    b = wait(e, h.get_result_async()).status
    e.shutdown()
    return [a, b, h.status]


def cancel_future_of_goal() -> Any:
    _n, _s, c, e = setup()
    f = c.send_goal_async(goal())
    f.cancel()
    end = time.monotonic() + 0.3
    while time.monotonic() < end:
        e.spin_once(timeout_sec=0.05)
    r = [f.done(), f.cancelled()]
    e.shutdown()
    return r


def goal_request() -> Any:
    seen = []

    def ex(h: Any) -> Any:
        seen.append([h.request.order, type(h.request).__name__, len(h.goal_id.uuid)])
        h.succeed()
        return Fibonacci.Result()

    run(execute=ex)
    return seen


def done_cb() -> Any:
    _n, _s, c, e = setup(with_(lambda h: h.succeed()))
    seen = []

    def got(f: Any) -> Any:
        h = f.result()
        seen.append(h.accepted)
        h.get_result_async().add_done_callback(lambda f: seen.append(f.result().status))

    c.send_goal_async(goal()).add_done_callback(got)
    end = time.monotonic() + 1.0
    while time.monotonic() < end and len(seen) < 2:
        e.spin_once(timeout_sec=0.05)
    e.shutdown()
    return seen


A, R = CancelResponse.ACCEPT, CancelResponse.REJECT
lines(
    "run",
    ok=run,
    cancel=lambda: run(0.1),
    cancel_rejected=lambda: run(0.1, False),
    cancel_default=lambda: run(0.1, None),
    cancel_late=lambda: run(1.5),
    cancel_twice=cancel_twice,
    raises=lambda: run(execute=raises(ValueError("x"))),
    no_terminal=lambda: run(execute=lambda h: Fibonacci.Result()),
    abort=lambda: run(execute=with_(lambda h: h.abort())),
    canceled_without_request=lambda: run(execute=with_(lambda h: STATES.append(outcome(h.canceled)))),
    states=lambda: st(states),
    terminal=lambda: st(after_terminal),
    async_ex=async_ex,
    async_goal=async_goal,
    async_cancel=async_cancel,
    no_arity=lambda: run(execute=lambda: None),
    sync=sync_send,
    request=goal_request,
    done_cb=done_cb,
)
lines(
    "goal",
    reject=reject,
    none=lambda: goalcb(None),
    true=lambda: goalcb(True),
    num=lambda: goalcb(2),
    num1=lambda: goalcb(1),
    accept=lambda: goalcb(GoalResponse.ACCEPT),
    wrong_none=lambda: wrong_goal(None),
    wrong_cls=lambda: wrong_goal(Fibonacci.Goal),
    wrong_type=lambda: wrong_goal(Fibonacci.Result()),
    wrong_text=lambda: wrong_goal("3"),
    uuid=given_uuid,
    cancel_future=cancel_future_of_goal,
    late=late_result,
)
lines(
    "cancel",
    none=lambda: cancelcb(None),
    true=lambda: cancelcb(True),
    num=lambda: cancelcb(2),
    reject=lambda: cancelcb(R),
    all=cancel_all,
    unknown=cancel_unknown,
)
lines("feedback", three=feedback, zero=lambda: feedback(0), wrong=fb_wrong, after=fb_after)
lines(
    "life",
    accepted=handle_accepted,
    other=execute_other,
    timeout0=lambda: result_timeout(0),
    timeout_short=lambda: result_timeout(0.1),
    timeout_long=lambda: result_timeout(10),
    timeout_neg=lambda: result_timeout(-1),
    two=two_servers,
    statuses=statuses,
)
lines(
    "enum",
    goal=lambda: [(x.name, x.value) for x in GoalResponse],
    cancel=lambda: [(x.name, x.value) for x in CancelResponse],
    status=lambda: [(k, getattr(GoalStatus, k)) for k in dir(GoalStatus) if k.startswith("STATUS")],
)
lines(
    "make",
    name_num=lambda: ActionClient(Node("n"), Fibonacci, 3),
    name_empty=lambda: ActionClient(Node("n"), Fibonacci, ""),
    node_none=lambda: ActionClient(None, Fibonacci, "x"),
    cb_none=lambda: ActionServer(Node("n"), Fibonacci, "x", None),
    cb_text=lambda: ActionServer(Node("n"), Fibonacci, "x", "y"),
    goalcb_none=lambda: ActionServer(Node("n"), Fibonacci, "x", print, goal_callback=None),
    cancelcb_none=lambda: ActionServer(Node("n"), Fibonacci, "x", print, cancel_callback=None),
    acc_none=lambda: ActionServer(Node("n"), Fibonacci, "x", print, handle_accepted_callback=None),
    wait_text=lambda: ActionClient(Node("n"), Fibonacci, "x").wait_for_server("1"),
    wait_zero=lambda: ActionClient(Node("n"), Fibonacci, "x").wait_for_server(0),
    wait_neg=lambda: ActionClient(Node("n"), Fibonacci, "x").wait_for_server(timeout_sec=0.05),
    group=lambda: ActionClient(Node("n"), Fibonacci, "x", callback_group=3),
    result_text=lambda: ActionServer(Node("n"), Fibonacci, "x", print, result_timeout="1"),
    rel=lambda: ActionClient(Node("n", namespace="/a"), Fibonacci, "~/x").wait_for_server(0.01),
)
if __name__ == "__main__":
    main()
