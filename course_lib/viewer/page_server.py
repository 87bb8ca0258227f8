"""A scene as a page of its own, on 127.0.0.1 or behind a JupyterHub's proxy."""

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
from course_lib.foreign import read_json
from course_lib.surroundings import address, hub_prefix, need_way_out
from course_lib.viewer.html import live_page
from course_lib.viewer.page_link import PageLink
from course_lib.viewer.scene import Scene

_MAX_MESSAGE = 64 << 20  # bytes; a picture that a page sends may be large


class Guarded(RequestHandler):
    """Base of the handlers: only requests with this host and token are answered.

    The token is in the path: a cookie would go to every port of this machine, whoever listens there.
    Behind a hub's proxy the host is the hub's name; no browser of this machine can be tricked.
    """

    port: int
    token: str

    def prepare(self) -> None:
        """Refuse a wrong host or token."""
        names = {f"{name}:{self.port}" for name in ("127.0.0.1", "localhost")}
        here = self.request.host in names or hub_prefix() is not None
        token = self.path_args[0] if self.path_args else ""
        if not here or not secrets.compare_digest(token.encode(), self.token.encode()):
            raise HTTPError(403, reason="Open the address that was printed, with its token")
        self.set_header("Cache-Control", "no-store")
        self.set_header("Referrer-Policy", "no-referrer")


class _SceneHandler(Guarded):
    def initialize(self, server: "PageServer") -> None:
        self.server, self.port, self.token = server, server.port, server.token


class PageHandler(_SceneHandler):
    """The handler of the page itself."""

    def get(self, _: str) -> None:
        """Answer GET."""
        self.finish(live_page(self.server.title))


class SocketHandler(_SceneHandler, WebSocketHandler):
    """The WebSocket of one open page; a message is JSON, a line end and the buffers."""

    page: str | None = None  # how the page calls itself

    def check_origin(self, origin: str) -> bool:
        """Refuse connections from other pages."""
        return urlsplit(origin).netloc == self.request.host  # a hub's scheme is that of its front

    def open(self, *_: str, **__: str) -> None:
        """Begin with the whole scene."""
        number, snapshot = self.server.link.snapshot()
        hello = {"type": "reset", "number": number, "label": self.server.title}
        self.write_message(framed(hello, [snapshot]), binary=True)
        self.server.sockets.add(self)

    def on_message(self, message: str | bytes) -> None:
        """Handle a message of the page."""
        try:
            content = read_json(message)
        except ValueError:
            self.close(1003, "not JSON")
            return
        if isinstance(content, dict):
            self.page = str(content.get("page", self.page))
            self.server.link.receive(content)

    def on_close(self) -> None:
        """Forget the page."""
        self.server.sockets.discard(self)
        if self.page is not None:
            self.server.link.receive({"type": "views", "page": self.page, "count": 0})


def framed(content: dict[str, Any], buffers: list[bytes]) -> bytes:
    """Write a message as one piece."""
    head = json.dumps(content | {"sizes": [len(buffer) for buffer in buffers]}).encode()
    return b"\n".join([head, b"".join(buffers)])


def bound(port: int) -> list[socket.socket]:
    """Bind a port of this machine; 0 is a free one.

    Raises:
        CourseError: The port cannot be had.
    """
    try:
        return bind_sockets(port, "127.0.0.1")
    except (OSError, OverflowError) as error:
        said = f"Port {port} cannot be had: {error}. Take another one, or 0 for any."
        raise CourseError(said) from None


class PageServer:
    """A server of a scene to the browsers of this machine, until it is closed or its process ends.

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
        self._closed = False
        self._loop: asyncio.AbstractEventLoop | None = None

    @property
    def url(self) -> str:
        """The address of the page, with its secret."""
        return address(self.port, f"{self.token}/")

    def listen(self) -> None:
        """Bind the port; the address is known from now on.

        Raises:
            CourseError: The port cannot be had, or no browser would reach it.
        """
        need_way_out()
        self._listening = bound(self.port)
        self.port = self._listening[0].getsockname()[1]

    def start(self) -> None:
        """Listen, and serve in a thread of its own from now on."""
        self.listen()
        threading.Thread(target=lambda: asyncio.run(self.serve()), name="page", daemon=True).start()

    def close(self) -> None:
        """Stop serving and free the port; open pages show that the program has ended."""
        self.link.close()
        self._closed = True
        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._ended.set)

    async def serve(self) -> None:
        """Serve where it listens, until it is closed or this is cancelled."""
        self._loop = asyncio.get_running_loop()
        if self._closed:  # before the loop was there to be told
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
            self._loop.call_soon_threadsafe(self._broadcast, framed(content, buffers))

    def _broadcast(self, message: bytes) -> None:
        for page in tuple(self.sockets):
            page.write_message(message, binary=True)
