import re
from collections.abc import Callable
from math import pi
from typing import Any

import pytest
import rclpy
import tf2_geometry_msgs  # noqa: F401  # teaches buffers the types of geometry_msgs
import tf2_py
import tf2_ros
from geometry_msgs.msg import PointStamped
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.time import Time
from std_msgs.msg import Header, String
from tf2_msgs.srv import FrameGraph
from tf2_ros import Buffer, TransformListener
from tf2_ros.buffer_interface import TypeException

from course_lib.ros.graph.graph import Graph
from course_lib.ros.tf2 import BufferCore, Pose
from tests.ros.tf2.stamped import stamped

S = 10**9  # [ns]


def filled() -> Buffer:
    """map -> base is 1 m at 1 s, 3 m at 3 s; base -> tool is static, 0.5 m, turned 90 degrees."""
    buffer = Buffer()
    for second in (1, 3):
        buffer.set_transform(stamped("map", "base", second * S, x=float(second)), "me")
    buffer.set_transform_static(stamped("base", "tool", x=0.5, yaw=pi / 2), "me")
    return buffer


def test_lookup_returns_a_message_with_frames_stamp_and_transform() -> None:
    transform = filled().lookup_transform("map", "tool", Time(nanoseconds=2 * S))
    assert (transform.header.frame_id, transform.child_frame_id, transform.header.stamp.sec) == (
        "map",
        "tool",
        2,
    )
    assert transform.transform.translation.x == pytest.approx(2.5)
    assert transform.transform.rotation.z == pytest.approx(2**-0.5)


def test_times_of_any_clock_and_time_messages_are_accepted() -> None:
    buffer = filled()
    for time in (Time(seconds=3), Time(seconds=3).to_msg(), Time()):
        assert buffer.lookup_transform("map", "base", time).header.stamp.sec == 3
    wrong: Any = 3.0
    with pytest.raises(TypeError, match=re.escape("time must have sec and nanosec, or nanoseconds.")):
        buffer.lookup_transform("map", "base", wrong)


def test_lookup_transform_full_relates_two_times_through_a_fixed_frame() -> None:
    transform = filled().lookup_transform_full("base", Time(seconds=3), "base", Time(seconds=1), "map")
    assert transform.transform.translation.x == pytest.approx(-2.0)


def test_lookup_without_a_timeout_searches_the_frames_once(monkeypatch: pytest.MonkeyPatch) -> None:
    buffer, searches = filled(), []
    search = BufferCore._walk

    def count(core: BufferCore, target: str, source: str, time_ns: int) -> Pose:
        searches.append((target, source))
        return search(core, target, source, time_ns)

    monkeypatch.setattr(BufferCore, "_walk", count)
    buffer.lookup_transform("map", "tool", Time())
    assert searches == [("map", "tool")]


def test_methods_of_tf2_py_agree_with_the_methods_of_the_buffer() -> None:
    buffer, at, then = filled(), Time(seconds=1), Time(seconds=3)
    full = "base", then, "base", at, "map"
    assert buffer.lookup_transform_core("map", "tool", at) == buffer.lookup_transform("map", "tool", at)
    assert buffer.lookup_transform_full_core(*full) == buffer.lookup_transform_full(*full)
    assert buffer.can_transform_core("map", "tool", at) == (1, "")
    assert buffer.can_transform_full_core(*full) == (1, "")
    assert (buffer.can_transform_full(*full), buffer.can_transform_full(*full, return_debug_tuple=True)) == (
        1,
        (1, ""),
    )
    problem = buffer.can_transform_core("map", "nowhere", at)
    assert problem == (
        0,
        'Invalid frame ID "nowhere" passed to canTransform argument source_frame - frame does not exist',
    )


def test_latest_common_time_is_the_newest_time_of_the_whole_chain() -> None:
    buffer = filled()
    assert buffer.get_latest_common_time("map", "tool") == Time(seconds=3)
    assert buffer.get_latest_common_time("base", "tool") == Time()
    assert buffer.get_latest_common_time("base", "base") == Time(seconds=3)
    assert buffer.get_latest_common_time("map", "map") == Time()


