"""Service clients."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from course_lib.ros.messages import deserialize
from course_lib.ros.mistakes import Mistake, marked
from course_lib.ros.time.time_lock import DeadlockError, time_lock
from course_lib.ros.tracebacks import explain_interrupts
from rclpy.context import Context
from rclpy.duration import S_TO_NS
from rclpy.executors import wait_until
from rclpy.impl.node_handle import NodeHandle
from rclpy.service import ServiceEnd
from rclpy.task import Future

# Interval between checks whether a service is available, as in rclpy.
POLL_NS = 250_000_000
_SPINNER = "another thread that spins the client's node"
_NO_RESPONSE = (
    f"no response can arrive without {_SPINNER}. Use call_async() with add_done_callback() or await."
)


class Client(ServiceEnd):
    """A client of a service, created by `Node.create_client`."""

    def __init__(self, *args: Any) -> None:
        super().__init__(*args, asks=True)
        self.context: Context = self._course_node.context
        self._pending_requests: dict[int, Future[Any]] = {}
        self.__requests = 0
        # Called when a response arrives for which no request is pending.
        self._course_on_unexpected: Callable[[], object] = lambda: None

    def call_async(self, request: Any) -> Future[Any]:
        """Send a request. The future is done when the executor has received the response.

        Without a service it is never done, as in ROS: call `wait_for_service` first. An object that
        is not a request of this service raises a TypeError without a message, as in rclpy.
        """
        if not isinstance(request, self.srv_type.Request):
            raise marked(TypeError(), Mistake.REQUEST)
        # Without this call, a thread that sends requests in a tight loop would stop robot time.
        time_lock.poll()
        self.__requests += 1
        self._course_send((self._course_id, self.__requests), request)
        future: Future[Any] = Future()
        future._course_unmet = self.__describe_missing
        self._pending_requests[self.__requests] = future
        return future

    def call(self, request: Any, timeout_sec: float | None = None) -> Any:
        """Send a request and block until another thread has received the response.

        Returns None after `timeout_sec` [s] without a response. Where it can never be received (the
        caller is a callback that has to end first, or no other thread spins the node) ROS hangs;
        here a DeadlockError is raised.
        """
        future, executor = self.call_async(request), self._course_node.executor
        if timeout_sec is None and executor is not None and executor._course_holds_up(self):
            self.remove_pending_request(future)
            raise DeadlockError(
                f"call() on {self._course_full_name} waits for a response that is taken only after "
                "this callback has ended. Use call_async() with add_done_callback() or await; or a "
                "MultiThreadedExecutor, with the client in another callback group."
            )
        awaited = f"the response of {self._course_full_name} and {_SPINNER}"
        with explain_interrupts(lambda: "" if self.__is_spun() else _NO_RESPONSE):
            wait_until(self._course_node, lambda: not future._pending(), timeout_sec, awaited)
        if future._pending():
            self.remove_pending_request(future)
            if timeout_sec is None and not self.__is_spun():
                raise DeadlockError(f"call() on {self._course_full_name}: {_NO_RESPONSE}")
        return future.result()

    def get_pending_request(self, sequence_number: int) -> Future[Any]:
        """Return the future of a pending request. Raise KeyError if the request is not pending."""
        return self._pending_requests[sequence_number]

    def remove_pending_request(self, future: Future[Any]) -> None:
        """Stop waiting for a response. The future is never done."""
        self._pending_requests = {
            number: f for number, f in self._pending_requests.items() if f is not future
        }

    def service_is_ready(self) -> bool:
        """Return whether the service is available.

        A program that polls it in a loop lets time advance.
        """
        time_lock.poll(lambda: "" if self._course_partner_count() else self.__missing_service)
        return self._course_is_ready()

    def _course_is_ready(self) -> bool:
        self._course_node.require("failed to check service availability")
        return self._course_partner_count() > 0

    def wait_for_service(self, timeout_sec: float | None = None) -> bool:
        """Wait at most `timeout_sec` [s] for the service, without limit if None.

        Return whether it is available.
        """
        awaited = f"the service {self._course_full_name}"
        why = "" if timeout_sec is not None else self.__missing_service
        with explain_interrupts(lambda: why):
            return wait_for_partner(self._course_node, self._course_is_ready, timeout_sec, awaited)

    def _course_take(self) -> Callable[[], object] | None:
        """Remove the oldest response and return the function that sets the result of its future."""
        if not self._course_queue:
            return None
        client, number, cdr = self._course_queue.popleft()
        self._course_record_taken(client, number, cdr)
        future = self._pending_requests.pop(number, None)
        if future is None:
            return self._course_on_unexpected
        return partial(self.__bring, future, cdr) if future._pending() else None

    def __bring(self, future: Future[Any], cdr: bytes) -> None:
        future._set_executor(self._course_node.executor)
        future.set_result(deserialize(cdr, self.srv_type.Response))

    @property
    def __missing_service(self) -> str:
        return f"it waited for the service {self._course_full_name}, which is not there."

    def __describe_missing(self) -> str:
        """Return why no response arrives, or "" if one may still arrive."""
        if not self.__is_spun():
            return (
                f"the future is done only after {self._course_node.full_name} has been spun, as in "
                "rclpy.spin_until_future_complete(node, future)."
            )
        if not self._course_partner_count():
            return self.__missing_service
        executor = self._course_node.executor
        if executor is not None and executor._course_holds_up(self):
            return "the response is received only after this callback has ended: use add_done_callback."
        return ""

    def __is_spun(self) -> bool:
        executor = self._course_node.executor
        return executor is not None and executor._course_runs(self._course_node)


def wait_for_partner(
    node: NodeHandle, is_ready: Callable[[], bool], timeout_sec: float | None, awaited: str
) -> bool:
    """Poll for a partner, at most `timeout_sec` [s], without limit if None.

    Return whether there is one.
    """
    graph = node.graph
    if timeout_sec is not None and not timeout_sec > 0.0:
        return is_ready()
    end_ns = None if timeout_sec is None else graph.now_ns + round(timeout_sec * S_TO_NS)
    with time_lock.hold():
        while node.context.ok() and not is_ready():
            if end_ns is not None and graph.now_ns >= end_ns:
                break
            time_lock.sleep_until(graph.now_ns + POLL_NS, awaited)
    return is_ready()
