# mypy: ignore-errors
"""Publishers, subscriptions, names, QoS profiles, events, and their graph queries.

Many of the calls are wrong on purpose.
"""

import copy
import pickle
import time
from collections.abc import Callable
from typing import Any

from geometry_msgs.msg import Point, Pose
from probing import Fibonacci, lines, main, outcome, probe
from rclpy.action import ActionClient, ActionServer
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.executors import SingleThreadedExecutor
from rclpy.expand_topic_name import expand_topic_name
from rclpy.node import Node
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    InvalidQoSProfileException,
    LivelinessPolicy,
    QoSPolicyKind,
    QoSPresetProfiles,
    QoSProfile,
    ReliabilityPolicy,
    qos_check_compatible,
    qos_profile_sensor_data,
    qos_profile_services_default,
    qos_profile_system_default,
)
from rclpy.topic_endpoint_info import TopicEndpointInfo, TopicEndpointTypeEnum
from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden
from rclpy.validate_full_topic_name import validate_full_topic_name
from rclpy.validate_namespace import validate_namespace
from rclpy.validate_node_name import validate_node_name
from rclpy.validate_parameter_name import validate_parameter_name
from rclpy.validate_topic_name import validate_topic_name
from rclpy.wait_for_message import wait_for_message
from std_msgs.msg import Int32, String
from std_srvs.srv import Trigger


def _until(ready: Callable[[], Any], *nodes: Any, limit: float = 5.0) -> bool:
    executor = SingleThreadedExecutor()
    for node in nodes:
        executor.add_node(node)
    end = time.monotonic() + limit
    while not ready() and time.monotonic() < end:
        executor.spin_once(timeout_sec=0.02)
    for node in nodes:
        executor.remove_node(node)
    return bool(ready())


NODE_NAMES = (
    "a",
    "A_1",
    "_a",
    "1a",
    "a-b",
    "a b",
    "a/b",
    "",
    "ä",
    "a" * 255,
    "a" * 256,
    3,
    None,
    "a.b",
    "~a",
)
NAMESPACES = (
    "",
    "/",
    "a",
    "/a",
    "/a/b",
    "a/",
    "/a//b",
    "/1",
    "/a b",
    "~",
    "/~",
    "/a-b",
    3,
    None,
    "/" + "a" * 300,
)
TOPICS = (
    *("t", "/t", "~/t", "~t", "t/", "a//b", "", "a b", "{node}/t", "{ns}/t", "{x}/t", "{node", "t}", "1t"),
    *("a/1", "~", "~/", "a~b", "__t", "a__b", "ä", "t-x", "t.x", "/a/~/b", "{node}{ns}", 3, None, "a" * 300),
    *("/", "{}", "{1}"),
)

