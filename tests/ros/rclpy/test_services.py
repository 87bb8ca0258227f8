from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import pytest
import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.client import Client
from rclpy.exceptions import InvalidHandle, InvalidServiceNameException
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import String
from std_srvs.srv import Trigger

from course_lib.ros.graph.graph import START_NS, Graph
from course_lib.ros.time.time_lock import DeadlockError

MS = 10**6  # [ns]


def add(request: AddTwoInts.Request, response: AddTwoInts.Response) -> AddTwoInts.Response:
    response.sum = request.a + request.b
    return response


@pytest.fixture
def adder(node: Node) -> Node:
    node.create_service(AddTwoInts, "add", add)
    return node


@pytest.fixture
def client(adder: Node) -> Client:
    return adder.create_client(AddTwoInts, "add")


def ask(node: Node, client: Client, a: int, b: int) -> Any:
    future = client.call_async(AddTwoInts.Request(a=a, b=b))
    rclpy.spin_until_future_complete(node, future)
    return future.result()


def test_request_is_answered_after_two_transport_delays(
    started_graph: Graph, adder: Node, client: Client
) -> None:
    assert ask(adder, client, 2, 3) == AddTwoInts.Response(sum=5)
    assert started_graph.now_ns - START_NS == 2 * MS


def test_each_client_receives_the_responses_to_its_own_requests(adder: Node, client: Client) -> None:
    other = Node("other").create_client(AddTwoInts, "/add")
    futures = [one.call_async(AddTwoInts.Request(a=n)) for n, one in enumerate((client, other, client))]
    rclpy.spin_until_future_complete(adder, futures[2])
    assert [f.done() for f in futures] == [True, False, True]
    assert [futures[0].result(), futures[2].result()] == [AddTwoInts.Response(sum=n) for n in (0, 2)]


def test_done_callbacks_run_in_the_executor_and_their_exceptions_propagate_from_spin(
    adder: Node, client: Client
) -> None:
    def fail(future: Future[Any]) -> None:
        raise KeyError(future.result())

    client.call_async(AddTwoInts.Request(a=7)).add_done_callback(fail)
    with pytest.raises(KeyError, match="sum=7"):
        rclpy.spin(adder)


def test_future_is_never_done_without_a_service(node: Node) -> None:
    client = node.create_client(AddTwoInts, "add")
    assert not client.service_is_ready()
    future = client.call_async(AddTwoInts.Request())
    rclpy.spin_until_future_complete(node, future, timeout_sec=1.0)
    assert not future.done()


def test_future_of_a_removed_request_is_never_completed(adder: Node, client: Client) -> None:
    future = client.call_async(AddTwoInts.Request())
    client.remove_pending_request(future)
    rclpy.spin_until_future_complete(adder, future, timeout_sec=1.0)
    assert not future.done()


@pytest.mark.parametrize("wrong", [None, 5, AddTwoInts.Request()])
def test_service_callback_without_a_response_raises_a_type_error_from_spin(node: Node, wrong: object) -> None:
    node.create_service(AddTwoInts, "add", lambda request, response: wrong)
    node.create_client(AddTwoInts, "add").call_async(AddTwoInts.Request())
    with pytest.raises(TypeError, match=r"^$"):
        rclpy.spin(node)


def test_invalid_request_type_raises_a_type_error(client: Client) -> None:
    for call in (client.call, client.call_async):
        with pytest.raises(TypeError, match=r"^$"):
            call(Trigger.Request())


