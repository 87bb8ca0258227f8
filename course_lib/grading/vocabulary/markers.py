"""Checks of the markers that a topic shows.

A task states the shape, position and color of a marker in several checks. If each check searched
the topic separately, three wrong markers would pass three checks, and a node that publishes every
height of a personal table would match the student's value. So the checks on one topic at one moment
are grouped into subjects, each subject is bound once to the marker that earns the most points, and
every property is judged on that marker.

- Checks that contradict each other, like two ids or two colors, belong to different subjects.

- A check without such a contradiction applies to every subject: all labels have letters of one
size.

- Markers beyond the required number are surplus. Then checks with a personal value fail, because
one of many values is not an answer. If everything else is right, and no `expect_marker_count`
fails, the last check of a marker fails, so that surplus markers always cost something.
"""

import math
import re
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from numbers import Real
from typing import Any

from course_lib.errors import format_count
from course_lib.grading.evidence import Check, Evidence
from course_lib.grading.run.outcome import plain
from course_lib.grading.task import My, resolve
from course_lib.grading.vocabulary.check_function import (
    CHOICES,
    Problem,
    are_angles_close,
    check_function,
    describe_offset,
    format_angle,
    format_number,
    format_numbers,
    is_close,
    name_hint,
    silent_topic_problem,
    yaw_of,
)
from course_lib.ros.messages import type_name

TYPES = (  # by the number in Marker.type
    "ARROW", "CUBE", "SPHERE", "CYLINDER", "LINE_STRIP", "LINE_LIST", "CUBE_LIST", "SPHERE_LIST",
    "POINTS", "TEXT_VIEW_FACING", "MESH_RESOURCE", "TRIANGLE_LIST", "ARROW_STRIP",
)  # fmt: skip
MARKER_MESSAGES = ("visualization_msgs/msg/Marker", "visualization_msgs/msg/MarkerArray")
ADD, DELETE, DELETE_ALL = 0, 2, 3
EACH_COLORED = ("LINE_STRIP", "LINE_LIST", "CUBE_LIST", "SPHERE_LIST", "POINTS", "TRIANGLE_LIST")
NEEDED_SCALES = {
    "LINE_STRIP": "x",
    "LINE_LIST": "x",
    "POINTS": "xy",
    "TEXT_VIEW_FACING": "z",
    # All other types have three axes.
}
INVISIBLE = "a marker is invisible"
MARGIN = 0.1  # [s]


def type_of(marker: Any) -> str:
    """Return the name of a marker's type, "CUBE"."""
    return TYPES[marker.type] if 0 <= marker.type < len(TYPES) else f"unknown type {marker.type}"


def matches(marker: Any, *expected: Any) -> bool:
    """Return whether a marker has this type name, namespace and id; None matches any value."""
    actual = (type_of(marker), marker.ns, marker.id)
    return all(value in (None, actual_value) for value, actual_value in zip(expected, actual, strict=True))


def iter_markers(evidence: Evidence, topic: str) -> Iterator[tuple[float, Any]]:
    """Yield (time since the start [s], marker) for every published marker."""
    for seconds, message in evidence.messages(topic):
        if type_name(message) in MARKER_MESSAGES:
            for marker in getattr(message, "markers", [message]):
                yield seconds, marker


def visible_markers(
    evidence: Evidence, topic: str, at: float | None = None, *, margin: bool = False
) -> list[Any]:
    """Return the markers that are displayed `at` [s] or at the end.

    With `margin`, a marker whose lifetime ends within MARGIN is excluded, because the next one
    replaces it.
    """
    now = evidence.seconds if at is None else at  # [s]
    begin = MARGIN if margin else -1e-6  # [s] minimum remaining lifetime
    markers: dict[tuple[str, int], Any] = {}
    for seconds, marker in iter_markers(evidence, topic):
        if seconds > now:
            break
        if marker.action == ADD:
            markers[marker.ns, marker.id] = marker
            if 0 < lifetime(marker) < now - seconds + begin:
                # The lifetime has expired, and no later message has renewed it.
                del markers[marker.ns, marker.id]
        elif marker.action == DELETE:
            markers.pop((marker.ns, marker.id), None)
        elif marker.action == DELETE_ALL:
            markers.clear()
    return list(markers.values())


def lifetime(marker: Any) -> float:
    """Return a marker's lifetime [s]; 0 means unlimited."""
    return float(marker.lifetime.sec + marker.lifetime.nanosec / 1e9)


def describe_moment(at: float | None) -> str:
    """Describe the time `at` [s], "after 1.00 s"; None is the end."""
    return "at the end" if at is None else f"after {format_number(at, 's')}"


