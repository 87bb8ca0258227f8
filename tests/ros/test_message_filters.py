from collections.abc import Callable
from functools import partial
from typing import Any

import pytest
import rclpy
from message_filters import (
    ApproximateTimeSynchronizer,
    Cache,
    SimpleFilter,
    Subscriber,
    TimeSynchronizer,
)
from rclpy.clock import ClockType
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from rclpy.time import Time
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header, String

from course_lib import spin_for
from course_lib.ros.graph.graph import Graph, use_graph


def at(seconds: float) -> Time:
    return Time(nanoseconds=round(seconds * 1e9), clock_type=ClockType.ROS_TIME)


def send(source: SimpleFilter, seconds: float) -> None:
    """Signal an image of a time, [s], whose frame is named by that."""
    source.signalMessage(Image(header=Header(stamp=at(seconds).to_msg(), frame_id=f"{seconds:g}")))


def collect_frames(last: SimpleFilter) -> list[tuple[str, ...]]:
    """Return a list to which the frames of a filter's messages are appended."""
    sets: list[tuple[str, ...]] = []
    last.registerCallback(lambda *images: sets.append(tuple(image.header.frame_id for image in images)))
    return sets


def test_pair_of_topics_is_synchronized_in_one_callback() -> None:
    class Camera(Node):
        def __init__(self) -> None:
            super().__init__("camera")
            self.images = self.create_publisher(Image, "image", qos_profile_sensor_data)
            self.infos = self.create_publisher(CameraInfo, "info", 10)
            self.create_timer(0.1, self.take)

        def take(self) -> None:
            header = Header(stamp=self.get_clock().now().to_msg())
            self.images.publish(Image(header=header))
            self.infos.publish(CameraInfo(header=header))

    pairs: list[tuple[Any, Any]] = []
    with use_graph(Graph()):
        rclpy.init()
        node = Node("listener")
        image = Subscriber(node, Image, "image", qos_profile=qos_profile_sensor_data)
        info = Subscriber(node, CameraInfo, "info")
        both = TimeSynchronizer([image, info], 10)
        both.registerCallback(lambda one, other: pairs.append((one, other)))
        spin_for(1.05, Camera(), node)
        rclpy.shutdown()
    assert len(pairs) == 10
    assert all(one.header == other.header for one, other in pairs)
    assert (image.getTopic(), info.topic_name) == ("image", "/info")


def test_exact_stamps_match_and_full_queues_drop_the_oldest() -> None:
    left, right = SimpleFilter(), SimpleFilter()
    sets = collect_frames(TimeSynchronizer([left, right], 2))
    for seconds in (1.0, 2.0, 3.0):
        send(left, seconds)
    for seconds in (1.0, 3.0, 2.0):
        send(right, seconds)
    assert sets == [("3", "3"), ("2", "2")]


@pytest.mark.parametrize(
    ("slop", "expected"),
    [(0.3, [("1.2", "1.1"), ("1", "0.9")]), (0.1, [("1.2", "1.1")]), (0.0, [])],
)
def test_approximate_stamps_match_the_nearest_first(slop: float, expected: list[tuple[str, ...]]) -> None:
    left, right = SimpleFilter(), SimpleFilter()
    sets = collect_frames(ApproximateTimeSynchronizer([left, right], 10, slop))
    for seconds in (1.0, 1.2):
        send(left, seconds)
    for seconds in (1.11, 0.9):
        send(right, seconds)
    assert [tuple(frame.replace("1.11", "1.1") for frame in one) for one in sets] == expected


def test_three_filters_match_only_within_the_slop_of_all() -> None:
    sources = [SimpleFilter() for _ in range(3)]
    sets = collect_frames(ApproximateTimeSynchronizer(sources, 5, 0.1))
    for source, seconds in zip(sources, (1.0, 1.09, 1.18), strict=True):
        send(source, seconds)
    assert sets == []
    send(sources[0], 1.1)
    assert sets == [("1.1", "1.09", "1.18")]


def test_message_without_a_header_uses_the_current_time_or_is_rejected(
    capfd: pytest.CaptureFixture[str],
) -> None:
    with use_graph(Graph()):
        rclpy.init()
        source = SimpleFilter()
        strict, open_to_all = Cache(source, 5), Cache(source, 5, allow_headerless=True)
        source.signalMessage(String(data="now"))
        rclpy.shutdown()
    assert (strict.getLast(), open_to_all.getLast()) == (None, String(data="now"))
    assert "can not use message filters messages without timestamp infomation" in capfd.readouterr().err


def test_cache_returns_messages_by_time_and_interval() -> None:
    source = SimpleFilter()
    cache = Cache(source, 3)
    passed = collect_frames(cache)
    for seconds in (1.0, 2.0, 3.0, 4.0):
        send(source, seconds)
    assert len(passed) == 4
    assert (cache.getOldestTime(), cache.getLastestTime()) == (at(2.0), at(4.0))
    assert [image.header.frame_id for image in cache.getInterval(at(2.5), at(4.0))] == ["3", "4"]
    assert cache.getElemAfterTime(at(2.5)).header.frame_id == "3"
    assert cache.getElemBeforeTime(at(2.5)).header.frame_id == "2"
    assert (cache.getElemBeforeTime(at(1.0)), cache.getElemAfterTime(at(5.0))) == (None, None)


def test_exception_in_a_callback_leaves_the_synchronizer_usable() -> None:
    left, right = SimpleFilter(), SimpleFilter()
    both = TimeSynchronizer([left, right], 5)
    both.registerCallback(lambda *_: 1 / 0)
    for seconds in (1.0, 2.0):
        send(left, seconds)
        with pytest.raises(ZeroDivisionError):
            send(right, seconds)


@pytest.mark.parametrize("kind", [TimeSynchronizer, partial(ApproximateTimeSynchronizer, slop=0.1)])
def test_set_stays_in_the_queues_until_its_callback_has_returned(kind: Callable[..., Any]) -> None:
    sources = [SimpleFilter(), SimpleFilter()]
    synchronizer, lengths = kind(sources, 3), list[list[int]]()
    synchronizer.registerCallback(lambda *messages: lengths.append([*map(len, synchronizer.queues)]))
    for source in sources:
        send(source, 1.0)
    assert (lengths, [*map(len, synchronizer.queues)]) == ([[1, 1]], [0, 0])
