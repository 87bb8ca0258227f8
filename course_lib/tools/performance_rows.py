"""Measured rows of a performance report: one per topic and per callback."""

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import fmean, pstdev
from typing import Any

from course_lib.ros.graph import Sample
from course_lib.ros.messages import message_class

_SECOND = 10**9  # [ns]


@dataclass(frozen=True)
class TopicRow:
    """Measurements of a topic; latency is from the header's stamp to the arrival, None without stamps."""

    topic: str
    messages: int
    rate: float  # [Hz], 0 for fewer than two messages, as is the jitter
    jitter: float  # [s] standard deviation of the time between messages
    latency: float | None  # [s] mean
    longest_latency: float | None  # [s]
    size: float  # [B] mean, as CDR
    bandwidth: float  # [B/s]


@dataclass(frozen=True)
class CallbackRow:
    """Measurements of a node's callback, in robot time, and `load`, which depends on the machine."""

    node: str
    callback: str
    calls: int
    longest: float  # [s] from start to end
    longest_wait: float  # [s] from ready to start
    busy: float  # share of the time in which it was under way
    load: float  # share of a processor at the wall clock's pace; differs from run to run


@dataclass(frozen=True)
class CallbackRun:
    """One run of a callback: [ns] of robot time, processor time [s]."""

    node: str
    callback: str
    ready_ns: int
    start_ns: int
    end_ns: int
    processor: float


def callback_run(entity: Any, ready_ns: int, start_ns: int, processor: float) -> CallbackRun:
    """Return the run of a callback that has just ended; it is named by topic, service or period."""
    handle = entity.node_handle
    period = getattr(entity, "timer_period_ns", None)
    name = getattr(entity, "topic_name", None) or getattr(entity, "srv_name", None)
    if period is not None:
        name = f"timer {period / _SECOND:g} s"
    return CallbackRun(
        handle.full_name, name or type(entity).__name__, ready_ns, start_ns, handle.graph.now_ns, processor
    )


def topic_rows(samples: Sequence[Sample], delay_ns: int) -> list[TopicRow]:
    """Measure the topics, by name; messages arrive `delay_ns` after they were published."""
    by_topic: dict[tuple[str, str], list[Sample]] = {}
    for sample in samples:
        by_topic.setdefault((sample.topic, sample.type_name), []).append(sample)
    return [_topic(topic, found, delay_ns) for (topic, _), found in sorted(by_topic.items())]


def callback_rows(calls: Sequence[CallbackRun], seconds: float) -> list[CallbackRow]:
    """Measure the callbacks over a time [s], by node and name."""
    by_name: dict[tuple[str, str], list[CallbackRun]] = {}
    for call in calls:
        by_name.setdefault((call.node, call.callback), []).append(call)
    return [
        CallbackRow(
            *name,
            calls=len(found),
            longest=max(c.end_ns - c.start_ns for c in found) / _SECOND,
            longest_wait=max(c.start_ns - c.ready_ns for c in found) / _SECOND,
            busy=sum(c.end_ns - c.start_ns for c in found) / _SECOND / seconds,
            load=sum(c.processor for c in found) / seconds,
        )
        for name, found in sorted(by_name.items())
    ]


def _topic(topic: str, samples: list[Sample], delay_ns: int) -> TopicRow:
    stamps = [sample.stamp_ns for sample in samples]
    gaps = [(b - a) / _SECOND for a, b in pairwise(stamps)]
    rate = 1 / fmean(gaps) if sum(gaps) else 0.0
    latencies = [
        (sample.stamp_ns + delay_ns - made_ns) / _SECOND
        for sample in samples
        if (made_ns := header_stamp(sample)) is not None
    ]
    size = fmean(len(sample.cdr) for sample in samples)
    return TopicRow(
        topic,
        len(samples),
        rate=rate,
        jitter=pstdev(gaps) if gaps else 0.0,
        latency=fmean(latencies) if latencies else None,
        longest_latency=max(latencies, default=None),
        size=size,
        bandwidth=size * rate,
    )


def header_stamp(sample: Sample) -> int | None:
    """Read the stamp [ns] from a message's header alone; None without a header or a stamp."""
    fields = message_class(sample.type_name).get_fields_and_field_types()
    if next(iter(fields.items()), None) != ("header", "std_msgs/Header"):
        return None
    seconds, nanoseconds = struct.unpack_from("<iI" if sample.cdr[1] else ">iI", sample.cdr, 4)
    return seconds * _SECOND + nanoseconds or None
