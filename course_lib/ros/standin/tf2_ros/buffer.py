"""The buffer that programs look transforms up in."""

from collections.abc import Callable
from typing import Literal, overload

from geometry_msgs.msg import TransformStamped
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.task import Future
from tf2_msgs.srv import FrameGraph
from tf2_py import AnyTime, BufferCore

from course_lib.ros.baton import baton
from course_lib.ros.driving import wait_for
from course_lib.ros.graph import current_graph
from tf2_ros.buffer_interface import NO_WAIT, BufferInterface


class Buffer(BufferCore, BufferInterface):
    """Remembers transforms, waits for them, and carries things from frame to frame.

    A lookup with a timeout waits for another thread that spins the listener's node: in a callback of the
    same thread nothing can come in meanwhile, as on a robot.

    Args:
        cache_time: How long dynamic transforms are remembered; default 10 s.
        node: Answers the service tf2_frames with a description of all frames.
    """

    def __init__(self, cache_time: Duration | None = None, node: Node | None = None) -> None:
        BufferCore.__init__(self, cache_time)
        BufferInterface.__init__(self)
        if node is not None:
            self.srv = node.create_service(FrameGraph, "tf2_frames", self._describe)
        self._on_new_data: dict[Callable[[], None], None] = {}  # a set that keeps its order

    def set_transform(self, transform: TransformStamped, authority: str) -> None:
        """Remember a transform; one that breaks tf2's rules is logged and ignored."""
        super().set_transform(transform, authority)
        self._tell()

    def set_transform_static(self, transform: TransformStamped, authority: str) -> None:
        """Remember a transform that holds at any time."""
        super().set_transform_static(transform, authority)
        self._tell()

    def lookup_transform(
        self, target_frame: str, source_frame: str, time: AnyTime, timeout: Duration = NO_WAIT
    ) -> TransformStamped:
        """Return the transform that takes coordinates in the source frame to the target frame.

        Args:
            target_frame: Frame to express things in.
            source_frame: Frame the things are given in.
            time: When; `Time()` means the latest time at which all of the chain is known.
            timeout: How long to wait for it.

        Raises:
            TransformException: It is not known.
        """
        self._wait(lambda: self.can_transform_core(target_frame, source_frame, time), timeout)
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
        """Return the transform from the source frame at one time to the target frame at another.

        Args:
            target_frame: Frame to express things in.
            target_time: When it is where it counts.
            source_frame: Frame the things are given in.
            source_time: When the things were seen.
            fixed_frame: Frame that does not move between the two times.
            timeout: How long to wait for it.

        Raises:
            TransformException: It is not known.
        """
        asked = target_frame, target_time, source_frame, source_time, fixed_frame
        self._wait(lambda: self.can_transform_full_core(*asked), timeout)
        return self.lookup_transform_full_core(*asked)

    @overload
    def can_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: AnyTime,
        timeout: Duration = ...,
        return_debug_tuple: Literal[False] = ...,
    ) -> bool: ...
    @overload
    def can_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: AnyTime,
        timeout: Duration = ...,
        *,
        return_debug_tuple: Literal[True],
    ) -> tuple[bool, str]: ...
    def can_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: AnyTime,
        timeout: Duration = NO_WAIT,
        return_debug_tuple: bool = False,
    ) -> bool | tuple[bool, str]:
        """Say whether a lookup would succeed; with `return_debug_tuple` also why not."""
        answer = self._wait(lambda: self.can_transform_core(target_frame, source_frame, time), timeout)
        baton.poll()
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
    ) -> bool | tuple[bool, str]:
        """Say whether a full lookup would succeed; with `return_debug_tuple` also why not."""
        asked = target_frame, target_time, source_frame, source_time, fixed_frame
        answer = self._wait(lambda: self.can_transform_full_core(*asked), timeout)
        baton.poll()
        return answer if return_debug_tuple else answer[0]

    def wait_for_transform_async(
        self, target_frame: str, source_frame: str, time: AnyTime
    ) -> Future[TransformStamped]:
        """Return a future of the transform."""
        return self._future(
            lambda: self.can_transform_core(target_frame, source_frame, time)[0],
            lambda: self.lookup_transform_core(target_frame, source_frame, time),
        )

    def wait_for_transform_full_async(
        self,
        target_frame: str,
        target_time: AnyTime,
        source_frame: str,
        source_time: AnyTime,
        fixed_frame: str,
    ) -> Future[TransformStamped]:
        """Return a future of the transform between two times."""
        asked = target_frame, target_time, source_frame, source_time, fixed_frame
        return self._future(
            lambda: self.can_transform_full_core(*asked)[0], lambda: self.lookup_transform_full_core(*asked)
        )

    async def lookup_transform_async(
        self, target_frame: str, source_frame: str, time: AnyTime
    ) -> TransformStamped:
        """Await the transform and return it; otherwise as `lookup_transform`."""
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
        """Await the transform between two times and return it."""
        asked = target_frame, target_time, source_frame, source_time, fixed_frame
        await self.wait_for_transform_full_async(*asked)
        return self.lookup_transform_full_core(*asked)

    def _describe(self, request: FrameGraph.Request, response: FrameGraph.Response) -> FrameGraph.Response:
        response.frame_yaml = self.all_frames_as_yaml()
        return response

    def _future(
        self, ready: Callable[[], bool], lookup: Callable[[], TransformStamped]
    ) -> Future[TransformStamped]:
        future: Future[TransformStamped] = Future()

        def look() -> None:
            if not future.done() and ready():
                future.set_result(lookup())

        self._on_new_data[look] = None
        future.add_done_callback(lambda _: self._on_new_data.pop(look))
        look()
        return future

    def _tell(self) -> None:
        for look in list(self._on_new_data):
            look()

    def _wait(self, ask: Callable[[], tuple[bool, str]], timeout: Duration) -> tuple[bool, str]:
        """Wait until the answer is yes, and give it; in a notebook's cell the live nodes run meanwhile."""
        if not isinstance(timeout, Duration):
            raise TypeError(
                f"timeout must be an rclpy.duration.Duration, like Duration(seconds=1.0), not {timeout!r}"
            )
        if timeout.nanoseconds > 0 and not ask()[0]:
            graph = current_graph()
            if graph.notebook and not baton.governs():
                wait_for(lambda: ask()[0], seconds=timeout.nanoseconds * 1e-9)
            else:
                until_ns = graph.now_ns + timeout.nanoseconds
                with baton.known():
                    what = "a transform, for which another thread has to spin the listener's node"
                    baton.wait(lambda: ask()[0], until_ns=until_ns, what=what)
        return ask()
