"""Expectations on layouts: the text of an .rviz file that was handed in, or returned by a function."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import lru_cache
from itertools import combinations
from typing import Any

from course_lib.displays.display import GROUP
from course_lib.displays.layout import Config, Layout, layout_of, text_at
from course_lib.displays.registry import full_name, short_name
from course_lib.displays.session import RvizSession
from course_lib.errors import CourseError
from course_lib.grading.evidence import Evidence
from course_lib.grading.personal import build
from course_lib.grading.task import Message
from course_lib.grading.vocabulary.values import compare
from course_lib.grading.vocabulary.wording import Problem, listed, word
from course_lib.ros.clock import START_NS
from course_lib.ros.graph import Sample
from course_lib.ros.messages import serialize
from course_lib.ros.qos import Qos
from course_lib.viewer.scene import Scene

TOPICS = ("Topic", "Description Topic", "Depth Map Topic")
MAX_TEXT = 200_000  # characters of a layout that is looked at
MOST_COLORS = 20  # of which each is compared with each
USUAL_COLOR = "25; 255; 0"  # of a display whose color nobody changed


@word("the layout has {class_name}")
def expect_display(
    evidence: Evidence,
    class_name: str,
    topic: str | None = None,
    *,
    properties: Mapping[str, Any] | None = None,
    call: int = 0,
) -> Iterable[Problem]:
    """Expect an enabled display of a class, on a topic, with properties by RViz's labels: "Topic/Depth"."""
    displays = _of_class(_layout(evidence, call), class_name)
    if topic is not None:
        on_topic = [config for config in displays if _topic_of(config) == topic]
        if not on_topic:
            came = listed([repr(_topic_of(config)) for config in displays])
            return [Problem(f"{class_name} listens to {came}, expected {topic!r}", "a topic is wrong")]
        displays = on_topic
    return _values(displays[0], properties or {}, class_name)


@word("the layout's options and view")
def expect_layout(
    evidence: Evidence,
    *,
    fixed_frame: str | None = None,
    view: str | Sequence[str] | None = None,
    view_properties: Mapping[str, Any] | None = None,
    view_within: Mapping[str, tuple[float, float]] | None = None,
    call: int = 0,
) -> Iterable[Problem]:
    """Expect the Fixed Frame, the class of the current view, and values of the view by RViz's labels.

    Args:
        evidence: With the layout.
        fixed_frame: Its name.
        view: RViz's short name of the class, or several of which one is expected.
        view_properties: The exact values.
        view_within: The least and the greatest value.
        call: Which call returned the layout.
    """
    found = _layout(evidence, call)
    frame, view_class = text_at(found.options, "Fixed Frame"), _class_of(found.view)
    if fixed_frame not in (None, frame):
        yield Problem(f"the Fixed Frame is {frame!r}, expected {fixed_frame!r}", "the Fixed Frame is wrong")
    views = [view] if isinstance(view, str) else view
    if views is not None and view_class not in views:
        expected = " or ".join(map(repr, views))
        yield Problem(f"the view is {view_class!r}, expected {expected}", "the view is of another class")
    else:
        yield from _values(found.view, view_properties or {}, "the view")
        yield from _outside(found.view, view_within or {})


@word("one display for each topic")
def expect_displays_on(evidence: Evidence, *topics: str, call: int = 0) -> Iterable[Problem]:
    """Expect exactly one enabled display on each of these topics, and no display on another topic."""
    there = Counter(_topic_of(config) for config in _displays(_layout(evidence, call).displays))
    for topic in dict.fromkeys([*topics, *filter(None, there)]):
        if there[topic] != (topic in topics):
            message = f"{there[topic]} enabled displays listen to {topic!r}, expected {int(topic in topics)}"
            yield Problem(message, "a topic has no display, or more than one")


@word("the displays {class_name} differ in color")
def expect_colors_apart(
    evidence: Evidence, class_name: str, by: float, *, call: int = 0
) -> Iterable[Problem]:
    """Expect colors that differ between any two displays of a class, in some channel, by `by` of 255."""
    configs = _of_class(_layout(evidence, call), class_name)[:MOST_COLORS]
    colors = [_color_of(config) for config in configs]
    if len(colors) < 2:
        message = f"the layout has one enabled display {class_name}, expected two"
        return [Problem(message, "a display is missing, or not enabled")]
    pairs = combinations(colors, 2)
    if all(max(abs(a - b) for a, b in zip(one, other, strict=True)) >= by for one, other in pairs):
        return []
    listed_colors = listed(["; ".join(f"{channel:g}" for channel in color) for color in colors])
    message = f"the colors of {class_name} are {listed_colors}: no channel differs by {by:g} or more"
    return [Problem(message, "the colors of two displays do not differ clearly")]


