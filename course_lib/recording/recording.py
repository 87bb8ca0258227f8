"""Recordings in memory: samples in the order of their publication."""

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from course_lib.ros.graph.graph import Graph, Sample
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import RosMessage


@dataclass(frozen=True)
class TopicSummary:
    """A topic of a recording, with the different QoS of its publishers."""

    name: str
    type_name: str
    count: int
    offered: tuple[Qos, ...]


@dataclass(frozen=True)
class Recording:
    """Samples in the order of their publication."""

    samples: Sequence[Sample]

    @property
    def start_ns(self) -> int:
        """Robot time of the first sample [ns]; 0 without samples."""
        return self.samples[0].stamp_ns if self.samples else 0

    @property
    def end_ns(self) -> int:
        """Robot time of the last sample [ns]; 0 without samples."""
        return self.samples[-1].stamp_ns if self.samples else 0

    def topics(self) -> list[TopicSummary]:
        """List the topics by name. A topic with two types is listed twice."""
        groups: dict[tuple[str, str], list[Qos]] = {}
        for sample in self.samples:
            groups.setdefault((sample.topic, sample.type_name), []).append(sample.qos)
        return [
            TopicSummary(name, type_name, len(qos), tuple(dict.fromkeys(qos)))
            for (name, type_name), qos in sorted(groups.items())
        ]

    def messages(self, topic: str) -> Iterator[tuple[int, RosMessage]]:
        """Yield (robot time [ns], message) of a topic.

        Raises:
            CourseError: A type is unknown, or the bytes are not a message of this type.
        """
        for sample in self.samples:
            if sample.topic == topic:
                yield sample.stamp_ns, sample.message()

    def digest(self) -> str:
        """Return the SHA-256 of all samples' topics, types, stamps and CDR bytes, in hexadecimal digits."""
        total = hashlib.sha256()
        for sample in self.samples:
            stamp = sample.stamp_ns.to_bytes(8, "little", signed=True)
            for part in (sample.topic.encode(), sample.type_name.encode(), stamp, sample.cdr):
                total.update(len(part).to_bytes(8, "little"))
                total.update(part)
        return total.hexdigest()


class Recorder:
    """Collects the samples of a graph until it is stopped; also a context manager."""

    def __init__(self, graph: Graph) -> None:
        self._samples = graph.latched_samples()
        self._untap = graph.tap(self._samples.append)
        self._is_listening = True

    def stop(self) -> None:
        """Stop collecting samples."""
        if self._is_listening:
            self._untap()
        self._is_listening = False

    def recording(self) -> Recording:
        """Return the collected samples as a recording."""
        return Recording(tuple(self._samples))

    def __enter__(self) -> "Recorder":
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()


def record(graph: Graph) -> Recorder:
    """Start to record all topics of a graph, including the samples kept for late-joining subscriptions."""
    return Recorder(graph)
