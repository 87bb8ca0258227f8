# mypy: ignore-errors
"""Parameter clients with files and callbacks, service events, and endpoints seen by other nodes."""

import tempfile
import time
from pathlib import Path
from typing import Any

from probing import lines, main, outcome
from rcl_interfaces.msg import IntegerRange, ParameterDescriptor, ParameterEvent
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter, parameter_dict_from_yaml_file
from rclpy.parameter_client import AsyncParameterClient
from rclpy.qos import (
    DurabilityPolicy,
    QoSProfile,
    ReliabilityPolicy,
    qos_profile_best_available,
    qos_profile_sensor_data,
    qos_profile_system_default,
)
from rclpy.service_introspection import ServiceIntrospectionState
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger


class Asked:
    """A node with parameters, and a client of another node."""

    def __init__(self, **options: Any) -> None:
        self.node, self.other = Node("asked", **options), Node("asking")
        self.node.declare_parameter("a", 1)
        self.node.declare_parameter("b.c", "text")
        self.node.declare_parameter("b.d", [1.5])
        bounds = IntegerRange(from_value=0, to_value=10, step=2)
        even = ParameterDescriptor(description="even", integer_range=[bounds])
        self.node.declare_parameter("r", 4, even)
        self.node.declare_parameter("fixed", True, ParameterDescriptor(read_only=True))
        self.client = AsyncParameterClient(self.other, "asked")
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.node)
        self.executor.add_node(self.other)
        self.client.wait_for_services(3.0)

    def wait(self, future: Any) -> Any:
        self.executor.spin_until_future_complete(future, 3.0)
        return future.result()

    def ask(self, method: Any, *args: Any, **options: Any) -> Any:
        return self.wait(getattr(self.client, method)(*args, **options))

    def values(self) -> Any:
        names = sorted(self.node.list_parameters([], 0).names)
        own = ("a", "b.c", "b.d", "fixed", "new", "r")
        return {name: self.node.get_parameter(name).value for name in names if name in own}


FILES = {
    "plain": "asked:\n  ros__parameters:\n    a: 5\n    b: {c: new}\n",
    "absolute": "/asked:\n  ros__parameters:\n    a: 5\n",
    "wildcard": "/**:\n  ros__parameters:\n    a: 6\n",
    "both": "/**:\n  ros__parameters: {a: 6, r: 8}\nasked:\n  ros__parameters: {a: 7}\n",
    "outside": "asked:\n  ros__parameters: {a: 5, r: 5}\n",
    "fixed": "asked:\n  ros__parameters: {fixed: false, a: 5}\n",
    "type": "asked:\n  ros__parameters: {a: text}\n",
    "undeclared": "asked:\n  ros__parameters: {new: 5}\n",
    "other_node": "someone:\n  ros__parameters: {a: 9}\n",
    "two_nodes": "someone:\n  ros__parameters: {a: 9}\nasked:\n  ros__parameters: {r: 2}\n",
    "lists": "asked:\n  ros__parameters: {b: {d: [1.0, 2.5]}}\n",
    "ints_for_floats": "asked:\n  ros__parameters: {b: {d: [1, 2]}}\n",
    "no_parameters": "asked:\n  a: 5\n",
    "empty": "",
    "text": "asked",
    "broken": "asked: [",
    "tabs": "asked:\n\tros__parameters: {a: 1}\n",
    "nothing": "asked:\n  ros__parameters: {a: null}\n",
    "quoted": "asked:\n  ros__parameters: {a: '5'}\n",
    "yes": "asked:\n  ros__parameters: {fixed: yes}\n",
    "exponent": "asked:\n  ros__parameters: {b: {d: [1e3]}}\n",
}


def file(text: Any) -> Any:
    path = Path(tempfile.mkdtemp()) / "parameters.yaml"
    path.write_text(text)
    return str(path)


def loaded(name: Any, method: Any = "load_parameter_file", *args: Any) -> Any:
    asked = Asked()

    def load() -> Any:
        answer = asked.ask(method, file(FILES[name]), *args)
        results = answer.results if hasattr(answer, "results") else [answer.result]
        return sorted((one.successful, one.reason) for one in results)

    # What the YAML parser says differs, and so does the order of keys.
    return outcome(load).partition(" expected")[0].partition(" while ")[0], asked.values()


