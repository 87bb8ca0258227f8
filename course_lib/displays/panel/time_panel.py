"""RViz's Time panel over the time of the running graph, or of a recording that is played."""

from dataclasses import dataclass, replace
from typing import Any

from course_lib.displays.frames import NS
from course_lib.displays.session import RvizSession
from course_lib.displays.view_time import ViewTime
from course_lib.recording import Recording
from course_lib.ros import pace, wall
from course_lib.ros.graph import Graph
from course_lib.viewer.page_link import PageLink
from course_lib.viewer.wire import MessageError, from_json, to_json

PERIOD = 0.1  # [s] of the wall clock between two readings
RATES = (0.01, 100.0)
_STEP_NS = NS // 10  # robot time of a step


@dataclass(frozen=True)
class TimeState:
    """The state of a time bar, [s]; wall time is that of a live graph, the range that of a recording."""

    elapsed: float
    paused: bool
    rate: float
    now: float | None = None  # ROS time
    range: tuple[float, float] | None = None
    wall: float | None = None
    wall_elapsed: float | None = None
    loop: bool = False
    note: str = ""


@dataclass(frozen=True)
class TimeChange:
    """An order of a time bar; without any field it requests the time."""

    now: float | None = None  # [s] since the start
    step: int | None = None  # frames
    rate: float | None = None
    loop: bool | None = None
    paused: bool | None = None


class LiveTime:
    """Robot time of the running graph: paused, stepped, slower or faster; it shows the view's ROS time."""

    def __init__(self, graph: Graph, view_time: ViewTime) -> None:
        self._graph = graph
        self._view_time = view_time
        self._speed = pace.speed_of(graph)
        self._start: tuple[bool, int] | None = None  # the source of ROS time, and its first time, [ns]
        self._wall = wall.monotonic()

    def time(self) -> TimeState:
        """Return ROS time and wall time."""
        now_ns = self._view_time.ros_ns(self._graph.now_ns)
        wall_now, wall_elapsed = wall.time_ns() / NS, wall.monotonic() - self._wall
        return TimeState(
            (now_ns - self._started_ns(now_ns)) / NS,
            self._speed.paused,
            self._speed.rate,
            now_ns / NS,
            wall=wall_now,
            wall_elapsed=wall_elapsed,
        )

    def _started_ns(self, now_ns: int) -> int:
        """Return the first time since ROS time was reset: it came from elsewhere, jumped back, or began."""
        source = self._view_time.use_sim_time
        if self._start is None or self._start[0] != source or not 0 < self._start[1] <= now_ns:
            self._start = source, now_ns
        return self._start[1]

    def act(self, change: TimeChange) -> None:
        """Step, pause or change the rate; raises a MessageError where time is a robot's."""
        if self._graph.keeps_wall_time and change != TimeChange():
            raise MessageError("The time of a robot goes on: it cannot be paused, nor made faster or slower.")
        if change.step == 1:
            self._speed.paused = True
            self._speed.step_ns += _STEP_NS
        if change.rate is not None and RATES[0] <= change.rate <= RATES[1]:
            self._speed.rate = change.rate
        if change.paused is not None:
            self._speed.paused = change.paused


class Playback:
    """A recording played to a session up to any time; back in time, from the start again."""

    def __init__(self, session: RvizSession, recording: Recording) -> None:
        self.session = session
        self.start_ns, self.end_ns = recording.start_ns, recording.end_ns
        self.now_ns = self.start_ns
        self.paused = False
        self.rate = 1.0
        self.loop = False
        self._samples = recording.samples
        self._next = 0  # the first sample that was not delivered yet

    def go_to(self, now_ns: int) -> None:
        """Show what is to be seen at a robot time, [ns]."""
        if now_ns < self.now_ns:
            self._next = 0  # the session notices the jump back
        while self._next < len(self._samples) and self._samples[self._next].stamp_ns <= now_ns:
            self._next += 1
            self.session.receive(self._samples[self._next - 1])
        self.now_ns = now_ns
        self.session.update(now_ns)

    def advance(self, seconds: float) -> None:
        """Play on for so much wall time, [s]."""
        if self.paused:
            return
        now_ns = self.now_ns + round(seconds * self.rate * NS)
        if now_ns < self.end_ns:
            self.go_to(now_ns)
        elif self.loop and self.end_ns > self.start_ns:
            self.go_to(self.start_ns + (now_ns - self.start_ns) % (self.end_ns - self.start_ns))
        else:
            self.go_to(self.end_ns)
            self.paused = True

    def act(self, change: TimeChange) -> None:
        """Seek, step, pause or change the rate."""
        if change.now is not None:
            self._seek(self.start_ns + round(change.now * NS))
        if change.step is not None:
            self.paused = True
            self._seek(self.now_ns + change.step * NS // self.session.time.frame_rate)
        if change.rate is not None and 0 < change.rate <= RATES[1]:
            self.rate = change.rate
        self.loop = self.loop if change.loop is None else change.loop
        self.paused = self.paused if change.paused is None else change.paused
        if change.paused is False and self.now_ns >= self.end_ns:
            self.go_to(self.start_ns)

    def time(self) -> TimeState:
        """Return the time in the recording."""
        elapsed, end = ((ns - self.start_ns) / NS for ns in (self.now_ns, self.end_ns))
        return TimeState(elapsed, self.paused, self.rate, self.now_ns / NS, range=(0.0, end), loop=self.loop)

    def _seek(self, now_ns: int) -> None:
        self.go_to(min(max(now_ns, self.start_ns), self.end_ns))


class TimePanel:
    """The time bars of pages, kept equal to a source of time that gets their orders."""

    def __init__(self, session: RvizSession, link: PageLink, source: LiveTime | Playback) -> None:
        self._session = session
        self._link = link
        self._source = source
        self._posted = 0.0  # [s] of the wall clock
        self._shown: TimeState | None = None
        link.listen("time", self._act)
        session.after_frame.append(self.refresh)

    def close(self) -> None:
        """Stop following the session."""
        self._session.after_frame.remove(self.refresh)

    def refresh(self) -> None:
        """Post the time if it has changed and the last reading is older than PERIOD."""
        is_due = self._link.watched and wall.monotonic() - self._posted >= PERIOD
        if is_due and self._source.time() != self._shown:
            self._post()

    def _act(self, content: dict[str, Any]) -> None:
        note = ""
        try:
            self._source.act(from_json(TimeChange, content))
        except MessageError as error:
            note = str(error)
        self._post(note)
        self._posted = 0.0  # what comes of it is shown with the next frame

    def _post(self, note: str = "") -> None:
        self._posted, self._shown = wall.monotonic(), self._source.time()
        self._link.post({"type": "time", **to_json(replace(self._shown, note=note))})
