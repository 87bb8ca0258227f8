"""`%rqt bag FOLDER`: a time line of a recording, which can be played to the nodes."""

import asyncio
from bisect import bisect_right
from html import escape
from pathlib import Path

import numpy as np

from course_lib.errors import CourseError, format_count
from course_lib.recording import read_bag
from course_lib.ros.messages.conversions import PrintOptions, to_yaml
from course_lib.ros.time import wall
from course_lib.tools.rqt.view import RqtView, drawing, tag, text
from course_lib.tools.sources import PLAYER

# Widths of names and time line, and height of a topic [px].
_LEFT, _WIDTH, _ROW = 190, 560, 22
# Wall-clock period of playback [s].
_STEP = 0.05


class BagView(RqtView):
    """A row per topic with a mark for each message, a cursor, and the last message before it."""

    name, title = "bag", "Bag"

    def build(self) -> None:
        """Read the bag, or raise a CourseError if it does not exist."""
        # Imported here because anywidget is slow to import.
        from course_lib.controls import Slider

        if len(self.words) != 1:
            raise CourseError("Add the folder of a bag from ros2 bag record: %rqt bag FOLDER")
        self._recording = read_bag(Path(self.words[0]))
        self._samples = self._recording.samples
        self._times = np.array([s.stamp_ns for s in self._samples], np.int64) - self._recording.start_ns
        self._topics = {topic.name: topic for topic in self._recording.topics()}
        self._node: int | None = None
        self._publishers: dict[str, int] = {}
        # Position of the cursor [s].
        self._at = 0.0
        self._task: asyncio.Task[None] | None = None
        length = (self._recording.end_ns - self._recording.start_ns) * 1e-9
        limits = {"max": max(length, 1e-3), "step": max(length / 1000, 1e-3)}
        self.add(Slider(**limits, description="Time [s]", layout={"width": "480px"}), self._move)
        self.add_check("Play", action=self._play)
        self.add_check("Publish", on=True)
        self.add_choice("Message of", list(self._topics), None)

    def stop(self) -> None:
        """Stop playing and remove the player from the graph."""
        super().stop()
        if self._task is not None:
            self._task.cancel()
        if self._node is not None:
            self.graph.remove_node(self._node)

    def picture(self) -> str:
        """Draw the time line above the last message before the cursor."""
        length = self.controls["Time [s]"].max
        x, height = _LEFT + self._at / length * _WIDTH, _ROW * len(self._topics) + 22
        shapes = "".join(self._line(row, topic) for row, topic in enumerate(self._topics))
        shapes += text("0 s", _LEFT, height - 4) + text(f"{length:.1f} s", _LEFT + _WIDTH, height - 4, "end")
        shapes += tag("path", d=f"M{x:.1f} 0v{height - 16}", stroke="#c9281f", stroke_width=2)
        messages, topics = (
            format_count(len(self._samples), "message"),
            format_count(len(self._topics), "topic"),
        )
        description = f"{messages} of {topics}, the cursor at {self._at:.2f} s"
        return drawing(shapes, _LEFT + _WIDTH + 90, height, description) + self._message()

    def _line(self, row: int, topic: str) -> str:
        """Draw a topic's name, a mark at each pixel with messages, and the number of messages."""
        stamps = self._times[[s.topic == topic for s in self._samples]] * 1e-9
        pixels = np.unique((stamps / self.controls["Time [s]"].max * _WIDTH).round()).astype(int)
        marks = "".join(f"M{_LEFT + pixel} {_ROW * row + 5}v12" for pixel in pixels.tolist())
        y = _ROW * row + 15
        line = tag("path", d=f"M{_LEFT} {y - 4}h{_WIDTH}", stroke="var(--rqt-line)")
        ends = text(topic[-26:], _LEFT - 8, y, "end") + text(str(len(stamps)), _LEFT + _WIDTH + 8, y)
        return line + tag("path", d=marks, stroke="#0072b2") + ends

    def _message(self) -> str:
        earlier = self._samples[: self._index(self._at)]
        sample = next((s for s in reversed(earlier) if s.topic == self["Message of"]), None)
        if sample is None:
            return "<p class='rqt-dim'>Choose a topic to see its last message before the cursor.</p>"
        stamp = (sample.stamp_ns - self._recording.start_ns) * 1e-9
        text = escape(to_yaml(sample.message(), PrintOptions()))
        return f"<p><b>{escape(sample.topic)}</b> at {stamp:.3f} s</p><pre>{text}</pre>"

    def _index(self, seconds: float) -> int:
        """Return the number of messages up to a time [s]."""
        return bisect_right(self._times.tolist(), round(seconds * 1e9))

    def _move(self) -> None:
        """Move the cursor to the time of the slider."""
        if abs(self["Time [s]"] - self._at) > self.controls["Time [s]"].step:
            self._at = self["Time [s]"]
        self.refresh()

    def _play(self) -> None:
        if (
            self._loop is not None
            and self.controls["Play"].value
            and (self._task is None or self._task.done())
        ):
            self._task = self._loop.create_task(self._keep_playing())

    async def _keep_playing(self) -> None:
        """Move the cursor in real time. If it is at the end, start again."""
        slider, last_update = self.controls["Time [s]"], wall.monotonic()
        if self._at >= slider.max:
            self._at = 0.0
        while self["Play"] and self._at < slider.max:
            await asyncio.sleep(_STEP)
            now = wall.monotonic()
            self.play_to(min(self._at + now - last_update, slider.max))
            last_update, slider.value = now, self._at
        self.controls["Play"].value = False

    def play_to(self, seconds: float) -> None:
        """Advance the cursor to a time [s], and publish the messages up to it if Publish is checked."""
        first_index = self._index(self._at) if self._at > 0 else 0
        if self["Publish"]:
            indices = range(first_index, self._index(seconds))
            if self._node is None:
                self._node = self.graph.add_node(PLAYER, "/")
                for topic in self._topics.values():
                    self._publishers[topic.name] = self.graph.add_publisher(
                        self._node, topic.name, topic.type_name, topic.offered[0]
                    )
            for index in indices:
                self.graph.publish(self._publishers[self._samples[index].topic], self._samples[index].cdr)
        self._at = seconds
