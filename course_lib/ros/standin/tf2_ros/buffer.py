"""The buffer with which programs look up transforms."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from geometry_msgs.msg import TransformStamped
from rclpy.clock import Clock, JumpThreshold, TimeJump
from rclpy.duration import Duration
from rclpy.logging import get_logger
from rclpy.node import Node
from rclpy.task import Future
from rclpy.time import Time
from tf2_msgs.srv import FrameGraph
from tf2_py import BufferCore

from course_lib.ros.graph.graph import current_graph
from course_lib.ros.time.time_lock import time_lock
from tf2_ros.buffer_interface import NO_WAIT, AnyTime, BufferInterface

_BACK = JumpThreshold(min_forward=None, min_backward=Duration(seconds=-1))


class Buffer(BufferCore, BufferInterface):
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
        super().__init__(cache_time)
        if node is not None:
            self.srv = node.create_service(FrameGraph, "tf2_frames", self._describe)
        self.clock = Clock() if node is None else node.get_clock()
        self.jump_handle = self.clock.create_jump_callback(_BACK, post_callback=self.time_jump_callback)
        # Called after each new transform. Callbacks of completed futures are then removed.
        self._new_data_callbacks: list[Callable[[], None]] = []
        self._callbacks_to_remove: list[Callable[[], None]] = []

    def time_jump_callback(self, time_jump: TimeJump) -> None:
        """Clear the buffer."""
        get_logger("tf2_buffer").warning("Detected jump back in time. Clearing tf buffer.")
        self.clear()

    def set_transform(self, transform: TransformStamped, authority: str) -> None:
        """Store a transform. A transform that tf2 rejects is logged and ignored."""
        super().set_transform(transform, authority)
        self._call_new_data_callbacks()

    def set_transform_static(self, transform: TransformStamped, authority: str) -> None:
        """Store a transform that is valid at any time."""
        super().set_transform_static(transform, authority)
        self._call_new_data_callbacks()

    def lookup_transform(
        self, target_frame: str, source_frame: str, time: AnyTime, timeout: Duration = NO_WAIT
    ) -> TransformStamped:
        """Return the transform from the source frame to the target frame.

        Wait for it at most `timeout`.
        """
        _wait(lambda: self.can_transform_core(target_frame, source_frame, time), timeout)
        return self.lookup_transform_core(target_frame, source_frame, time)

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
        query = target_frame, target_time, source_frame, source_time, fixed_frame
        _wait(lambda: self.can_transform_full_core(*query), timeout)
        return self.lookup_transform_full_core(*query)

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
        _wait(lambda: self.can_transform_core(target_frame, source_frame, time), timeout)
        answer = self.can_transform_core(target_frame, source_frame, time)
        time_lock.poll()
        return answer if return_debug_tuple else answer[0]

    def can_transform_full(
        self,
        target_frame: str,
        target_time: AnyTime,
        source_frame: str,
        source_time: AnyTime,
        fixed_frame: str,
        timeout: Duration = NO_WAIT,
        return_debug_tuple: bool = False,
    ) -> Any:
        """Return 1 if a full lookup would succeed, else 0; with `return_debug_tuple` also the reason."""
        query = target_frame, target_time, source_frame, source_time, fixed_frame
        _wait(lambda: self.can_transform_full_core(*query), timeout)
        answer = self.can_transform_full_core(*query)
        time_lock.poll()
        return answer if return_debug_tuple else answer[0]

    def wait_for_transform_async(
        self, target_frame: str, source_frame: str, time: AnyTime
    ) -> Future[TransformStamped]:
        """Return a future that is done when the transform is available."""
        query = target_frame, source_frame, time
        return self._future(
            lambda: self.can_transform_core(*query), lambda: self.lookup_transform_core(*query)
        )

    def wait_for_transform_full_async(
        self,
        target_frame: str,
        target_time: AnyTime,
        source_frame: str,
        source_time: AnyTime,
        fixed_frame: str,
    ) -> Future[TransformStamped]:
        """Return a future that is done when the transform between two times is available."""
        query = target_frame, target_time, source_frame, source_time, fixed_frame
        return self._future(
            lambda: self.can_transform_full_core(*query), lambda: self.lookup_transform_full_core(*query)
        )

    async def lookup_transform_async(
        self, target_frame: str, source_frame: str, time: AnyTime
    ) -> TransformStamped:
        """Wait for the transform and return it.

        The errors are the same as in `lookup_transform`.
        """
        await self.wait_for_transform_async(target_frame, source_frame, time)
        return self.lookup_transform_core(target_frame, source_frame, time)

    async def lookup_transform_full_async(
        self,
        target_frame: str,
        target_time: AnyTime,
        source_frame: str,
        source_time: AnyTime,
        fixed_frame: str,
    ) -> TransformStamped:
        """Wait for the transform between two times and return it."""
        query = target_frame, target_time, source_frame, source_time, fixed_frame
        await self.wait_for_transform_full_async(*query)
        return self.lookup_transform_full_core(*query)

    def _describe(
        self,
        request: FrameGraph.Request,
        response: FrameGraph.Response,
    ) -> FrameGraph.Response:
        response.frame_yaml = self.all_frames_as_yaml()
        return response

    def _call_new_data_callbacks(self) -> None:
        for callback in list(self._new_data_callbacks):
            callback()
        for callback in self._callbacks_to_remove:
            self._new_data_callbacks.remove(callback)
        self._callbacks_to_remove.clear()

    def _future(
        self, ask: Callable[[], tuple[int, str]], lookup: Callable[[], TransformStamped]
    ) -> Future[TransformStamped]:
        """Return a future of a lookup, which is done as soon as the lookup succeeds."""
        future: Future[TransformStamped] = Future()

        def look() -> None:
            if ask()[0]:
                future.set_result(lookup())

        look()
        if not future.done():
            self._new_data_callbacks.append(look)
            future.add_done_callback(lambda _: self._callbacks_to_remove.append(look))
        return future


def _wait(ask: Callable[[], tuple[int, str]], timeout: Duration) -> None:
    """Wait until `ask()` returns no problem, at most for the timeout.

    In a notebook cell, live nodes run during the wait.
    """
    if not isinstance(timeout, Duration):
        # Raises the error of ROS's addition.
        Time() + timeout
    if timeout.nanoseconds <= 0 or ask()[0]:
        return
    graph = current_graph()
    if graph.notebook and not time_lock.is_program_thread():
        # Imported late: `course run --ros` runs this module with the real rclpy, which lacks it.
        from rclpy.executors import wait_driving_live_nodes

        wait_driving_live_nodes(lambda: bool(ask()[0]), seconds=timeout.nanoseconds * 1e-9)
    else:
        until_ns = graph.now_ns + timeout.nanoseconds
        with time_lock.hold():
            awaited = "a transform, for which another thread has to spin the listener's node"
            time_lock.wait(lambda: bool(ask()[0]), until_ns=until_ns, awaited=awaited)