lines(
    "node_name",
    **{
        str(at): lambda name=name: Node(name).get_fully_qualified_name() for at, name in enumerate(NODE_NAMES)
    },
)
lines(
    "namespace",
    **{
        str(at): lambda name=name: Node("n", namespace=name).get_namespace()
        for at, name in enumerate(NAMESPACES)
    },
)
lines(
    "publisher_topic",
    **{
        str(at): lambda name=name: Node("n", namespace="/ns").create_publisher(String, name, 1).topic_name
        for at, name in enumerate(TOPICS)
    },
)
lines(
    "resolve",
    **{
        str(at): lambda name=name: Node("n", namespace="/ns").resolve_topic_name(name)
        for at, name in enumerate(TOPICS)
    },
)
lines(
    "resolve_service",
    **{
        str(at): lambda name=name: Node("n", namespace="/ns").resolve_service_name(name)
        for at, name in enumerate(TOPICS)
    },
)
lines(
    "service_name",
    **{
        str(at): lambda name=name: (
            Node("n", namespace="/ns").create_service(Trigger, name, print).service_name
        )
        for at, name in enumerate(TOPICS)
    },
)
lines(
    "client_name",
    **{
        str(at): lambda name=name: Node("n", namespace="/ns").create_client(Trigger, name).service_name
        for at, name in enumerate(TOPICS)
    },
)
lines(
    "action_name",
    **{
        str(at): lambda name=name: bool(ActionServer(Node("n", namespace="/ns"), Fibonacci, name, print))
        for at, name in enumerate(TOPICS)
    },
)
lines(
    "action_client_name",
    **{
        str(at): lambda name=name: bool(ActionClient(Node("n", namespace="/ns"), Fibonacci, name))
        for at, name in enumerate(TOPICS)
    },
)
lines(
    "info_topic",
    **{
        str(at): lambda name=name: Node("n", namespace="/ns").get_publishers_info_by_topic(name)
        for at, name in enumerate(TOPICS)
    },
)
lines(
    "count_topic",
    **{
        str(at): lambda name=name: Node("n", namespace="/ns").count_publishers(name)
        for at, name in enumerate(TOPICS)
    },
)
lines(
    "expand",
    **{str(at): lambda name=name: expand_topic_name(name, "n", "/ns") for at, name in enumerate(TOPICS)},
)
lines(
    "validate_topic",
    **{str(at): lambda name=name: validate_topic_name(name) for at, name in enumerate(TOPICS)},
)
lines(
    "validate_full",
    **{str(at): lambda name=name: validate_full_topic_name(name) for at, name in enumerate(TOPICS) if name},
)
lines(
    "hidden",
    **{
        str(at): lambda name=name: topic_or_service_is_hidden(name)
        for at, name in enumerate(("a", "_a", "/a/_b", "a_b", "/_a/b", ""))
    },
)
lines(
    "validate",
    node=lambda: validate_node_name("a b"),
    node_fine=lambda: validate_node_name("a"),
    namespace=lambda: validate_namespace("a"),
    namespace_fine=lambda: validate_namespace("/a"),
    parameter=lambda: validate_parameter_name("a"),
    parameter_empty=lambda: validate_parameter_name(""),
    parameter_dash=lambda: validate_parameter_name("a-b"),
    service=lambda: validate_topic_name("a b", is_service=True),
    full_service=lambda: validate_full_topic_name("a b", is_service=True),
    expand_node=lambda: expand_topic_name("t", "a b", "/"),
    expand_namespace=lambda: expand_topic_name("t", "a", "x"),
    only_expand=lambda: Node("n").resolve_topic_name("~/t", only_expand=True),
)


def _publisher(kind: Any = String, topic: Any = "t", qos: Any = 10, **more: Any) -> Any:
    return Node("n").create_publisher(kind, topic, qos, **more)


def _subscription(
    kind: Any = String, topic: Any = "t", callback: Any = print, qos: Any = 10, **more: Any
) -> Any:
    return Node("n").create_subscription(kind, topic, callback, qos, **more)


