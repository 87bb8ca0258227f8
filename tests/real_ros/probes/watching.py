# mypy: ignore-errors
"""Callbacks for parameters, simulated time and matched endpoints, and objects of nodes.

Many of the calls are wrong on purpose.
"""

import threading
import time
from typing import Any

import rclpy
from probing import lines, main, outcome
from rcl_interfaces.msg import (
    ParameterEvent,
    SetParametersResult,
)
from rclpy.clock import Clock, ClockChange, ClockType, JumpThreshold, ROSClock
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_event_handler import (
    ParameterEventHandler,
)
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.time import Time
from rclpy.time_source import TimeSource
from rosgraph_msgs.msg import Clock as ClockMsg
from std_msgs.msg import Int32, String


def spin(n: Any, s: Any = 0.4, until: Any = lambda: False) -> Any:
    end = time.monotonic() + s
    while time.monotonic() < end and not until():
        rclpy.spin_once(n, timeout_sec=0.03)


# parameter events
def pev(change: Any, n_expected: Any = 1) -> Any:
    n = Node("n")
    n.declare_parameter("a", 1)
    n.declare_parameter("b", "x")
    h = ParameterEventHandler(n)
    seen = []
    c = h.add_parameter_callback("a", "n", lambda p: seen.append((p.name, p.value.integer_value)))
    d = h.add_parameter_event_callback(
        lambda e: seen.append(
            (
                e.node,
                [p.name for p in e.new_parameters],
                [p.name for p in e.changed_parameters],
                [p.name for p in e.deleted_parameters],
            )
        )
    )
    spin(n, 0.3)
    seen.clear()
    r = outcome(change, n, h, c, d, seen)
    spin(n, 0.5)
    return [r, seen]


def set_a(n: Any, *x: Any) -> Any:
    n.set_parameters([Parameter("a", value=5)])
    return


def set_same(n: Any, *x: Any) -> Any:
    n.set_parameters([Parameter("a", value=1)])
    return


def set_both(n: Any, *x: Any) -> Any:
    n.set_parameters_atomically([Parameter("a", value=2), Parameter("b", value="y")])
    return


def set_two(n: Any, *x: Any) -> Any:
    n.set_parameters([Parameter("a", value=2), Parameter("a", value=3)])
    return


def removed(n: Any, h: Any, c: Any, d: Any, s: Any) -> Any:
    h.remove_parameter_callback(c)
    return set_a(n)


def removed2(n: Any, h: Any, c: Any, d: Any, s: Any) -> Any:
    h.remove_parameter_event_callback(d)
    return set_a(n)


def removed_twice(n: Any, h: Any, c: Any, d: Any, s: Any) -> Any:
    h.remove_parameter_callback(c)
    return h.remove_parameter_callback(c)


def removed_wrong(n: Any, h: Any, c: Any, d: Any, s: Any) -> Any:
    return h.remove_parameter_callback(d)


def added(n: Any, h: Any, c: Any, d: Any, s: Any) -> Any:
    h.add_parameter_callback("a", "n", lambda p: s.append("second"))
    return set_a(n)


def added_slash(n: Any, h: Any, c: Any, d: Any, s: Any) -> Any:
    h.add_parameter_callback("a", "/n", lambda p: s.append("slash"))
    return set_a(n)


def added_none(n: Any, h: Any, c: Any, d: Any, s: Any) -> Any:
    h.add_parameter_callback("a", None, lambda p: s.append("none"))
    return set_a(n)


def added_empty(n: Any, h: Any, c: Any, d: Any, s: Any) -> Any:
    h.add_parameter_callback("a", "", lambda p: s.append("empty"))
    return set_a(n)


def undeclared(n: Any, *x: Any) -> Any:
    n.undeclare_parameter("a")


def declared(n: Any, *x: Any) -> Any:
    n.declare_parameter("c", 3)
    return


def refused(n: Any, *x: Any) -> Any:
    n.add_on_set_parameters_callback(lambda ps: SetParametersResult(successful=False, reason="no"))
    return n.set_parameters([Parameter("a", value=5)])[0].reason


def raising(n: Any, h: Any, c: Any, d: Any, s: Any) -> Any:
    h.add_parameter_callback("a", "n", lambda p: 1 / 0)
    return set_a(n)


def other_node(n: Any, h: Any, c: Any, d: Any, s: Any) -> Any:
    m = Node("m")
    m.declare_parameter("z", 1)
    h.add_parameter_callback("z", "m", lambda p: s.append(p.value.integer_value))
    time.sleep(0.3)
    m.set_parameters([Parameter("z", value=7)])
    return