def no_markers_problem(evidence: Evidence, topic: str, at: float | None = None) -> Problem:
    """Return the problem of a topic that shows no marker `at` [s] or at the end."""
    if topic not in evidence.topics:
        return silent_topic_problem(evidence, topic)
    if evidence.topics[topic] not in MARKER_MESSAGES:
        message = f"{topic} carries {evidence.topics[topic]}, expected {' or '.join(MARKER_MESSAGES)}"
        return Problem(message, "a topic has the wrong message type")
    why = "all were deleted, or their lifetime is over"
    actions = {marker.action for _, marker in iter_markers(evidence, topic)}
    if ADD not in actions:
        why = f"none was added{_describe_actions(actions)}"
    if at is not None and not any(seconds <= at for seconds, _ in iter_markers(evidence, topic)):
        why = "the first one is published later"
    mistake = "no marker is left at the end" if at is None else "no marker is shown in between"
    return Problem(f"{topic} shows no marker {describe_moment(at)}: {why}", mistake)


def _describe_actions(actions: Collection[int]) -> str:
    """Return the end of a message about markers whose actions are all wrong, or ""."""
    names = {DELETE: "DELETE (2)", DELETE_ALL: "DELETEALL (3)"}
    if not actions or ADD in actions:
        return ""
    return f"; action is {' or '.join(names.get(a, str(a)) for a in sorted(actions))}, not ADD (0)"


def invisibility_reason(marker: Any) -> str:
    """Return the reason why a marker is invisible, or "" if RViz draws it."""
    kind = type_of(marker)
    has_mesh_materials = marker.mesh_use_embedded_materials and kind == "MESH_RESOURCE"
    alphas = [color.a for color in marker.colors if kind in EACH_COLORED] or [marker.color.a]
    if not has_mesh_materials and not max(alphas) > 0:
        return f"color.a is {max(alphas):g}"
    needed_axes = "xy" if kind == "ARROW" and marker.points else NEEDED_SCALES.get(kind, "xyz")
    if none := [axis for axis in needed_axes if not abs(getattr(marker.scale, axis)) > 0]:
        return f"scale.{none[0]} is 0"
    if kind == "TEXT_VIEW_FACING" and not marker.text.strip():
        return "its text is empty"
    return "it has no points" if kind in EACH_COLORED and not len(marker.points) else ""


Arguments = Mapping[str, Any]
# Return the problems of a marker; without a marker, the problems of the best-fitting one ever
# added.
Find = Callable[[Evidence, Arguments, Any], list[Problem]]

MARKER, CIRCLE, COUNT = "expect_marker", "expect_circle", "expect_marker_count"
CHOICES.update({(name, "type"): TYPES for name in (MARKER, CIRCLE, COUNT)})
SELECTING = ("topic", "at", "tolerance", "allow_others")  # arguments that are not a property of a marker
SAME_TOLERANCE = 1e-6  # tolerance within which the numbers of two checks are equal
MOST_MARKERS = 2_000  # limit on the markers of a topic that are compared with each check
FULL_WEIGHT = 1.0  # weight of a check that was not reduced, as for formal checks
WRONG_TYPE = "the type of a marker is wrong"
WRONG_NAME = "ns or id of a marker is wrong"
WRONG_COUNT = "the count is wrong"
REPEATED = "a marker is twice in one array"
REPLACED = "markers with the same ns and id replace each other"
SHORT_LIFETIME = "no marker is shown in between"
SURPLUS = "a topic shows more markers than the task asks for"


@dataclass(frozen=True)
class ResolvedCheck:
    """A check of a marker, with the student's personal values in its arguments.

    Args:
        check_function: The name of the check function.
        arguments: The arguments by name, as plain data.
        weight: The check's weight plus that of all checks which require it.
        is_personal: Whether an argument is a personal value.
    """

    check_function: str
    arguments: Arguments
    weight: float = 1.0
    is_personal: bool = False

    def contradicts(self, other: "ResolvedCheck") -> bool:
        """Return whether no marker can satisfy both checks."""
        names = (self.arguments.keys() & other.arguments.keys()) - set(SELECTING)
        return any(not _are_compatible(self.arguments[name], other.arguments[name]) for name in names)


def judge_marker(evidence: Evidence, name: str, arguments: Arguments) -> list[Problem]:
    """Return the problems of one check, judged on the marker that its subject is bound to."""
    own_check = ResolvedCheck(name, {key: plain(value) for key, value in arguments.items()})
    scene = _scene(evidence, own_check.arguments["topic"], own_check.arguments.get("at"))
    call = (own_check.check_function, own_check.arguments)
    index = next(
        (i for i, check in enumerate(scene.asked) if (check.check_function, check.arguments) == call), None
    )
    if index is None:
        # The check was called on its own, not as part of a scenario.
        scene, index = MarkerScene(evidence, scene.topic, scene.at, (own_check,), (), is_whole=False), 0
    return scene.problems(index)