@pytest.mark.parametrize(
    ("frame", "exception", "text"),
    [
        ("nowhere", tf2_ros.LookupException, '"nowhere" passed to get_latest_common_time does not exist. '),
        (
            "/map",
            tf2_ros.InvalidArgumentException,
            'Invalid argument "/map" passed to get_latest_common_time - in tf2 frame_ids cannot start '
            "with a '/'",
        ),
        ("island", tf2_ros.TransformException, "Could not find a connection between 'map' and 'island'"),
    ],
)
def test_latest_common_time_of_unconnected_frames_has_the_error_of_tf2_py(
    frame: str, exception: type[Exception], text: str
) -> None:
    buffer = filled()
    buffer.set_transform(stamped("sea", "island", S), "me")
    with pytest.raises(tf2_ros.TransformException, match=re.escape(text)) as caught:
        buffer.get_latest_common_time("map", frame)
    assert type(caught.value) is exception


def test_buffer_core_stores_transforms_without_a_node() -> None:
    core = tf2_py.BufferCore(Duration(seconds=5))
    core.set_transform(stamped("map", "base", S, x=2.0), "me")
    core.set_transform_static(stamped("base", "tool", x=0.5), "me")
    assert core.lookup_transform_core("map", "tool", Time()).transform.translation.x == 2.5
    assert isinstance(Buffer(), tf2_py.BufferCore)


def test_stamped_gives_an_object_a_header() -> None:
    point = tf2_ros.Stamped(PointStamped(), Time(seconds=2).to_msg(), "map")
    assert (point.header.frame_id, point.header.stamp.sec) == ("map", 2)


def test_message_is_transformed_to_another_time_via_a_fixed_frame() -> None:
    point = PointStamped(header=Header(frame_id="base", stamp=Time(seconds=1).to_msg()))
    moved = filled().transform_full(point, "base", Time(seconds=3), "map")
    assert (moved.header.frame_id, moved.point.x) == ("base", -2.0)


def test_future_of_a_full_transform_is_done_when_its_data_arrives() -> None:
    buffer = filled()
    future = buffer.wait_for_transform_full_async("base", Time(seconds=5), "base", Time(seconds=1), "map")
    assert not future.done()
    buffer.set_transform(stamped("map", "base", 5 * S, x=5.0), "me")
    result = future.result()
    assert result is not None
    assert result.transform.translation.x == -4.0


def test_can_transform_returns_the_reason_with_return_debug_tuple() -> None:
    ok, reason = filled().can_transform("map", "base", Time(seconds=9), return_debug_tuple=True)
    assert not ok
    assert reason.startswith("Lookup would require extrapolation into the future.  Requested time 9.000000")
    assert filled().can_transform("map", "base", Time(), return_debug_tuple=True) == (True, "")


def test_exceptions_have_one_base_class_and_the_module_of_tf2() -> None:
    with pytest.raises(tf2_ros.TransformException) as caught:
        filled().lookup_transform("map", "nowhere", Time())
    assert isinstance(caught.value, tf2_ros.LookupException)
    assert type(caught.value).__module__ == "tf2"


def test_stamped_point_is_transformed_at_its_stamp() -> None:
    point = PointStamped(header=Header(frame_id="tool", stamp=Time(seconds=1).to_msg()))
    point.point.x = 1.0
    carried = filled().transform(point, "map")
    assert (carried.point.x, carried.point.y) == pytest.approx((1.5, 1.0))
    assert carried.header.frame_id == "map"


def test_transform_of_an_unregistered_type_is_rejected() -> None:
    expected = f"Type {String} is not loaded or supported"
    with pytest.raises(TypeException, match=re.escape(expected)):
        filled().transform(String(), "map")


def test_rejected_transforms_are_logged_and_ignored(
    started_graph: Graph, capfd: pytest.CaptureFixture[str]
) -> None:
    buffer = filled()
    buffer.set_transform(stamped("map", "map", 1 * S), "me")
    buffer.set_transform(stamped("map", "base", 20 * S), "me")
    buffer.set_transform(stamped("map", "base", 5 * S), "me")
    lines = capfd.readouterr().err.splitlines()
    assert lines[0].startswith("[ERROR]")
    assert 'TF_SELF_TRANSFORM: Ignoring transform from authority "me"' in lines[0]
    assert lines[1].startswith("[WARN]")
    assert "TF_OLD_DATA ignoring data from the past for frame base at time 5.000000" in lines[1]


