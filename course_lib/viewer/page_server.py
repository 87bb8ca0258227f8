"""A scene as a page on 127.0.0.1, for programs outside notebooks."""

import asyncio
import secrets
import socket
import threading
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import TYPE_CHECKING, Any

from course_lib.errors import CourseError
from course_lib.viewer.page_link import PageLink
from course_lib.viewer.scene import Scene

if TYPE_CHECKING:
    from course_lib.viewer.page_handlers import SocketHandler

_MAX_MESSAGE = 64 << 20  # bytes; a picture that a page sends may be large


class PageServer:
    """Serves a scene to the browsers of this machine, until it is closed or its process ends.

    Args:
        scene: What the page shows.
        title: The page's title, and the view's name for those who cannot see it.
        port: Where to listen; 0 lets the system choose a free one.
        token: The secret part of the address; None makes one up.
        turn: Entered while what a page has said is dealt with.
    """

    def __init__(
        self,
        scene: Scene,
        title: str = "3D view",
        port: int = 0,
        token: str | None = None,
        turn: Callable[[], AbstractContextManager[Any]] = nullcontext,
    ) -> None:
        self.title = title
        self.port = port
        self.token = token or secrets.token_urlsafe(24)
        self.link = PageLink(scene, self._send, turn)
        self.sockets: set[SocketHandler] = set()  # the open pages
        self._listening: list[socket.socket] = []
        self._ended = asyncio.Event()
        self._loop: asyncio.AbstractEventLoop | None = None

    @property
    def url(self) -> str:
        """The address of the page, with its secret."""
        return f"http://127.0.0.1:{self.port}/{self.token}/"

    def listen(self) -> None:
        """Take the port; the address is known from now on.

        Raises:
            CourseError: The port cannot be had.
        """
        from tornado.netutil import bind_sockets

        try:
            self._listening = bind_sockets(self.port, "127.0.0.1")
        except (OSError, OverflowError) as error:
            said = f"Port {self.port} cannot be had: {error}. Take another one, or 0 for any."
            raise CourseError(said) from None
        self.port = self._listening[0].getsockname()[1]

    def start(self) -> None:
        """Listen, and serve in a thread of its own from now on."""
        self.listen()
        threading.Thread(target=lambda: asyncio.run(self.serve()), name="page", daemon=True).start()

    def close(self) -> None:
        """Stop serving and give the port back; open pages say that nobody is there."""
        self.link.close()
        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._ended.set)

    async def serve(self) -> None:
        """Serve where it listens, until it is closed or this is cancelled."""
        from tornado.httpserver import HTTPServer
        from tornado.web import Application

        from course_lib.viewer.page_handlers import PageHandler, SocketHandler

        self._loop = asyncio.get_running_loop()
        handlers = (("", PageHandler), ("socket", SocketHandler))
        routes = [(rf"/([^/]*)/{name}", handler, {"server": self}) for name, handler in handlers]
        settings = {"websocket_max_message_size": _MAX_MESSAGE, "log_function": lambda _: None}
        server = HTTPServer(Application(routes, None, None, **settings))
        server.add_sockets(self._listening)
        try:
            await self._ended.wait()
        finally:
            server.stop()
            for page in tuple(self.sockets):
                page.close(1001, "the program has ended")
            await server.close_all_connections()

    def _send(self, content: dict[str, Any], buffers: list[bytes]) -> None:
        """Send to all pages, from any thread."""
        from course_lib.viewer.page_handlers import framed

        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._broadcast, framed(content, buffers))

    def _broadcast(self, message: bytes) -> None:
        for page in tuple(self.sockets):
            page.write_message(message, binary=True)
