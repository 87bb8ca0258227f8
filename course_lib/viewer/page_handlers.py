"""What the server of a scene's page answers; it refuses all who do not know the address."""

import json
import secrets
from typing import TYPE_CHECKING, Any

from tornado.web import HTTPError, RequestHandler
from tornado.websocket import WebSocketHandler

from course_lib.viewer.html import live_page

if TYPE_CHECKING:
    from course_lib.viewer.page_server import PageServer


class _Guarded(RequestHandler):
    """Answers nothing but requests for this very address: no page of elsewhere gets in by another name."""

    def initialize(self, server: "PageServer") -> None:
        self.server = server

    def prepare(self) -> None:
        """Refuse a wrong host or token."""
        here = self.request.host in {f"{name}:{self.server.port}" for name in ("127.0.0.1", "localhost")}
        token = self.path_args[0] if self.path_args else ""
        if not here or not secrets.compare_digest(token.encode(), self.server.token.encode()):
            raise HTTPError(403, reason="Open the address that was printed, with its token")
        self.set_header("Cache-Control", "no-store")
        self.set_header("Referrer-Policy", "no-referrer")


class PageHandler(_Guarded):
    """Gives the page."""

    def get(self, _: str) -> None:
        """Answer GET."""
        self.finish(live_page(self.server.title))


class SocketHandler(_Guarded, WebSocketHandler):
    """Carries the messages of one open page: JSON, a line end, the buffers."""

    page: str | None = None  # how the page calls itself

    def check_origin(self, origin: str) -> bool:
        """Let no other page connect."""
        return origin == f"http://{self.request.host}"

    def open(self, *_: str, **__: str) -> None:
        """Begin with the whole scene."""
        number, snapshot = self.server.link.snapshot()
        hello = {"type": "reset", "number": number, "label": self.server.title}
        self.write_message(framed(hello, [snapshot]), binary=True)
        self.server.sockets.add(self)

    def on_message(self, message: str | bytes) -> None:
        """Take what the page says."""
        try:
            content = json.loads(message)
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
