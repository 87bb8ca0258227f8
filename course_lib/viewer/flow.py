"""How far pages have come with what they were sent, and whether there is room for more."""

import asyncio
import threading
from collections import deque
from dataclasses import dataclass

_BATCHES, _BYTES = 4, 1 << 18  # of what is sent, pages are asked to answer
_QUESTIONS = 3  # may be open at a time


@dataclass
class Page:
    """What is known of a page."""

    number: int  # of the last batch that it has
    views: int = 1


class Flow:
    """Counts what pages have not answered yet, so that slow ones get fewer batches and none pile up.

    Most front-ends' answers wait until the running cell ends, which is not the pages' fault: until then
    everything is sent. JupyterLab's come in between, in a thread of their own.
    """

    def __init__(self) -> None:
        self.pages: dict[str, Page] = {}
        self._loop = running_loop()  # that of the cells, if this is a kernel
        self._hears_in_cells = False
        self._open: deque[int] = deque()  # batches that pages were asked about
        self._batches = self._bytes = 0  # since the last question
        self._idle_at = -1  # number of a batch after which the kernel was free to hear

    def heard(self, name: str, number: int) -> bool:
        """Note how far a page has come; say whether it is a new one."""
        self._hears_in_cells |= threading.current_thread() is not threading.main_thread()
        is_new = name not in self.pages
        self.pages.setdefault(name, Page(number)).number = number
        self._settle()
        return is_new

    def left(self, name: str) -> None:
        """Forget a page."""
        self.pages.pop(name, None)
        self._settle()

    def sent(self, number: int, size: int) -> bool:
        """Count a batch of a size in bytes; say whether pages shall answer it."""
        self._batches, self._bytes = self._batches + 1, self._bytes + size
        if self._batches < _BATCHES and self._bytes < _BYTES:
            return False
        self._batches = self._bytes = 0
        self._open.append(number)
        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._idle, number)
        return True

    def room(self) -> bool:
        """Say whether one more batch may be sent."""
        questions = tuple(self._open)  # pages answer in other threads
        is_deaf = self._loop is not None and not self._hears_in_cells
        return len(questions) < _QUESTIONS or (is_deaf and self._idle_at < questions[0])

    def give_up(self) -> None:
        """Forget the pages that have not answered."""
        late = self._open[0] if self._open else -1
        self.pages = {name: page for name, page in self.pages.items() if page.number >= late}
        self._open.clear()

    def _settle(self) -> None:
        slowest = min((page.number for page in tuple(self.pages.values())), default=-1)
        while self._open and self._open[0] <= slowest:
            self._open.popleft()

    def _idle(self, number: int) -> None:
        self._idle_at = number


def running_loop() -> asyncio.AbstractEventLoop | None:
    """Return the event loop of this thread, or None."""
    try:
        return asyncio.get_running_loop()
    except RuntimeError:
        return None
