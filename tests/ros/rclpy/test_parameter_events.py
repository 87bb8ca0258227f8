"""AsyncParameterClient and ParameterEventHandler."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter, parameter_dict_from_yaml_file
from rclpy.parameter_client import AsyncParameterClient
from rclpy.parameter_event_handler import ParameterEventHandler
from rclpy.task import Future


@pytest.fixture
def robot(node: Node) -> Node:
    robot = Node("robot")
    robot.declare_parameter("speed", 1)
    rclpy.get_global_executor().add_node(robot)
    return robot


@pytest.fixture
def client(node: Node, robot: Node) -> AsyncParameterClient:
    return AsyncParameterClient(node, "robot")


def result(node: Node, future: Future[Any]) -> Any:
    rclpy.spin_until_future_complete(node, future)
    return future.result()


def test_parameter_client_gets_and_sets_parameters_of_another_node(
    node: Node, robot: Node, client: AsyncParameterClient
) -> None:
    assert client.wait_for_services(timeout_sec=1.0)
    names = result(node, client.list_parameters()).result.names
    assert sorted(names) == ["speed", "start_type_description_service", "use_sim_time"]
    done: list[Future[Any]] = []
    future = client.set_parameters([Parameter("speed", value=3)], done.append)
    assert result(node, future).results[0].successful
    assert robot.get_parameter("speed").value == 3
    rclpy.spin_once(node, timeout_sec=0.0)
    assert done == [future]
    assert result(node, client.get_parameters(["speed"])).values[0].integer_value == 3
    assert list(result(node, client.get_parameter_types(["speed"])).types) == [2]
    assert result(node, client.describe_parameters(["speed"])).descriptors[0].name == "speed"
    many: list[Any] = [Parameter("speed", value=4).to_parameter_msg(), Parameter("speed", value="x")]
    assert not result(node, client.set_parameters_atomically(many)).result.successful
    assert not result(node, client.delete_parameters(["speed"])).results[0].successful


def test_parameter_files_are_read_with_wildcards_on_request(tmp_path: Path) -> None:
    file = tmp_path / "robot.yaml"
    file.write_text("/**:\n  ros__parameters: {speed: 7}\n/other:\n  ros__parameters: {arm: {length: 2.0}}\n")
    assert list(parameter_dict_from_yaml_file(str(file))) == ["arm.length"]
    assert list(parameter_dict_from_yaml_file(str(file), True)) == ["speed", "arm.length"]
    with pytest.raises(RuntimeError, match=r"^Param file does not contain parameters for /x,only for nodes"):
        parameter_dict_from_yaml_file(str(file), target_nodes=["/x"])


def test_parameters_of_a_file_are_set_in_another_node(
    tmp_path: Path, node: Node, robot: Node, client: AsyncParameterClient
) -> None:
    file = tmp_path / "robot.yaml"
    file.write_text("/robot:\n  ros__parameters: {speed: 7}\n")
    assert [one.successful for one in result(node, client.load_parameter_file(str(file))).results] == [True]
    assert robot.get_parameter("speed").value == 7
    file.write_text("/robot:\n  ros__parameters: {speed: fast}\n")
    assert not result(node, client.load_parameter_file_atomically(str(file))).result.successful
    assert robot.get_parameter("speed").value == 7


def test_parameter_and_event_callbacks_are_called_until_removed(node: Node, robot: Node) -> None:
    handler = ParameterEventHandler(node)
    calls: list[Any] = []
    one = handler.add_parameter_callback("speed", "robot", lambda p: calls.append(p.value.integer_value))
    handler.add_parameter_callback("speed", "", lambda p: pytest.fail("it is not this node's"))
    every = handler.add_parameter_event_callback(lambda event: calls.append(event.node))
    robot.set_parameters([Parameter("speed", value=5)])
    drain(node)
    assert calls == [5, "/robot"]
    handler.remove_parameter_callback(one)
    handler.remove_parameter_event_callback(every)
    with pytest.raises(RuntimeError, match=r"^Callback doesn't exist$"):
        handler.remove_parameter_callback(one)
    robot.set_parameters([Parameter("speed", value=6)])
    drain(node)
    assert calls == [5, "/robot"]
    handler.destroy()


def test_parameter_client_receives_parameter_events(
    node: Node, robot: Node, client: AsyncParameterClient
) -> None:
    changed_names: list[str] = []
    client.on_parameter_event(lambda event: changed_names.append(event.changed_parameters[0].name))
    robot.set_parameters([Parameter("speed", value=5)])
    drain(node)
    assert changed_names == ["speed"]


def drain(node: Node) -> None:
    for _ in range(5):
        rclpy.spin_once(node, timeout_sec=0.01)