def test_all_frames_are_listed() -> None:
    assert filled().all_frames_as_string() == (
        "Frame base exists with parent map.\nFrame tool exists with parent base.\n"
    )
    assert (
        filled()
        .all_frames_as_yaml()
        .startswith(
            "base: \n  parent: 'map'\n  broadcaster: 'me'\n  rate: 1.000\n  most_recent_transform: 3.000000\n"
            "  oldest_transform: 1.000000\n  buffer_length: 2.000\n"
            "tool: \n  parent: 'base'\n  broadcaster: 'me'\n  rate: 10000.000\n"
        )
    )
    assert Buffer().all_frames_as_yaml() == "[]"


def test_wait_in_the_spinning_thread_ends_at_its_timeout(started_graph: Graph, node: Node) -> None:
    buffer, waits = Buffer(), list[tuple[bool, int]]()
    TransformListener(buffer, node)
    sender = Node("sender")
    broadcaster = tf2_ros.TransformBroadcaster(sender)
    sender.create_timer(0.1, lambda: broadcaster.sendTransform(stamped("map", "base", started_graph.now_ns)))

    def wait() -> None:
        timer.cancel()
        start_ns = started_graph.now_ns
        answer = buffer.can_transform("map", "base", Time(), timeout=Duration(seconds=2.0))
        waits.append((answer, started_graph.now_ns - start_ns))

    timer = node.create_timer(0.05, wait)
    executor = SingleThreadedExecutor()
    for one in (node, sender):
        executor.add_node(one)
    executor.spin()
    assert waits == [(False, 2 * S)]


def test_wait_succeeds_if_the_listener_spins_in_its_own_thread(started_graph: Graph, node: Node) -> None:
    buffer = Buffer()
    TransformListener(buffer, Node("listener"), spin_thread=True)
    broadcaster = tf2_ros.TransformBroadcaster(node)
    node.create_timer(0.1, lambda: broadcaster.sendTransform(stamped("map", "base", started_graph.now_ns)))
    rclpy.spin_once(node)
    start_ns = started_graph.now_ns
    assert buffer.lookup_transform("map", "base", Time(), timeout=Duration(seconds=5.0)).child_frame_id
    assert started_graph.now_ns - start_ns == 1_000_000  # the delivery


def test_coroutine_can_await_a_transform(started_graph: Graph, node: Node) -> None:
    buffer = Buffer()
    TransformListener(buffer, node)
    broadcaster = tf2_ros.TransformBroadcaster(node)
    timer = node.create_timer(
        0.5, lambda: broadcaster.sendTransform(stamped("map", "base", started_graph.now_ns))
    )
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    task = executor.create_task(buffer.lookup_transform_async, "map", "base", Time())
    executor.spin_until_future_complete(task, timeout_sec=3.0)
    found = task.result()
    assert found is not None
    assert found.header.frame_id == "map"
    assert timer.time_since_last_call() == 1_000_000  # the delivery
    known = buffer.wait_for_transform_async("map", "base", Time())
    assert known.done()


NONE: Any = None
# Calls with wrong arguments, and the error of tf2 in ROS 2 Jazzy.
WRONG_CALLS: dict[str, tuple[Callable[[Buffer], object], str]] = {
    "timeout in seconds": (
        lambda buffer: buffer.lookup_transform("map", "base", Time(), 1.0),  # type: ignore[arg-type]
        "unsupported operand type(s) for +: 'Time' and 'float'",
    ),
    "no target frame": (
        lambda buffer: buffer.lookup_transform(NONE, "base", Time()),
        "argument 1 must be str, not None",
    ),
    "no source frame": (
        lambda buffer: buffer.can_transform("map", NONE, Time()),
        "argument 2 must be str, not None",
    ),
    "no fixed frame": (
        lambda buffer: buffer.lookup_transform_full("map", Time(), "base", Time(), NONE),
        "argument 5 must be str, not None",
    ),
    "no time": (
        lambda buffer: buffer.wait_for_transform_async("map", "base", NONE),
        "time must have sec and nanosec, or nanoseconds.",
    ),
    "no authority": (
        lambda buffer: buffer.set_transform(stamped("map", "base"), NONE),
        "argument 2 must be str, not None",
    ),
    "cache time in seconds": (
        lambda buffer: Buffer(10.0),  # type: ignore[arg-type]
        "duration must have sec and nanosec, or nanoseconds.",
    ),
}