def bound_marker(evidence: Evidence, topic: str) -> Any:
    """Return the marker that a topic's checks are bound to at the end, or None without a single subject."""
    scene = _scene(evidence, topic, None)
    only = len(scene.subjects) == 1 and scene.markers
    return scene.markers[scene.bindings[0]] if only else None


def _are_compatible(first: Any, second: Any) -> bool:
    """Return whether one marker can satisfy two values of an argument; None means any value."""
    if first is None or second is None:
        return True
    if isinstance(first, Real) and isinstance(second, Real):
        return math.isclose(first, second, abs_tol=SAME_TOLERANCE)
    if isinstance(first, list) and isinstance(second, list):
        # A color may be given with or without alpha.
        is_color = len(first) != len(second) and {len(first), len(second)} == {3, 4}
        return (len(first) == len(second) or is_color) and all(map(_are_compatible, first, second))
    return bool(first == second)


def is_personal(value: Any) -> bool:
    """Return whether a value or a part of it is `my(...)`."""
    if isinstance(value, Mapping):
        return any(map(is_personal, value.values()))
    return isinstance(value, My) or (isinstance(value, list | tuple) and any(map(is_personal, value)))


class MarkerScene:
    """The markers of a topic at one moment, with the checks that apply to them.

    Args:
        evidence: The evidence of the scenario.
        topic: The topic of the markers.
        at: The moment [s]; None is the end.
        checks: The checks of single markers.
        counts: The checks of the number of markers.
        is_whole: Whether these are all checks of the scenario, so that surplus markers can be
            detected.
    """

    def __init__(
        self,
        evidence: Evidence,
        topic: str,
        at: float | None,
        checks: Sequence[ResolvedCheck],
        counts: Sequence[ResolvedCheck],
        *,
        is_whole: bool = True,
    ) -> None:
        self.topic, self.at, self.asked = topic, at, tuple(checks)
        self._evidence, self._counts, self._is_whole = evidence, counts, is_whole
        self._problem_cache: dict[tuple[int, int], list[Problem]] = {}

    @cached_property
    def visible_markers(self) -> list[Any]:
        """The markers that the topic shows, without expiring ones that newer ones replace.

        A marker whose lifetime ends within MARGIN gives way to one of its namespace and type that
        stays, and is not compared with the checks either: otherwise one could show an answer for
        each personal value.
        """
        there = visible_markers(self._evidence, self.topic, self.at)
        if len(there) <= self.allowed:
            return there
        fresh = visible_markers(self._evidence, self.topic, self.at, margin=True)
        stay, renewed = {(m.ns, m.id) for m in fresh}, {(m.ns, m.type) for m in fresh}
        return [m for m in there if (m.ns, m.id) in stay or (m.ns, m.type) not in renewed]

    @property
    def markers(self) -> list[Any]:
        """The markers that the topic shows."""
        return self.visible_markers[:MOST_MARKERS]

    @cached_property
    def allowed(self) -> int:
        """The number of markers that the checks require."""
        counts: dict[str | None, int] = {c.arguments["type"]: c.arguments["count"] for c in self._counts}
        return max(counts.get(None, sum(counts.values())), len(self.subjects))

    @cached_property
    def shared_checks(self) -> frozenset[int]:
        """Indices of the checks that apply to every subject."""
        indices = range(len(self.asked))
        clash = [any(self.asked[i].contradicts(self.asked[other]) for other in indices) for i in indices]
        return frozenset(i for i in indices if any(clash) and not clash[i])

    @cached_property
    def subjects(self) -> list[list[int]]:
        """The indices of each subject's checks, without checks that apply to every subject."""
        groups: list[list[int]] = []
        for index in range(len(self.asked)):
            if index not in self.shared_checks:
                fitting = (
                    group
                    for group in groups
                    if not any(self.asked[index].contradicts(self.asked[other]) for other in group)
                )
                subject = next(fitting, None)
                if subject is None:
                    groups.append([index])
                else:
                    subject.append(index)
        return groups

    @cached_property
    def bindings(self) -> list[int]:
        """For each subject, the index of the marker that earns the most points."""
        return [
            min(range(len(self.markers)), key=lambda marker: self._misfit_key(subject, marker))
            for subject in self.subjects
        ]

    @cached_property
    def surplus(self) -> str:
        """An error message if the topic shows more markers than the task requires, else ""."""
        if not self._is_whole or any(check.arguments["allow_others"] for check in self.asked):
            return ""
        there = sum(not invisibility_reason(marker) for marker in self.visible_markers)
        if there <= self.allowed:
            return ""
        asks = f"expected at most {self.allowed}"
        remedy = "remove the others, because it is unclear which one is your answer"
        return (
            f"{self.topic} shows {format_count(there, 'marker')} {describe_moment(self.at)}, {asks}: {remedy}"
        )

    def problems(self, index: int) -> list[Problem]:
        """Return the problems of one check: with its own marker, or with surplus markers."""
        if not self.markers:
            if self.asked[index].check_function == CIRCLE:
                return FINDERS[CIRCLE](self._evidence, self.asked[index].arguments, None)
            raise no_markers_problem(self._evidence, self.topic, self.at)
        if own_problems := self._own_problems(index):
            return own_problems
        return [Problem(self.surplus, SURPLUS)] if self.surplus and self._is_surplus_failure(index) else []

    def _own_problems(self, index: int) -> list[Problem]:
        owners = [
            marker
            for subject, marker in zip(self.subjects, self.bindings, strict=True)
            if index in subject or (index in self.shared_checks and not self._is_missing(subject, marker))
        ]
        if not owners:
            # All subjects are missing, so any marker may have the property.
            owners = [min(range(len(self.markers)), key=lambda marker: self._misfit_key([index], marker))]
        return next(filter(None, (self._problems(index, marker) for marker in owners)), [])

    def _is_surplus_failure(self, index: int) -> bool:
        """Return whether a check that would pass is failed because of surplus markers."""
        if self.asked[index].is_personal:
            return True
        everything = range(len(self.asked))
        payers = [i for i in everything if self.asked[i].weight > 0] or list(everything)
        payer = max(payers, key=lambda i: (min(self.asked[i].weight, FULL_WEIGHT), i))
        if index != payer or any(self.asked[i].is_personal for i in payers):
            return False
        if any(self._own_problems(i) for i in payers):
            return False
        # A failing check of the number of markers costs points already.
        shown = visible_markers(self._evidence, self.topic, self.at)
        for check in (check for check in self._counts if check.weight > 0):
            of_type = [marker for marker in shown if matches(marker, check.arguments["type"], None, None)]
            if sum(not invisibility_reason(marker) for marker in of_type) != check.arguments["count"]:
                return False
        return True

    def _is_missing(self, subject: Iterable[int], marker: int) -> bool:
        """Return whether the bound marker has a different ns or id than the subject."""
        return any(_is_misnamed(self.markers[marker], self.asked[i].arguments) for i in subject)

    def _misfit_key(self, subject: Sequence[int], marker: int) -> tuple[float, ...]:
        """Return a sort key for how badly a marker fits a subject: lost points first, then mistakes."""
        indices = [*subject, *self.shared_checks.difference(subject)]
        problems_by_check = {i: self._problems(i, marker) for i in indices}
        mistakes = [problem.mistake for problems in problems_by_check.values() for problem in problems]
        is_other = len(self.subjects) > 1 and self._is_missing(subject, marker)
        own_weight, shared = (
            sum(self.asked[i].weight for i in group if not problems_by_check[i])
            for group in (subject, indices[len(subject) :])
        )
        return (
            is_other,
            -own_weight,
            -shared,
            mistakes.count(WRONG_NAME),
            mistakes.count(WRONG_TYPE),
            len(mistakes),
        )

    def _problems(self, index: int, marker: int) -> list[Problem]:
        if (index, marker) not in self._problem_cache:
            kind, arguments = self.asked[index].check_function, self.asked[index].arguments
            if kind == MARKER and _is_misnamed(self.markers[marker], arguments):
                ns, marker_id = arguments["ns"], arguments["id"]
                sought = [f"ns {ns!r}"] * (ns is not None) + [f"id {marker_id}"] * (marker_id is not None)
                there = ", ".join(f"{shown.ns!r} {shown.id}" for shown in self.markers[:5])
                message = f"no marker with {' and '.join(sought)} on {self.topic}; it shows: {there}"
                problems = [Problem(message, WRONG_NAME)]
            else:
                problems = FINDERS[kind](self._evidence, arguments, self.markers[marker])
            self._problem_cache[index, marker] = problems
        return self._problem_cache[index, marker]


