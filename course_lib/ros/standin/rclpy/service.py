"""Services: they answer requests."""

from collections.abc import Callable
from functools import partial
from typing import Any

from course_lib.ros.messages import deserialize
from rclpy.impl.executor import await_or_execute
from rclpy.impl.service_end import ServiceEnd


class Service(ServiceEnd):
    """Answers requests; made by `Node.create_service`."""

    def __init__(self, callback: Callable[[Any, Any], Any], *args: Any) -> None:
        self.callback = callback
        super().__init__(*args, asks=False)

    def take(self) -> Callable[[], object] | None:
        """Take the oldest request."""
        if not self._queue:
            return None
        client, number, cdr = self._queue.popleft()
        return partial(self._answer, client, number, deserialize(cdr, self.srv_type.Request))

    async def _answer(self, client: int, number: int, request: Any) -> None:
        """Send what the callback, maybe a coroutine, returns; raises TypeError if it is no response."""
        response = await await_or_execute(self.callback, request, self.srv_type.Response())
        if not isinstance(response, self.srv_type.Response):
            raise TypeError
        self.send(client, number, response)


class LateService(Service):
    """Gives its callback `(request, respond)`, to be answered whenever it likes."""

    async def _answer(self, client: int, number: int, request: Any) -> None:
        await await_or_execute(self.callback, request, partial(self.send, client, number))
