"""Expectations on any topic: that it is there, how often, with which stamps and fields."""

from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import Any

from course_lib.errors import counted
from course_lib.grading.evidence import Evidence
from course_lib.grading.run.outcome import plain
from course_lib.grading.vocabulary.marker_state import ADD
from course_lib.grading.vocabulary.values import compare
from course_lib.grading.vocabulary.wording import Problem, close, heard, number, word
from course_lib.ros.clock import START_NS
from course_lib.ros.messages import to_plain, type_name

IMAGE = "sensor_msgs/msg/Image"
KEPT = 1 << 20  # bytes of an image whose pixels the evidence has for certain
LONGEST_GAP = 2  # periods, between two messages of a topic that keeps its rate


@word("publishes {type} on {topic}")
def expect_topic(
    evidence: Evidence,
    topic: str,
    type: str,  # noqa: A002 - ROS says type
    *,
    at_least: int = 1,
    at_most: int | None = None,
) -> Iterable[Problem]:
    """Expect `at_least` messages of this type on the topic, and no more than `at_most`."""
    came = heard(evidence, topic)
    strange = [type_name(message) for _, message in came if type_name(message) != type]
    if strange:
        return [Problem(f"{topic} carries {strange[0]}, expected {type}", "a topic has the wrong type")]
    message = f"{counted(len(came), 'message')} on {topic} in {evidence.seconds:g} s, expected "
    if len(came) < at_least:
        return [Problem(f"{message}at least {at_least}", "too few messages on a topic")]
    if at_most is not None and len(came) > at_most:
        return [Problem(f"{message}at most {at_most}", "too many messages on a topic")]
    return []


@word("the rate of {topic}")
def expect_rate(
    evidence: Evidence,
    topic: str,
    hz: float,
    *,
    tolerance: float = 0.1,
    begin: float = 0.0,
    end: float | None = None,
) -> Iterable[Problem]:
    """Expect a rate of `hz`, [1/s], off by the fraction `tolerance` at most, from begin to end, [s].

    Messages of equal time count once.
    """
    end = evidence.seconds if end is None else end
    times = sorted({seconds for seconds, _ in heard(evidence, topic) if begin <= seconds <= end})  # [s]
    if not times:
        message = f"nothing was published on {topic} from {begin:g} to {end:g} s"
        return [Problem(message, "a topic falls silent for a while")]
    if len(times) == 1:
        message = f"{topic} was published once in {end - begin:g} s, expected {number(hz, 'Hz')}"
        return [Problem(message, "a topic is published only once")]
    rate = (len(times) - 1) / (times[-1] - times[0])  # [1/s]
    if not close(rate, hz, tolerance * hz):
        fast = rate > hz
        message = f"{topic} is too {'fast' if fast else 'slow'}: {number(rate, 'Hz')}"
        mistake = f"a topic is published too {'fast' if fast else 'slowly'}"
        return [Problem(f"{message}, expected {number(hz, 'Hz')}", mistake)]
    for before, after in pairwise((begin, *times, end)):
        if after - before > LONGEST_GAP / hz + 1e-6:
            message = f"{topic} is silent from {number(before, 's')} to {number(after, 's')}"
            return [Problem(message, "a topic falls silent for a while")]
    return []


@word("{topic} is published from beginning to end")
def expect_throughout(evidence: Evidence, topic: str) -> Iterable[Problem]:
    """Expect more than one message, and no silence longer than half of the scenario."""
    times = sorted({seconds for seconds, _ in heard(evidence, topic)})  # [s]
    gaps = [after - before for before, after in pairwise((0.0, *times, evidence.seconds))]  # [s]
    if len(times) > 1 and max(gaps) <= evidence.seconds / 2 + 1e-6:
        return []
    often = "was published only once" if len(times) == 1 else f"is silent for {number(max(gaps), 's')}"
    message = f"{topic} {often} in {evidence.seconds:g} s, expected messages from beginning to end"
    return [Problem(message, "a topic is not published all the time")]


