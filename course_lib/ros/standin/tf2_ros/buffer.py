"""The buffer with which programs look up transforms."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import builtin_interfaces.msg
from geometry_msgs.msg import Quaternion, Transform, TransformStamped, Vector3
from rclpy.clock import Clock, JumpThreshold, TimeJump
from rclpy.duration import Duration
from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.logging import get_logger
from rclpy.node import Node
from rclpy.task import Future
from rclpy.time import Time
from std_msgs.msg import Header
from tf2_msgs.srv import FrameGraph

from course_lib.ros import tf2
from course_lib.ros.graph.graph import current_graph
from course_lib.ros.time.time_lock import time_lock
from tf2_ros.buffer_interface import NO_WAIT, AnyTime, BufferInterface

_BACK = JumpThreshold(min_forward=None, min_backward=Duration(seconds=-1))
# The logger has no name, as in C++.
_log = RcutilsLogger()


class Buffer(BufferInterface):
    """A buffer of transforms, which can wait for transforms and transform messages between frames.

    A lookup returns the transform from the source frame to the target frame. The time zero,
    `Time()`, stands for the latest time at which the whole chain is known. A failure raises one of
    tf2's TransformExceptions. A timeout waits for another thread that spins the listener's node: in
    a callback of the same thread no transform can arrive during the wait, as on a robot.

    Args:
        cache_time: How long dynamic transforms are stored; default 10 s.
        node: Provides the service tf2_frames, which describes all frames. The buffer is cleared if
            the node's clock jumps back by a second or more, or if `use_sim_time` changes.
    """

    def __init__(self, cache_time: Duration | None = None, node: Node | None = None) -> None:
        self._core = tf2.BufferCore(tf2.CACHE_NS if cache_time is None else _ns(cache_time, "duration"))
        if node is not None:
            self.srv = node.create_service(FrameGraph, "tf2_frames", self._describe)
        self.clock = Clock() if node is None else node.get_clock()
        self.jump_handle = self.clock.create_jump_callback(_BACK, post_callback=self.time_jump_callback)
        # Called after each new transform. Those of futures that are done are removed afterwards.
        self._new_data_callbacks: list[Callable[[], None]] = []
        self._callbacks_to_remove: list[Callable[[], None]] = []

    def time_jump_callback(self, time_jump: TimeJump) -> None:
        """Clear the buffer."""
        get_logger("tf2_buffer").warning("Detected jump back in time. Clearing tf buffer.")
        self.clear()

    def set_transform(self, transform: TransformStamped, authority: str) -> None:
        """Store a transform. A transform that tf2 rejects is logged and ignored."""
        self._set(transform, authority, is_static=False)

    def set_transform_static(self, transform: TransformStamped, authority: str) -> None:
        """Store a transform that is valid at any time."""
        self._set(transform, authority, is_static=True)

    def lookup_transform(
        self, target_frame: str, source_frame: str, time: AnyTime, timeout: Duration = NO_WAIT
    ) -> TransformStamped:
        """Return the transform from the source frame to the target frame.

        Wait for it at most `timeout`.
        """
        _check_timeout(timeout)
        query = _check_text(target_frame, 1), _check_text(source_frame, 2), _ns(time)
        self._wait(lambda: self._core.can_transform(*query), timeout)
        return _message(self._core.lookup(*query))

    def lookup_transform_full(
        self,
        target_frame: str,
        target_time: AnyTime,
        source_frame: str,
        source_time: AnyTime,
        fixed_frame: str,
        timeout: Duration = NO_WAIT,
    ) -> TransformStamped:
        """Return the transform between two frames at two times, via a fixed frame."""
        _check_timeout(timeout)
        target = _check_text(target_frame, 1), _ns(target_time)
        source = _check_text(source_frame, 3), _ns(source_time)
        query = *target, *source, _check_text(fixed_frame, 5)
        self._wait(lambda: self._core.can_transform_full(*query), timeout)
        return _message(self._core.lookup_full(*query))

    def can_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: AnyTime,
        timeout: Duration = NO_WAIT,
        return_debug_tuple: bool = False,
    ) -> Any:
        """Return whether a lookup would succeed and, with `return_debug_tuple`, the reason why not.

        As in ROS, the answer is 1 or 0, not True or False.
        """
        _check_timeout(timeout)
        query = _check_text(target_frame, 1), _check_text(source_frame, 2), _ns(time)
        self._wait(lambda: self._core.can_transform(*query), timeout)
        problem = self._core.can_transform(*query)
        time_lock.poll()
        answer = int(problem is None)
        return (answer, problem or "") if return_debug_tuple else answer

    def wait_for_transform_async(
        self, target_frame: str, source_frame: str, time: AnyTime
    ) -> Future[TransformStamped]:
        """Return a future that is done when the transform is available."""
        query = _check_text(target_frame, 1), _check_text(source_frame, 2), _ns(time)
        future: Future[TransformStamped] = Future()

        def look() -> None:
            if self._core.can_transform(*query) is None:
                future.set_result(_message(self._core.lookup(*query)))

        look()
        if not future.done():
            self._new_data_callbacks.append(look)
            future.add_done_callback(lambda _: self._callbacks_to_remove.append(look))
        return future

    async def lookup_transform_async(
        self, target_frame: str, source_frame: str, time: AnyTime
    ) -> TransformStamped:
        """Wait for the transform and return it.

        The errors are the same as in `lookup_transform`.
        """
        await self.wait_for_transform_async(target_frame, source_frame, time)
        return self.lookup_transform(target_frame, source_frame, time)

    def all_frames_as_yaml(self) -> str:
        """Describe all frames that have a parent, in YAML."""
        return tf2.as_yaml(self._core)

    def all_frames_as_string(self) -> str:
        """List all frames that have a parent, one per line."""
        return self._core.describe_frames()

    def clear(self) -> None:
        """Remove all dynamic transforms."""
        self._core.clear()

    def _describe(
        self,
        request: FrameGraph.Request,
        response: FrameGraph.Response,
    ) -> FrameGraph.Response:
        response.frame_yaml = self.all_frames_as_yaml()
        return response

    def _set(self, message: TransformStamped, authority: str, *, is_static: bool) -> None:
        _check_text(authority, 2)
        transform = tf2.Transform.from_message(message)
        for complaint in self._core.set_transform(transform, authority, is_static):
            if complaint.startswith("TF_OLD_DATA"):
                _log.warning(complaint)
            else:
                _log.error(complaint)
        for callback in list(self._new_data_callbacks):
            callback()
        for callback in self._callbacks_to_remove:
            self._new_data_callbacks.remove(callback)
        self._callbacks_to_remove.clear()

    def _wait(self, ask: Callable[[], str | None], timeout: Duration) -> None:
        """Wait until `ask()` reports no problem, at most for the timeout.

        In a notebook cell, live nodes run during the wait.
        """
        if timeout.nanoseconds > 0 and ask() is not None:
            graph = current_graph()
            if graph.notebook and not time_lock.is_program_thread():
                # Imported late: `course run --ros` runs this module with the real rclpy, which
                # lacks it.
                from rclpy.executors import wait_driving_live_nodes

                wait_driving_live_nodes(lambda: ask() is None, seconds=timeout.nanoseconds * 1e-9)
            else:
                until_ns = graph.now_ns + timeout.nanoseconds
                with time_lock.hold():
                    awaited = "a transform, for which another thread has to spin the listener's node"
                    time_lock.wait(lambda: ask() is None, until_ns=until_ns, awaited=awaited)


def _check_timeout(timeout: Duration) -> None:
    """Raise the error of ROS's addition if the timeout is not a Duration."""
    if not isinstance(timeout, Duration):
        Time() + timeout


def _check_text(value: str, position: int) -> str:
    """Return a string, which an argument of tf2 must be."""
    if not isinstance(value, str):
        kind = "None" if value is None else type(value).__name__
        raise TypeError(f"argument {position} must be str, not {kind}")
    return value


def _ns(time: Any, noun: str = "time") -> int:
    """Return the nanoseconds of a time or a duration, of rclpy or a message."""
    if hasattr(time, "nanoseconds"):
        return int(time.nanoseconds)
    if hasattr(time, "sec") and hasattr(time, "nanosec"):
        return int(time.sec) * 10**9 + int(time.nanosec)
    raise TypeError(f"{noun} must have sec and nanosec, or nanoseconds.")


def _message(transform: tf2.Transform) -> TransformStamped:
    seconds, nanoseconds = divmod(transform.stamp_ns, 10**9)
    (x, y, z), (qx, qy, qz, qw) = transform.pose
    return TransformStamped(
        header=Header(
            stamp=builtin_interfaces.msg.Time(sec=seconds, nanosec=nanoseconds), frame_id=transform.parent
        ),
        child_frame_id=transform.child,
        transform=Transform(translation=Vector3(x=x, y=y, z=z), rotation=Quaternion(x=qx, y=qy, z=qz, w=qw)),
    )