lines(
    "publisher",
    of_a_service=lambda: _publisher(Trigger),
    of_an_action=lambda: _publisher(Fibonacci),
    of_a_text=lambda: _publisher("String"),
    of_an_instance=lambda: _publisher(String()).msg_type,
    of_nothing=lambda: _publisher(None),
    of_an_int=lambda: _publisher(int),
    zero=lambda: _publisher(qos=0).qos_profile.depth,
    negative=lambda: _publisher(qos=-1),
    text=lambda: _publisher(qos="10"),
    float=lambda: _publisher(qos=1.0),
    true=lambda: _publisher(qos=True).qos_profile.depth,
    none=lambda: _publisher(qos=None),
    reliability=lambda: _publisher(qos=ReliabilityPolicy.RELIABLE),
    preset=lambda: _publisher(qos=QoSPresetProfiles.SENSOR_DATA),
    preset_value=lambda: _publisher(qos=QoSPresetProfiles.SENSOR_DATA.value).qos_profile.reliability,
    wrong_group=lambda: _publisher(callback_group=3),
    unknown_option=lambda: _publisher(latch=True),
    attributes=lambda: [_publisher().topic, _publisher().topic_name, _publisher().msg_type.__name__],
    logger=lambda: _publisher().logger_name,
    handlers=lambda: len(_publisher().event_handlers),
    wait_for_acked=lambda: _publisher().wait_for_all_acked(),
    wait_for_acked_limit=lambda: _publisher().wait_for_all_acked(Duration(seconds=1)),
    count=lambda: _publisher().get_subscription_count(),
    publish_other=lambda: _publisher().publish(Int32()),
    publish_text=lambda: _publisher().publish("x"),
    publish_class=lambda: _publisher().publish(String),
    publish_nothing=lambda: _publisher().publish(None),
    publish_dict=lambda: _publisher().publish({"data": "x"}),
    publish_without=lambda: _publisher().publish(),
    publish_bytes=lambda: _publisher().publish(b"x"),
    in_with=lambda: _in_with(_publisher()),
    destroyed=lambda: _destroyed(),
    group=lambda: (
        type(_publisher().callback_group).__name__ if hasattr(_publisher(), "callback_group") else None
    ),
)
lines(
    "subscription",
    of_a_service=lambda: _subscription(Trigger),
    of_nothing=lambda: _subscription(None),
    no_callback=lambda: _subscription(callback=None),
    callback_text=lambda: _subscription(callback="x"),
    callback_without_arguments=lambda: _subscription(callback=lambda: None),
    callback_with_three=lambda: _subscription(callback=lambda a, b, c: None),
    callback_with_any=lambda: bool(_subscription(callback=lambda *args: None)),
    swapped=lambda: Node("n").create_subscription(String, "t", 10, print),
    qos_missing=lambda: Node("n").create_subscription(String, "t", print),
    zero=lambda: _subscription(qos=0).qos_profile.depth,
    attributes=lambda: [_subscription().topic, _subscription().topic_name, _subscription().raw],
    callback=lambda: _subscription().callback is print,
    logger=lambda: _subscription().logger_name,
    handlers=lambda: len(_subscription().event_handlers),
    count=lambda: _subscription().get_publisher_count(),
    in_with=lambda: _in_with(_subscription()),
    wrong_group=lambda: _subscription(callback_group=3),
    group=lambda: type(_subscription().callback_group).__name__,
    set_callback=lambda: setattr(_subscription(), "callback", repr),
)


def _in_with(entity: Any) -> list[Any]:
    with entity as inside:
        found = inside is entity
    return [found, outcome(lambda: entity.topic_name)]


def _destroyed() -> list[str]:
    node = Node("n")
    publisher, subscription = (
        node.create_publisher(String, "t", 1),
        node.create_subscription(String, "t", print, 1),
    )
    found = [str(node.destroy_publisher(publisher)), str(node.destroy_subscription(subscription))]
    found += [str(node.destroy_publisher(publisher)), str(node.destroy_subscription(subscription))]
    found += [outcome(lambda: publisher.publish(String())), outcome(lambda: publisher.topic_name)]
    return [*found, outcome(publisher.get_subscription_count), outcome(lambda: subscription.topic_name)]


def _heard(callback: Any, count: int = 1, **more: Any) -> list[Any]:
    node, seen = Node("n"), []
    publisher = node.create_publisher(String, "t", 10)
    node.create_subscription(String, "t", lambda *args: seen.append(args), 10) if callback is None else None
    if callback is not None:
        node.create_subscription(String, "t", lambda m: callback(seen, m), 10, **more)
    _until(lambda: publisher.get_subscription_count() == 1, node)
    for number in range(count):
        publisher.publish(String(data=str(number)))
    error = outcome(_until, lambda: len(seen) >= count, node, limit=1.0)
    return [seen, error]


