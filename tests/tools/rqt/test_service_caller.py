import pytest
from example_interfaces.srv import AddTwoInts
from rclpy.node import Node

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import Graph
from course_lib.ros.time.driving import running_nodes
from course_lib.ros.time.pace import speed_of
from course_lib.tools.rqt.services import ServiceCallerView


@pytest.fixture
def view(graph: Graph) -> ServiceCallerView:
    def add(request: AddTwoInts.Request, response: AddTwoInts.Response) -> AddTwoInts.Response:
        response.sum = request.a + request.b
        return response

    node = Node("server")
    node.create_service(AddTwoInts, "add", add)
    running_nodes().append(node)
    return ServiceCallerView(graph, ["add"])


def call(view: ServiceCallerView, request: str) -> str:
    view.request.value = request
    view.buttons()[0].click()
    return str(view.screen.value)


def test_request_has_default_values_at_first(view: ServiceCallerView) -> None:
    assert view.request.value == "a: 0\nb: 0\n"


def test_response_is_shown(view: ServiceCallerView) -> None:
    assert "sum: 42" in call(view, "{a: 20, b: 22}")


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        ("c: 1", "object has no attribute &#x27;c&#x27;"),
        ("a: [", "is not YAML"),
        ("a: {b: 1}", "Failed to populate field"),
    ],
)
def test_invalid_request_is_explained(view: ServiceCallerView, request_: str, message: str) -> None:
    assert "No response" in call(view, request_)
    assert message in view.notice.value


def test_missing_response_is_an_error(view: ServiceCallerView) -> None:
    running_nodes().clear()
    call(view, "a: 1")
    assert "/add does not respond. Is it running?" in view.notice.value


def test_unknown_service_error_suggests_the_closest(view: ServiceCallerView, graph: Graph) -> None:
    with pytest.raises(CourseError, match=r"There is no service /ad\. Did you mean /add\?"):
        ServiceCallerView(graph, ["ad"])


def test_later_services_are_offered_and_the_selection_is_kept(view: ServiceCallerView, planner: Node) -> None:
    said = call(view, "{a: 20, b: 22}")
    planner.create_service(AddTwoInts, "a_new_one", lambda _, response: response)
    view.refresh()
    assert "/a_new_one" in view.controls["Service"].options
    assert view["Service"] == "/add"
    assert (view.request.value, view.screen.value) == ("{a: 20, b: 22}", said)


def test_no_service_is_called_while_robot_time_is_paused(
    view: ServiceCallerView, graph: Graph, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COURSE_PACE", "real")
    speed_of(graph).is_paused = True
    call(view, "a: 1")
    assert "Robot time is paused, so no node responds" in view.notice.value