def read(name: Any, *args: Any, **options: Any) -> Any:
    found = parameter_dict_from_yaml_file(file(FILES[name]), *args, **options)
    return {key: (one.name, one.value.type) for key, one in sorted(found.items())}


lines("loaded", **{name: (lambda name=name: loaded(name)) for name in FILES})
lines(
    "load",
    with_wildcard=lambda: loaded("wildcard", "load_parameter_file", True),
    both_with_wildcard=lambda: loaded("both", "load_parameter_file", True),
    atomically=lambda: loaded("plain", "load_parameter_file_atomically"),
    atomically_outside=lambda: loaded("outside", "load_parameter_file_atomically"),
    atomically_fixed=lambda: loaded("fixed", "load_parameter_file_atomically"),
    atomically_undeclared=lambda: loaded("undeclared", "load_parameter_file_atomically"),
    read=lambda: read("plain"),
    read_target=lambda: read("two_nodes", target_nodes=["asked"]),
    read_unknown_target=lambda: read("plain", target_nodes=["nobody"]),
    read_targets=lambda: read("two_nodes", target_nodes=["asked", "someone"]),
    read_wildcard=lambda: read("wildcard"),
    read_with_wildcard=lambda: read("both", use_wildcard=True),
    read_without_wildcard=lambda: read("both"),
    read_namespace=lambda: read("plain", namespace="robot."),
)


def called_back(method: Any, *args: Any) -> Any:
    """Ask with a callback; return the result, and what the callback got."""
    asked, heard = Asked(), []
    future = getattr(asked.client, method)(*args, lambda done: heard.append(done.result()))
    asked.wait(future)
    for _ in range(5):
        asked.executor.spin_once(timeout_sec=0.05)
    return future.result(), heard == [future.result()]


def callback_fails() -> Any:
    asked = Asked()
    future = asked.client.get_parameters(["a"], lambda done: 1 / 0)
    raised = outcome(asked.executor.spin_until_future_complete, future, 2.0)
    later = [outcome(asked.executor.spin_once, timeout_sec=0.05) for _ in range(5)]
    return raised, sorted(set(later)), future.done()


def events(change: Any, **options: Any) -> Any:
    """Return the parameter events that a client hears of."""
    asked, heard = Asked(), []
    asked.client.on_parameter_event(heard.append, **options)
    asked.executor.spin_once(timeout_sec=0.2)
    for _ in range(3):
        asked.executor.spin_once(timeout_sec=0.05)
    heard.clear()
    change(asked)
    end = time.monotonic() + 0.5
    while time.monotonic() < end:
        asked.executor.spin_once(timeout_sec=0.05)
    return [
        (
            one.node,
            [p.name for p in one.new_parameters],
            [(p.name, p.value.type) for p in one.changed_parameters],
            [p.name for p in one.deleted_parameters],
        )
        if isinstance(one, ParameterEvent)
        else type(one).__name__
        for one in heard
    ]


def changed(asked: Any) -> None:
    values = [("a", 2), ("r", 5), ("r", 6)]
    asked.ask("set_parameters", [Parameter(name, value=value) for name, value in values])


ALLOWED = {"allow_undeclared_parameters": True}
ONE = Parameter("a", value=3)


def ranged() -> Any:
    asked = Asked()
    return [asked.ask("set_parameters", [Parameter("r", value=v)]) for v in (2, 3, 12, 1.0, "a")]


def deleted(asked: Any) -> Any:
    return asked.ask("delete_parameters", ["a"])