@word("{class_name} draws, with no warning")
def expect_drawn(
    evidence: Evidence,
    class_name: str,
    messages: Sequence[Message],
    *,
    best_effort: Sequence[str] = (),
    call: int = 0,
) -> Iterable[Problem]:
    """Expect that a display of the layout draws these messages, and that all its statuses are Ok.

    Args:
        evidence: With the layout.
        class_name: RViz's short name.
        messages: What a robot publishes, in order of time.
        best_effort: Topics whose publisher does not resend.
        call: Which call returned the layout.
    """
    found = _layout(evidence, call)
    config, *_ = _of_class(found, class_name)
    if text_at(config, "Description Source") == "File":  # nothing on this machine is read for a layout
        message = f"{class_name} reads a file, expected that it listens to its Description Topic"
        return [Problem(message, "a description comes from a file")]
    # Only this display is made: a layout may ask for a grid of a billion lines.
    options = {"Fixed Frame": text_at(found.options, "Fixed Frame")}
    session = RvizSession(Scene())
    session.apply(Layout(options=options, displays=(config,)))
    for sample in _samples(messages, best_effort, evidence.personal):
        session.receive(sample)
    session.update(START_NS + round(messages[-1].at * 1e9) + 10**8)
    return list(_silent(session, class_name))


def _silent(session: RvizSession, class_name: str) -> Iterator[Problem]:
    rows = [row for row in session.rows() if row.level != "ok"]
    for row in rows:
        said = f"{row.display}, {row.name}: {row.text}"
        yield Problem(said, f"{class_name} or its frames show a status that is not Ok")
    drawn = session.context.scene.objects()
    if not rows and not any(path.startswith(session.displays[0].path) for path in drawn):
        yield Problem(
            f"{class_name} draws nothing of what the robot publishes", f"{class_name} draws nothing"
        )


def _samples(
    messages: Sequence[Message], best_effort: Sequence[str], personal: Mapping[str, Any]
) -> Iterator[Sample]:
    for message in messages:
        qos = Qos()
        if message.topic in best_effort:
            qos = replace(qos, reliability="best_effort")
        if message.topic == "/tf_static":
            qos = replace(qos, durability="transient_local")
        cdr = serialize(build(message, personal))
        yield Sample(START_NS + round(message.at * 1e9), message.topic, message.type_name, cdr, qos, 0)


def _layout(evidence: Evidence, call: int) -> Layout:
    """Return the layout that was handed in; raise the problem if it is not a layout."""
    text = evidence.returns[call] if call < len(evidence.returns) else None
    if not isinstance(text, str) or not text.strip():
        raise Problem("no text of a layout came back", "there is no layout")
    if len(text) > MAX_TEXT:
        raise Problem(f"the layout has {len(text)} characters", "the layout is too long")
    found = _parsed(text)
    if isinstance(found, str):
        raise Problem(found, "the layout is no YAML")
    if found.problems:
        raise Problem(found.problems[0], "the layout has another structure")
    return found


@lru_cache(maxsize=4)  # many checks look at one layout, and a long one takes seconds
def _parsed(text: str) -> Layout | str:
    """Return the layout, or what is wrong with the YAML."""
    try:
        return layout_of(text, "the layout")
    except CourseError as error:
        return str(error)


def _of_class(layout: Layout, class_name: str) -> list[Config]:
    """Return the enabled displays of a class; raise the problem if there is none."""
    classes = [(_class_of(config), config) for config in _displays(layout.displays)]
    found = [config for name, config in classes if name == class_name]
    if not found:
        there = listed([name for name, _ in classes]) or "no display"
        message = f"no enabled display {class_name} is in the layout, it has {there}"
        raise Problem(message, "a display is missing, or not enabled")
    return found


def _displays(configs: Iterable[Config]) -> Iterator[Config]:
    """Yield the enabled displays, also those in enabled groups."""
    for config in configs:
        if text_at(config, "Enabled").lower() == "false":
            continue
        if config.get("Class") == GROUP:
            yield from _displays(config.get("Displays") or ())
        else:
            yield config


def _class_of(config: Config) -> str:
    return short_name(full_name(text_at(config, "Class")))


def _topic_of(config: Config) -> str:
    topic = next((config[label] for label in TOPICS if label in config), None)
    return text_at(topic, "Value") if isinstance(topic, Mapping) else str(topic or "")


def _color_of(config: Config) -> tuple[float, ...]:
    """Return red, green and blue of a display, 0 to 255; raise the problem if there are none."""
    text = text_at(config, "Color") or USUAL_COLOR
    try:
        red, green, blue = (float(part) for part in text.split(";"))
    except ValueError as error:
        raise Problem(
            f"the color is {text!r}, expected like '25; 255; 0'", "a color is not a color"
        ) from error
    return red, green, blue


def _outside(config: Config, within: Mapping[str, tuple[float, float]]) -> Iterator[Problem]:
    for label, (low, high) in within.items():
        value = _typed(config.get(label), low)
        if not isinstance(value, int | float):
            yield Problem(f"the view has no {label}", "a value of the view is missing")
        elif not low <= value <= high:
            message = f"{label!r} of the view is {value:g}, expected {low:g} to {high:g}"
            yield Problem(message, "the camera is where nothing can be seen")


def _values(config: Config, properties: Mapping[str, Any], what: str) -> Iterator[Problem]:
    for path, expected in properties.items():
        value: Any = config
        for label in path.split("/"):
            value = value.get(label) if isinstance(value, Mapping) else None
        yield from compare(_typed(value, expected), expected, 1e-3, "", f"{path!r} of {what}")


def _typed(value: Any, expected: Any) -> Any:
    """Return a text of a layout as a number or a truth value if one is expected."""
    if isinstance(value, str) and isinstance(expected, bool):
        return {"true": True, "false": False}.get(value.lower(), value)
    if isinstance(value, str) and isinstance(expected, int | float):
        with suppress(ValueError):
            return float(value)
    return value
