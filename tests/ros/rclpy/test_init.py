import pytest
import rclpy
from rclpy.context import Context, Contexts
from rclpy.exceptions import NotInitializedException
from rclpy.impl.implementation_singleton import RCLError
from rclpy.node import Node

from course_lib.ros.graph.graph import Graph, ProgramNodes, use_graph


def test_second_init_is_rejected(started_graph: Graph) -> None:
    with pytest.raises(RuntimeError, match=r"^Context.init\(\) must only be called once$"):
        rclpy.init()


def test_node_before_init_is_rejected(graph: Graph) -> None:
    text = r"^rclpy.init\(\) has not been called. msg:cannot create node$"
    with pytest.raises(NotInitializedException, match=text):
        Node("talker")


def test_shutdown_before_init_is_rejected_but_try_shutdown_is_not(graph: Graph) -> None:
    rclpy.try_shutdown()
    with pytest.raises(RuntimeError, match=r"^Context must be initialized before it can be shutdown$"):
        rclpy.shutdown()


def test_context_cannot_be_shut_down_twice(graph: Graph) -> None:
    context = Context()
    rclpy.init(context=context)
    rclpy.shutdown(context=context)
    text = "^failed to shutdown: rcl_shutdown already called on the given context$"
    with pytest.raises(RCLError, match=text):
        rclpy.shutdown(context=context)
    rclpy.try_shutdown(context=context)


def test_ok_is_true_between_init_and_shutdown(graph: Graph) -> None:
    before = rclpy.ok()
    rclpy.init(args=[])
    between = rclpy.ok()
    rclpy.shutdown()
    assert (before, between, rclpy.ok()) == (False, True, False)


def test_init_after_a_shutdown_creates_a_new_context(started_graph: Graph) -> None:
    rclpy.shutdown()
    rclpy.init(args=[])
    assert rclpy.ok()
    Node("talker")


def test_init_in_a_with_statement_shuts_down_at_the_end(graph: Graph) -> None:
    with rclpy.init(args=[]):
        assert rclpy.ok()
    assert not rclpy.ok()
    with Context() as context:
        assert rclpy.ok(context=context)
    assert not context.ok()


def test_shutdown_skips_callbacks_of_deleted_objects(started_graph: Graph) -> None:
    called: list[str] = []

    class Camera:
        def stop(self) -> None:
            called.append("stopped")

    kept = Camera()
    context = rclpy.get_default_context()
    context.on_shutdown(kept.stop)
    context.on_shutdown(Camera().stop)
    rclpy.shutdown()
    assert called == ["stopped"]


def test_context_is_not_ok_in_a_shutdown_callback(started_graph: Graph) -> None:
    states: list[bool] = []
    rclpy.get_default_context().on_shutdown(lambda: states.append(rclpy.ok()))
    rclpy.shutdown()
    assert states == [False]


def test_shutdown_calls_the_on_shutdown_callbacks(started_graph: Graph) -> None:
    called: list[str] = []
    rclpy.get_default_context().on_shutdown(lambda: called.append("called"))
    rclpy.shutdown()
    assert called == ["called"]


def test_shutdown_removes_the_nodes_from_the_graph(node: Node, started_graph: Graph) -> None:
    publisher = node.create_publisher(type(node.get_clock().now().to_msg()), "now", 10)
    rclpy.shutdown()
    assert (started_graph.nodes(), started_graph.endpoints()) == ([], [])
    with pytest.raises(RCLError, match=r"^Failed to publish: publisher's context is invalid$"):
        publisher.publish(node.get_clock().now().to_msg())
    node.destroy_node()


def test_ok_is_false_after_the_end_of_a_run_and_shutdown_is_allowed(node: Node, started_graph: Graph) -> None:
    rclpy.spin(node)
    assert started_graph.ended
    assert not rclpy.ok()
    rclpy.spin_once(node)
    node.destroy_node()
    rclpy.shutdown()


def test_new_graph_has_no_nodes(started_graph: Graph) -> None:
    with use_graph(Graph()):
        assert not rclpy.ok()
        rclpy.init(args=[])
        Node("other")
    assert [node.name for node in started_graph.nodes()] == []
    assert rclpy.ok()


def test_negative_domain_ids_are_rejected(graph: Graph) -> None:
    with pytest.raises(RuntimeError, match=r"^Domain id \(-1\) should not be lower than zero.$"):
        rclpy.init(domain_id=-1)


def test_submodules_used_by_their_full_name_are_available_with_a_node() -> None:
    assert rclpy.Parameter.Type.STRING is rclpy.parameter.Parameter.Type.STRING
    assert issubclass(rclpy.executors.ExternalShutdownException, Exception)
    assert rclpy.time.Time().nanoseconds == rclpy.duration.Duration().nanoseconds == 0


def test_ros_arguments_can_be_removed() -> None:
    from rclpy.utilities import remove_ros_args

    given = ["me", "--speed", "1", "--ros-args", "-r", "a:=b", "--", "--more"]
    assert remove_ros_args(given) == ["me", "--speed", "1", "--more"]


def test_repeated_init_in_a_notebook_keeps_only_the_last_context(notebook: Graph) -> None:
    for _ in range(3):
        rclpy.init(args=["cell", "--ros-args", "-r", "chatter:=talk"])
        rclpy.shutdown()
    assert len(notebook.state(Contexts).initialized) == 1
    assert not notebook.state(ProgramNodes).find_slips
