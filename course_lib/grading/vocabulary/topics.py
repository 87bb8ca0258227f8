"""Expectations on any topic: that it is there, how often, with which stamps and fields."""

from typing import Any

from course_lib.grading.evidence import Check, Evidence
from course_lib.grading.vocabulary.values import compare
from course_lib.grading.vocabulary.wording import Problem, check_of, close, nothing_on, number
from course_lib.ros.clock import START_NS
from course_lib.ros.messages import to_plain, type_name


def expect_topic(topic: str, type: str, *, at_least: int = 1) -> Check:  # noqa: A002 - ROS says type
    """At least so many messages of this type were published on the topic."""
    expected = {"topic": topic, "wanted": type, "at_least": at_least}
    return check_of(f"publishes {type} on {topic}", expected, _topic)


def expect_rate(topic: str, hz: float, *, tolerance: float = 0.1) -> Check:
    """The topic keeps a rate all through the scenario; messages of equal time count once.

    Args:
        topic: Its name.
        hz: [1/s].
        tolerance: Fraction of the rate that it may be off.
    """
    return check_of(f"the rate of {topic}", {"topic": topic, "hz": hz, "tolerance": tolerance}, _rate)


def expect_stamps(topic: str, *, tolerance: float = 0.05) -> Check:
    """The stamps in the headers are the robot time of publishing, within a tolerance in [s]."""
    return check_of(f"the stamps on {topic}", {"topic": topic, "tolerance": tolerance}, _stamps)


def expect_message(topic: str, fields: dict[str, Any], *, tolerance: float = 1e-3, unit: str = "") -> Check:
    """The last message on the topic has these fields, named with dots: `{"header.frame_id": "map"}`."""
    expected = {"topic": topic, "fields": fields, "tolerance": tolerance, "unit": unit}
    return check_of(f"the last message on {topic}", expected, _message)


def _topic(evidence: Evidence, topic: str, wanted: str, at_least: int) -> list[Problem]:
    came = [sample for sample in evidence.samples if sample.topic == topic]
    if not came:
        return [nothing_on(evidence, topic)]
    if any(sample.type_name != wanted for sample in came):
        message = f"{topic} carries {evidence.topics[topic]}, expected {wanted}"
        return [Problem(message, "a topic has the wrong message type")]
    if len(came) >= at_least:
        return []
    message = f"{len(came)} message(s) on {topic} in {evidence.seconds:g} s, expected at least {at_least}"
    return [Problem(message, "too few messages on a topic")]


def _rate(evidence: Evidence, topic: str, hz: float, tolerance: float) -> list[Problem]:
    stamps = sorted({s.stamp_ns for s in evidence.samples if s.topic == topic})
    times = [(stamp - START_NS) / 1e9 for stamp in stamps]  # [s]
    if not times:
        return [nothing_on(evidence, topic)]
    if len(times) == 1:
        message = f"{topic} was published once in {evidence.seconds:g} s, expected {number(hz, 'Hz')}"
        return [Problem(message, "a topic is published only once")]
    rate = (len(times) - 1) / (times[-1] - times[0])  # [1/s]
    if not close(rate, hz, tolerance * hz):
        which = "fast" if rate > hz else "slow"
        message = f"{topic} is too {which}: {number(rate, 'Hz')}, expected {number(hz, 'Hz')}"
        return [Problem(message, f"a topic is published too {which}ly".replace("fastly", "fast"))]
    if times[-1] < evidence.seconds - 2 / hz:
        message = f"{topic} falls silent after {number(times[-1], 's')} of {evidence.seconds:g} s"
        return [Problem(message, "a topic falls silent before the end")]
    return []


def _stamps(evidence: Evidence, topic: str, tolerance: float) -> list[Problem]:
    came = evidence.messages(topic)
    for seconds, message in came:
        for stamped in getattr(message, "markers", [message]):
            if not hasattr(stamped, "header"):
                return [
                    Problem(f"{type_name(stamped)} on {topic} has no header", "a topic has the wrong type")
                ]
            stamp = stamped.header.stamp
            stamp_s = stamp.sec - START_NS // 10**9 + stamp.nanosec / 1e9  # [s] since the start
            if not close(stamp_s, seconds, tolerance):
                return [_bad_stamp(topic, stamp_s - seconds, stamp.sec == 0)]
    return [] if came else [nothing_on(evidence, topic)]


def _bad_stamp(topic: str, late: float, unset: bool) -> Problem:
    if unset:
        return Problem(f"header.stamp on {topic} is not set (sec = 0)", "a stamp is not set")
    where = "in the future" if late > 0 else "in the past"
    message = f"header.stamp on {topic} is {number(abs(late), 's')} {where}, expected the time of publishing"
    return Problem(message, f"a stamp is {where}")


def _message(
    evidence: Evidence, topic: str, fields: dict[str, Any], tolerance: float, unit: str
) -> list[Problem]:
    came = evidence.messages(topic)
    if not came:
        return [nothing_on(evidence, topic)]
    last = to_plain(came[-1][1])
    problems = []
    for dotted, expected in fields.items():
        value = last
        for part in dotted.split("."):
            value = value.get(part) if isinstance(value, dict) else None
        problems += compare(value, expected, tolerance, unit, dotted)
    return problems