lines(
    "heard",
    messages=lambda: _heard(lambda seen, m: seen.append(m.data), 3),
    raw=lambda: _heard(lambda seen, m: seen.append(bytes(m)), raw=True),
    error=lambda: _heard(lambda seen, m: 1 / 0),
    wrong_attribute=lambda: _heard(lambda seen, m: m.date),
    own_copy=lambda: _copies(),
    info=lambda: _info(),
    wait_for_message=lambda: wait_for_message(String, Node("n"), "nothing", time_to_wait=0.2),
)


def _copies() -> list[Any]:
    node, seen = Node("n"), []
    publisher = node.create_publisher(String, "t", 10)
    for _ in range(2):
        node.create_subscription(String, "t", seen.append, 10)
    _until(lambda: publisher.get_subscription_count() == 2, node)
    message = String(data="x")
    publisher.publish(message)
    message.data = "y"
    _until(lambda: len(seen) == 2, node)
    return [seen, seen[0] is seen[1], seen[0] is message]


def _info() -> list[Any]:
    node, seen = Node("n"), []
    publisher = node.create_publisher(String, "t", 10)
    node.create_subscription(String, "t", lambda m, info: seen.append(info), 10)
    _until(lambda: publisher.get_subscription_count() == 1, node)
    for _ in range(2):
        publisher.publish(String(data="x"))
    _until(lambda: len(seen) == 2, node)
    return [(type(one).__name__, sorted(one), one["publication_sequence_number"]) for one in seen]


def _late(publisher: Any, subscription: Any, count: int = 3) -> list[Any]:
    """Publish before the subscription exists. Return the messages that it receives."""
    node, seen = Node("n"), []
    sender = node.create_publisher(Int32, "t", publisher)
    for number in range(count):
        sender.publish(Int32(data=number))
    node.create_subscription(Int32, "t", lambda m: seen.append(m.data), subscription)
    _until(lambda: False, node, limit=0.4)
    return seen


def _latched(depth: int = 1) -> QoSProfile:
    return QoSProfile(depth=depth, durability=DurabilityPolicy.TRANSIENT_LOCAL)