def _is_misnamed(marker: Any, arguments: Arguments) -> bool:
    return not matches(marker, None, arguments["ns"], arguments["id"])


def _scene(evidence: Evidence, topic: str, at: float | None) -> MarkerScene:
    scenes = evidence.compute_once(_scenes)
    if (topic, at) not in scenes:
        scenes[topic, at] = MarkerScene(evidence, topic, at, (), ())
    return scenes[topic, at]


def _scenes(evidence: Evidence) -> dict[tuple[str, float | None], MarkerScene]:
    """Return the scenes that the checks of a scenario refer to, by topic and time."""
    rows: dict[tuple[str, float | None], list[ResolvedCheck]] = {}
    for check in evidence.checks:
        if check.origin and check.origin.check_function in (MARKER, CIRCLE, COUNT):
            resolved = resolve_check(check, evidence.personal)
            rows.setdefault((resolved.arguments["topic"], resolved.arguments.get("at")), []).append(resolved)
    return {
        (topic, at): MarkerScene(
            evidence,
            topic,
            at,
            [check for check in checks if check.check_function != COUNT],
            [check for check in checks if check.check_function == COUNT],
        )
        for (topic, at), checks in rows.items()
    }


def resolve_check(check: Check, personal: Mapping[str, Any]) -> ResolvedCheck:
    """Return a check with the student's personal values in its arguments."""
    assert check.origin is not None
    raw_arguments = {name: value for name, value in check.origin.arguments.items() if name != "evidence"}
    arguments = {name: plain(resolve(value, personal)) for name, value in raw_arguments.items()}
    return ResolvedCheck(check.origin.check_function, arguments, check.weight, is_personal(raw_arguments))