def test_service_callback_can_be_a_coroutine_that_calls_another_service(adder: Node, client: Client) -> None:
    async def double(request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        answer = await client.call_async(AddTwoInts.Request(a=4, b=4))
        response.message = str(answer.sum if answer else None)
        return response

    adder.create_service(Trigger, "double", double, callback_group=MutuallyExclusiveCallbackGroup())
    asker = adder.create_client(Trigger, "double")
    future = asker.call_async(Trigger.Request())
    rclpy.spin_until_future_complete(adder, future)
    assert future.done()
    assert future.result() == Trigger.Response(message="8")


def test_wait_for_service_polls_every_quarter_of_a_second(started_graph: Graph, node: Node) -> None:
    client = Node("client").create_client(AddTwoInts, "add")
    node.create_timer(0.3, lambda: node.create_service(AddTwoInts, "add", add))
    spinner = threading.Thread(target=rclpy.spin, args=(node,), daemon=True)
    spinner.start()
    assert client.wait_for_service(timeout_sec=5.0)
    assert started_graph.now_ns - START_NS == 500 * MS
    assert not node.create_client(Trigger, "nothing").wait_for_service(timeout_sec=1.0)
    assert started_graph.now_ns - START_NS == 1500 * MS


def test_call_waits_while_another_thread_spins(adder: Node, client: Client) -> None:
    threading.Thread(target=rclpy.spin, args=(adder,), daemon=True).start()
    assert client.call(AddTwoInts.Request(a=1, b=1)).sum == 2
    lonely = adder.create_client(Trigger, "nothing")
    assert lonely.call(Trigger.Request(), timeout_sec=1.0) is None


def test_call_without_a_spinning_executor_raises_deadlock_error(client: Client) -> None:
    with pytest.raises(
        DeadlockError,
        match="/add: no response can arrive without another thread that spins the client's node",
    ):
        client.call(AddTwoInts.Request())


def calls_in_a_timer(node: Node, client: Client, answers: list[Any], **options: Any) -> None:
    def tick() -> None:
        timer.cancel()
        answers.append(client.call(AddTwoInts.Request(a=1)))

    timer = node.create_timer(0.1, tick, **options)


@pytest.mark.parametrize("executor", [SingleThreadedExecutor, MultiThreadedExecutor])
def test_call_in_a_callback_that_blocks_its_own_response_raises_deadlock_error(
    adder: Node, client: Client, executor: Callable[[], SingleThreadedExecutor]
) -> None:
    calls_in_a_timer(adder, client, [])
    with pytest.raises(DeadlockError, match=r"call\(\) on /add waits .* Use call_async"):
        rclpy.spin(adder, executor())


def test_call_in_a_callback_succeeds_with_a_multi_threaded_executor_and_separate_groups(
    adder: Node, client: Client
) -> None:
    answers: list[Any] = []
    calls_in_a_timer(adder, client, answers, callback_group=MutuallyExclusiveCallbackGroup())
    rclpy.spin(adder, MultiThreadedExecutor(2))
    assert answers == [AddTwoInts.Response(sum=1)]


def test_services_and_clients_are_not_listed_as_topics(adder: Node, client: Client) -> None:
    asker = Node("asker", namespace="/robot")
    asker.create_client(Trigger, "go")
    added = ("/add", ["example_interfaces/srv/AddTwoInts"])
    assert added in asker.get_service_names_and_types()
    assert ("/robot/go", ["std_srvs/srv/Trigger"]) in asker.get_service_names_and_types()
    assert {name for name, _ in asker.get_topic_names_and_types()} == {"/parameter_events", "/rosout"}
    assert client.service_name == "/add"
    assert client.srv_name == "add"


def test_recording_contains_no_service_requests_as_in_ros(
    started_graph: Graph, adder: Node, client: Client
) -> None:
    topics = set[str]()
    started_graph.tap(lambda sample: topics.add(sample.topic))
    ask(adder, client, 1, 2)
    assert all(topic.startswith("/") for topic in topics)


def test_destroyed_services_and_clients_are_unusable(adder: Node, client: Client) -> None:
    (service,) = [service for service in adder.services if service.srv_name == "add"]
    assert adder.destroy_service(service)
    assert not adder.destroy_service(service)
    assert not client.service_is_ready()
    assert adder.destroy_client(client)
    with pytest.raises(InvalidHandle):
        client.call_async(AddTwoInts.Request())
    adder.destroy_node()
    assert [*adder.services, *adder.clients] == []


def test_invalid_service_type_is_rejected_with_the_error_of_rclpy(node: Node) -> None:
    with pytest.raises(RuntimeError, match=r"The service type provided is not valid \(<class .*String'>\)"):
        node.create_client(String, "x")
    with pytest.raises(RuntimeError, match=r"The message type .*, this might be a service or action"):
        node.create_publisher(Trigger, "x", 1)  # type: ignore[type-var]  # the mistake that is tested
    with pytest.raises(AttributeError, match="has no attribute '_TYPE_SUPPORT'"):
        node.create_service(int, "x", add)


def test_invalid_service_name_is_rejected_with_a_caret(node: Node) -> None:
    with pytest.raises(InvalidServiceNameException) as caught:
        node.create_client(Trigger, "x y")
    assert str(caught.value).startswith("Invalid service name: topic name must not contain characters")
