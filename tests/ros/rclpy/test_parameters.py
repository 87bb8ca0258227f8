from typing import Any

import pytest
import rclpy
from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    ParameterEvent,
    SetParametersResult,
)
from rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    GetParameterTypes,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)
from rclpy.exceptions import (
    InvalidParameterException,
    InvalidParameterTypeException,
    InvalidParameterValueException,
    ParameterAlreadyDeclaredException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
    ParameterUninitializedException,
)
from rclpy.impl.node_handle import NodesById
from rclpy.node import Node
from rclpy.parameter import Parameter

from course_lib.ros.graph.graph import Graph, current_graph

OK = SetParametersResult(successful=True)


def refused(reason: str) -> SetParametersResult:
    return SetParametersResult(successful=False, reason=reason)


def in_range(low: float, high: float, step: float) -> ParameterDescriptor:
    return ParameterDescriptor(
        floating_point_range=[FloatingPointRange(from_value=low, to_value=high, step=step)]
    )


def test_parameter_keeps_its_type(node: Node) -> None:
    node.declare_parameter("speed", 1)
    assert node.set_parameters([Parameter("speed", value=2)]) == [OK]
    (result,) = node.set_parameters([Parameter("speed", value="fast")])
    assert result == refused("Wrong parameter type, expected 'Type.INTEGER' got 'Type.STRING'")
    assert node.get_parameter("speed").value == 2
    assert node.get_parameter_type("speed") == Parameter.Type.INTEGER.value


def test_dynamically_typed_parameter_can_change_its_type_and_be_undeclared(node: Node) -> None:
    node.declare_parameter("x", 1, ParameterDescriptor(dynamic_typing=True))
    assert node.set_parameters([Parameter("x", value="y")]) == [OK]
    assert node.set_parameters([Parameter("x")]) == [OK]
    assert not node.has_parameter("x")


@pytest.mark.parametrize(
    ("descriptor", "value", "reason"),
    [
        (
            ParameterDescriptor(integer_range=[IntegerRange(from_value=0, to_value=10, step=3)]),
            11,
            "Parameter p out of range. Min: 0, Max: 10, value: 11",
        ),
        (
            ParameterDescriptor(integer_range=[IntegerRange(from_value=0, to_value=10, step=3)]),
            4,
            "The parameter value for p is not a valid step. Min: 0, max: 10, value: 4, step: 3",
        ),
        (in_range(0.0, 1.0, 0.1), 1.5, "Parameter p out of range Min: 0.0, Max: 1.0, value: 1.5"),
        (
            in_range(0.0, 1.0, 0.1),
            0.25,
            "The parameter value for p is not close enough to a valid step. "
            "Min: 0.0, max: 1.0, value: 0.25, step: 0.1",
        ),
        (ParameterDescriptor(read_only=True), 3, "Trying to set a read-only parameter: p."),
    ],
)
def test_descriptor_rejects_values_with_the_error_text_of_rclpy(
    node: Node, descriptor: ParameterDescriptor, value: float, reason: str
) -> None:
    node.declare_parameter("p", type(value)(), descriptor)
    assert node.set_parameters([Parameter("p", value=value)]) == [refused(reason)]
    assert node.get_parameter("p").value == 0


@pytest.mark.parametrize("value", [0, 3, 10])
def test_range_allows_its_steps_and_both_bounds(node: Node, value: int) -> None:
    steps = [IntegerRange(from_value=0, to_value=10, step=3)]
    node.declare_parameter("p", 0, ParameterDescriptor(integer_range=steps))
    assert node.set_parameters([Parameter("p", value=value)]) == [OK]


def test_default_outside_its_range_is_rejected(node: Node) -> None:
    with pytest.raises(InvalidParameterValueException) as caught:
        node.declare_parameter("p", 2.0, in_range(0.0, 1.0, 0.0))
    assert str(caught.value) == (
        "Invalid parameter value (2.0) for parameter. "
        "Reason: Parameter p out of range Min: 0.0, Max: 1.0, value: 2.0: p"
    )