# The comparison of a marker by check function; motion.py adds the comparison with a circle.
FINDERS: dict[str, Find] = {}


NUMBER = re.compile(r"\d+(\.\d+)?")
COLOR_TOLERANCE = 0.02  # on the scale from 0 to 1
YAW_TOLERANCE = 0.02  # [rad]
LIFETIME_TOLERANCE = 0.01  # [s]
DIRECTIONS = {
    "x": ("too far towards +x", "too far towards -x"),
    "y": ("too far towards +y", "too far towards -y"),
    "z": ("too high", "too low"),
}
COLORS = {
    "black": (0, 0, 0), "white": (1, 1, 1), "grey": (0.5, 0.5, 0.5), "red": (1, 0, 0), "green": (0, 1, 0),
    "blue": (0, 0, 1), "yellow": (1, 1, 0), "cyan": (0, 1, 1), "magenta": (1, 0, 1), "orange": (1, 0.5, 0),
    "purple": (0.5, 0, 0.5),
}  # fmt: skip
Points = Sequence[Sequence[float]]


@check_function("the marker on {topic}: {given}")
def expect_marker(
    evidence: Evidence,
    topic: str,
    *,
    type: str | None = None,  # noqa: A002 - the field's name in ROS
    ns: str | None = None,
    id: int | None = None,  # noqa: A002 - the field's name in ROS
    frame: str | None = None,
    position: Sequence[float] | None = None,
    yaw: float | None = None,
    scale: Sequence[float | None] | None = None,
    color: Sequence[float] | None = None,
    text: str | None = None,
    points: Points | None = None,
    loop: Points | None = None,
    lifetime: float | None = None,
    at: float | None = None,
    tolerance: float = 0.01,
    allow_others: bool = False,
) -> Iterable[Problem]:
    """Expect a visible marker with these fields on the topic (Marker or MarkerArray), `at` [s] or at the end.

    All checks of a scenario that may refer to one marker judge the same marker: the one that fits
    them best. Markers beyond those that the checks require cost points, unless one of the checks
    has `allow_others`. The position of the center, scale (None is any length), points (shape (N,
    3), in any order except for an arrow) and `tolerance` are in [m], yaw about z in [rad], lifetime
    in [s], color is RGB or RGBA from 0 to 1. Text and frame are compared exactly. A line strip must
    join the corners of `loop` in order, starting at any of them, in either direction, and end where
    it starts.
    """
    arguments = {name: value for name, value in locals().items() if name != "evidence"}
    return judge_marker(evidence, MARKER, arguments)


def _marker_problems(_: Evidence, arguments: Arguments, marker: Any) -> list[Problem]:
    noun = f"the {type_of(marker).removesuffix('_VIEW_FACING').lower().replace('_', ' ')}"
    marker_problems = (
        [Problem(f"{noun} is invisible: {why}", INVISIBLE)] if (why := invisibility_reason(marker)) else []
    )
    for name, (mistake, find) in PROPERTIES.items():
        if (expected := arguments[name]) is not None:
            texts = find(marker, expected, arguments["tolerance"])
            marker_problems += [Problem(f"{noun}{text}", mistake) for text in texts]
    if not marker_problems and arguments["scale"] is not None:
        texts = _compare_height(marker, arguments["tolerance"])
        marker_problems = [Problem(f"{noun}{text}", "a marker is tilted") for text in texts]
    return marker_problems