@pytest.mark.parametrize("name", WRONG_CALLS)
def test_argument_of_a_wrong_type_is_rejected_as_in_tf2(name: str) -> None:
    call, text = WRONG_CALLS[name]
    with pytest.raises(TypeError, match=f"^{re.escape(text)}$"):
        call(filled())


def test_can_transform_returns_1_or_0_as_in_tf2() -> None:
    buffer = filled()
    answers = [buffer.can_transform("map", frame, Time()) for frame in ("base", "nowhere")]
    assert [str(answer) for answer in answers] == ["1", "0"]
    assert str(buffer.can_transform("map", "base", Time(), return_debug_tuple=True)) == "(1, '')"


def test_canceled_wait_for_a_transform_gets_the_next_one_as_in_tf2() -> None:
    buffer = Buffer()
    future = buffer.wait_for_transform_async("map", "base", Time())
    future.cancel()
    buffer.set_transform(stamped("map", "base", S), "me")
    assert future.done()
    buffer.set_transform(stamped("map", "base", 2 * S), "me")
    transform = future.result()
    assert transform is not None
    assert transform.header.stamp.sec == 1


def test_result_of_transform_is_converted_to_a_passed_type() -> None:
    point = PointStamped(header=Header(frame_id="base", stamp=Time(seconds=1).to_msg()))
    assert filled().transform(point, "map", new_type=PointStamped).point.x == pytest.approx(1.0)
    with pytest.raises(TypeException, match="not loaded or supported"):
        filled().transform(point, "map", new_type=String)


def test_clear_removes_dynamic_transforms_and_keeps_static_ones() -> None:
    buffer = filled()
    buffer.clear()
    assert not buffer.can_transform("map", "base", Time())
    assert buffer.can_transform("base", "tool", Time())


def test_buffer_with_a_node_offers_the_service_tf2_frames(started_graph: Graph, node: Node) -> None:
    buffer = Buffer(node=node)
    buffer.set_transform(stamped("map", "base", 5), "me")
    future = node.create_client(FrameGraph, "tf2_frames").call_async(FrameGraph.Request())
    rclpy.spin_until_future_complete(node, future)
    answer = future.result()
    assert answer is not None
    assert answer.frame_yaml == buffer.all_frames_as_yaml()


class OnlyUp(tf2_ros.BufferInterface):
    """A custom buffer in which every frame is 1 m above every other."""

    def lookup_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: object,
        timeout: Duration = Duration(),  # noqa: B008
    ) -> tf2_ros.TransformStamped:
        transform = tf2_ros.TransformStamped()
        transform.header.frame_id = target_frame
        transform.transform.translation.z = 1.0
        return transform


def test_custom_buffer_transforms_with_its_own_lookup() -> None:
    message = OnlyUp().transform(PointStamped(header=Header(frame_id="a")), "b")
    assert (message.header.frame_id, message.point.z) == ("b", 1.0)
    assert isinstance(Buffer(), tf2_ros.BufferInterface)


def test_buffer_interface_without_lookup_raises_not_implemented() -> None:
    with pytest.raises(tf2_ros.NotImplementedException, match="LookupTransform not implemented"):
        tf2_ros.BufferInterface().transform(PointStamped(), "b")
    with pytest.raises(tf2_ros.NotImplementedException, match="CanTransform"):
        tf2_ros.BufferInterface().can_transform("a", "b", Time())


def test_description_of_the_frames_is_formatted_again_only_after_a_change() -> None:
    buffer = filled()
    before = buffer.all_frames_as_string()
    assert buffer.all_frames_as_string() is before
    buffer.set_transform_static(stamped("tool", "tip"), "me")
    assert buffer.all_frames_as_string() == f"{before}Frame tip exists with parent tool.\n"
    buffer.clear()
    assert "Frame base exists with parent NO_PARENT." in buffer.all_frames_as_string()
