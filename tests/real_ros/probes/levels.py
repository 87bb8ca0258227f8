# mypy: ignore-errors
"""Filters, levels and texts of log messages, /rosout and the logger services.

Many of the calls are wrong on purpose.
"""

import os
import time
from typing import Any

import rclpy
import rclpy.logging
from probing import lines, main, outcome, said
from rcl_interfaces.msg import Log
from rclpy.clock import Clock, ROSClock
from rclpy.duration import Duration
from rclpy.logging import (
    LoggingSeverity,
    get_logger,
    get_logger_effective_level,
    get_logger_level,
    get_logging_severity_from_string,
    set_logger_level,
)
from rclpy.node import Node

S = LoggingSeverity


def many(n: Any, wait: Any = 0.0, **kw: Any) -> Any:
    log = Node("n").get_logger()

    def go() -> Any:
        for i in range(n):
            log.info(f"m{i}", **kw)
            if wait:
                time.sleep(wait)

    return said(go)


def two_lines_once() -> Any:
    log = Node("n").get_logger()

    def go() -> Any:
        log.info("a", once=True)
        log.info("b", once=True)
        for _ in range(2):
            log.info("c", once=True)

    return said(go)


def change(kw1: Any, kw2: Any) -> Any:
    log = Node("n").get_logger()

    def go() -> Any:
        for kw in (kw1, kw2):
            log.info("x", **kw)

    return said(go)


def level_change() -> Any:
    log = Node("n").get_logger()

    def go() -> Any:
        for f in (log.info, log.warning):
            f("x")

    def g() -> Any:
        for s in (S.INFO, S.WARN):
            log.log("x", s)

    return [said(go), said(g)]


def levels(setup: Any) -> Any:
    n = Node("n")
    log = n.get_logger()
    child = log.get_child("c")

    def go() -> Any:
        setup(log, child)
        for logger in (log, child):
            for k in ("debug", "info", "warning", "error", "fatal"):
                getattr(logger, k)(k)

    return [
        said(go),
        outcome(log.get_effective_level),
        outcome(child.get_effective_level),
        outcome(log.is_enabled_for, S.INFO),
    ]


def setlev(v: Any) -> Any:
    log = get_logger("q")
    return [
        outcome(log.set_level, v),
        outcome(log.get_effective_level),
        outcome(log.set_level, S.INFO),
    ]


def filt(text: Any = "m", **kw: Any) -> Any:
    log = get_logger("f")
    return said(lambda: [log.info(text, **kw) for _ in range(3)])


def rosout(call: Any, n: Any = 1) -> Any:
    node = Node("n")
    got = []
    node.create_subscription(Log, "/rosout", got.append, 50)
    time.sleep(0.3)
    call(node)
    end = time.monotonic() + 1.0
    while time.monotonic() < end and len(got) < n:
        rclpy.spin_once(node, timeout_sec=0.05)
    return [[m.name, m.level, m.msg, m.function, m.line > 0, os.path.basename(m.file)] for m in got]