FINDERS[MARKER] = _marker_problems


@check_function("the number of markers on {topic}")
def expect_marker_count(
    evidence: Evidence,
    topic: str,
    count: int,
    *,
    type: str | None = None,  # noqa: A002 - the field's name in ROS
    at: float | None = None,
) -> Iterable[Problem]:
    """Expect `count` visible markers (of one type) on the topic, `at` [s] or at the end.

    No array may add equal markers: the second one replaces the first, so that both look like one.
    """
    if topic not in evidence.topics:
        return [silent_topic_problem(evidence, topic)]
    reasons = [
        invisibility_reason(marker)
        for marker in visible_markers(evidence, topic, at)
        if matches(marker, type, None, None)
    ]
    there, invisible_reasons = reasons.count(""), sorted(filter(None, reasons))
    if there == count:
        return _repeated_marker_problems(evidence, topic, type)
    of_type = f" of type {type}" if type else ""
    message = (
        f"{topic} shows {format_count(there, 'marker')}{of_type} {describe_moment(at)}, expected {count}"
    )
    if invisible_reasons:
        are = "is" if len(invisible_reasons) == 1 else "are"
        return [
            Problem(
                f"{message}; {len(invisible_reasons)} more {are} invisible: {invisible_reasons[0]}", INVISIBLE
            )
        ]
    why, mistake = _reason_for_missing(evidence, topic, type, at) if there < count else ("", WRONG_COUNT)
    return [Problem(message + why, mistake)]


def _repeated_marker_problems(evidence: Evidence, topic: str, kind: str | None) -> list[Problem]:
    """Return the problem of the first array that adds the same marker several times."""
    for _, message in evidence.messages(topic):
        added_markers: dict[tuple[str, int], list[Any]] = {}
        for marker in getattr(message, "markers", []):
            if marker.action == ADD and matches(marker, kind, None, None):
                added_markers.setdefault((marker.ns, marker.id), []).append(marker)
        for (ns, marker_id), markers in added_markers.items():
            # Different markers with one id lack an id each, which other checks report.
            if (times := markers.count(markers[-1])) > 1:
                noun = f"{kind} markers" if kind else "markers"
                text = f"one array on {topic} adds {times} equal {noun} with ns {ns!r} and id {marker_id}"
                return [Problem(f"{text}, expected one: is append called twice?", REPEATED)]
    return []


def _reason_for_missing(
    evidence: Evidence, topic: str, kind: str | None, at: float | None
) -> tuple[str, str]:
    """Return why a topic shows too few markers, as the end of a message and a kind of mistake."""
    now = evidence.seconds if at is None else at  # [s]
    marker_rows = [row for row in iter_markers(evidence, topic) if row[0] <= now]
    added_markers = [(seconds, marker) for seconds, marker in marker_rows if marker.action == ADD]
    if not marker_rows:
        return "; its arrays are empty", "no marker is added"
    if actions := _describe_actions({marker.action for _, marker in marker_rows}):
        return actions, "no marker is added"
    other_types = sorted({type_of(marker) for _, marker in added_markers} - {kind}) if kind else []
    if other_types and not any(type_of(marker) == kind for _, marker in added_markers):
        return f"; its markers are of type {other_types[0]}", WRONG_TYPE
    together = Counter((seconds, marker.ns, marker.id) for seconds, marker in added_markers)
    if repeated := [name for name, times in together.items() if times > 1]:
        _, ns, marker_id = repeated[-1]
        return f"; several have ns {ns!r} and id {marker_id}, and each replaces the one before", REPLACED
    if added_markers and any(0 < lifetime(marker) < MARGIN for _, marker in added_markers):
        return (
            f"; the lifetime of {format_number(lifetime(added_markers[-1][1]), 's')} is over",
            SHORT_LIFETIME,
        )
    return "", WRONG_COUNT


@check_function("the markers on {topic} are gone")
def expect_gone(evidence: Evidence, topic: str) -> Iterable[Problem]:
    """Expect markers during the scenario, but none at its end."""
    if not any(True for _ in iter_markers(evidence, topic)):
        raise silent_topic_problem(evidence, topic)
    visible_count = len(visible_markers(evidence, topic))
    message = f"{topic} still shows {format_count(visible_count, 'marker')} at the end, expected none"
    return [Problem(message, WRONG_COUNT)] if visible_count else []


def _compare_type(marker: Any, expected: str, _: float) -> Iterator[str]:
    if type_of(marker) != expected:
        yield f" is of type {type_of(marker)}, expected {expected}"


