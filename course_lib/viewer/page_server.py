"""A server for a scene as a separate page, on 127.0.0.1 or behind the proxy of a JupyterHub."""

import asyncio
import json
import secrets
import socket
import threading
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import Any
from urllib.parse import urlsplit

from tornado.httpserver import HTTPServer
from tornado.netutil import bind_sockets
from tornado.web import Application, HTTPError, RequestHandler
from tornado.websocket import WebSocketHandler

from course_lib.errors import CourseError
from course_lib.host import address, hub_prefix, require_reachable_page
from course_lib.third_party import read_json
from course_lib.viewer.html import live_page
from course_lib.viewer.page_link import PageLink
from course_lib.viewer.scene import Scene

# In bytes. A picture that a page sends may be large.
_MAX_MESSAGE = 64 << 20


class GuardedHandler(RequestHandler):
    """Base class of handlers that respond only to requests with the right host and token.

    The token is in the path, because a cookie would be sent to every port of this machine. Behind a
    hub's proxy the host is the hub's name, and DNS rebinding is not possible.
    """

    port: int
    token: str

    def prepare(self) -> None:
        """Reject a wrong host or token."""
        names = {f"{name}:{self.port}" for name in ("127.0.0.1", "localhost")}
        is_local = self.request.host in names or hub_prefix() is not None
        token = self.path_args[0] if self.path_args else ""
        if not is_local or not secrets.compare_digest(token.encode(), self.token.encode()):
            raise HTTPError(403, reason="Open the printed URL, including its token")
        self.set_header("Cache-Control", "no-store")
        self.set_header("Referrer-Policy", "no-referrer")


class _SceneHandler(GuardedHandler):
    def initialize(self, server: "PageServer") -> None:
        self.server, self.port, self.token = server, server.port, server.token


class PageHandler(_SceneHandler):
    """Serves the page itself."""

    def get(self, _: str) -> None:
        """Respond to GET."""
        self.finish(live_page(self.server.title))


class SocketHandler(_SceneHandler, WebSocketHandler):
    """The WebSocket of one open page. A message consists of JSON, a newline and the buffers."""

    # The page's id.
    page: str | None = None

    def check_origin(self, origin: str) -> bool:
        """Reject connections from other pages."""
        # The scheme may differ behind a hub's proxy.
        return urlsplit(origin).netloc == self.request.host

    def open(self, *_: str, **__: str) -> None:
        """Send the whole scene."""
        number, snapshot = self.server.link.snapshot()
        hello = {"type": "reset", "number": number, "label": self.server.title}
        self.write_message(frame_message(hello, [snapshot]), binary=True)
        self.server.sockets.add(self)

    def on_message(self, message: str | bytes) -> None:
        """Handle a message from the page."""
        try:
            content = read_json(message)
        except ValueError:
            self.close(1003, "not JSON")
            return
        if isinstance(content, dict):
            self.page = str(content.get("page", self.page))
            self.server.link.receive(content)

    def on_close(self) -> None:
        """Remove the page."""
        self.server.sockets.discard(self)
        if self.page is not None:
            self.server.link.receive({"type": "views", "page": self.page, "count": 0})


def frame_message(content: dict[str, Any], buffers: list[bytes]) -> bytes:
    """Encode a message and its buffers as one byte string."""
    head = json.dumps(content | {"sizes": [len(buffer) for buffer in buffers]}).encode()
    return b"\n".join([head, b"".join(buffers)])


def open_sockets(port: int) -> list[socket.socket]:
    """Bind a port of this machine; 0 selects a free one.

    Raises:
        CourseError: The port is not available.
    """
    try:
        return bind_sockets(port, "127.0.0.1")
    except (OSError, OverflowError) as error:
        message = f"Port {port} is not available: {error}. Choose another one, or 0 for any."
        raise CourseError(message) from None


class PageServer:
    """Serves a scene to the browsers of this machine, until it is closed or its process ends.

    Args:
        scene: The scene to show.
        title: The title of the page, and the view's name for screen readers.
        port: The port; 0 lets the system choose a free one.
        token: The secret part of the URL; None generates one.
        turn: Context manager around the handling of messages from pages.
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
        self.sockets: set[SocketHandler] = set()
        self._listening: list[socket.socket] = []
        self._ended = asyncio.Event()
        self._is_closed = False
        self._loop: asyncio.AbstractEventLoop | None = None

    @property
    def url(self) -> str:
        """The URL of the page, including its token."""
        return address(self.port, f"{self.token}/")

    def listen(self) -> None:
        """Bind the port, so that the URL is known.

        Raises:
            CourseError: The port is not available, or browsers could not reach it.
        """
        require_reachable_page()
        self._listening = open_sockets(self.port)
        self.port = self._listening[0].getsockname()[1]

    def start(self) -> None:
        """Bind the port, and serve in a thread."""
        self.listen()
        threading.Thread(target=lambda: asyncio.run(self.serve()), name="page", daemon=True).start()

    def close(self) -> None:
        """Stop serving and free the port; open pages show that the program has ended."""
        self.link.close()
        self._is_closed = True
        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._ended.set)

    async def serve(self) -> None:
        """Serve until it is closed or cancelled."""
        self._loop = asyncio.get_running_loop()
        # The server may have been closed before this loop existed.
        if self._is_closed:
            self._ended.set()
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
        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._broadcast, frame_message(content, buffers))

    def _broadcast(self, message: bytes) -> None:
        for page in tuple(self.sockets):
            page.write_message(message, binary=True)
