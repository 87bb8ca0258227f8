"""Clients, which call services."""

from collections.abc import Callable
from functools import partial
from typing import Any

from course_lib.ros.baton import DeadlockError, baton
from course_lib.ros.messages import deserialize
from course_lib.ros.mistakes import Mistake, marked
from rclpy.constants import S_TO_NS
from rclpy.executors import wait_until
from rclpy.impl.node_handle import NodeHandle
from rclpy.service import ServiceEnd
from rclpy.task import Future

POLL_NS = 250_000_000  # [ns] between two looks at whether a service is there, as in rclpy
_SPINNER = "another thread that spins the client's node"


class Client(ServiceEnd):
    """A client of a service; made by `Node.create_client`."""

    def __init__(self, *args: Any) -> None:
        super().__init__(*args, asks=True)
        self._pending: dict[int, Future[Any]] = {}
        self._requests = 0
        self.on_unexpected: Callable[[], object] = lambda: None  # a response came that nobody waits for

    def call_async(self, request: Any) -> Future[Any]:
        """Send a request; the future is done when the executor has taken the response.

        Without a service that is never, as in ROS: call `wait_for_service` first. An object that is not a
        request of this service raises a TypeError without a text, as in rclpy.
        """
        if not isinstance(request, self.srv_type.Request):
            raise marked(TypeError(), Mistake.REQUEST)
        self._requests += 1
        self.send(self.id, self._requests, request)
        future: Future[Any] = Future()
        self._pending[self._requests] = future
        return future

    def call(self, request: Any, timeout_sec: float | None = None) -> Any:
        """Send a request and wait for the response, which another thread that spins the node has to take.

        Returns None if it did not come within `timeout_sec` [s]. Where it can never be taken (the caller is
        a callback that has to end first, or nobody spins the node) ROS hangs; here that is a DeadlockError.
        """
        future, executor = self.call_async(request), self.node_handle.executor
        if timeout_sec is None and executor is not None and executor.is_held_up(self):
            self.remove_pending_request(future)
            raise DeadlockError(
                f"call() on {self.full_name} waits for a response that is taken only after this callback has "
                "ended. Use call_async() with add_done_callback() or await; or a MultiThreadedExecutor, with "
                "the client in another callback group."
            )
        what = f"the response of {self.full_name} and {_SPINNER}"
        wait_until(self.node_handle, future.arrived, timeout_sec, what)
        if not future.arrived():
            self.remove_pending_request(future)
            if timeout_sec is None and not self._is_spun():
                raise DeadlockError(f"call() on {self.full_name} waited in vain for {_SPINNER}.")
        return future.result()

    def remove_pending_request(self, future: Future[Any]) -> None:
        """Stop waiting for a response: the future stays undone."""
        self._pending = {number: f for number, f in self._pending.items() if f is not future}

    def service_is_ready(self) -> bool:
        """Return whether the service is there."""
        return self.partner_count() > 0

    def wait_for_service(self, timeout_sec: float | None = None) -> bool:
        """Wait until the service is there, [s]; None: without limit; returns whether it is."""
        what = f"the service {self.full_name}"
        return wait_for_partner(self.node_handle, self.service_is_ready, timeout_sec, what)

    def is_for_me(self, client: int) -> bool:
        """Return whether a response is to one of its own requests."""
        return client == self.id

    def take(self) -> Callable[[], object] | None:
        """Remove the oldest response; returns the call that completes its future."""
        if not self._queue:
            return None
        client, number, cdr = self._queue.popleft()
        self.note_taken(client, number, cdr)
        future = self._pending.pop(number, None)
        return self.on_unexpected if future is None else partial(self._bring, future, cdr)

    def _bring(self, future: Future[Any], cdr: bytes) -> None:
        future._set_executor(self.node_handle.executor)
        future.set_result(deserialize(cdr, self.srv_type.Response))

    def _is_spun(self) -> bool:
        executor = self.node_handle.executor
        return executor is not None and any(n.handle is self.node_handle for n in executor.get_nodes())


def wait_for_partner(
    node: NodeHandle, is_ready: Callable[[], bool], timeout_sec: float | None, what: str
) -> bool:
    """Poll until a partner is there, at most so long [s]; None: without limit. Returns whether it is."""
    graph = node.graph
    end_ns = None if timeout_sec is None else graph.now_ns + round(timeout_sec * S_TO_NS)
    with baton.known():
        while node.context.ok() and not is_ready():
            if end_ns is not None and graph.now_ns >= end_ns:
                break
            baton.sleep_until(graph.now_ns + POLL_NS, what)
    return is_ready()