lines(
    "late",
    volatile=lambda: _late(10, 10),
    latched=lambda: _late(_latched(), _latched()),
    latched_more=lambda: _late(_latched(2), _latched(10)),
    latched_to_volatile=lambda: _late(_latched(10), 10),
    volatile_to_latched=lambda: _late(10, _latched(10)),
)
lines(
    "profile",
    nothing=lambda: QoSProfile(),
    depth=lambda: QoSProfile(depth=3),
    text=lambda: str(QoSProfile(depth=3)),
    keep_last=lambda: QoSProfile(history=HistoryPolicy.KEEP_LAST),
    keep_all=lambda: QoSProfile(history=HistoryPolicy.KEEP_ALL).depth,
    all_and_depth=lambda: QoSProfile(history=HistoryPolicy.KEEP_ALL, depth=3),
    negative=lambda: QoSProfile(depth=-1),
    depth_float=lambda: QoSProfile(depth=1.0),
    depth_text=lambda: QoSProfile(depth="1"),
    unknown=lambda: QoSProfile(depth=1, latch=True),
    reliability_text=lambda: QoSProfile(depth=1, reliability="reliable").reliability,
    reliability_int=lambda: QoSProfile(depth=1, reliability=1).reliability,
    reliability_wrong=lambda: QoSProfile(depth=1, reliability=77),
    durability_of_reliability=lambda: QoSProfile(depth=1, durability=ReliabilityPolicy.RELIABLE).durability,
    deadline_float=lambda: QoSProfile(depth=1, deadline=1.0),
    deadline=lambda: QoSProfile(depth=1, deadline=Duration(seconds=1)).deadline,
    lifespan=lambda: QoSProfile(depth=1, lifespan=Duration(seconds=1)).lifespan,
    equal=lambda: QoSProfile(depth=1) == QoSProfile(depth=1),
    not_equal=lambda: QoSProfile(depth=1) == QoSProfile(depth=2),
    equal_int=lambda: QoSProfile(depth=1) == 1,
    hashed=lambda: hash(QoSProfile(depth=1)),
    copied=lambda: copy.copy(QoSProfile(depth=1)).depth,
    deeply_copied=lambda: copy.deepcopy(QoSProfile(depth=1)),
    pickled=lambda: pickle.dumps(QoSProfile(depth=1)) and True,
    assigned=lambda: setattr(QoSProfile(depth=1), "depth", -1),
    assigned_text=lambda: setattr(QoSProfile(depth=1), "depth", "x"),
    assigned_new=lambda: setattr(QoSProfile(depth=1), "dept", 3),
    sensor=lambda: qos_profile_sensor_data,
    services=lambda: qos_profile_services_default,
    system=lambda: qos_profile_system_default,
    presets=lambda: [one.name for one in QoSPresetProfiles],
    short_keys=lambda: QoSPresetProfiles.short_keys(),
    from_short_key=lambda: QoSPresetProfiles.get_from_short_key("sensor_data"),
    from_wrong_key=lambda: QoSPresetProfiles.get_from_short_key("x"),
    reliability_keys=lambda: ReliabilityPolicy.short_keys(),
    durability_keys=lambda: DurabilityPolicy.short_keys(),
    history_keys=lambda: HistoryPolicy.short_keys(),
    liveliness_keys=lambda: LivelinessPolicy.short_keys(),
    reliability_key=lambda: ReliabilityPolicy.get_from_short_key("reliable"),
    short_key=lambda: [one.short_key for one in ReliabilityPolicy if one.name != "UNKNOWN"],
    short_key_unknown=lambda: ReliabilityPolicy.UNKNOWN.short_key,
    values=lambda: [(one.name, one.value) for one in (*ReliabilityPolicy, *DurabilityPolicy, *HistoryPolicy)],
    livelinesses=lambda: [(one.name, one.value) for one in LivelinessPolicy],
    kinds=lambda: [(one.name, one.value) for one in QoSPolicyKind],
    error=lambda: InvalidQoSProfileException("x"),
)
_PROFILES = {
    "plain": QoSProfile(depth=1),
    "sensor": qos_profile_sensor_data,
    "latched": _latched(),
    "deadline": QoSProfile(depth=1, deadline=Duration(seconds=1)),
    "long_deadline": QoSProfile(depth=1, deadline=Duration(seconds=2)),
    "manual": QoSProfile(depth=1, liveliness=LivelinessPolicy.MANUAL_BY_TOPIC),
    "lease": QoSProfile(depth=1, liveliness_lease_duration=Duration(seconds=1)),
    "system": qos_profile_system_default,
    "best": QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_AVAILABLE),
}
lines(
    "compatible",
    **{
        f"{one}_{two}": lambda one=one, two=two: qos_check_compatible(_PROFILES[one], _PROFILES[two])
        for one in _PROFILES
        for two in _PROFILES
    },
)


def _endpoint(qos: Any = 10, kind: str = "publishers") -> Any:
    node = Node("n", namespace="/ns")
    node.create_publisher(String, "t", qos)
    node.create_subscription(String, "t", print, qos)
    query = getattr(node, f"get_{kind}_info_by_topic")
    _until(lambda: query("/ns/t"), node)
    [info] = query("/ns/t")
    info.endpoint_gid = []
    return info


