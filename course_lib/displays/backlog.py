"""Messages and times that a viewer has not processed yet, because no page can show its scene."""

from collections import deque
from dataclasses import replace

from course_lib.displays.session import RvizSession
from course_lib.ros.graph import Graph, Sample

MOST = 20_000  # messages and frames
MOST_BYTES = 16 << 20  # of messages


class Backlog:
    """Passes a graph's samples and times to a session: at once, or later while no page can show the scene.

    `Context.settle` replays the samples and times that wait, in order and each at its own robot time. The
    session's state is then the same as if none had waited.

    Args:
        session: Receives the samples and times.
        graph: Publishes them.
    """

    def __init__(self, session: RvizSession, graph: Graph) -> None:
        self._session, self._graph = session, graph
        self._waiting: deque[Sample | int] = deque()  # samples, and robot times [ns] that passed
        self._bytes = 0
        self._topics: set[str] | None = None  # that displays listen to; None if nothing can wait
        self._is_known = False  # whether `_topics` is up to date
        self._replayed_ns: int | None = None  # robot time of what is being replayed
        session.context.settle = self.settle

    @property
    def now_ns(self) -> int:
        """The robot time of the sample or time that is processed now, [ns]."""
        return self._graph.now_ns if self._replayed_ns is None else self._replayed_ns

    def receive(self, sample: Sample) -> None:
        """Process a published message, now or later."""
        topics = self._wanted()
        if topics is None:
            self._session.receive(sample)
            return
        if sample.topic not in topics:  # the session reads only its time and type
            sample = replace(sample, cdr=b"")
        self._bytes += len(sample.cdr)
        self._wait(sample)

    def tick(self, now_ns: int) -> None:
        """Process a robot time that was reached, [ns], now or later."""
        if self._wanted() is None:
            self._session.tick(now_ns)
        else:
            self._wait(now_ns)

    def settle(self) -> None:
        """Process all samples and times that wait."""
        if self._replayed_ns is not None:
            return
        self._is_known = False
        try:
            while self._waiting:
                self._replay(self._waiting.popleft())
        finally:
            self._replayed_ns = None
            self._session.context.owes = bool(self._waiting)
        self._bytes = 0

    def _replay(self, one: Sample | int) -> None:
        if isinstance(one, Sample):
            self._replayed_ns = one.stamp_ns
            self._session.receive(one)
        else:
            self._replayed_ns = one
            self._session.tick(one)

    def _wait(self, one: Sample | int) -> None:
        self._waiting.append(one)
        self._session.context.owes = True
        if len(self._waiting) > MOST or self._bytes > MOST_BYTES:
            self.settle()

    def _wanted(self) -> set[str] | None:
        """Return the topics whose messages must be kept; None if nothing can wait."""
        if not self._is_known:
            session = self._session
            is_asleep = not (session.context.is_seen or session.after_frame)
            can_wait = is_asleep and not any(display.acts for display in session.displays)
            self._topics = session.topics() if can_wait else None
            self._is_known = True
        return self._topics
