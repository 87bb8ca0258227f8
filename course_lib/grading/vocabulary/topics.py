"""Checks of any topic: existence, rate and gaps, stamps, fields, diagnostics and reported facts."""

import hashlib
import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from itertools import pairwise
from statistics import median
from typing import Any

from course_lib.displays.images import is_supported, row_bytes
from course_lib.errors import CourseError, format_count
from course_lib.grading.evidence import Check, Evidence
from course_lib.grading.run.outcome import RAISED, plain
from course_lib.grading.task import resolve
from course_lib.grading.vocabulary.check_function import (
    Problem,
    check_function,
    format_number,
    is_close,
    name_hint,
    received_messages,
)
from course_lib.grading.vocabulary.markers import ADD, SHORT_LIFETIME, bound_marker, iter_markers, lifetime
from course_lib.grading.vocabulary.values import compare
from course_lib.ros.graph.graph import START_NS
from course_lib.ros.messages import to_plain, type_name

LONGEST_GAP = 2  # maximum gap between two messages, in periods of the rate
DELIVERY = 0.05  # [s] allowed delay from publishing to recording
LIFETIME_MARGIN = 0.05  # of a period, by which a lifetime may be too short
STATING = ("expect_rate", "expect_throughout")
NOT_ALL_THE_TIME = "a topic is not published all the time"
FALLS_SILENT = "a topic falls silent temporarily"


def find_silence(
    evidence: Evidence,
    topic: str,
    times: Iterable[float],
    noun: str,
    *,
    hz: float | None = None,
    begin: float | None = None,
    end: float | None = None,
) -> Iterator[Problem]:
    """Yield a problem for the first gap that is longer than the rate allows.

    Args:
        evidence: The evidence of the scenario.
        topic: The topic whose stated rate applies.
        times: Times of the messages [s] after the start.
        noun: The subject of the problem's message.
        hz: The rate [1/s]. None means the lowest rate that the scenario states for the topic or, without
            one, the usual rate of the messages; then no gap may exceed half of the scenario.
        begin: Time [s] from which messages are expected. None means the time that the scenario
            states.
        end: Time [s] until which messages are expected. None means the end of the scenario.
    """
    stated = [
        resolve(check.origin.arguments, evidence.personal)
        for check in evidence.checks
        if check.origin
        and check.origin.check_function in STATING
        and check.origin.arguments["topic"] == topic
    ]
    rates = [row for row in stated if row["hz"] is not None]
    if begin is None:
        begin = min((row["begin"] for row in rates or stated), default=0.0)
    end = evidence.seconds if end is None else end
    hz = hz or min((row["hz"] for row in rates), default=None)
    arrivals = sorted({seconds for seconds in times if begin - DELIVERY <= seconds <= end})  # [s]
    gaps = [after - before for before, after in pairwise(arrivals)]  # [s]
    usual = min(LONGEST_GAP * median(gaps), evidence.seconds / 2) if gaps else evidence.seconds / 2
    max_gap = (LONGEST_GAP / hz if hz else usual) + DELIVERY  # [s]
    if len(gaps) > 1 and min(gaps) > max_gap:
        period, limit = format_number(median(gaps), "s"), format_number(max_gap, "s")
        message = f"{noun} is published every {period}, expected messages at most {limit} apart"
        yield Problem(message, "a topic is published too slowly")
        return
    for before, after in pairwise((begin, *arrivals, end)):
        if after - before > max_gap:
            message = f"{noun} is silent from {format_number(before, 's')} to {format_number(after, 's')}"
            expected = f"expected messages all the time, at most {format_number(max_gap, 's')} apart"
            yield Problem(f"{message}, {expected}", NOT_ALL_THE_TIME)
            return


IMAGE = "sensor_msgs/msg/Image"
MARKER_MESSAGE = "visualization_msgs/msg/Marker"
KEPT = 1 << 20  # [B] images up to this size are always recorded with their pixels


@check_function("publishes {type} on {topic}")
def expect_topic(
    evidence: Evidence,
    topic: str,
    type: str,  # noqa: A002 - ROS says type
    *,
    at_least: int = 1,
    at_most: int | None = None,
) -> Iterable[Problem]:
    """Expect at least `at_least` and at most `at_most` messages of this type on the topic."""
    messages = received_messages(evidence, topic)
    strange = [type_name(message) for _, message in messages if type_name(message) != type]
    if strange:
        return [Problem(f"{topic} carries {strange[0]}, expected {type}", "a topic has the wrong type")]
    message = f"{format_count(len(messages), 'message')} on {topic} in {evidence.seconds:g} s, expected "
    if len(messages) < at_least:
        return [Problem(f"{message}at least {at_least}", "too few messages on a topic")]
    if at_most is not None and len(messages) > at_most:
        return [Problem(f"{message}at most {at_most}", "too many messages on a topic")]
    return []