lines(
    "endpoint",
    text=lambda: str(_endpoint()),
    text_of_subscription=lambda: str(_endpoint(kind="subscriptions")),
    text_best_effort=lambda: str(_endpoint(qos_profile_sensor_data)),
    text_limits=lambda: str(_endpoint(_PROFILES["deadline"])),
    text_lease=lambda: str(_endpoint(_PROFILES["lease"])),
    text_lifespan=lambda: str(_endpoint(QoSProfile(depth=1, lifespan=Duration(seconds=1)))),
    hash=lambda: str(_endpoint().topic_type_hash),
    hash_version=lambda: _endpoint().topic_type_hash.version,
    hash_length=lambda: len(_endpoint().topic_type_hash.value),
    name=lambda: _endpoint().node_name,
    namespace=lambda: _endpoint().node_namespace,
    type=lambda: _endpoint().topic_type,
    kind=lambda: _endpoint().endpoint_type,
    profile=lambda: _endpoint(_latched(5)).qos_profile,
    profile_of_subscription=lambda: _endpoint(_latched(5), "subscriptions").qos_profile,
    empty=lambda: str(TopicEndpointInfo()),
    wrong_name=lambda: TopicEndpointInfo(node_name=3),
    wrong_word=lambda: TopicEndpointInfo(name="x"),
    equal=lambda: TopicEndpointInfo(node_name="a") == TopicEndpointInfo(node_name="a"),
    kinds=lambda: [(one.name, one.value) for one in TopicEndpointTypeEnum],
)


def _graph(query: Callable[[Node], Any]) -> Any:
    node = Node("n", namespace="/ns")
    node.create_publisher(String, "t", 1)
    node.create_subscription(Int32, "u", print, 1)
    node.create_service(Trigger, "s", print)
    node.create_client(Trigger, "c")
    server, client = ActionServer(node, Fibonacci, "f", print), ActionClient(node, Fibonacci, "g")
    _until(lambda: len(node.get_service_names_and_types_by_node("n", "/ns")) > 9, node)
    _until(lambda: False, node, limit=0.1)
    found = query(node)
    server.destroy()
    client.destroy()
    return found


def _own(pairs: Any) -> Any:
    return [
        (name, kinds)
        for name, kinds in pairs
        if "test_msgs" not in str(kinds) and "example_int" not in str(kinds)
    ]


lines(
    "query",
    publishers=lambda: _graph(lambda n: _own(n.get_publisher_names_and_types_by_node("n", "/ns"))),
    subscriptions=lambda: _graph(lambda n: _own(n.get_subscriber_names_and_types_by_node("n", "/ns"))),
    services=lambda: _graph(lambda n: _own(n.get_service_names_and_types_by_node("n", "/ns"))),
    clients=lambda: _graph(lambda n: _own(n.get_client_names_and_types_by_node("n", "/ns"))),
    of_nobody=lambda: Node("n").get_publisher_names_and_types_by_node("nobody", "/"),
    subscriptions_of_nobody=lambda: Node("n").get_subscriber_names_and_types_by_node("nobody", "/"),
    services_of_nobody=lambda: Node("n").get_service_names_and_types_by_node("nobody", "/"),
    clients_of_nobody=lambda: Node("n").get_client_names_and_types_by_node("nobody", "/"),
    bad_node=lambda: Node("n").get_publisher_names_and_types_by_node("a b", "/"),
    bad_namespace=lambda: Node("n").get_publisher_names_and_types_by_node("n", "x y"),
    own_publishers=lambda: [one.topic for one in Node("n").publishers],
    own_subscriptions=lambda: [one.topic for one in Node("n").subscriptions],
    own_services=lambda: [one.srv_name for one in Node("n", enable_logger_service=True).services],
    own_timers=lambda: len(list(Node("n").timers)),
    own_guards=lambda: len(list(Node("n").guards)),
    count_services=lambda: _graph(
        lambda n: [n.count_services("s"), n.count_clients("c"), n.count_services("x")]
    ),
    lists=lambda: [type(Node("n").publishers).__name__, type(Node("n").services).__name__],
)


