"""A recording played to a session, as `ros2 bag play` plays one to RViz, and by the Time panel's orders."""

from math import isfinite
from typing import Any

from course_lib.displays.frames import NS
from course_lib.displays.session import Session
from course_lib.recording import Recording


class Playback:
    """Lets a session hear a recording up to any time; back in time it hears it from the start again."""

    def __init__(self, session: Session, recording: Recording) -> None:
        self.session = session
        self.start_ns, self.end_ns = recording.start_ns, recording.end_ns
        self.now_ns = self.start_ns
        self.paused = False
        self.rate = 1.0
        self.loop = False
        self._samples = recording.samples
        self._next = 0  # the first sample that was not heard yet

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

    def act(self, change: dict[str, Any]) -> None:
        """Do what somebody did with a time bar."""
        if isinstance(now := change.get("now"), int | float) and isfinite(now):
            self._seek(self.start_ns + round(now * NS))
        if isinstance(steps := change.get("step"), int):
            self.paused = True
            self._seek(self.now_ns + steps * NS // self.session.frame_rate)
        if isinstance(rate := change.get("rate"), int | float) and 0 < rate <= 100:
            self.rate = float(rate)
        self.loop = bool(change.get("loop", self.loop))
        self.paused = bool(change.get("paused", self.paused))
        if change.get("paused") is False and self.now_ns >= self.end_ns:
            self.go_to(self.start_ns)

    def time(self) -> dict[str, Any]:
        """Say what a time bar shows."""
        return {
            "now": self.now_ns / NS,
            "elapsed": (self.now_ns - self.start_ns) / NS,
            "range": [0.0, (self.end_ns - self.start_ns) / NS],
            "paused": self.paused,
            "rate": self.rate,
            "loop": self.loop,
        }

    def _seek(self, now_ns: int) -> None:
        self.go_to(min(max(now_ns, self.start_ns), self.end_ns))
