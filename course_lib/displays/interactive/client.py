"""RViz's client of a server of interactive markers (interactive_marker_client.cpp of rolling)."""

from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import chain
from typing import Any, Literal

from course_lib.displays.display import Context
from course_lib.displays.frames import NS, nanoseconds
from course_lib.displays.interactive.handles import Message, complete
from course_lib.displays.statuses import Level, Statuses
from course_lib.ros.qos import Qos

LABEL = "Interactive Marker Client"  # of RViz's status
FEEDBACK = "visualization_msgs/msg/InteractiveMarkerFeedback"
QOS = Qos(depth=100)
_SERVICE = "visualization_msgs/srv/GetInteractiveMarkers"
_PATIENCE_NS = NS  # [ns] that a response may take
_KEEP_ALIVE = 0
_NOT_SPUN = "The server answers while its node is spun, for instance by spin_for(1.0, node)."


@dataclass(frozen=True)
class Actions:
    """Functions that show markers."""

    begin: Callable[[Iterable[Message]], None]  # all markers, in place of those that are there
    follow: Callable[[Message], None]  # an InteractiveMarkerUpdate
    clear: Callable[[], None]


class MarkerClient:
    """A connection to a server: asks for all markers, then follows its updates; a recording has updates only.

    Args:
        context: Of the display.
        namespace: Of the server, with its slash.
        statuses: Of the display.
        actions: What is done with markers.
        transparent: Whether handles may be transparent.
    """

    def __init__(
        self, context: Context, namespace: str, statuses: Statuses, actions: Actions, transparent: bool
    ) -> None:
        self._context, self._namespace, self._statuses = context, namespace, statuses
        self._actions, self._transparent = actions, transparent
        self._state: Literal["idle", "asking", "running", "stopped"] = "idle"
        self._queue: deque[Message] = deque()
        self._last: int | None = None  # number of the last update
        self._response: Message = None
        self._asked = 0  # requests
        self._asked_ns = 0
        self._say("ok", f"Connected on namespace: {namespace}")
        if context.node is not None:
            context.node.publisher(f"{namespace}/feedback", FEEDBACK, QOS)

    def send(self, feedback: Message) -> None:
        """Publish feedback, if this is no recording."""
        if self._context.node is not None:
            self._context.node.publish(f"{self._namespace}/feedback", FEEDBACK, QOS, feedback)

    def take(self, update: Message) -> None:
        """Queue an update; one that is not the next makes the client begin again."""
        if update.type == _KEEP_ALIVE or self._state == "stopped":
            return
        expected = update.seq_num if self._last is None else self._last + 1
        if update.seq_num != expected and self._context.node is not None:
            self._restart()
            numbers = f"{expected} (expected) vs. {update.seq_num} (received)"
            self._say("warn", f"Update sequence number is out of order. {numbers}")
            return
        self._say("ok", f"Received update with sequence number {update.seq_num}")
        self._last = update.seq_num
        for marker in update.markers:
            complete(marker, self._transparent)
        self._queue.append(update)
        if self._state == "idle":
            self.step()  # there is a server now

    def step(self) -> None:
        """Go on: ask, begin with the response, show the updates that tf2 can place."""
        node = self._context.node
        if self._state == "stopped":
            return
        if node is None:
            self._state = "running"
        elif not node.has_service(f"{self._namespace}/get_interactive_markers"):
            self._miss()
        elif self._state == "idle":
            self._ask()
        if self._state == "asking":
            self._begin()
        if self._state == "running":
            self._follow()

    def stop(self, reason: str) -> None:
        """Forget all markers and listen no more, as RViz does after some messages."""
        self._restart()
        self._state = "stopped"
        self._statuses.hint(LABEL, f"RViz listens no more: {reason} Untick the display and tick it again.")

    def _say(self, level: Level, text: str) -> None:
        self._statuses.set(level, LABEL, text)

    def _restart(self) -> None:
        self._state, self._last, self._response = "idle", None, None
        self._asked += 1  # nobody waits for responses that are on their way
        self._queue.clear()
        self._actions.clear()

    def _miss(self) -> None:
        """Note that nobody answers."""
        if self._state != "idle":
            when = "during initialization" if self._state == "asking" else "while running"
            self._restart()
            self._say("warn", f"Server not available {when}, resetting")
        self._statuses.hint(LABEL, f"No server of interactive markers is in {self._namespace}.")

    def _ask(self) -> None:
        self._state, self._asked_ns = "asking", self._context.now_ns
        self._asked += 1
        number = self._asked
        self._say("ok", "Sending request for interactive markers")
        self._statuses.hint(LABEL, _NOT_SPUN)

        def take(response: Message) -> None:
            if number == self._asked:
                for marker in response.markers:
                    complete(marker, self._transparent)
                self._response = response
                self._context.touched()

        if self._context.node is not None:
            self._context.node.call(f"{self._namespace}/get_interactive_markers", _SERVICE, take)

    def _begin(self) -> None:
        """Show the markers of the response, once it is there and tf2 can place them."""
        if self._response is None:
            if self._context.now_ns - self._asked_ns > _PATIENCE_NS:
                self._ask()
                problem = "Did not receive response with interactive markers, resending request..."
                self._say("warn", problem)
            return
        error, waits = self._missing(self._response.markers)
        self._statuses.hint(LABEL, *([f"RViz asks again and again: {error}"] if error else []))
        if error or waits:
            said = f"Resetting due to transform error: {error}"
            self._say("ok", said if error else "Initialization: Waiting for TF info")
            return
        response, self._response = self._response, None
        while self._queue and self._queue[0].seq_num <= response.sequence_number:
            self._queue.popleft()
        self._state = "running"
        self._say("ok", "Initialized")
        self._actions.begin(response.markers)

    def _follow(self) -> None:
        """Show the updates that tf2 can place, in their order."""
        while self._queue and self._state == "running":
            update = self._queue[0]
            error, waits = self._missing(chain(update.markers, update.poses))
            if error and self._context.node is not None:
                self._restart()
            if error:
                self._say("error", f"Resetting due to transform error: {error}")
            if error or waits:
                return
            self._queue.popleft()
            self._say("ok", f"Pushing update with sequence number {update.seq_num}")
            self._actions.follow(update)

    def _missing(self, things: Iterable[Any]) -> tuple[str, bool]:
        """Return why tf2 cannot place markers or poses: an error, and whether to wait for transforms."""
        waits = False
        for header in chain.from_iterable(map(_headers, things)):
            error = self._problem(header)
            if error:
                return error, False
            waits = waits or error is None
        return "", waits

    def _problem(self, header: Message) -> str | None:
        """Return "" if a header's frame is known at its stamp, an error, or None if it may be known later."""
        frames, frame = self._context.frames, header.frame_id.removeprefix("/")
        stamp_ns = nanoseconds(header.stamp)
        if frame == frames.fixed_frame or frames.transform(frame, stamp_ns) is not None:
            return ""
        if frames.transform(frame) is None:
            return frames.buffer.can_transform(frames.fixed_frame, frame, stamp_ns) or ""
        if frames.buffer.lookup(frames.fixed_frame, frame).stamp_ns <= stamp_ns:
            return None
        return (
            f"The message contains an old timestamp and cannot be transformed ('{header.frame_id}' to "
            f"'{frames.fixed_frame}' at time {stamp_ns / NS:f})."
        )


def _headers(thing: Message) -> Iterable[Message]:
    """Yield the headers of an interactive marker and of what it is made of, or of a pose."""
    yield thing.header
    for control in getattr(thing, "controls", ()):
        yield from (part.header for part in control.markers if part.header.frame_id)
