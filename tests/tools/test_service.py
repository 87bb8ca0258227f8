"""`ros2 service …`, line by line as ros2cli writes it."""

from collections.abc import Callable

import pytest
from example_interfaces.srv import AddTwoInts
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node
from rclpy.task import Future

from course_lib.errors import CourseError
from course_lib.recording import Recording
from course_lib.ros.graph.graph import Graph
from course_lib.tools.ros2 import ros2
from course_lib.tools.sources import RecordingSource

Run = Callable[[str], str]
TYPE = "example_interfaces/srv/AddTwoInts"


def add(request: AddTwoInts.Request, response: AddTwoInts.Response) -> AddTwoInts.Response:
    response.sum = request.a + request.b
    return response


@pytest.fixture
def adder(talker: Node) -> Node:
    talker.create_service(AddTwoInts, "add_two_ints", add)
    return talker


def test_list_prints_services_with_their_types(run: Run, adder: Node) -> None:
    lines = run("service list").splitlines()
    assert lines[0] == "/add_two_ints"
    assert "/talker/list_parameters" in lines
    assert run("service list -t").splitlines()[0] == f"/add_two_ints [{TYPE}]"
    assert run("service list -c") == f"{len(lines)}\n"


def test_type_and_find_are_inverse_commands(run: Run, adder: Node) -> None:
    assert run("service type /add_two_ints") == f"{TYPE}\n"
    with pytest.raises(CourseError, match="Unknown service '/nothing'"):
        run("service type /nothing")
    assert run(f"service find {TYPE}") == "/add_two_ints\n"
    assert run(f"service find {TYPE} -c") == "1\n"


def test_info_counts_clients_and_servers(run: Run, adder: Node) -> None:
    adder.create_client(AddTwoInts, "add_two_ints")
    assert run("service info /add_two_ints") == f"Type: {TYPE}\nClients count: 1\nServices count: 1\n"
    with pytest.raises(CourseError, match=r"^Unknown service '/add_two_int'\. Did you mean /add_two_ints\?$"):
        run("service info /add_two_int")


def test_call_shows_the_request_and_the_response(run: Run, adder: Node) -> None:
    assert run(f"service call /add_two_ints {TYPE} {{a: 1, b: 2}}") == (
        "requester: making request: example_interfaces.srv.AddTwoInts_Request(a=1, b=2)\n\n"
        "response:\nexample_interfaces.srv.AddTwoInts_Response(sum=3)\n\n"
    )


def test_repeated_calls_keep_their_rate(run: Run, adder: Node, graph: Graph) -> None:
    graph.end_ns = graph.now_ns + 1_900_000_000
    assert run(f"service call -r 2 /add_two_ints {TYPE}").count("response:") == 4


def test_invalid_service_calls_are_reported(run: Run, adder: Node) -> None:
    with pytest.raises(CourseError, match=r"^No node serves the service '/ad_two_ints'\. Did you mean /add"):
        run(f"service call /ad_two_ints {TYPE}")
    assert run.written == "waiting for service to become available...\n"  # type: ignore[attr-defined]
    with pytest.raises(CourseError, match="Failed to populate field: 'AddTwoInts_Request' object has no"):
        run(f"service call /add_two_ints {TYPE} {{c: 1}}")
    with pytest.raises(
        CourseError, match=r"^The passed service type is invalid: .*/AddTwo\. Did you mean .*/AddTwoInts\?$"
    ):
        run("service call /add_two_ints example_interfaces/AddTwo")
    with pytest.raises(CourseError, match=r"^The passed service type is invalid: AddTwoInts\. Did you mean"):
        run("service call /add_two_ints AddTwoInts")
    with pytest.raises(
        CourseError, match=r"^/add_two_ints has the type .*AddTwoInts, not std_srvs/srv/Empty\.$"
    ):
        run("service call /add_two_ints std_srvs/srv/Empty")
    with pytest.raises(CourseError, match="A recording cannot respond"):
        ros2(["service", "call", "/add_two_ints", TYPE], RecordingSource(Recording(())), print)


def test_call_ends_when_the_server_disappears(run: Run, talker: Node, graph: Graph) -> None:
    async def never(request: AddTwoInts.Request, response: AddTwoInts.Response) -> AddTwoInts.Response:
        await Future()
        return response

    service = talker.create_service(AddTwoInts, "add_two_ints", never)
    # The service occupies its own callback group until it responds.
    group = MutuallyExclusiveCallbackGroup()
    talker.create_timer(0.5, lambda: talker.destroy_service(service), callback_group=group)
    start_ns = graph.now_ns
    with pytest.raises(CourseError, match=r"^/add_two_ints has disappeared before it responded"):
        run(f"service call /add_two_ints {TYPE}")
    assert graph.now_ns - start_ns < 2_000_000_000
