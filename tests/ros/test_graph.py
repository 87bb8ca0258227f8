import random

from course_lib.ros.graph.graph import START_NS, Graph, current_graph, use_graph
from course_lib.ros.graph.topics import Qos

MS = 10**6  # [ns]
STRING = "std_msgs/msg/String"
LATCHED = Qos(depth=2, durability="transient_local")


def run(graph: Graph) -> None:
    while graph.advance():
        pass


def test_simultaneous_events_are_ordered_by_node_then_entity_then_sequence() -> None:
    graph, calls = Graph(), list[str]()
    for node, entity, name in ((2, 0, "c"), (1, 1, "b"), (1, 0, "a"), (2, 0, "d")):
        graph.call_at(START_NS + MS, lambda name=name: calls.append(name), node=node, entity=entity)  # type: ignore[misc]  # bound now
    run(graph)
    assert calls == ["a", "b", "c", "d"]
    assert graph.now_ns == START_NS + MS


def test_canceled_event_is_not_run() -> None:
    graph = Graph()
    graph.call_at(START_NS + MS, lambda: None, node=0, entity=0).cancel()
    assert not graph.advance()
    assert graph.now_ns == START_NS


def test_events_due_at_the_end_run_and_later_events_do_not() -> None:
    graph, calls = Graph(end_ns=START_NS + 2 * MS), list[int]()
    for due in (1, 2, 3):
        graph.call_at(START_NS + due * MS, lambda due=due: calls.append(due), node=0, entity=0)  # type: ignore[misc]  # bound now
    run(graph)
    assert calls == [1, 2]
    assert graph.ended
    assert graph.now_ns == START_NS + 2 * MS


def test_message_arrives_one_millisecond_after_its_publication() -> None:
    graph, received = Graph(), list[tuple[bytes, int, int]]()
    node = graph.add_node("talker", "/")
    publisher = graph.add_publisher(node, "/chatter", STRING, Qos())
    graph.add_subscription(node, 0, "/chatter", STRING, Qos(), lambda *sample: received.append(sample))
    graph.publish(publisher, b"hello")
    assert received == []
    run(graph)
    assert received == [(b"hello", START_NS, START_NS + MS)]


def test_only_endpoints_of_equal_type_and_compatible_qos_match() -> None:
    graph, received = Graph(), list[str]()
    node = graph.add_node("talker", "/")
    publisher = graph.add_publisher(node, "/t", STRING, Qos(reliability="best_effort"))
    wanted = {
        "reliable": (STRING, Qos()),
        "other type": ("std_msgs/msg/Bool", Qos(reliability="best_effort")),
        "latched": (STRING, Qos(reliability="best_effort", durability="transient_local")),
        "match": (STRING, Qos(reliability="best_effort")),
    }
    for name, (type_name, qos) in wanted.items():
        graph.add_subscription(node, 0, "/t", type_name, qos, lambda *_, name=name: received.append(name))
    graph.publish(publisher, b"")
    run(graph)
    assert received == ["match"]


def test_late_joining_subscription_receives_last_samples_only_with_transient_local_endpoints() -> None:
    graph = Graph()
    late, volatile = list[bytes](), list[bytes]()
    node = graph.add_node("map_server", "/")
    publisher = graph.add_publisher(node, "/map", STRING, LATCHED)
    for data in (b"1", b"2", b"3"):
        graph.publish(publisher, data)
    graph.add_subscription(node, 0, "/map", STRING, LATCHED, lambda cdr, *_: late.append(cdr))
    graph.add_subscription(node, 1, "/map", STRING, Qos(), lambda cdr, *_: volatile.append(cdr))
    run(graph)
    assert late == [b"2", b"3"]
    assert volatile == []
    assert [sample.cdr for sample in graph.latched_samples()] == [b"2", b"3"]


def test_removing_a_node_removes_its_endpoints_and_the_messages_being_delivered_to_them() -> None:
    graph, received = Graph(), list[bytes]()
    talker, listener = graph.add_node("talker", "/"), graph.add_node("listener", "/")
    publisher = graph.add_publisher(talker, "/t", STRING, Qos())
    graph.add_subscription(listener, 0, "/t", STRING, Qos(), lambda cdr, *_: received.append(cdr))
    graph.publish(publisher, b"late")
    graph.remove_node(listener)
    run(graph)
    assert received == []
    assert [node.name for node in graph.nodes()] == ["talker"]
    assert [endpoint.kind for endpoint in graph.endpoints()] == ["pub"]


def test_topic_endpoints_agree_with_the_endpoints_of_the_full_graph() -> None:
    graph, chance = Graph(), random.Random(0)
    nodes = [graph.add_node(f"n{number}", "/") for number in range(4)]
    for _ in range(300):
        node, topic = chance.choice(nodes), chance.choice("abc")
        ends = graph.endpoints()
        if ends and chance.random() < 0.4:
            graph.remove_endpoint(chance.choice(ends).id)
        elif chance.random() < 0.1:
            chance.choice((graph.hide_node, graph.show_node))(node)
        elif chance.random() < 0.5:
            graph.add_publisher(node, topic, STRING, Qos())
        else:
            graph.add_subscription(node, 0, topic, STRING, Qos(), lambda *_: None)
        for topic in "abc":
            assert graph.endpoints_on(topic) == [end for end in graph.endpoints() if end.topic == topic]


def test_taps_and_watchers_receive_all_events_until_removed() -> None:
    graph, samples, times = Graph(), list[bytes](), list[int]()
    publisher = graph.add_publisher(graph.add_node("talker", "/"), "/t", STRING, Qos())
    untap = graph.tap(lambda sample: samples.append(sample.cdr))
    unwatch = graph.watch_time(times.append)
    graph.publish(publisher, b"seen")
    untap()
    graph.publish(publisher, b"unseen")
    graph.call_at(START_NS + MS, lambda: None, node=0, entity=0)
    graph.call_at(START_NS + MS, lambda: None, node=0, entity=0)
    run(graph)
    unwatch()
    assert samples == [b"seen"]
    assert times == [START_NS + MS]


def test_another_graph_can_be_used_temporarily() -> None:
    before = current_graph()
    with use_graph(Graph()) as graph:
        assert current_graph() is graph
        graph.state(list).append(1)
        assert graph.state(list) == [1]
    assert current_graph() is before
    assert before.state(list) == []