def _compare_frame(marker: Any, expected: str, _: float) -> Iterator[str]:
    frame = marker.header.frame_id
    if frame != expected:
        yield f" is in frame {frame!r}, expected {expected!r}{name_hint(frame, expected)}"


def _compare_position(marker: Any, expected: Sequence[float], tolerance: float) -> Iterator[str]:
    for (axis, directions), target in zip(DIRECTIONS.items(), expected, strict=True):
        value = getattr(marker.pose.position, axis)
        if not is_close(value, target, tolerance):
            actual, expected_text = format_number(value, "m"), format_number(target, "m")
            where = f"its centre is at {axis} = {actual}, expected {expected_text}"
            yield f" is {describe_offset(value, target, *directions)}: {where}"


def _compare_scale(
    marker: Any,
    expected: Sequence[float | None],
    tolerance: float,
) -> Iterator[str]:
    for axis, target in zip("xyz", expected, strict=True):
        value = getattr(marker.scale, axis)
        if target is not None and not is_close(value, target, tolerance):
            yield f": scale.{axis} is {format_number(value, 'm')}, expected {format_number(target, 'm')}"


def _compare_height(marker: Any, tolerance: float) -> Iterator[str]:
    """Yield a message if a standing shape is tilted, so that its height is not scale.z."""
    kind, size, q = type_of(marker), marker.scale, marker.pose.orientation
    length = math.hypot(q.x, q.y, q.z, q.w)
    # RViz2 draws a marker whose quaternion is all zeros without a rotation.
    if kind not in ("CUBE", "CYLINDER") or not 0 < length < math.inf:
        return
    x, y, z, w = (part / length for part in (q.x, q.y, q.z, q.w))
    # The z axis of the frame, as seen from the shape.
    up = (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y))
    parts = [abs(part * scale) for part, scale in zip(up, (size.x, size.y, size.z), strict=True)]
    height = sum(parts) if kind == "CUBE" else math.hypot(*parts[:2]) + parts[2]
    if not is_close(height, abs(size.z), tolerance):
        actual, expected = format_number(height, "m"), format_number(abs(size.z), "m")
        yield f" is tilted by pose.orientation: it is {actual} high, expected {expected}"


def _compare_yaw(marker: Any, expected: float, _: float) -> Iterator[str]:
    q = marker.pose.orientation
    value = yaw_of(q.x, q.y, q.z, q.w)
    if not are_angles_close(value, expected, YAW_TOLERANCE):
        message = f" is turned by {format_angle(value)} about z, expected {format_angle(expected)}"
        causes = {
            "is it in degrees instead of radians?": math.degrees(expected),
            "a quaternion holds half of the angle": 2 * expected,
            "is the angle halved twice?": expected / 2,
            "counter-clockwise is positive": -expected,
            "are z and w swapped?": math.pi - expected,
        }
        explanations = [
            cause for cause, angle in causes.items() if are_angles_close(value, angle, YAW_TOLERANCE)
        ]
        axis = max("xyz", key=lambda name: abs(getattr(q, name)))
        if axis != "z" and abs(getattr(q, axis)) > YAW_TOLERANCE:
            explanations = [f"it is turned about {axis} instead"]
        if type_of(marker) == "ARROW" and marker.points:
            explanations = ["points are another way to set a direction, and leave pose.orientation as it is"]
        yield message + "".join(f": {cause}" for cause in explanations[:1])


def _compare_color(marker: Any, expected: Sequence[float], _: float) -> Iterator[str]:
    channels = "rgba"[: len(expected)]
    value = [getattr(marker.color, channel) for channel in channels]
    if not all(is_close(v, e, COLOR_TOLERANCE) for v, e in zip(value, expected, strict=True)):
        hint = " (with a = 0 it is invisible)" if marker.color.a == 0 else ""
        hint = " (colors go from 0 to 1, not to 255)" if max(value) > 1 else hint
        for i, j in combinations(range(len(expected)), 2):
            swapped = list(value)
            swapped[i], swapped[j] = value[j], value[i]
            pairs = zip(swapped, expected, strict=True)
            if not hint and all(is_close(v, e, COLOR_TOLERANCE) for v, e in pairs):
                hint = f": {channels[i]} and {channels[j]} are exchanged"
        text = f"'s color {channels} is {_format_color(value)}, expected {_format_color(expected)}"
        yield f"{text}{hint}"


def _format_color(color: Sequence[float]) -> str:
    if not all(map(math.isfinite, color)):
        return format_numbers(color)
    name = min(COLORS, key=lambda name: math.dist(COLORS[name], color[:3]))
    return f"{format_numbers(color)} ({name})"