lines(
    "client",
    get=lambda: called_back("get_parameters", ["a", "b.c"]),
    set=lambda: called_back("set_parameters", [Parameter("a", value=3)]),
    set_messages=lambda: called_back("set_parameters", [ONE.to_parameter_msg()]),
    set_atomically=lambda: called_back("set_parameters_atomically", [Parameter("a", value=3)]),
    describe=lambda: called_back("describe_parameters", ["r", "fixed"]),
    types=lambda: called_back("get_parameter_types", ["a", "b.c", "b.d", "r"]),
    list_=lambda: called_back("list_parameters", ["b"], 2),
    list_depth=lambda: sorted(Asked().ask("list_parameters", [], 1).result.names),
    list_prefixes=lambda: sorted(Asked().ask("list_parameters", ["b", "a"]).result.names),
    list_deep=lambda: Asked().ask("list_parameters", ["b"], 2).result.prefixes,
    delete=lambda: called_back("delete_parameters", ["a"]),
    delete_fixed=lambda: Asked().ask("delete_parameters", ["fixed"]),
    delete_unknown=lambda: Asked().ask("delete_parameters", ["x"]),
    delete_dynamic=lambda: Asked(**ALLOWED).ask("delete_parameters", ["a"]),
    set_range=ranged,
    set_fixed=lambda: Asked().ask("set_parameters", [Parameter("fixed", value=False)]),
    set_unknown=lambda: Asked().ask("set_parameters", [Parameter("x", value=1)]),
    set_unknown_allowed=lambda: Asked(**ALLOWED).ask("set_parameters", [Parameter("x", value=1)]),
    set_float=lambda: Asked().ask("set_parameters", [Parameter("a", value=1.0)]),
    set_nothing=lambda: Asked().ask("set_parameters", [Parameter("a", Parameter.Type.NOT_SET)]),
    get_unknown_allowed=lambda: Asked(**ALLOWED).ask("get_parameters", ["x"]),
    types_unknown_allowed=lambda: Asked(**ALLOWED).ask("get_parameter_types", ["x", "a"]),
    describe_unknown_allowed=lambda: Asked(**ALLOWED).ask("describe_parameters", ["x"]),
    callback_fails=callback_fails,
    get_text=lambda: Asked().client.get_parameters("a", 5),
    events=lambda: events(changed),
    events_of_a_deletion=lambda: events(deleted),
    events_raw=lambda: events(changed, raw=True),
    events_qos=lambda: events(changed, qos_profile=qos_profile_sensor_data),
)


def service_events(of_service: Any, of_client: Any, answers: Any = True) -> Any:
    """Return the events of a call, as a subscription to `/s/_service_event` gets them."""
    node, heard = Node("n"), []
    service = node.create_service(SetBool, "s", lambda request, response: response)
    client = node.create_client(SetBool, "s")
    clock, qos = node.get_clock(), qos_profile_system_default
    if of_service is not None:
        service.configure_introspection(clock, qos, of_service)
    if of_client is not None:
        client.configure_introspection(clock, qos, of_client)
    node.create_subscription(SetBool.Event, "s/_service_event", heard.append, 10)
    client.wait_for_service(2.0)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    end = time.monotonic() + 0.3
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.05)
    future = client.call_async(SetBool.Request(data=True))
    executor.spin_until_future_complete(future, 3.0)
    end = time.monotonic() + 0.5
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.05)
    found = sorted(
        (
            one.info.event_type,
            one.info.sequence_number,
            [request.data for request in one.request],
            [response.success for response in one.response],
        )
        for one in heard
    )
    topics = [name for name, _ in node.get_topic_names_and_types() if name.startswith("/s/")]
    return found, topics, [one.info.stamp.sec > 0 for one in heard]


OFF, METADATA, CONTENTS = (
    getattr(ServiceIntrospectionState, name) for name in ("OFF", "METADATA", "CONTENTS")
)


def introspection_changes() -> Any:
    """Return the events of calls while the state of a service changes."""
    node, heard = Node("n"), []
    service = node.create_service(SetBool, "s", lambda request, response: response)
    client = node.create_client(SetBool, "s")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    node.create_subscription(SetBool.Event, "s/_service_event", heard.append, 10)
    client.wait_for_service(2.0)
    counts = []
    for state in (CONTENTS, OFF, METADATA):
        service.configure_introspection(node.get_clock(), qos_profile_system_default, state)
        end = time.monotonic() + 0.3
        while time.monotonic() < end:
            executor.spin_once(timeout_sec=0.05)
        future = client.call_async(SetBool.Request())
        executor.spin_until_future_complete(future, 3.0)
        end = time.monotonic() + 0.3
        while time.monotonic() < end:
            executor.spin_once(timeout_sec=0.05)
        counts.append((len(heard), sum(len(one.request) for one in heard)))
        heard.clear()
    return counts