def test_invalid_declarations_raise_the_errors_of_rclpy(node: Node) -> None:
    node.declare_parameter("x", 1)
    for wrong, error, text in (
        (("x", 1), ParameterAlreadyDeclaredException, "Parameter(s) already declared: ['x']"),
        (("", 1), InvalidParameterException, "Invalid parameter name: "),
        (
            ("y", None, ParameterDescriptor()),
            ValueError,
            "Cannot declare a statically typed parameter with default value of type PARAMETER_NOT_SET",
        ),
        (("y", {}), TypeError, "The given value is not one of the allowed types '{}'."),
    ):
        with pytest.raises(error) as caught:
            node.declare_parameter(*wrong)
        assert str(caught.value) == text
    with pytest.warns(UserWarning, match="declaring a parameter only providing its name is deprecated"):
        assert node.declare_parameter("nothing").value is None


def test_invalid_reads_raise_the_errors_of_rclpy(node: Node) -> None:
    node.declare_parameter("typed", Parameter.Type.STRING)
    with pytest.raises(ParameterUninitializedException) as empty:
        node.get_parameter("typed")
    assert str(empty.value) == "The parameter 'typed' is not initialized: typed"
    assert node.get_parameter_or("typed", Parameter("alt", value=1)).value == 1
    with pytest.raises(ParameterNotDeclaredException) as missing:
        node.get_parameter("x")
    assert str(missing.value) == "Invalid access to undeclared parameter(s): x"
    with pytest.raises(ParameterNotDeclaredException) as unset:
        node.set_parameters([Parameter("x", value=1)])
    assert str(unset.value) == "Invalid access to undeclared parameter(s): []"


def test_undeclared_parameters_can_be_allowed(started_graph: Graph) -> None:
    node = Node("free", allow_undeclared_parameters=True)
    assert node.get_parameter("x").type_ is Parameter.Type.NOT_SET
    assert node.set_parameters([Parameter("x", value=1.5)]) == [OK]
    assert node.get_parameter("x").value == 1.5


def test_read_only_parameter_cannot_be_undeclared(node: Node) -> None:
    node.declare_parameter("x", 1, ParameterDescriptor(read_only=True))
    with pytest.raises(ParameterImmutableException) as caught:
        node.undeclare_parameter("x")
    assert str(caught.value) == "Attempted to modify read-only parameter: x"
    node.declare_parameter("y", 1)
    node.undeclare_parameter("y")
    assert not node.has_parameter("y")


def test_several_parameters_are_declared_in_a_namespace_and_found_by_its_prefix(node: Node) -> None:
    node.declare_parameters("arm", [("speed", 1.5), ("name", "left"), ("joint.limit", 2)])
    arm = node.get_parameters_by_prefix("arm")
    assert {name: p.value for name, p in arm.items()} == {"speed": 1.5, "name": "left", "joint.limit": 2}
    listed = node.list_parameters(["arm"], 0)
    assert (listed.names, listed.prefixes) == (
        ["arm.speed", "arm.name", "arm.joint.limit"],
        ["arm", "arm.joint"],
    )
    assert node.list_parameters(["arm"], 1).names == ["arm.speed", "arm.name"]
    assert node.list_parameters([], 1).names == ["use_sim_time", "start_type_description_service"]


def test_overrides_take_precedence_over_defaults_unless_ignored(started_graph: Graph) -> None:
    given = [Parameter("x", value=5), Parameter("word", value="hi")]
    node = Node("over", parameter_overrides=given)
    assert node.declare_parameter("x", 1).value == 5
    assert node.declare_parameter("word", "ho", ignore_override=True).value == "ho"
    other = Node("typed", parameter_overrides=given)
    with pytest.raises(InvalidParameterTypeException) as caught:
        other.declare_parameter("word", 1)
    assert str(caught.value) == (
        "Trying to set parameter 'word' to 'hi' of type 'STRING', expecting type 'INTEGER': word"
    )
    auto = Node("auto", parameter_overrides=given, automatically_declare_parameters_from_overrides=True)
    assert auto.get_parameter("x").value == 5