def _compare_text(marker: Any, expected: str, _: float) -> Iterator[str]:
    text = marker.text.strip()
    if text != expected:
        # Normalizations that each ignore one kind of difference.
        views: dict[str, Callable[[str], str]] = {
            "the spaces differ": lambda words: "".join(words.split()),
            "upper and lower case differ": str.casefold,
            "the digits of the number differ": lambda words: NUMBER.sub("0", words),
            "the punctuation around the words differs": lambda words: " ".join(re.findall(r"[\w.]+", words)),
        }
        causes = [cause for cause, view in views.items() if view(text) == view(expected)]
        if "{" in text:
            causes = ["is f missing before the quotes of the string, or is a brace doubled?"]
        yield f" reads {marker.text!r}, expected {expected!r}" + "".join(f": {why}" for why in causes[:1])


def _compare_lifetime(marker: Any, expected: float, _: float) -> Iterator[str]:
    if not is_close(lifetime(marker), expected, LIFETIME_TOLERANCE):
        actual, expected_text = format_number(lifetime(marker), "s"), format_number(expected, "s")
        yield f"'s lifetime is {actual}, expected {expected_text}"


def _compare_points(marker: Any, expected: Points, tolerance: float) -> Iterator[str]:
    points = [(p.x, p.y, p.z) for p in marker.points]
    is_arrow = type_of(marker) == "ARROW"
    has_two_ends = is_arrow and len(points) == 2
    if len(points) != len(expected):
        text = f" has {format_count(len(points), 'point')}, expected {len(expected) or 'none'}"
        if is_arrow and not expected:
            text += ": with points scale.x is the diameter of its shaft, not its length"
        yield text
    elif _are_points_equal(points, expected, tolerance):
        return
    elif has_two_ends and _are_points_equal(points[::-1], expected, tolerance):
        yield " points the other way: from the second point to the first"
    elif has_two_ends:
        for verb, point, target in zip(("begins", "ends"), points, expected, strict=True):
            if not is_close(math.dist(point, target), 0.0, tolerance):
                yield f" {verb} at {format_numbers(point)} m, expected {format_numbers(target)} m"
    elif unmatched := _find_unmatched_points(expected, points, tolerance):
        nearest = min(points, key=lambda point: _distance(point, unmatched[0]))
        yield (
            f" has no point at {format_numbers(unmatched[0])} m; the nearest is at "
            f"{format_numbers(nearest)} m"
        )
    elif strange := _find_unmatched_points(points, expected, tolerance):
        yield f" has a point at {format_numbers(strange[0])} m, which is not expected"


def _compare_loop(marker: Any, expected: Points, tolerance: float) -> Iterator[str]:
    points = [(p.x, p.y, p.z) for p in marker.points]
    if not points or not is_close(math.dist(points[0], points[-1]), 0.0, tolerance):
        yield " does not end at its first point"
        return
    turns = [[*expected[i:], *expected[: i + 1]] for i in range(len(expected))]
    ways = [way for turn in turns for way in (turn, turn[::-1])]
    if not any(_are_points_equal(points, way, tolerance) for way in ways):
        yield " does not go round from corner to corner"


def _are_points_equal(points: Points, other_points: Points, tolerance: float) -> bool:
    """Return whether both sequences have the same points in the same order."""
    pairs = zip(points, other_points, strict=False)
    return len(points) == len(other_points) and all(
        is_close(math.dist(a, b), 0.0, tolerance) for a, b in pairs
    )


def _distance(point: Sequence[float], other: Sequence[float]) -> float:
    """Return the distance of two points [m]; a point with NaN is infinitely far."""
    distance = math.dist(point, other)
    return math.inf if math.isnan(distance) else distance


def _find_unmatched_points(points: Points, candidates: Points, tolerance: float) -> list[Sequence[float]]:
    return [
        p for p in points if not any(is_close(math.dist(p, other), 0.0, tolerance) for other in candidates)
    ]


PROPERTIES: dict[str, tuple[str, Callable[[Any, Any, float], Iterator[str]]]] = {
    "type": (WRONG_TYPE, _compare_type),
    "frame": ("the frame of a marker is wrong", _compare_frame),
    "position": ("the position of a marker is wrong", _compare_position),
    "yaw": ("the orientation of a marker is wrong", _compare_yaw),
    "scale": ("the size of a marker is wrong", _compare_scale),
    "color": ("the color of a marker is wrong", _compare_color),
    "text": ("the text of a marker is wrong", _compare_text),
    "points": ("the points of a marker are wrong", _compare_points),
    "loop": ("a line does not go round from corner to corner, and back", _compare_loop),
    "lifetime": ("the lifetime of a marker is wrong", _compare_lifetime),
}
