"""RViz's Time panel: what time it is, and orders to the running graph or to the recording that is played."""

from typing import Any

from course_lib.displays.frames import NS
from course_lib.displays.playback import Playback
from course_lib.displays.session import Session
from course_lib.ros import pace, wall
from course_lib.ros.graph import Graph
from course_lib.viewer.page_link import PageLink

PERIOD = 0.1  # [s] of the wall clock between two readings
_STEP_NS = NS // 10  # robot time of a step
RATES = (0.01, 100.0)


class LiveTime:
    """Robot time of the running graph: it stands, steps, goes slower or faster."""

    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        self._speed = pace.speed_of(graph)
        self._start_ns = graph.now_ns
        self._wall = wall.monotonic()

    def time(self) -> dict[str, Any]:
        """Say what a time bar shows."""
        return {
            "now": self._graph.now_ns / NS,
            "elapsed": (self._graph.now_ns - self._start_ns) / NS,
            "wall": wall.time_ns() / NS,
            "wallElapsed": wall.monotonic() - self._wall,
            "paused": self._speed.paused,
            "rate": self._speed.rate,
        }

    def act(self, change: dict[str, Any]) -> None:
        """Do what somebody did with a time bar."""
        if change.get("step") == 1:
            self._speed.paused = True
            self._speed.step_ns += _STEP_NS
        rate = change.get("rate")
        if isinstance(rate, int | float) and RATES[0] <= rate <= RATES[1]:
            self._speed.rate = float(rate)
        self._speed.paused = bool(change.get("paused", self._speed.paused))


class TimePanel:
    """Keeps the time bars of pages up to date with every frame of a session; hears what is done with them."""

    def __init__(self, session: Session, link: PageLink, source: LiveTime | Playback) -> None:
        self._session = session
        self._link = link
        self._source = source
        self._posted = 0.0  # [s] of the wall clock
        self._shown: dict[str, Any] = {}
        link.listen("time", self._act)
        session.after_frame.append(self.refresh)

    def close(self) -> None:
        """Follow the session no more."""
        self._session.after_frame.remove(self.refresh)

    def post(self) -> None:
        """Show the time, now."""
        self._posted, self._shown = wall.monotonic(), self._source.time()
        self._link.post({"type": "time", **self._shown})

    def refresh(self) -> None:
        """Show the time to whoever looks, unless that was done a moment ago."""
        is_due = self._link.ready and wall.monotonic() - self._posted >= PERIOD
        if is_due and self._source.time() != self._shown:
            self.post()

    def _act(self, change: dict[str, Any]) -> None:
        self._source.act(change)
        self.post()
        self._posted = 0.0  # what comes of it is shown with the next frame
