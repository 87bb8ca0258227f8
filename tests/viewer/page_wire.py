"""A link to simulated pages."""

from typing import Any

import numpy as np

from course_lib.viewer.page_link import PageLink
from course_lib.viewer.scene import Scene


class Wire:
    """Stores the messages that a link sends."""

    def __init__(self) -> None:
        self.scene = Scene()
        self.sent: list[dict[str, Any]] = []
        self.fails: BaseException | None = None
        self.moves = 0
        self.link = PageLink(self.scene, self.carry)

    def carry(self, content: dict[str, Any], buffers: list[bytes]) -> None:
        if self.fails is not None:
            error, self.fails = self.fails, None
            raise error
        self.sent.append(content)

    def kinds(self) -> list[str]:
        return [content["type"] for content in self.sent]

    def hear(self, kind: str, page: str = "a", **fields: Any) -> None:
        fields.setdefault("number", max((c["number"] for c in self.sent if "number" in c), default=0))
        self.link.receive({"type": kind, "page": page, **fields})

    def change(self, times: int = 1) -> None:
        for _ in range(times):
            self.moves += 1
            self.scene.set_transform("box", np.eye(4) + self.moves * np.eye(4, k=3))
            self.link.flush()