def _events(publisher: Any, subscription: Any) -> list[str]:
    node, seen = Node("n"), []
    node.create_publisher(
        Int32,
        "t",
        publisher,
        event_callbacks=PublisherEventCallbacks(
            matched=lambda i: seen.append(f"pub matched {i.total_count} {i.current_count}"),
            incompatible_qos=lambda i: seen.append(f"pub incompatible {i.total_count} {i.last_policy_kind}"),
        ),
    )
    node.create_subscription(
        Int32,
        "t",
        print,
        subscription,
        event_callbacks=SubscriptionEventCallbacks(
            matched=lambda i: seen.append(f"sub matched {i.total_count} {i.current_count}"),
            incompatible_qos=lambda i: seen.append(f"sub incompatible {i.total_count} {i.last_policy_kind}"),
        ),
    )
    _until(lambda: len(seen) == 2, node, limit=2.0)
    return sorted(seen)


lines(
    "event",
    matched=lambda: _events(10, 10),
    reliability=lambda: _events(qos_profile_sensor_data, 10),
    durability=lambda: _events(10, _latched()),
    deadline=lambda: _events(10, _PROFILES["deadline"]),
    liveliness=lambda: _events(10, _PROFILES["manual"]),
    unknown=lambda: PublisherEventCallbacks(message_lost=print),
    two_partners=lambda: _two_partners(),
)


def _two_partners() -> list[Any]:
    node, seen = Node("n"), []
    events = SubscriptionEventCallbacks(
        matched=lambda i: seen.append(
            (i.total_count, i.total_count_change, i.current_count, i.current_count_change)
        )
    )
    node.create_subscription(Int32, "t", print, 1, event_callbacks=events)
    publishers = [node.create_publisher(Int32, "t", 1) for _ in range(2)]
    end = time.monotonic() + 5.0
    while any(one.get_subscription_count() < 1 for one in publishers) and time.monotonic() < end:
        time.sleep(0.05)
    time.sleep(0.3)
    _until(lambda: False, node, limit=0.3)
    node.destroy_publisher(publishers[0])
    time.sleep(0.3)
    _until(lambda: False, node, limit=0.3)
    return seen


def _burst(depth: int, in_callback: bool, count: int = 5) -> list[int]:
    """Publish several messages at the same time. Return those received with this depth."""
    node, seen = Node("n"), []
    publisher = node.create_publisher(Int32, "t", 10)
    node.create_subscription(Int32, "t", lambda m: seen.append(m.data), depth)
    _until(lambda: publisher.get_subscription_count() == 1, node)

    def publish() -> None:
        for number in range(count):
            publisher.publish(Int32(data=number))

    if in_callback:
        timer = node.create_timer(0.05, lambda: (timer.cancel(), publish()))
    else:
        publish()
        time.sleep(0.1)
    _until(lambda: False, node, limit=0.4)
    return seen


lines(
    "burst",
    one=lambda: _burst(1, False),
    three=lambda: _burst(3, False),
    ten=lambda: _burst(10, False),
    one_in_a_callback=lambda: _burst(1, True),
    three_in_a_callback=lambda: _burst(3, True),
    ten_in_a_callback=lambda: _burst(10, True),
)


@probe
def counts_of_partners() -> list[int]:
    node, other = Node("n"), Node("m")
    publisher = node.create_publisher(String, "t", 1)
    subscriptions = [other.create_subscription(String, "t", print, 1) for _ in range(2)]
    _until(lambda: publisher.get_subscription_count() == 2, node)
    found = [publisher.get_subscription_count(), subscriptions[0].get_publisher_count()]
    other.destroy_node()
    _until(lambda: publisher.get_subscription_count() == 0, node)
    return [*found, publisher.get_subscription_count(), node.count_subscribers("t")]


@probe
def messages_as_fields() -> list[str]:
    pose = Pose(position=Point(x=1.0))
    return [outcome(lambda: pose.position.x), outcome(setattr, pose, "positon", 3), outcome(lambda: pose.x)]


if __name__ == "__main__":
    main()