@check_function("the rate of {topic}")
def expect_rate(
    evidence: Evidence,
    topic: str,
    hz: float,
    *,
    tolerance: float = 0.1,
    begin: float = 0.0,
    end: float | None = None,
    by_marker: bool = False,
) -> Iterable[Problem]:
    """Expect the rate `hz` [1/s] within the relative `tolerance`, from `begin` to `end` [s].

    Messages with equal times count once, and have to differ in a name, a frame or an id, like the
    markers of one callback. With `by_marker`, each marker needs this rate, by its ns and id;
    markers that are published once only count as in a topic without `by_marker`. A marker's
    lifetime must not be shorter than the period, or the marker blinks.
    """
    end = evidence.seconds if end is None else end
    received = [pair for pair in received_messages(evidence, topic) if begin <= pair[0] <= end]
    times = sorted({seconds for seconds, _ in received})  # [s]
    if not times:
        message = f"nothing was published on {topic} from {begin:g} to {end:g} s"
        return [Problem(message, FALLS_SILENT)]
    if len(times) == 1:
        message = f"{topic} was published once in {end - begin:g} s, expected {format_number(hz, 'Hz')}"
        return [Problem(message, "a topic is published only once")]
    paths: dict[tuple[str, int], set[float]] = {}
    for seconds, marker in iter_markers(evidence, topic) if by_marker else ():
        if begin <= seconds <= end and marker.action == ADD:
            paths.setdefault((marker.ns, marker.id), set()).add(seconds)
    repeated = {key: sorted(path) for key, path in paths.items() if len(path) > 1}
    if found := _repetition_problems(received, topic):
        return found
    for (ns, number), path in repeated.items():
        if found := _rate_problems(path, f"the marker {ns}/{number}", hz, tolerance, begin, end):
            if len(repeated) > 1 and not _rate_problems(times, topic, hz, tolerance, begin, end):
                text = f"{found[0].message}: the markers take turns"
                return [Problem(text, "markers take turns")]
            return found
    if not repeated and (found := _rate_problems(times, topic, hz, tolerance, begin, end)):
        return found
    return _blinking_problems(evidence, topic, 1 / hz)


def _blinking_problems(evidence: Evidence, topic: str, period: float) -> list[Problem]:
    """Return the problem of a marker that vanishes before the next message, after `period` [s]."""
    for _, marker in iter_markers(evidence, topic):
        if marker.action == ADD and 0 < lifetime(marker) < period * (1 - LIFETIME_MARGIN):
            every, visible = format_number(period, "s"), format_number(lifetime(marker), "s")
            text = f"the marker {marker.ns}/{marker.id} blinks: it is published every {every} "
            text += f"with a lifetime of {visible}"
            return [Problem(text, SHORT_LIFETIME)]
    return []


def _repetition_problems(received: list[tuple[float, Any]], topic: str) -> list[Problem]:
    """Return the problem of a topic on which most messages are published several times simultaneously."""
    by_time: dict[float, list[Any]] = {}
    for seconds, message in received:
        by_time.setdefault(seconds, []).append(message)
    crowded = {seconds: messages for seconds, messages in by_time.items() if len(messages) > 1}
    # Other callbacks may coincide once in a while.
    if 2 * len(crowded) <= len(by_time):
        return []
    counts = {
        seconds: max(Counter(tuple(_identity(to_plain(message))) for message in messages).values())
        for seconds, messages in crowded.items()
    }
    repeated = [seconds for seconds, count in counts.items() if count > 1]
    if 2 * len(repeated) <= len(by_time):
        return []
    last = max(repeated)
    text = f"{counts[last]} messages with the same names and ids are published on {topic} at "
    text += f"{format_number(last, 's')}, expected one"
    return [Problem(text, "messages repeat at one time")]