@word("nothing on {topic} before {begin} s")
def expect_nothing_before(evidence: Evidence, topic: str, begin: float) -> Iterable[Problem]:
    """Expect messages on a topic, the first of them not before a time [s]."""
    first, _ = heard(evidence, topic)[0]
    message = (
        f"{topic} was published after {number(first, 's')}, expected nothing before {number(begin, 's')}"
    )
    return [Problem(message, "a message comes too early")] if first < begin else []


@word("the images on {topic} have pixels")
def expect_images(evidence: Evidence, topic: str) -> Iterable[Problem]:
    """Expect images of at least one pixel; the data of the first are as long as its rows are together."""
    came = [image for _, image in heard(evidence, topic, IMAGE)]
    empty = [image for image in came if not (image.width and image.height)]
    if empty:
        message = f"an image on {topic} has {empty[0].width} x {empty[0].height} pixels"
        return [Problem(message, "an image has no pixels")]
    first, size = came[0], came[0].step * came[0].height  # later ones may be kept without their pixels
    if size < KEPT and (first.step < first.width or len(first.data) != size):
        message = f"{len(first.data)} bytes of data for {first.height} rows of {first.step} bytes (step)"
        return [Problem(f"the first image on {topic} has {message}", "the data of an image do not fit")]
    return []


@word("the frame of {topic}")
def expect_frame(evidence: Evidence, topic: str, frame: str) -> Iterable[Problem]:
    """Expect this frame in all messages on the topic, and in all markers that they add."""
    for _, message in _stamped(evidence, topic):
        if message.header.frame_id != frame:
            noun = type_name(message).split("/")[-1]
            problem = f"a {noun} on {topic} is in frame {message.header.frame_id!r}, expected {frame!r}"
            return [Problem(problem, "the frame of a message is wrong")]
    return []


@word("the stamps on {topic}")
def expect_stamps(evidence: Evidence, topic: str, *, tolerance: float = 0.05) -> Iterable[Problem]:
    """Expect the robot time of publishing as the stamp of each header, within a tolerance in [s].

    Markers that delete need none.
    """
    for seconds, message in _stamped(evidence, topic):
        stamp = message.header.stamp
        late = stamp.sec - START_NS // 10**9 + stamp.nanosec / 1e9 - seconds  # [s]
        if stamp.sec == 0:
            return [Problem(f"header.stamp on {topic} is not set (sec = 0)", "a stamp is not set")]
        if not close(late, 0.0, tolerance):
            where = "in the future" if late > 0 else "in the past"
            by = number(abs(late), "s")
            message = f"header.stamp on {topic} is {by} {where}, expected the time of publishing"
            return [Problem(message, f"a stamp is {where}")]
    return []


def _stamped(evidence: Evidence, topic: str) -> list[tuple[float, Any]]:
    """Return ([s] since the start, message or marker with a header); markers that delete are left out.

    Raises:
        Problem: There is none, or the type has no header.
    """
    parts = [
        (seconds, part)
        for seconds, message in heard(evidence, topic)
        for part in getattr(message, "markers", [message])
        if getattr(part, "action", ADD) == ADD
    ]
    if not parts:
        raise Problem(f"no marker is added on {topic}", "no marker is added")
    for _, part in parts:
        if not hasattr(part, "header"):
            raise Problem(f"{type_name(part)} on {topic} has no header", "a topic has the wrong type")
    return parts


@word("the last message on {topic}")
def expect_message(
    evidence: Evidence, topic: str, fields: dict[str, Any], *, tolerance: float = 1e-3, unit: str = ""
) -> Iterator[Problem]:
    """Expect fields of the last message, named with dots: `{"header.frame_id": "map"}`.

    A number is a place in a list, counted from 0: `"status.0.name"`.
    """
    last = to_plain(heard(evidence, topic)[-1][1])
    for dotted, expected in fields.items():
        value = last
        for part in dotted.split("."):
            if isinstance(value, list):
                value = dict(enumerate(value)).get(int(part)) if part.isdecimal() else None
            else:
                value = value.get(part) if isinstance(value, dict) else None
        if dotted.endswith("stamp.nanosec") and isinstance(value, int):
            name = f"the fraction of a second in {dotted.removesuffix('.nanosec')}"
            yield from compare(value / 1e9, expected / 1e9, tolerance / 1e9, "s", name)
        else:
            yield from compare(plain(value), plain(expected), tolerance, unit, dotted)