lines(
    "introspection",
    service_metadata=lambda: service_events(METADATA, None),
    service_contents=lambda: service_events(CONTENTS, None),
    client_metadata=lambda: service_events(None, METADATA),
    client_contents=lambda: service_events(None, CONTENTS),
    both=lambda: service_events(CONTENTS, CONTENTS),
    off=lambda: service_events(OFF, OFF),
    changes=introspection_changes,
    fields=lambda: SetBool.Event.get_fields_and_field_types(),
    states=lambda: [OFF.name, METADATA.name, CONTENTS.name],
)


def endpoints(qos: Any, kind: Any = "publisher", **options: Any) -> Any:
    """Return how another node sees an endpoint, without its GID."""
    node, other = Node("seen", namespace="/ns"), Node("seeing")
    if kind == "publisher":
        node.create_publisher(String, "t", qos)
        infos = other.get_publishers_info_by_topic
    else:
        node.create_subscription(String, "t", print, qos)
        infos = other.get_subscriptions_info_by_topic
    end = time.monotonic() + 3.0
    while not infos("/ns/t") and time.monotonic() < end:
        time.sleep(0.02)
    (info,) = infos("/ns/t")
    return [line for line in str(info).splitlines() if "GID" not in line], len(info.endpoint_gid)


def best_available(*offered: Any) -> Any:
    """Return the policies of a subscription that takes the best of these publishers' policies."""
    node = Node("n")
    for qos in offered:
        node.create_publisher(String, "t", qos)
    end = time.monotonic() + 2.0
    while node.count_publishers("t") < len(offered) and time.monotonic() < end:
        time.sleep(0.02)
    subscription = node.create_subscription(String, "t", print, qos_profile_best_available)
    while not node.get_subscriptions_info_by_topic("t") and time.monotonic() < end:
        time.sleep(0.02)
    (info,) = node.get_subscriptions_info_by_topic("t")
    qos = info.qos_profile
    policies = qos.reliability.name, qos.durability.name, qos.liveliness.name
    return policies, subscription.get_publisher_count()


def best_service() -> Any:
    """Return whether a service and a client with the best policies find each other."""
    node = Node("n")
    node.create_service(Trigger, "s", print, qos_profile=qos_profile_best_available)
    client = node.create_client(Trigger, "s", qos_profile=qos_profile_best_available)
    return client.wait_for_service(1.0)


LATCHED = QoSProfile(depth=3, durability=DurabilityPolicy.TRANSIENT_LOCAL)
lines(
    "endpoints",
    publisher=lambda: endpoints(10),
    subscription=lambda: endpoints(10, "subscription"),
    latched=lambda: endpoints(LATCHED),
    latched_subscription=lambda: endpoints(LATCHED, "subscription"),
    sensor=lambda: endpoints(qos_profile_sensor_data),
    sensor_subscription=lambda: endpoints(qos_profile_sensor_data, "subscription"),
    system=lambda: endpoints(QoSProfile(depth=1, reliability=ReliabilityPolicy.SYSTEM_DEFAULT)),
    system_subscription=lambda: endpoints(
        QoSProfile(depth=1, reliability=ReliabilityPolicy.SYSTEM_DEFAULT), "subscription"
    ),
    best_alone=lambda: best_available(),
    best_of_reliable=lambda: best_available(10),
    best_of_best_effort=lambda: best_available(qos_profile_sensor_data),
    best_of_both=lambda: best_available(10, qos_profile_sensor_data),
    best_of_latched=lambda: best_available(LATCHED),
    best_of_latched_and_reliable=lambda: best_available(LATCHED, 10),
    best_publisher=lambda: endpoints(qos_profile_best_available),
    best_services=lambda: best_service(),
    before=lambda: Node("n").get_publishers_info_by_topic("nothing"),
    services=lambda: sorted(
        name
        for name, _ in (lambda n: (n.create_service(Trigger, "s", print), n)[1])(
            Node("n", namespace="/ns")
        ).get_service_names_and_types()
        if name.endswith("/s")
    ),
)


if __name__ == "__main__":
    main()
