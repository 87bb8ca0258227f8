# mypy: ignore-errors
"""Remapping rules of nodes and topics, domains, and parameters that override QoS.

Many of the calls are wrong on purpose.
"""

from typing import Any

import rclpy
from probing import lines, main
from rclpy.node import Node
from rclpy.qos import QoSPolicyKind, QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions
from std_msgs.msg import String


def ns(*rules: Any, **kw: Any) -> Any:
    rclpy.shutdown()
    rclpy.init(args=["x", "--ros-args", *(w for r in rules for w in ("-r", r))])
    n = Node("n", **kw)
    return [
        n.get_namespace(),
        n.get_fully_qualified_name(),
        n.create_publisher(String, "t", 1).topic_name,
    ]


def dom(v: Any) -> Any:
    rclpy.shutdown()
    rclpy.init(domain_id=v)
    return rclpy.get_default_context().get_domain_id()


def over(o: Any, **kw: Any) -> Any:
    n = Node("n", **kw)
    p = n.create_publisher(String, "t", QoSProfile(depth=5), qos_overriding_options=o)
    return [sorted(x for x in n._parameters if "qos" in x), p.qos_profile.depth]


def over2(o: Any, args: Any) -> Any:
    rclpy.shutdown()
    rclpy.init(args=["x", "--ros-args", *args])
    n = Node("n")
    p = n.create_publisher(String, "t", QoSProfile(depth=5), qos_overriding_options=o)
    s = n.create_subscription(String, "t", print, QoSProfile(depth=5), qos_overriding_options=o)
    return [
        p.qos_profile.depth,
        s.qos_profile.depth,
        str(p.qos_profile.reliability),
        {k: v.value for k, v in n._parameters.items() if "qos" in k},
    ]


K = QoSPolicyKind
lines(
    "ns",
    slash=lambda: ns("__ns:=/a/"),
    plain=lambda: ns("__ns:=/a"),
    rel=lambda: ns("__ns:=a"),
    empty=lambda: ns("__ns:="),
    root=lambda: ns("__ns:=/"),
    two=lambda: ns("__ns:=/a//b"),
    deep=lambda: ns("__ns:=/a/b"),
    deepslash=lambda: ns("__ns:=/a/b/"),
    tilde=lambda: ns("__ns:=~"),
    num=lambda: ns("__ns:=/1a"),
    twice=lambda: ns("__ns:=/a", "__ns:=/b"),
    kw=lambda: ns("__ns:=/a", namespace="/k"),
    kwslash=lambda: ns(namespace="/k/"),
    kwrel=lambda: ns(namespace="k"),
    kwroot=lambda: ns(namespace="//"),
    name=lambda: ns("__node:=a/b"),
    nameslash=lambda: ns("__name:=x/"),
    node_dot=lambda: ns("n:__node:=q"),
    other=lambda: ns("m:__node:=q"),
    nodens=lambda: ns("n:__ns:=/q"),
    topic_slash=lambda: ns("t:=/a/"),
    topic_abs=lambda: ns("/t:=/a"),
    topic_tilde=lambda: ns("t:=~/a"),
    topic_star=lambda: ns("*:=/a"),
    topic_re=lambda: ns("/**:=/a"),
    empty_from=lambda: ns(":=/a"),
    empty_to=lambda: ns("t:="),
    sp=lambda: ns("t := a"),
    two_eq=lambda: ns("t:=a:=b"),
    rosout=lambda: ns("/rosout:=/x"),
    privtop=lambda: ns("~/t:=u"),
)
lines(
    "domain",
    true=lambda: dom(True),
    false=lambda: dom(False),
    zero=lambda: dom(0),
    neg=lambda: dom(-1),
    big=lambda: dom(233),
    floatv=lambda: dom(1.0),
    text=lambda: dom("1"),
    hundred=lambda: dom(101),
    huge=lambda: dom(10**20),
    floaty=lambda: dom(1.5),
)
lines(
    "over",
    text=lambda: over(QoSOverridingOptions("depth")),
    texts=lambda: over(QoSOverridingOptions(["depth"])),
    kind=lambda: over(QoSOverridingOptions([K.DEPTH])),
    kind1=lambda: over(QoSOverridingOptions(K.DEPTH)),
    none=lambda: over(QoSOverridingOptions(None)),
    empty=lambda: over(QoSOverridingOptions([])),
    default=lambda: over(QoSOverridingOptions.with_default_policies()),
    bad=lambda: over(QoSOverridingOptions(["nope"])),
    num=lambda: over(QoSOverridingOptions([5])),
    num1=lambda: over(QoSOverridingOptions(5)),
    noargs=lambda: QoSOverridingOptions(),
    id=lambda: over(QoSOverridingOptions([K.DEPTH], entity_id="me")),
    cb=lambda: over(QoSOverridingOptions([K.DEPTH], callback=lambda q: False)),
    cbt=lambda: over(QoSOverridingOptions([K.DEPTH], callback=lambda q: True)),
    gen=lambda: over(QoSOverridingOptions(k for k in [K.DEPTH, K.HISTORY])),
    tup=lambda: over(QoSOverridingOptions((K.DEPTH, K.DEPTH))),
    all=lambda: over(QoSOverridingOptions(list(K))),
    inv=lambda: over(QoSOverridingOptions([K.INVALID])),
    opt=lambda: over("depth"),
    opt2=lambda: over(QoSOverridingOptions(k for k in K if k not in (K.INVALID,))),
    kinds=lambda: QoSOverridingOptions([K.DEPTH]).policy_kinds,
    kinds2=lambda: list(QoSOverridingOptions.with_default_policies().policy_kinds),
    eid=lambda: QoSOverridingOptions([K.DEPTH]).entity_id,
    cbk=lambda: QoSOverridingOptions([K.DEPTH]).callback,
    defcb=lambda: over(QoSOverridingOptions.with_default_policies(callback=print, entity_id="a b")),
    numid=lambda: over(QoSOverridingOptions([K.DEPTH], entity_id=5)),
    set=lambda: over2(QoSOverridingOptions([K.DEPTH]), ["-p", "qos_overrides./t.publisher.depth:=9"]),
    set2=lambda: over2(
        QoSOverridingOptions([K.DEPTH, K.RELIABILITY]),
        ["-p", "qos_overrides./t.publisher.reliability:=best_effort"],
    ),
    setbad=lambda: over2(
        QoSOverridingOptions([K.DEPTH, K.RELIABILITY]),
        ["-p", "qos_overrides./t.publisher.reliability:=nope"],
    ),
    setnum=lambda: over2(QoSOverridingOptions([K.DEPTH]), ["-p", "qos_overrides./t.publisher.depth:=abc"]),
    setneg=lambda: over2(QoSOverridingOptions([K.DEPTH]), ["-p", "qos_overrides./t.publisher.depth:=-1"]),
    setsub=lambda: over2(QoSOverridingOptions([K.DEPTH]), ["-p", "qos_overrides./t.subscription.depth:=3"]),
    setdl=lambda: over2(
        QoSOverridingOptions([K.DEADLINE]), ["-p", "qos_overrides./t.subscription.deadline:=1000"]
    ),
)
if __name__ == "__main__":
    main()
