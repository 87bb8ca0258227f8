"""The buffer in which programs look up transforms."""

from collections.abc import Callable
from typing import Any

import builtin_interfaces.msg
from geometry_msgs.msg import Quaternion, Transform, TransformStamped, Vector3
from rclpy.clock import Clock, JumpThreshold, TimeJump
from rclpy.duration import Duration
from rclpy.executors import wait_driving_live_nodes
from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.logging import get_logger
from rclpy.node import Node
from rclpy.task import Future
from rclpy.time import Time
from std_msgs.msg import Header
from tf2_msgs.srv import FrameGraph

from course_lib.ros import tf2_core, tf2_transform
from course_lib.ros.baton import baton
from course_lib.ros.graph import current_graph
from tf2_ros.buffer_interface import NO_WAIT, AnyTime, BufferInterface

_BACK = JumpThreshold(min_forward=None, min_backward=Duration(seconds=-1))
_log = RcutilsLogger()  # C++ names none


class Buffer(BufferInterface):
    """A buffer of transforms, which also waits for them and transforms messages from frame to frame.

    A lookup takes coordinates in the source frame to the target frame; the time zero, `Time()`, means the
    latest at which all of the chain is known. A failure raises one of tf2's TransformExceptions.
    A timeout waits for another thread that spins the listener's node: in a callback of the same thread
    nothing can come in meanwhile, as on a robot.

    Args:
        cache_time: How long dynamic transforms are remembered; default 10 s.
        node: Answers the service tf2_frames with a description of all frames. When its clock jumps back by
            a second or more, or `use_sim_time` changes, the buffer is cleared.
    """

    def __init__(self, cache_time: Duration | None = None, node: Node | None = None) -> None:
        self._core = tf2_core.BufferCore(tf2_core.CACHE_NS if cache_time is None else cache_time.nanoseconds)
        if node is not None:
            self.srv = node.create_service(FrameGraph, "tf2_frames", self._describe)
        self.clock = Clock() if node is None else node.get_clock()
        self.jump_handle = self.clock.create_jump_callback(_BACK, post_callback=self.time_jump_callback)
        self._on_new_data: dict[Callable[[], None], None] = {}  # a set that keeps its order

    def time_jump_callback(self, time_jump: TimeJump) -> None:
        """Clear the buffer."""
        get_logger("tf2_buffer").warning("Detected jump back in time. Clearing tf buffer.")
        self.clear()

    def set_transform(self, transform: TransformStamped, authority: str) -> None:
        """Store a transform; one that breaks tf2's rules is logged and ignored."""
        self._set(transform, authority, is_static=False)

    def set_transform_static(self, transform: TransformStamped, authority: str) -> None:
        """Store a transform that holds at any time."""
        self._set(transform, authority, is_static=True)

    def lookup_transform(
        self, target_frame: str, source_frame: str, time: AnyTime, timeout: Duration = NO_WAIT
    ) -> TransformStamped:
        """Return the transform from the source frame to the target frame; wait for it at most so long."""
        asked = target_frame, source_frame, _ns(time)
        self._wait(lambda: self._core.can_transform(*asked), timeout)
        return _message(self._core.lookup(*asked))

    def lookup_transform_full(
        self,
        target_frame: str,
        target_time: AnyTime,
        source_frame: str,
        source_time: AnyTime,
        fixed_frame: str,
        timeout: Duration = NO_WAIT,
    ) -> TransformStamped:
        """Return the transform between two frames at two times; the fixed frame rests between them."""
        asked = target_frame, _ns(target_time), source_frame, _ns(source_time), fixed_frame
        self._wait(lambda: self._core.can_transform_full(*asked), timeout)
        return _message(self._core.lookup_full(*asked))

    def can_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: AnyTime,
        timeout: Duration = NO_WAIT,
        return_debug_tuple: bool = False,
    ) -> Any:
        """Return whether a lookup would succeed; with `return_debug_tuple` also why not."""
        asked = target_frame, source_frame, _ns(time)
        problem = self._wait(lambda: self._core.can_transform(*asked), timeout)
        baton.poll()
        return (problem is None, problem or "") if return_debug_tuple else problem is None

    def wait_for_transform_async(
        self, target_frame: str, source_frame: str, time: AnyTime
    ) -> Future[TransformStamped]:
        """Return a future of the transform."""
        asked = target_frame, source_frame, _ns(time)
        future: Future[TransformStamped] = Future()

        def look() -> None:
            if not future.arrived() and self._core.can_transform(*asked) is None:
                future.set_result(_message(self._core.lookup(*asked)))

        self._on_new_data[look] = None
        future.add_done_callback(lambda _: self._on_new_data.pop(look))
        look()
        return future

    async def lookup_transform_async(
        self, target_frame: str, source_frame: str, time: AnyTime
    ) -> TransformStamped:
        """Await the transform and return it; otherwise as `lookup_transform`."""
        await self.wait_for_transform_async(target_frame, source_frame, time)
        return self.lookup_transform(target_frame, source_frame, time)

    def all_frames_as_yaml(self) -> str:
        """Describe all frames that have a parent, as YAML."""
        return tf2_core.as_yaml(self._core)

    def all_frames_as_string(self) -> str:
        """Name all frames that have a parent, one in a line."""
        return self._core.described()

    def clear(self) -> None:
        """Remove all dynamic transforms."""
        self._core.clear()

    def _describe(self, request: FrameGraph.Request, response: FrameGraph.Response) -> FrameGraph.Response:
        response.frame_yaml = self.all_frames_as_yaml()
        return response

    def _set(self, message: TransformStamped, authority: str, *, is_static: bool) -> None:
        transform = tf2_transform.Transform.from_message(message)
        for complaint in self._core.set_transform(transform, authority, is_static):
            if complaint.startswith("TF_OLD_DATA"):
                _log.warning(complaint)
            else:
                _log.error(complaint)
        for look in list(self._on_new_data):
            look()

    def _wait(self, ask: Callable[[], str | None], timeout: Duration) -> str | None:
        """Wait until `ask()` returns no problem; in a cell live nodes run meanwhile. Returns the last one."""
        if not isinstance(timeout, Duration):
            raise TypeError(
                f"timeout must be an rclpy.duration.Duration, like Duration(seconds=1.0), not {timeout!r}"
            )
        if timeout.nanoseconds > 0 and ask() is not None:
            graph = current_graph()
            if graph.notebook and not baton.governs():
                wait_driving_live_nodes(lambda: ask() is None, seconds=timeout.nanoseconds * 1e-9)
            else:
                until_ns = graph.now_ns + timeout.nanoseconds
                with baton.known():
                    what = "a transform, for which another thread has to spin the listener's node"
                    baton.wait(lambda: ask() is None, until_ns=until_ns, what=what)
        return ask()


def _ns(time: AnyTime) -> int:
    if isinstance(time, Time):
        return time.nanoseconds
    if isinstance(time, builtin_interfaces.msg.Time):
        return time.sec * 10**9 + time.nanosec
    raise TypeError("time must have sec and nanosec, or nanoseconds.")


def _message(found: tf2_transform.Transform) -> TransformStamped:
    seconds, nanoseconds = divmod(found.stamp_ns, 10**9)
    (x, y, z), (qx, qy, qz, qw) = found.pose
    return TransformStamped(
        header=Header(
            stamp=builtin_interfaces.msg.Time(sec=seconds, nanosec=nanoseconds), frame_id=found.parent
        ),
        child_frame_id=found.child,
        transform=Transform(translation=Vector3(x=x, y=y, z=z), rotation=Quaternion(x=qx, y=qy, z=qz, w=qw)),
    )