def pe(call: Any) -> Any:
    e = ParameterEvent(node="/n")

    p = Parameter("a", value=4).to_parameter_msg()
    e.changed_parameters = [p]
    return call(e)


lines(
    "pevent",
    set_a=lambda: pev(set_a),
    same=lambda: pev(set_same),
    both=lambda: pev(set_both),
    two=lambda: pev(set_two),
    removed=lambda: pev(removed),
    removed2=lambda: pev(removed2),
    removed_twice=lambda: pev(removed_twice),
    removed_wrong=lambda: pev(removed_wrong),
    added=lambda: pev(added),
    added_slash=lambda: pev(added_slash),
    added_none=lambda: pev(added_none),
    added_empty=lambda: pev(added_empty),
    undeclared=lambda: pev(undeclared),
    declared=lambda: pev(declared),
    refused=lambda: pev(refused),
    raising=lambda: pev(raising),
    other=lambda: pev(other_node),
    from_event=lambda: pe(
        lambda e: ParameterEventHandler.get_parameter_from_event(e, "a", "n").value.integer_value
    ),
    from_event_missing=lambda: pe(lambda e: ParameterEventHandler.get_parameter_from_event(e, "q", "n")),
    from_event_slash=lambda: pe(lambda e: ParameterEventHandler.get_parameter_from_event(e, "a", "/n").name),
    from_event_other=lambda: pe(lambda e: ParameterEventHandler.get_parameter_from_event(e, "a", "/m")),
    many=lambda: pe(
        lambda e: (
            len(ParameterEventHandler.get_parameters_from_event(e))
            if not hasattr(ParameterEventHandler.get_parameters_from_event(e), "__next__")
            else len(list(ParameterEventHandler.get_parameters_from_event(e)))
        )
    ),
    qos=lambda: type(ParameterEventHandler(Node("n"), qos_profile=5)).__name__,
    nonode=lambda: ParameterEventHandler(None),
    handle=lambda: (lambda h: [h.parameter_name, h.node_name, h.callback is print])(
        ParameterEventHandler(Node("n")).add_parameter_callback("a", "n", print)
    ),
    destroy=lambda: ParameterEventHandler(Node("n")).destroy(),
)


# sim time and jumps
def sim(use: Any = True) -> Any:
    return Node("n", parameter_overrides=[Parameter("use_sim_time", value=use)])


def clocked(stamps: Any, thr: Any = None, use: Any = True, toggle: Any = None) -> Any:
    n = sim(use)
    p = n.create_publisher(ClockMsg, "/clock", 10)
    jumps = []
    thr = thr or JumpThreshold(
        min_forward=Duration(seconds=1.0),
        min_backward=Duration(seconds=-1.0),
        on_clock_change=True,
    )
    # Without a reference to the handle, rclpy calls a callback that no longer exists.
    n.handle_of_jumps = n.get_clock().create_jump_callback(
        thr,
        pre_callback=lambda: jumps.append("pre"),
        post_callback=lambda j: jumps.append(
            (
                str(j.clock_change),
                j.delta.nanoseconds if hasattr(j.delta, "nanoseconds") else str(j.delta),
            )
        ),
    )
    end = time.monotonic() + 2
    while p.get_subscription_count() < 1 and time.monotonic() < end and use:
        time.sleep(0.02)
    times = []
    for s in stamps:
        p.publish(ClockMsg(clock=Time(nanoseconds=round(s * 1e9)).to_msg()))
        spin(n, 1.0, lambda s=s: n.get_clock().now().nanoseconds == round(s * 1e9))
        times.append(n.get_clock().now().nanoseconds)
    if toggle is not None:
        n.set_parameters([Parameter("use_sim_time", value=toggle)])
        spin(n, 0.1)
    jumps = [j if j == "pre" or abs(j[1]) < 10**15 else (j[0], "big") for j in jumps]
    return [times if use else len(times), jumps, n.get_clock().ros_time_is_active]


def threshold(f: Any, b: Any, c: Any) -> Any:
    return JumpThreshold(
        min_forward=f and Duration(seconds=f),
        min_backward=b and Duration(seconds=b),
        on_clock_change=c,
    )