def _identity(value: Any) -> Iterator[object]:
    """Yield the names, frames and ids in a message as plain data, which identify its subject."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for key, inner in value.items():
            if key == "id":
                yield inner
            elif key != "stamp":
                yield from _identity(inner)
    elif isinstance(value, list):
        for inner in value:
            if isinstance(inner, str | dict):
                yield from _identity(inner)


def _rate_problems(
    times: list[float], noun: str, hz: float, tolerance: float, begin: float, end: float
) -> list[Problem]:
    """Return the problems of the rate of sorted times [s], of which there are at least two."""
    rate = (len(times) - 1) / (times[-1] - times[0])  # [1/s]
    if not is_close(rate, hz, tolerance * hz):
        fast = rate > hz
        message = f"{noun} is too {'fast' if fast else 'slow'}: {format_number(rate, 'Hz')}"
        mistake = f"a topic is published too {'fast' if fast else 'slowly'}"
        return [Problem(f"{message}, expected {format_number(hz, 'Hz')}", mistake)]
    for before, after in pairwise((begin, *times, end)):
        if after - before > LONGEST_GAP / hz + 1e-6:
            message = f"{noun} is silent from {format_number(before, 's')} to {format_number(after, 's')}"
            return [Problem(message, "a topic falls silent temporarily")]
    return []


@check_function("{topic} is published the whole time")
def expect_throughout(
    evidence: Evidence,
    topic: str,
    *,
    hz: float | None = None,
    begin: float = 0.0,
    end: float | None = None,
) -> Iterable[Problem]:
    """Expect at least two messages and no gap longer than two periods of the rate `hz` [1/s].

    The gaps at the beginning and the end of the scenario, or from `begin` to `end` [s], count as
    well. Without `hz`, the lowest rate that an `expect_rate` of the scenario states for the topic
    applies; without any, the usual time between two messages.
    """
    times = sorted({seconds for seconds, _ in received_messages(evidence, topic)})  # [s]
    if len(times) == 1:
        often = f"{topic} was published only once in {evidence.seconds:g} s"
        return [Problem(f"{often}, expected messages the whole time", "a topic is published only once")]
    # The default 0 must not replace the start time that a stated rate may have.
    first_second = begin or None
    return find_silence(evidence, topic, times, topic, hz=hz, begin=first_second, end=end)


@check_function("nothing on {topic} before {begin} s")
def expect_nothing_before(evidence: Evidence, topic: str, begin: float) -> Iterable[Problem]:
    """Expect messages on a topic, the first one not before the time `begin` [s]."""
    first, _ = received_messages(evidence, topic)[0]
    actual, expected_text = format_number(first, "s"), format_number(begin, "s")
    message = f"{topic} was published after {actual}, expected nothing before {expected_text}"
    return [Problem(message, "a message comes too early")] if first < begin else []


@check_function("the images on {topic} have pixels")
def expect_images(evidence: Evidence, topic: str) -> Iterable[Problem]:
    """Expect images with pixels in a known encoding, and data of the right length in the first image."""
    images = [image for _, image in received_messages(evidence, topic, IMAGE)]
    empty = [image for image in images if not (image.width and image.height)]
    if empty:
        message = f"an image on {topic} has {empty[0].width} x {empty[0].height} pixels"
        return [Problem(message, "an image has no pixels")]
    if unknown := [image.encoding for image in images if not is_supported(image.encoding)]:
        message = f"an image on {topic} has the encoding {unknown[0]!r}, which RViz cannot draw"
        return [
            Problem(f"{message}, expected 'mono8', 'rgb8' or similar", "the encoding of an image is unknown")
        ]
    # Later images may be recorded without their pixels.
    first, size = images[0], images[0].step * images[0].height
    if first.step < (needed := row_bytes(first.encoding, first.width)):
        row = f"{first.width} pixels of {first.encoding!r} in {first.step} bytes (step)"
        message = f"the first image on {topic} has rows of {row}, expected {needed} or more"
        return [Problem(message, "the data of an image has the wrong length")]
    if size < KEPT and len(first.data) != size:
        message = f"{len(first.data)} bytes of data for {first.height} rows of {first.step} bytes (step)"
        return [
            Problem(f"the first image on {topic} has {message}", "the data of an image has the wrong length")
        ]
    return []


@check_function("the frame of {topic}")
def expect_frame(evidence: Evidence, topic: str, frame: str) -> Iterable[Problem]:
    """Expect this frame in all messages on the topic, and in all markers that they add."""
    for _, message in _stamped_messages(evidence, topic):
        if message.header.frame_id != frame:
            noun = type_name(message).split("/")[-1]
            problem = f"a {noun} on {topic} is in frame {message.header.frame_id!r}, expected {frame!r}"
            problem += name_hint(message.header.frame_id, frame)
            return [Problem(problem, "the frame of a message is wrong")]
    return []


@check_function("the stamps on {topic}")
def expect_stamps(
    evidence: Evidence, topic: str, *, tolerance: float = 0.05, delay: float = 0.0
) -> Iterable[Problem]:
    """Expect the robot time of publication in the stamp of each header, within a tolerance [s].

    Stamps of markers that delete are not checked. With `delay` a task copies the stamps of its
    input, which are `delay` [s] earlier: the time of publishing is then a mistake.
    """
    for seconds, message in _stamped_messages(evidence, topic):
        stamp = message.header.stamp
        lateness = stamp.sec - START_NS // 10**9 + stamp.nanosec / 1e9 - seconds  # [s]
        if stamp.sec == 0:
            # A stamp that belongs to the input must not be set to the time of publishing.
            mistake = "a stamp is not copied" if delay else "a stamp is not set"
            return [Problem(f"header.stamp on {topic} is not set (sec = 0)", mistake)]
        if delay and not is_close(lateness, -delay, tolerance):
            by = format_number(abs(lateness + delay), "s")
            how = "later" if lateness > -delay else "earlier"
            message = f"header.stamp on {topic} is {by} {how} than the stamp of the input"
            return [Problem(message, "a stamp is not the expected one")]
        if not delay and not is_close(lateness, 0.0, tolerance):
            where = "in the future" if lateness > 0 else "in the past"
            by = format_number(abs(lateness), "s")
            message = f"header.stamp on {topic} is {by} {where}, expected the time of publishing"
            return [Problem(message, f"a stamp is {where}")]
    return []


def _stamped_messages(evidence: Evidence, topic: str) -> list[tuple[float, Any]]:
    """Return (time since start [s], message or marker with a header), except markers that delete.

    Raises:
        Problem: No marker is added, or the type has no header.
    """
    parts = [
        (seconds, part)
        for seconds, message in received_messages(evidence, topic)
        for part in getattr(message, "markers", [message])
        if getattr(part, "action", ADD) == ADD
    ]
    if not parts:
        raise Problem(f"no marker is added on {topic}", "no marker is added")
    for _, part in parts:
        if not hasattr(part, "header"):
            raise Problem(f"{type_name(part)} on {topic} has no header", "a topic has the wrong type")
    return parts


@check_function("the last message on {topic}")
def expect_message(
    evidence: Evidence,
    topic: str,
    fields: dict[str, Any],
    *,
    tolerance: float = 1e-3,
    unit: str = "",
) -> Iterator[Problem]:
    """Expect fields of the last message, given by dotted paths: `{"header.frame_id": "map"}`.

    A number in a path is an index in a list: `"status.0.name"`. If other checks of the scenario
    judge one marker of the topic, the last message is the last one of that marker.
    """
    last = received_messages(evidence, topic)[-1][1]
    if type_name(last) == MARKER_MESSAGE and (marker := bound_marker(evidence, topic)):
        last = marker
    last = to_plain(last)
    for dotted, expected in fields.items():
        value = last
        for part in dotted.split("."):
            if isinstance(value, list):
                value = dict(enumerate(value)).get(int(part)) if part.isdecimal() else None
            else:
                value = value.get(part) if isinstance(value, dict) else None
        if dotted.endswith("stamp.nanosec") and isinstance(value, int):
            name = f"the fraction of a second in {dotted.removesuffix('.nanosec')}"
            for problem in compare(value / 1e9, expected / 1e9, tolerance / 1e9, "s", name):
                yield Problem(problem.message, "a stamp is not the expected one")
        else:
            is_frame = dotted.endswith("header.frame_id") and isinstance(value, str)
            for problem in compare(plain(value), plain(expected), tolerance, unit, dotted):
                yield Problem(problem.message, "the frame of a message is wrong") if is_frame else problem


RATE_TOLERANCE = 0.03  # relative tolerance of a measured rate
# The command that shows each fact.
TOOLS = {
    "image_rate": "ros2 topic hz",
    "image_width": "ros2 topic echo --once --field width",
    "scan_reliability": "ros2 topic info -v",
    "threshold": "ros2 param get",
    "trigger_service": "ros2 service list -t",
}
# By serial number, in the order of TOOLS. The facts are hashed, so that students cannot read them
# here.
DIGESTS = {
    11: ("f06190ebd5c4", "9685b57aa459", "407dd88dea80", "92c3b72a2be4", "e62db038f7e6"),
    17: ("96e66dd4419d", "c3cbf854c757", "c42f5e198a68", "b19a75f4fbf7", "a386aa2832f3"),
    23: ("6a99899b5c54", "3d4562ebb768", "27cc6c8afd0e", "25ac2c164041", "014cec068eab"),
    26: ("a90f44d11172", "82a418f15101", "d90a3a9b6be0", "ab0a72b4df3f", "3d28b5a38f66"),
    32: ("1e85461cc1a2", "c6cab8684d01", "dd73fc64bbeb", "105650a70ebc", "fe78d6922466"),
    38: ("c29bba8bbc84", "deee80423aad", "6346e7c05574", "2949d3e91ab8", "6dd554a6d64a"),
    44: ("c8b1526c913b", "b3b5959e8bd0", "81ea1b441ba2", "d5d1b6e602ec", "9f896fd162b3"),
    47: ("8c65af9efb72", "83949fab6212", "8a02c35cd34b", "ee53d0678098", "ca9f6406ddf5"),
    53: ("e973230868bd", "1426e0d4c653", "975b03510946", "4b3f95d3a84d", "2b3f04d8aa52"),
    59: ("3358af9e9a60", "d4cfbbc409ca", "1fbf0ce9661a", "02ef1861f62f", "2c5396c5aad4"),
    62: ("87cc069c09bd", "11a4d249d92e", "cc535e4b09e1", "8cf723a14c7a", "cf094cc2705e"),
    68: ("0cda77411ec5", "4d83f6a06f88", "c7789e1e13f5", "6e6a18d4859b", "4683c9ee2c60"),
}
TOPIC, ARRAY = "/diagnostics", "diagnostic_msgs/msg/DiagnosticArray"
LEVELS = ("OK", "WARN", "ERROR", "STALE")
MAX_KEYS = 120  # limit on the characters of the keys in a message
LAST_WEIGHT = 0.3  # relative weight of the last part
SETTLED = 1.005  # [s] delay until a part of the run appears in a report that is published every second


def digest(serial: int, name: str, value: float | str) -> str:
    """Return the hash of a fact, as stored in the table."""
    text = repr(value) if isinstance(value, str) else f"{value:.6g}"
    return hashlib.blake2b(f"{serial} {name} {text}".encode(), digest_size=6).hexdigest()


def is_fact(serial: int, name: str, value: Any) -> bool:
    """Return whether a robot has this value, with a relative RATE_TOLERANCE for rates.

    Raises:
        CourseError: The table has no robot with this serial number.
    """
    if serial not in DIGESTS:
        raise CourseError(
            f"there are no facts about robot {serial}, only about {', '.join(map(str, DIGESTS))}"
        )
    expected = DIGESTS[serial][list(TOOLS).index(name)]
    possible: Iterable[float | str] = [value]
    if isinstance(value, str):
        possible = [value.strip()]
    elif not isinstance(value, int | float) or isinstance(value, bool) or not 0 <= value <= 1e6:
        return False
    elif name == "image_rate":
        # The rates of robots are integers.
        low, high = value / (1 + RATE_TOLERANCE), value / (1 - RATE_TOLERANCE)
        possible = range(math.ceil(low), math.floor(min(high, low + 100)) + 1)
    return any(digest(serial, name, fact) == expected for fact in possible)


@check_function("{level}, {says}")
def expect_level(
    evidence: Evidence,
    level: str,
    *,
    says: str,
    begin: float,
    end: float,
) -> Iterable[Problem]:
    """Expect one status per second from `begin` to `end` [s], with this level and `says` in its message."""
    arrays = received_messages(evidence, TOPIC, ARRAY)
    lists = [list(m.status) for at, m in arrays if begin + SETTLED <= at <= end + SETTLED - 1]
    statuses = [status for together in lists for status in together]
    when = f"from {begin:g} to {end:g} s"
    if not statuses:
        return [Problem(f"no status was published {when}", "a status is missing")]
    if surplus := max(len(together) for together in lists) - 1:
        message = f"a message has {surplus + 1} statuses {when}, expected one"
        return [Problem(message, "a message has more than one status")]
    reports = [at for at, m in arrays if len(m.status)]
    for gap in find_silence(
        evidence, TOPIC, reports, TOPIC, hz=1.0, begin=begin + SETTLED, end=end + SETTLED - 1
    ):
        return [Problem(gap.message, "a status is missing")]
    for status in statuses:
        number = status.level[0]
        # A student may publish the character b"0", whose number is 48.
        reported = LEVELS[number] if number < len(LEVELS) else f"{number}, which is not a level,"
        if reported != level:
            return [Problem(f"the level is {reported} {when}, expected {level}", "a level is wrong")]
        if says not in status.message.lower():
            message = f"the message is {status.message!r} {when}: it lacks {says!r}"
            return [Problem(message, "a status message lacks an expected word")]
    return []


def expect_levels(*parts: tuple[str, str, str], seconds: float = 3.0) -> tuple[Check, ...]:
    """Return a check for each of `parts`: (level, word in its message, title), each `seconds` [s] long.

    The first part requires the last one, and all others require the first, so that a constant level
    gets few points.
    """
    first, *middle_checks, last = (
        expect_level(level, says=says, begin=seconds * n, end=seconds * (n + 1)).titled(title)
        for n, (level, says, title) in enumerate(parts)
    )
    first = first.requiring(last)
    return (first, *(other.requiring(first) for other in middle_checks), last.worth(LAST_WEIGHT))


@check_function("{name}")
def expect_fact(evidence: Evidence, name: str, *, serial: int) -> Iterable[Problem]:
    """Expect a dict with the fact `name` about the robot `serial`, rates within 3 %.

    Messages never reveal the expected value.
    """
    facts: Any = evidence.returns[0] if evidence.returns else None
    if facts == RAISED:
        return [Problem(f"{name} is missing: the call raised an exception", "a value is missing")]
    is_object = isinstance(facts, dict) and list(facts) == ["object"]
    if not isinstance(facts, dict) or is_object:
        type_text = type(facts).__name__
        with_article = f"{'an' if type_text == 'int' else 'a'} {type_text}"
        kind = "nothing" if facts is None else facts["object"] if is_object else with_article
        message = f"{kind} was returned, expected a dict with the key {name!r}"
        return [Problem(message, "a value is of the wrong kind")]
    if name not in facts:
        own = f"only {', '.join(map(repr, facts))}"[:MAX_KEYS] if facts else "it is empty"
        return [Problem(f"the returned dict has no key {name!r}, {own}", "a fact is missing")]
    if is_fact(serial, name, facts[name]):
        return []
    value = facts[name]
    if isinstance(value, dict) and list(value) == ["object"]:
        kind = value["object"].replace("a ellipsis", "...")
        # A student who looks the policy up in Python has a constant, whose name is meant.
        is_constant = kind.endswith("Policy")
        asked = "its name as a string in quotes" if is_constant else "a value in its place"
        message = f"{name} is {kind}, expected {asked}"
        return [Problem(message, "a value is of the wrong kind")]
    if isinstance(value, str) and (number := re.fullmatch(r"\s*\d*[.,]?\d+\s*([A-Za-z]*)\s*", value)):
        unit = " and without a unit" if number[1] else ""
        message = f"{name} is {facts[name]!r}, a string; expected a number: write it without quotes{unit}"
        return [Problem(message, "a value is of the wrong kind")]
    bare = value.strip().strip("/") if isinstance(value, str) else ""
    # The spelling of constants, and the full name.
    spellings = [re.sub(r"[\s-]+", "_", bare).upper(), f"/{bare}", f"/robot/{bare}"]
    if isinstance(value, str) and any(is_fact(serial, name, text) for text in spellings):
        message = f"{name} is {value!r}: {TOOLS[name]} spells it differently, letter by letter"
        return [Problem(message, "a fact about the robot is wrong")]
    words = value.split()[:5] if isinstance(value, str) else []
    numbers = [float(word) for word in words if re.fullmatch(r"\d*\.?\d+", word)]
    if any(is_fact(serial, name, part) for part in (*words, *numbers)):
        message = f"{name} is {value!r}, a line of {TOOLS[name]}: copy only the value from it"
        return [Problem(message, "a fact about the robot is wrong")]
    message = f"{name} is {facts[name]!r}, but your robot has another value. Check with {TOOLS[name]}"
    return [Problem(message, "a fact about the robot is wrong")]