lines(
    "filter",
    once=lambda: many(3, once=True),
    skip=lambda: many(3, skip_first=True),
    skip_once=lambda: many(4, skip_first=True, once=True),
    throttle=lambda: many(6, 0.05, throttle_duration_sec=0.12),
    throttle0=lambda: many(2, throttle_duration_sec=0),
    throttle_int=lambda: many(2, throttle_duration_sec=1),
    throttle_neg=lambda: many(2, throttle_duration_sec=-1.0),
    throttle_none=lambda: many(2, throttle_duration_sec=None),
    throttle_text=lambda: many(2, throttle_duration_sec="1"),
    throttle_dur=lambda: many(2, throttle_duration_sec=Duration(seconds=1)),
    throttle_skip=lambda: many(6, 0.05, throttle_duration_sec=0.12, skip_first=True),
    once_false=lambda: many(2, once=False),
    skip_false=lambda: many(2, skip_first=False),
    once_text=lambda: many(2, once="yes"),
    once_none=lambda: many(2, once=None),
    unknown=lambda: many(1, twice=True),
    source=lambda: many(3, 0.02, throttle_duration_sec=1.0, throttle_time_source_type="SYSTEM_TIME"),
    source_clock=lambda: many(3, throttle_duration_sec=1.0, throttle_time_source_type=ROSClock()),
    source_clock2=lambda: many(3, throttle_duration_sec=1.0, throttle_time_source_type=Clock()),
    source_steady=lambda: many(2, throttle_duration_sec=1.0, throttle_time_source_type="STEADY_TIME"),
    source_bad=lambda: many(2, throttle_duration_sec=1.0, throttle_time_source_type="MOON"),
    source_only=lambda: many(2, throttle_time_source_type="ROS_TIME"),
    two_once=two_lines_once,
    change=lambda: change({"once": True}, {"skip_first": True}),
    change2=lambda: change({}, {"once": True}),
    change3=lambda: change({"once": True}, {}),
    change4=lambda: change({"throttle_duration_sec": 1.0}, {"throttle_duration_sec": 2.0}),
    level_change=level_change,
    plain=lambda: filt(),
    name=lambda: filt(name="other"),
    severity=lambda: filt(severity=S.WARN),
)
lines(
    "level",
    debug=lambda: levels(lambda log, c: log.set_level(S.DEBUG)),
    child=lambda: levels(lambda log, c: c.set_level(S.ERROR)),
    both=lambda: levels(lambda log, c: (log.set_level(S.FATAL), c.set_level(S.DEBUG))),
    unset=lambda: levels(lambda log, c: (log.set_level(S.WARN), log.set_level(S.UNSET))),
    kw=lambda: levels(lambda log, c: log.set_level(level=S.WARN)),
    none=lambda: setlev(None),
    num=lambda: setlev(30),
    odd=lambda: setlev(35),
    text=lambda: setlev("warn"),
    neg=lambda: setlev(-1),
    big=lambda: setlev(60),
    flt=lambda: setlev(30.0),
    bool_=lambda: setlev(True),
    glob=lambda: [
        set_logger_level("zz", S.WARN),
        get_logger_level("zz"),
        get_logger_effective_level("zz.a"),
        get_logger_level("zz.a"),
    ],
    from_string=lambda: [get_logging_severity_from_string(x) for x in ("DEBUG", "INFO")],
    from_low=lambda: get_logging_severity_from_string("warn"),
    from_bad=lambda: get_logging_severity_from_string("nope"),
    sevs=lambda: [(s.name, s.value) for s in S],
    sevstr=lambda: str(S.WARN),
    sevcmp=lambda: S.WARN > S.INFO,
    isen=lambda: [get_logger("a").is_enabled_for(s) for s in S],
    isen_bad=lambda: get_logger("a").is_enabled_for("info"),
    get_set=lambda: get_logger("a").get_level() if hasattr(get_logger("a"), "get_level") else "no",
    det=lambda: set_logger_level("zz", S.WARN, detailed_error=True),
    empty=lambda: get_logger("").info("x"),
    none_name=lambda: get_logger(None),
    num_name=lambda: get_logger(5),
    slash=lambda: get_logger("a/b").name,
    dots=lambda: get_logger("a..b").name,
)
lines(
    "msg",
    fmt=lambda: said(lambda: get_logger("a").info("%s %d")),
    args=lambda: said(lambda: get_logger("a").info("%s", "x")),
    kw=lambda: said(lambda: get_logger("a").info(message="hi")),
    empty=lambda: said(lambda: get_logger("a").info("")),
    newline=lambda: said(lambda: get_logger("a").info("a\nb")),
    uni=lambda: said(lambda: get_logger("a").info("ä→")),
    brace=lambda: said(lambda: get_logger("a").info("{x}")),
    long=lambda: [len(line) for line in said(lambda: get_logger("a").info("x" * 5000))[1]],
    none=lambda: said(lambda: get_logger("a").info()),
    warn=lambda: said(lambda: get_logger("a").warn("w")),
    log=lambda: said(lambda: get_logger("a").log("m", S.ERROR)),
    log_pos=lambda: said(lambda: get_logger("a").log("m", 20)),
    log_bad=lambda: said(lambda: get_logger("a").log("m", 17)),
    log_none=lambda: said(lambda: get_logger("a").log("m", None)),
    unset=lambda: said(lambda: get_logger("a").log("m", S.UNSET)),
    ret=lambda: [get_logger("a").info("x"), get_logger("a").debug("x")],
    child_name=lambda: get_logger("a").get_child("b").name,
    child_empty=lambda: get_logger("a").get_child("").name,
    child_none=lambda: get_logger("a").get_child(None).name,
    child_of_root=lambda: get_logger("").get_child("b").name,
    logger_name=lambda: [
        Node("n").get_logger().name,
        Node("n", namespace="/a/b").get_logger().name,
    ],
    same=lambda: get_logger("a") is get_logger("a"),
    eq=lambda: get_logger("a") == get_logger("a"),
    nodesame=lambda: (lambda n: n.get_logger() is n.get_logger())(Node("n")),
    critical=lambda: get_logger("a").critical("x"),
    exception=lambda: get_logger("a").exception("x"),
)
lines(
    "rosout",
    info=lambda: rosout(lambda n: n.get_logger().info("hi")),
    child=lambda: rosout(lambda n: n.get_logger().get_child("c").warning("hi")),
    debug=lambda: rosout(lambda n: n.get_logger().debug("hi")),
    named=lambda: rosout(lambda n: get_logger("other").info("hi")),
    off=lambda: rosout(lambda n: Node("m", enable_rosout=False).get_logger().info("hi")),
    other=lambda: rosout(lambda n: get_logger("n").info("same name")),
    nl=lambda: rosout(lambda n: n.get_logger().info("a\nb")),
    level=lambda: rosout(
        lambda n: (
            n.get_logger().set_level(S.ERROR),
            n.get_logger().info("no"),
            n.get_logger().error("yes"),
        )
    ),
)


def srv(level: Any, names: Any = ("n",)) -> Any:
    from rcl_interfaces.msg import LoggerLevel
    from rcl_interfaces.srv import GetLoggerLevels, SetLoggerLevels

    n = Node("n", enable_logger_service=True)
    c = n.create_client(SetLoggerLevels, "/n/set_logger_levels")
    g = n.create_client(GetLoggerLevels, "/n/get_logger_levels")
    c.wait_for_service(3.0)
    g.wait_for_service(3.0)
    f = c.call_async(SetLoggerLevels.Request(levels=[LoggerLevel(name=x, level=level) for x in names]))
    rclpy.spin_until_future_complete(n, f, timeout_sec=3.0)
    h = g.call_async(GetLoggerLevels.Request(names=["n", "zzz"]))
    rclpy.spin_until_future_complete(n, h, timeout_sec=3.0)
    return [
        [(r.successful, r.reason) for r in f.result().results],
        [(one.name, one.level) for one in h.result().levels],
    ]


lines(
    "service",
    warn=lambda: srv(30),
    zero=lambda: srv(0),
    odd=lambda: srv(33),
    two=lambda: srv(10, ("n", "q.r")),
    empty=lambda: srv(20, ()),
    noname=lambda: srv(20, ("",)),
)
if __name__ == "__main__":
    main()