def test_pre_on_and_post_set_callbacks_run_in_this_order_newest_first(node: Node) -> None:
    node.declare_parameters("", [("a", 1), ("b", 1)])
    calls: list[str] = []

    def note(name: str, result: Any) -> Any:
        def callback(parameters: list[Parameter]) -> Any:
            calls.append(f"{name} {[p.name for p in parameters]}")
            return result

        return callback

    node.add_post_set_parameters_callback(note("post", None))
    node.add_on_set_parameters_callback(note("on old", OK))
    node.add_on_set_parameters_callback(note("on new", OK))
    pre = note("pre", [Parameter("a", value=2), Parameter("b", value=3)])
    node.add_pre_set_parameters_callback(pre)
    assert node.set_parameters([Parameter("a", value=2)]) == [OK]
    both = "['a', 'b']"
    assert calls == ["pre ['a']", f"on new {both}", f"on old {both}", f"post {both}"]
    assert node.get_parameter("b").value == 3
    node.remove_pre_set_parameters_callback(pre)
    node.add_pre_set_parameters_callback(lambda parameters: [])
    assert "parameter list cannot be empty" in node.set_parameters([Parameter("a", value=9)])[0].reason


def test_on_set_callback_can_reject_the_change_atomically(node: Node) -> None:
    node.declare_parameters("", [("a", 1), ("b", 1)])
    no = refused("not today")
    node.add_on_set_parameters_callback(lambda parameters: no)
    assert node.set_parameters_atomically([Parameter("a", value=2), Parameter("b", value=2)]) == no
    assert [p.value for p in node.get_parameters(["a", "b"])] == [1, 1]


def test_warning_about_the_result_of_a_callback_states_the_line_of_the_callback(node: Node) -> None:
    def forgets_to_return(parameters: list[Parameter]) -> None:
        pass

    node.declare_parameter("a", 1)
    node.add_on_set_parameters_callback(forgets_to_return)  # type: ignore[arg-type]
    with pytest.warns(UserWarning, match="Callback returned an invalid type") as caught:
        node.set_parameters([Parameter("a", value=2)])
    assert caught[0].filename == __file__
    assert caught[0].lineno == forgets_to_return.__code__.co_firstlineno


def test_parameter_changes_are_published_on_parameter_events(node: Node) -> None:
    events: list[ParameterEvent] = []
    watcher = Node("watcher")
    watcher.create_subscription(ParameterEvent, "/parameter_events", events.append, 10)
    node.declare_parameter("x", 1, ParameterDescriptor(dynamic_typing=True))
    node.set_parameters([Parameter("x", value=2)])
    node.set_parameters([Parameter("x")])
    rclpy.spin(watcher)
    assert [event.node for event in events] == ["/talker"] * 3
    told = [(len(e.new_parameters), len(e.changed_parameters), len(e.deleted_parameters)) for e in events]
    assert told == [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
    assert events[1].changed_parameters[0].value.integer_value == 2


def call_service(node: Node, kind: Any, name: str, **request: Any) -> Any:
    client = Node("asker").create_client(kind, f"/talker/{name}")
    future = client.call_async(kind.Request(**request))
    executor = rclpy.get_global_executor()
    executor.add_node(node)
    for one in current_graph().state(NodesById).nodes.values():
        executor.add_node(one)
    executor.spin_until_future_complete(future)
    return future.result()


def test_other_nodes_get_and_set_parameters_with_the_six_services(node: Node) -> None:
    node.declare_parameter("speed", 1, ParameterDescriptor(description="how fast"))
    names = call_service(node, ListParameters, "list_parameters").result.names
    assert names == ["use_sim_time", "start_type_description_service", "speed"]
    (described,) = call_service(node, DescribeParameters, "describe_parameters", names=["speed"]).descriptors
    assert (described.name, described.type, described.description) == ("speed", 2, "how fast")
    assert call_service(node, GetParameters, "get_parameters", names=["speed"]).values[0].integer_value == 1
    assert list(call_service(node, GetParameterTypes, "get_parameter_types", names=["speed"]).types) == [2]
    new = [Parameter(n, value=v).to_parameter_msg() for n, v in (("speed", 2), ("speed", "x"), ("no", 1))]
    results = call_service(node, SetParameters, "set_parameters", parameters=new).results
    assert [result.successful for result in results] == [True, False, False]
    assert "undeclared" in results[2].reason
    atomic = call_service(node, SetParametersAtomically, "set_parameters_atomically", parameters=new[:2])
    assert not atomic.result.successful
    assert call_service(node, GetParameters, "get_parameters", names=["speed", "no"]).values == []


def test_parameter_services_can_be_disabled(started_graph: Graph) -> None:
    quiet, open_ = Node("quiet", start_parameter_services=False), Node("open")
    assert [service.srv_name for service in quiet.services] == ["quiet/get_type_description"]
    assert len(list(open_.services)) == 7