def sim_timer(stamps: Any, period: Any = 1.0) -> Any:
    n = sim()
    p = n.create_publisher(ClockMsg, "/clock", 10)
    seen = []
    n.create_timer(period, lambda: seen.append(n.get_clock().now().nanoseconds // 10**6))
    end = time.monotonic() + 2
    while p.get_subscription_count() < 1 and time.monotonic() < end:
        time.sleep(0.02)
    for s in stamps:
        p.publish(ClockMsg(clock=Time(nanoseconds=round(s * 1e9)).to_msg()))
        spin(n, 0.25)
    return seen


def sleep_sim() -> Any:
    n = sim()
    p = n.create_publisher(ClockMsg, "/clock", 10)
    t = threading.Thread(target=rclpy.spin, args=(n,), daemon=True)
    t.start()
    time.sleep(0.4)
    p.publish(ClockMsg(clock=Time(seconds=10).to_msg()))
    time.sleep(0.1)
    res = []
    s = threading.Thread(
        target=lambda: res.append(n.get_clock().sleep_until(Time(seconds=12, clock_type=ClockType.ROS_TIME)))
    )
    s.start()
    time.sleep(0.1)
    a = list(res)
    p.publish(ClockMsg(clock=Time(seconds=13).to_msg()))
    s.join(2)
    return [a, res, s.is_alive()]


def jump_unreg() -> Any:
    n = sim()
    seen = []
    h = n.get_clock().create_jump_callback(threshold(1, -1, True), post_callback=seen.append)
    h.unregister() if hasattr(h, "unregister") else None
    return [
        hasattr(h, "unregister"),
        n.set_parameters([Parameter("use_sim_time", value=False)])[0].successful,
        len(seen),
    ]


def ctx_jump() -> Any:
    n = sim()
    seen = []
    with n.get_clock().create_jump_callback(threshold(1, -1, True), post_callback=lambda j: seen.append(1)):
        n.set_parameters([Parameter("use_sim_time", value=False)])
    n.set_parameters([Parameter("use_sim_time", value=True)])
    return len(seen)


lines(
    "sim",
    forward=lambda: clocked([1, 1.5, 5]),
    back=lambda: clocked([5, 4.5, 1]),
    thr_none=lambda: clocked([1, 9, 1], threshold(None, None, True), toggle=False),
    thr_change=lambda: clocked([1], threshold(1, -1, True), toggle=False),
    thr_nochange=lambda: clocked([1], threshold(1, -1, False), toggle=False),
    off_on=lambda: clocked([], threshold(1, -1, True), use=False, toggle=True),
    same=lambda: clocked([2, 2]),
    zero=lambda: clocked([0, 0]),
    exact=lambda: clocked([1, 2]),
    timer=lambda: sim_timer([1, 2, 3]),
    timer_jump=lambda: sim_timer([1, 10]),
    timer_back=lambda: sim_timer([10, 11, 2, 3.5]),
    timer_half=lambda: sim_timer([1, 1.5, 1.9, 2.1]),
    sleep=sleep_sim,
    unreg=jump_unreg,
    ctx=ctx_jump,
    thr_pos_back=lambda: JumpThreshold(min_forward=None, min_backward=Duration(seconds=1)),
    thr_neg_fwd=lambda: JumpThreshold(min_forward=Duration(seconds=-1), min_backward=None),
    thr_zero=lambda: JumpThreshold(min_forward=Duration(), min_backward=None),
    thr_zero_b=lambda: JumpThreshold(min_forward=None, min_backward=Duration()),
    thr_missing=lambda: JumpThreshold(min_forward=None),
    thr_pos=lambda: JumpThreshold(None, None, True),
    no_cb=lambda: ROSClock().create_jump_callback(threshold(1, -1, True)),
    text_cb=lambda: ROSClock().create_jump_callback(threshold(1, -1, True), pre_callback="x"),
    sys_cb=lambda: type(Clock().create_jump_callback(threshold(1, -1, True), pre_callback=print)).__name__,
    change_names=lambda: [c for c in dir(ClockChange) if c.isupper()],
    param_type=lambda: Node("n").set_parameters([Parameter("use_sim_time", value=3)])[0].reason,
    param_undeclare=lambda: Node("n").undeclare_parameter("use_sim_time"),
    param_default=lambda: Node("n").get_parameter("use_sim_time").value,
    over_text=lambda: (
        Node("n", parameter_overrides=[Parameter("use_sim_time", value="yes")])
        .get_parameter("use_sim_time")
        .value
    ),
    desc=lambda: Node("n").describe_parameter("use_sim_time").name,
    ros_active=lambda: [
        Clock().clock_type.name,
        ROSClock().ros_time_is_active,
        sim().get_clock().ros_time_is_active,
    ],
    sys_active=lambda: Clock().ros_time_is_active,
    set_override=lambda: ROSClock().set_ros_time_override(Time(seconds=3)),
    set_active=lambda: (
        lambda c: [
            c._set_ros_time_is_active(True),
            c.set_ros_time_override(Time(seconds=3, clock_type=ClockType.ROS_TIME)),
            c.now().nanoseconds,
        ]
    )(ROSClock()),
    ts=lambda: (
        lambda t: [
            t.ros_time_is_active,
            outcome(t.attach_clock, Clock()),
            outcome(t.attach_clock, ROSClock()),
        ]
    )(TimeSource(node=Node("n"))),
    ts_none=lambda: TimeSource().ros_time_is_active,
    ts_set=lambda: (
        lambda t: [
            setattr(t, "ros_time_is_active", True),
            t.ros_time_is_active,
            t.detach_node(),
            t.ros_time_is_active,
        ]
    )(TimeSource(node=Node("n"))),
    ts_attrs=lambda: sorted(a for a in dir(TimeSource) if not a.startswith("_")),
    ts_attach_none=lambda: TimeSource().attach_node(None),
)


# events, content filter
def ev(cb_kind: Any, pub_q: Any, sub_q: Any, wait: Any = 0.6, acts: Any = None) -> Any:
    n = Node("n")
    seen = []

    def rec(i: Any) -> Any:
        return seen.append(
            {
                k: (int(getattr(i, k)) if not isinstance(getattr(i, k), str) else getattr(i, k))
                for k in dir(i)
                if not k.startswith("_") and k != "policy_kind"
            }
        )

    pe = (
        PublisherEventCallbacks(**{cb_kind[4:]: rec}, use_default_callbacks=False)
        if cb_kind.startswith("pub_")
        else None
    )
    se = (
        SubscriptionEventCallbacks(**{cb_kind[4:]: rec}, use_default_callbacks=False)
        if cb_kind.startswith("sub_")
        else None
    )
    s = n.create_subscription(String, "t", print, sub_q, event_callbacks=se)
    p = n.create_publisher(String, "t", pub_q, event_callbacks=pe)
    spin(n, wait)
    if acts:
        acts(n, p, s)
        spin(n, 0.4)
    return seen


Q = QoSProfile
BE, RE = ReliabilityPolicy.BEST_EFFORT, ReliabilityPolicy.RELIABLE


def within(s: Any) -> Any:
    return QoSProfile(depth=1, deadline=Duration(seconds=s))


lines(
    "event",
    pub_matched=lambda: ev("pub_matched", 1, 1),
    sub_matched=lambda: ev("sub_matched", 1, 1),
    sub_unmatched=lambda: ev("sub_matched", 1, 1, acts=lambda n, p, s: n.destroy_publisher(p))[-1:],
    pub_unmatched=lambda: ev("pub_matched", 1, 1, acts=lambda n, p, s: n.destroy_subscription(s))[-1:],
    sub_incomp=lambda: ev("sub_incompatible_qos", Q(depth=1, reliability=BE), 1),
    pub_incomp=lambda: ev("pub_incompatible_qos", Q(depth=1, reliability=BE), 1),
    sub_type=lambda: ev("sub_incompatible_type", 1, 1),
    lost=lambda: ev("sub_message_lost", 1, 1),
    deadline=lambda: (
        len(ev("sub_deadline", within(0.2), within(0.2), acts=lambda n, p, s: p.publish(String()))) > 0
    ),
    none=lambda: SubscriptionEventCallbacks().deadline,
    defaults=lambda: PublisherEventCallbacks().use_default_callbacks,
    unknown=lambda: SubscriptionEventCallbacks(foo=print),
    text=lambda: Node("n").create_subscription(
        String, "t", print, 1, event_callbacks=SubscriptionEventCallbacks(matched="x")
    ),
    wrong=lambda: Node("n").create_subscription(String, "t", print, 1, event_callbacks="x"),
    swapped=lambda: Node("n").create_subscription(
        String, "t", print, 1, event_callbacks=PublisherEventCallbacks(matched=print)
    ),
    swapped2=lambda: Node("n").create_publisher(
        String, "t", 1, event_callbacks=SubscriptionEventCallbacks(matched=print)
    ),
    handlers=lambda: [
        type(h).__name__ for h in Node("n").create_subscription(String, "t", print, 1).event_handlers
    ],
    phandlers=lambda: [type(h).__name__ for h in Node("n").create_publisher(String, "t", 1).event_handlers],
    nodefault=lambda: (
        Node("n")
        .create_publisher(
            String, "t", 1, event_callbacks=PublisherEventCallbacks(use_default_callbacks=False)
        )
        .event_handlers
    ),
)


def cft(options: Any, msgs: Any = ("a", "b")) -> Any:
    n = Node("n")
    got = []
    n.create_subscription(String, "t", lambda m: got.append(m.data), 10, **options)
    p = n.create_publisher(String, "t", 10)
    time.sleep(0.4)
    for m in msgs:
        p.publish(String(data=m))
    spin(n, 0.4)
    return got


def cft_api() -> Any:
    s = Node("n").create_subscription(String, "t", print, 1)
    return [a for a in dir(s) if "filter" in a or "cft" in a]


lines(
    "filter",
    api=cft_api,
    opt=lambda: cft({"content_filter_options": None}),
    kw=lambda: cft({"filter_expression": "data = 'a'"}),
)


# pub/sub objects, loaned, raw
def raw() -> Any:
    n = Node("n")
    got = []
    n.create_subscription(Int32, "t", lambda b: got.append((type(b).__name__, b.hex())), 10, raw=True)
    p = n.create_publisher(Int32, "t", 10)
    time.sleep(0.4)
    p.publish(Int32(data=5))
    spin(n, 0.4)
    return got


def pub_bytes() -> Any:
    n = Node("n")
    got = []
    n.create_subscription(Int32, "t", lambda m: got.append(m.data), 10)
    p = n.create_publisher(Int32, "t", 10)
    time.sleep(0.4)
    p.publish(bytes([0, 1, 0, 0, 9, 0, 0, 0]))
    spin(n, 0.4)
    return got


def info() -> Any:
    n = Node("n")
    got = []
    n.create_subscription(
        Int32,
        "t",
        lambda m, i: got.append((type(i).__name__, sorted(i) if isinstance(i, dict) else "obj")),
        10,
    )
    p = n.create_publisher(Int32, "t", 10)
    time.sleep(0.4)
    p.publish(Int32(data=5))
    spin(n, 0.4)
    return got


def wfa(secs: Any, sub: Any = True, q: Any = 10) -> Any:
    n = Node("n")
    n.create_subscription(Int32, "t", print, q) if sub else None
    p = n.create_publisher(Int32, "t", 10)
    time.sleep(0.3)
    p.publish(Int32())
    return p.wait_for_all_acked(secs)


lines(
    "object",
    raw=raw,
    pub_bytes=pub_bytes,
    info=info,
    acked=lambda: wfa(Duration(seconds=1)),
    acked_none=lambda: wfa(Duration(seconds=1), False),
    acked_be=lambda: wfa(Duration(seconds=1), q=Q(depth=1, reliability=BE)),
    acked_float=lambda: wfa(1.0),
    acked_default=lambda: (lambda p: p.wait_for_all_acked())(Node("n").create_publisher(Int32, "t", 1)),
    pub_attrs=lambda: sorted(
        a for a in dir(Node("n").create_publisher(Int32, "t", 1)) if not a.startswith("_")
    ),
    rate_attrs=lambda: sorted(a for a in dir(Node("n").create_rate(1.0)) if not a.startswith("_")),
    pub_none=lambda: Node("n").create_publisher(Int32, "t", 1).publish(None),
    pub_cls=lambda: Node("n").create_publisher(Int32, "t", 1).publish(Int32),
    pub_other=lambda: Node("n").create_publisher(Int32, "t", 1).publish(String()),
    pub_int=lambda: Node("n").create_publisher(Int32, "t", 1).publish(5),
    loan=lambda: [
        hasattr(Node("n").create_publisher(Int32, "t", 1), a)
        for a in ("borrow_loaned_message", "can_loan_messages", "loan_message")
    ],
    nlive=lambda: Node("n").assert_liveliness() if hasattr(Node("n"), "assert_liveliness") else "no",
    ctxp=lambda: (lambda: [Node("n").create_publisher(Int32, "t", 1)])() and 1,
    with_pub=lambda: outcome(lambda: Node("n").create_publisher(Int32, "t", 1).__enter__().topic),
    with_node=lambda: outcome(lambda: Node("n").__enter__().get_name()),
    with_timer=lambda: outcome(lambda: type(Node("n").create_timer(1.0, print).__enter__()).__name__),
    cb_kind=lambda: str(Node("n").create_subscription(Int32, "t", print, 1).callback is print),
    topic_set=lambda: setattr(Node("n").create_subscription(Int32, "t", print, 1), "topic", "x"),
    cb_set=lambda: outcome(setattr, Node("n").create_subscription(Int32, "t", print, 1), "callback", len),
    cb_set3=lambda: outcome(
        setattr,
        Node("n").create_subscription(Int32, "t", print, 1),
        "callback",
        lambda a, b, c: 0,
    ),
    cb3=lambda: Node("n").create_subscription(Int32, "t", lambda a, b, c: 0, 1),
    cb0=lambda: type(Node("n").create_subscription(Int32, "t", lambda: 0, 1)).__name__,
    cbnone=lambda: Node("n").create_subscription(Int32, "t", None, 1),
    qoszero=lambda: Node("n").create_subscription(Int32, "t", print, 0).qos_profile.depth,
    qosneg=lambda: Node("n").create_subscription(Int32, "t", print, -1),
    qosnone=lambda: Node("n").create_subscription(Int32, "t", print, None),
    qosflt=lambda: Node("n").create_subscription(Int32, "t", print, 1.0),
    qosbool=lambda: Node("n").create_subscription(Int32, "t", print, True).qos_profile.depth,
)


def timer(f: Any) -> Any:
    n = Node("n")
    t = n.create_timer(0.5, lambda: None)
    return f(n, t)


lines(
    "timer",
    reset=lambda: timer(
        lambda n, t: [t.is_canceled(), t.cancel(), t.is_canceled(), t.reset(), t.is_canceled()]
    ),
    period=lambda: timer(
        lambda n, t: [t.timer_period_ns, setattr(t, "timer_period_ns", 10**8), t.timer_period_ns]
    ),
    period_neg=lambda: timer(lambda n, t: setattr(t, "timer_period_ns", -5)),
    period_flt=lambda: timer(lambda n, t: [setattr(t, "timer_period_ns", 5e8), t.timer_period_ns]),
    ready=lambda: timer(
        lambda n, t: [
            t.is_ready(),
            0 < t.time_until_next_call() <= 5 * 10**8,
            0 <= t.time_since_last_call() < 10**8,
        ]
    ),
    until_canceled=lambda: timer(lambda n, t: [t.cancel(), t.time_until_next_call()]),
    autostart=lambda: Node("n").create_timer(0.1, print, autostart=False).is_canceled(),
    autostart_none=lambda: Node("n").create_timer(0.1, print, autostart=None),
    zero=lambda: Node("n").create_timer(0.0, print).timer_period_ns,
    neg=lambda: Node("n").create_timer(-1.0, print),
    none=lambda: Node("n").create_timer(None, print),
    text=lambda: Node("n").create_timer("1", print),
    dur=lambda: Node("n").create_timer(Duration(seconds=1), print),
    int_=lambda: Node("n").create_timer(1, print).timer_period_ns,
    nan=lambda: Node("n").create_timer(float("nan"), print),
    inf=lambda: Node("n").create_timer(float("inf"), print),
    tiny=lambda: Node("n").create_timer(1e-10, print).timer_period_ns,
    huge=lambda: Node("n").create_timer(1e12, print),
    cbnone=lambda: type(Node("n").create_timer(1.0, None)).__name__,
    clock=lambda: (
        Node("n")
        .create_timer(1.0, print, clock=Clock(clock_type=ClockType.STEADY_TIME))
        .clock.clock_type.name
    ),
    clock_text=lambda: Node("n").create_timer(1.0, print, clock="x"),
    rate0=lambda: Node("n").create_rate(0),
    rate_neg=lambda: Node("n").create_rate(-1.0),
    rate_text=lambda: Node("n").create_rate("1"),
    rate_destroyed=lambda: (lambda r: [r.destroy(), outcome(r.sleep)])(Node("n").create_rate(10)),
    destroy=lambda: timer(
        lambda n, t: [
            n.destroy_timer(t),
            n.destroy_timer(t),
            outcome(t.cancel),
            outcome(t.is_canceled),
        ]
    ),
    cb_change=lambda: timer(lambda n, t: outcome(setattr, t, "callback", print)),
    info=lambda: timer(lambda n, t: [a for a in dir(t) if "info" in a]),
)
if __name__ == "__main__":
    main()
