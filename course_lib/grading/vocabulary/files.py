"""Checks of submitted files: launch files, by the record of their run, and layouts of RViz2."""

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
from course_lib.errors import CourseError, join_words
from course_lib.grading.evidence import Evidence, LaunchRecord, StartedNode
from course_lib.grading.inputs import build
from course_lib.grading.run.outcome import plain
from course_lib.grading.task import Message
from course_lib.grading.vocabulary.check_function import Problem, check_function, is_close
from course_lib.grading.vocabulary.markers import ResolvedCheck, resolve_check
from course_lib.grading.vocabulary.values import compare, describe_missing_text
from course_lib.ros.graph.graph import START_NS, Sample
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import serialize
from course_lib.viewer.scene import Scene

MISSING = "an argument of the launch file is missing"


@check_function("the launch file declares {argument}")
def expect_launch_argument(
    evidence: Evidence, argument: str, *, default: str, call: int = 0
) -> Iterable[Problem]:
    """Expect a launch argument with this default."""
    record = _launch_record(evidence, call)
    if argument in record.defaults and record.defaults[argument] != default:
        value = record.defaults[argument]
        yield Problem(f"the default of {argument} is {value!r}, expected {default!r}", "a default is wrong")
        return
    _require_success(record)
    if argument not in record.defaults:
        yield Problem(f"the launch description declares no argument {argument!r}", MISSING)


@check_function("the launch file starts {executable}")
def expect_launch_node(
    evidence: Evidence,
    package: str,
    executable: str,
    *,
    name: str | None = None,
    options: Mapping[str, Any] | None = None,
    of: int = 1,
    call: int = 0,
) -> Iterable[Problem]:
    """Expect that the launch file starts a node.

    Args:
        evidence: The evidence, whose returned value with the index `call` is the record of the
            launch.
        package: The package of the executable.
        executable: The name of the executable.
        name: The new name of its node.
        options: Expected options in `arguments`, with their values; "$(layout)" is a launch
            configuration.
        of: Maximum number of nodes of this executable. Without a limit, a file that starts one node
            for each value of a personal table would contain the right one. If it is more than one,
            `name` selects the node.
        call: Index of the call that returned the launch file.
    """
    record = _launch_record(evidence, call)
    _require_success(record)
    nodes = [n for n in record.started if (n.package, n.executable) == (package, executable)]
    if len(nodes) > of:
        text = f"the launch file starts {len(nodes)} nodes of {executable}, expected at most {of}"
        raise Problem(text, "the launch file starts a node too often")
    node = next((node for node in nodes if name in (None, node.name)), nodes[0] if nodes else None)
    if node is None:
        started_nodes = ", ".join(f"{n.executable} of {n.package}" for n in record.started) or "nothing"
        text = f"the launch description starts {started_nodes}, expected {executable} of {package}"
        raise Problem(text, "a node is missing in the launch file")
    if name is not None and node.name != name:
        text = f"the name of {executable} is {node.name!r}, expected {name!r}"
        yield Problem(text, "a node in the launch file has another name")
    misfits = list(_check_options(record, node, options or {}))
    if node.death and not misfits:
        # The last line that a failed node printed states the reason.
        prefix = node.death.partition("]")[0] + "]"
        lines = [line for line in evidence.output.splitlines() if line.startswith(f"{prefix} ")]
        reason = "; ".join(filter(None, [*lines[-1:], node.death]))
        yield Problem(f"ros2 launch reports: {reason}", "a node of the launch file ends with an error")
    yield from misfits


def _launch_record(evidence: Evidence, call: int) -> LaunchRecord:
    """Return the record of a launch, or raise a Problem if there is none."""
    value = evidence.returns[call] if call < len(evidence.returns) else None
    record = LaunchRecord.from_plain(value)
    if record is None:
        raise Problem(describe_missing_text(value, "launch file"), "there is no launch file")
    return record


def _require_success(record: LaunchRecord) -> None:
    if record.error:
        raise Problem(f"ros2 launch reports: {record.error}", "ros2 launch ends with an error")


def _check_options(
    record: LaunchRecord,
    node: StartedNode,
    options: Mapping[str, Any],
) -> Iterator[Problem]:
    for option, expected in options.items():
        value = node.options.get(option)
        if isinstance(expected, str) and expected.startswith("$(") and expected.endswith(")"):
            is_right = _is_forwarded(record, node, option, expected[2:-1])
        else:
            is_right = value == expected
            if isinstance(expected, float):
                with suppress(TypeError, ValueError):
                    is_right = is_right or is_close(float(value or ""), expected, 1e-6)
        if not is_right:
            text = f"the argument after {option!r} of {node.executable} is {value!r}"
            if value is None:
                own = f"it has {list(node.arguments)}" if node.arguments else "it has no arguments"
                text = f"{node.executable} has no {option!r} with a value after it, {own}"
            if isinstance(expected, str) and expected.startswith("$("):
                argument = expected[2:-1]
                expected_text = f"the value of the argument {argument}, LaunchConfiguration({argument!r})"
            else:
                expected_text = repr(str(expected))
            text = f"{text}, expected {expected_text}"
            yield Problem(text, "the arguments of a node in the launch file are wrong")


def _is_forwarded(record: LaunchRecord, node: StartedNode, option: str, argument: str) -> bool:
    """Return whether an option's value equals the launch argument, including for another value of it."""
    if record.defaults.get(argument) != node.options.get(option):
        return False
    for other in record.other_values:
        if other.argument == argument:
            same = {(n.package, n.executable): n for n in reversed(other.started)}
            other_node = same.get((node.package, node.executable))
            return other_node is not None and other_node.options.get(option) == other.value
    return False


TOPICS = ("Topic", "Description Topic", "Depth Map Topic")
DISPLAY, DRAWN = "expect_display", "expect_drawn"
COLORS_APART, DISPLAYS_ON = "expect_colors_apart", "expect_displays_on"
TOO_MANY = "a layout has more displays than the task asks for"
MOST_OTHERS = 5  # limit on enabled displays of classes to which no check refers
MAX_TEXT = 200_000  # limit on the characters of a layout
MOST_COLORS = 20  # limit on colors that are compared pairwise
USUAL_COLOR = "25; 255; 0"  # default color of a display


@check_function("the layout has {class_name}")
def expect_display(
    evidence: Evidence,
    class_name: str,
    topic: str | None = None,
    *,
    properties: Mapping[str, Any] | None = None,
    call: int = 0,
) -> Iterable[Problem]:
    """Expect an enabled display of a class, on a topic, with properties by RViz's labels: "Topic/Depth"."""
    arguments = {name: value for name, value in locals().items() if name != "evidence"}
    displays = _displays_of_class(_read_layout(evidence, call), class_name)
    if topic is not None:
        on_topic = [config for config in displays if _topic_of(config) == topic]
        if not on_topic:
            topics = join_words([repr(_topic_of(config)) for config in displays])
            return [Problem(f"{class_name} subscribes to {topics}, expected {topic!r}", "a topic is wrong")]
        displays = on_topic
    return list(_check_values(displays[0], properties or {}, class_name)) or _check_surplus(
        evidence, DISPLAY, arguments
    )


@check_function("the layout's options and view")
def expect_layout(
    evidence: Evidence,
    *,
    fixed_frame: str | None = None,
    view: str | Sequence[str] | None = None,
    view_properties: Mapping[str, Any] | None = None,
    view_within: Mapping[str, tuple[float, float]] | None = None,
    call: int = 0,
) -> Iterable[Problem]:
    """Expect the Fixed Frame, the class of the current view, and view properties by RViz's labels.

    Args:
        evidence: The evidence with the layout.
        fixed_frame: The expected Fixed Frame.
        view: RViz's short name of the class, or several names of which one is expected.
        view_properties: Exact values.
        view_within: Minimum and maximum values.
        call: Index of the call that returned the layout.
    """
    layout = _read_layout(evidence, call)
    frame, view_class = text_at(layout.options, "Fixed Frame"), _class_of(layout.view)
    if fixed_frame not in (None, frame):
        yield Problem(f"the Fixed Frame is {frame!r}, expected {fixed_frame!r}", "the Fixed Frame is wrong")
    views = [view] if isinstance(view, str) else view
    if views is not None and view_class not in views:
        expected = " or ".join(map(repr, views))
        yield Problem(f"the view is {view_class!r}, expected {expected}", "the view is of another class")
    else:
        yield from _check_values(layout.view, view_properties or {}, "the view")
        within = view_within or {}
        for label, (low, high) in within.items():
            value = _convert(layout.view.get(label), low)
            if not isinstance(value, int | float):
                yield Problem(f"the view has no {label}", "a value of the view is missing")
            elif not low <= value <= high:
                message = f"{label!r} of the view is {value:g}, expected {low:g} to {high:g}"
                yield Problem(message, "the camera sees nothing")


@check_function("one display for each topic")
def expect_displays_on(evidence: Evidence, *topics: str, call: int = 0) -> Iterable[Problem]:
    """Expect exactly one enabled display on each of these topics, and none on other topics."""
    there = Counter(_topic_of(config) for config in _enabled_displays(_read_layout(evidence, call).displays))
    for topic in dict.fromkeys([*topics, *filter(None, there)]):
        if there[topic] != (topic in topics):
            message = (
                f"{there[topic]} enabled displays subscribe to {topic!r}, expected {int(topic in topics)}"
            )
            yield Problem(message, "a topic has no display, or more than one")


@check_function("the displays {class_name} differ in color")
def expect_colors_apart(
    evidence: Evidence, class_name: str, by: float, *, call: int = 0
) -> Iterable[Problem]:
    """Expect the colors of a class's displays to differ pairwise by at least `by` of 255 in some channel."""
    arguments = {name: value for name, value in locals().items() if name != "evidence"}
    configs = _displays_of_class(_read_layout(evidence, call), class_name)[:MOST_COLORS]
    colors: list[tuple[float, ...]] = []
    for config in configs:
        text = text_at(config, "Color") or USUAL_COLOR
        try:
            red, green, blue = (float(channel) for channel in text.split(";"))
        except ValueError as error:
            raise Problem(
                f"the color is {text!r}, expected a color like '25; 255; 0'", "a color is malformed"
            ) from error
        colors.append((red, green, blue))
    if len(colors) < 2:
        message = f"the layout has one enabled display {class_name}, expected two"
        return [Problem(message, "a display is missing, or not enabled")]
    pairs = combinations(colors, 2)
    if all(max(abs(a - b) for a, b in zip(first, second, strict=True)) >= by for first, second in pairs):
        return _check_surplus(evidence, COLORS_APART, arguments)
    listed_colors = join_words(["; ".join(f"{channel:g}" for channel in color) for color in colors])
    message = f"the colors of {class_name} are {listed_colors}: no channel differs by {by:g} or more"
    return [Problem(message, "the colors of two displays do not differ clearly")]


@check_function("{class_name} draws, with no warning")
def expect_drawn(
    evidence: Evidence,
    class_name: str,
    messages: Sequence[Message],
    *,
    best_effort: Sequence[str] = (),
    call: int = 0,
) -> Iterable[Problem]:
    """Expect that a display of the layout draws these messages with all statuses Ok.

    Args:
        evidence: The evidence with the layout.
        class_name: RViz's short name of the class.
        messages: The messages that a robot publishes, ordered by time.
        best_effort: Topics whose publishers are best effort.
        call: Index of the call that returned the layout.
    """
    arguments = {name: value for name, value in locals().items() if name != "evidence"}
    layout = _read_layout(evidence, call)
    config, *_ = _displays_of_class(layout, class_name)
    if text_at(config, "Description Source") == "File":
        # A student's layout must not make the grader read files.
        message = f"{class_name} reads a file, expected it to subscribe to its Description Topic"
        return [Problem(message, "a description comes from a file")]
    # Only this display is created: other displays may be huge, like a grid with a billion lines.
    options = {"Fixed Frame": text_at(layout.options, "Fixed Frame")}
    session = RvizSession(Scene())
    session.apply(Layout(options=options, displays=(config,)))
    for sample in _samples(messages, best_effort, evidence.personal):
        session.receive(sample)
    session.update(START_NS + round(messages[-1].at * 1e9) + 10**8)
    rows = [row for row in session.rows() if row.level != "ok"]
    if rows:
        mistake = f"{class_name} or its frames show a status that is not Ok"
        return [Problem(f"{row.display}, {row.name}: {row.text}", mistake) for row in rows]
    objects = session.context.scene.objects()
    if not any(path.startswith(session.displays[0].path) for path in objects):
        message = f"{class_name} draws none of the messages that the robot publishes"
        return [Problem(message, f"{class_name} draws nothing")]
    return _check_surplus(evidence, DRAWN, arguments)


def _check_surplus(
    evidence: Evidence,
    check_name: str,
    arguments: Mapping[str, Any],
) -> list[Problem]:
    """Return a problem for a check that would pass if the layout has surplus displays.

    The checks with a personal value get the problem, because one of many values is not an answer,
    and so does the last check of the class. `expect_displays_on` counts displays itself.
    """
    own_arguments = {key: plain(value) for key, value in arguments.items()}
    everything = evidence.compute_once(_display_checks)
    rows = [row for row in everything if row.arguments["call"] == own_arguments["call"]]
    own_row = next(
        (row for row in rows if (row.check_function, row.arguments) == (check_name, own_arguments)), None
    )
    if own_row is None or any(row.check_function == DISPLAYS_ON for row in everything):
        return []
    display_counts = Counter(
        map(_class_of, _enabled_displays(_read_layout(evidence, own_arguments["call"]).displays))
    )
    classes = {row.arguments["class_name"] for row in rows}
    of_class = [row for row in rows if row.arguments["class_name"] == own_arguments["class_name"]]
    topics = {row.arguments.get("topic") for row in of_class} - {None}
    max_displays = max(1, len(topics), 2 * any(row.check_function == COLORS_APART for row in of_class))
    if (count := display_counts[own_arguments["class_name"]]) > max_displays and (
        own_row.is_personal or own_row is _last_row_with_weight(of_class)
    ):
        message = (
            f"the layout has {count} enabled displays {own_arguments['class_name']}, expected at "
            f"most {max_displays}"
        )
        return [Problem(f"{message}: remove or disable the others", TOO_MANY)]
    other_count = sum(display_counts.values()) - sum(display_counts[name] for name in classes)
    if other_count > max(MOST_OTHERS, len(classes)) and own_row is _last_row_with_weight(rows):
        message = f"the layout has {other_count} enabled displays that the task does not require"
        return [Problem(f"{message}: remove or disable them", TOO_MANY)]
    return []


def _display_checks(evidence: Evidence) -> list[ResolvedCheck]:
    check_names = (DISPLAY, DRAWN, COLORS_APART, DISPLAYS_ON)
    checks = (
        check for check in evidence.checks if check.origin and check.origin.check_function in check_names
    )
    return [resolve_check(check, evidence.personal) for check in checks]


def _last_row_with_weight(rows: Sequence[ResolvedCheck]) -> ResolvedCheck:
    """Return the last check with a weight, or the last check."""
    return ([row for row in rows if row.weight > 0] or rows)[-1]


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


def _read_layout(evidence: Evidence, call: int) -> Layout:
    """Return the submitted layout, or raise a Problem if it is not a layout."""
    text = evidence.returns[call] if call < len(evidence.returns) else None
    if not isinstance(text, str) or not text.strip():
        message = describe_missing_text(text, ".rviz file")
        if not message.startswith("no "):
            message = f"{message}: read it with Path(...).read_text()"
            raise Problem(message, "no text of a file was returned")
        raise Problem("no layout was returned", "there is no layout")
    if "\n" not in text and text.strip().endswith(".rviz"):
        message = f"{text.strip()!r} is the name of a file, expected its text"
        raise Problem(f"{message}: read it with Path(...).read_text()", "no text of a file was returned")
    if len(text) > MAX_TEXT:
        raise Problem(f"the layout has {len(text)} characters", "the layout is too long")
    layout = _parse(text)
    if isinstance(layout, str):
        raise Problem(layout, "the layout is not valid YAML")
    if layout.problems:
        raise Problem(layout.problems[0], "the layout has another structure")
    return layout


# Many checks read the same layout, and parsing a long one takes seconds.
@lru_cache(maxsize=4)
def _parse(text: str) -> Layout | str:
    """Return the layout, or an error message if it is not valid YAML."""
    try:
        return layout_of(text, "the layout")
    except CourseError as error:
        return str(error)


def _displays_of_class(layout: Layout, class_name: str) -> list[Config]:
    """Return the enabled displays of a class, or raise a Problem if there is none."""
    classes = [(_class_of(config), config) for config in _enabled_displays(layout.displays)]
    configs = [config for name, config in classes if name == class_name]
    if not configs:
        there = join_words([name for name, _ in classes]) or "no display"
        message = f"the layout has no enabled display {class_name}, it has {there}"
        raise Problem(message, "a display is missing, or not enabled")
    return configs


def _enabled_displays(configs: Iterable[Config]) -> Iterator[Config]:
    """Yield the enabled displays, including displays in enabled groups."""
    for config in configs:
        if text_at(config, "Enabled").lower() == "false":
            continue
        if config.get("Class") == GROUP:
            yield from _enabled_displays(config.get("Displays") or ())
        else:
            yield config


def _class_of(config: Config) -> str:
    return short_name(full_name(text_at(config, "Class")))


def _topic_of(config: Config) -> str:
    topic = next((config[label] for label in TOPICS if label in config), None)
    return text_at(topic, "Value") if isinstance(topic, Mapping) else str(topic or "")


def _check_values(config: Config, properties: Mapping[str, Any], subject: str) -> Iterator[Problem]:
    for path, expected in properties.items():
        value: Any = config
        for label in path.split("/"):
            value = value.get(label) if isinstance(value, Mapping) else None
        yield from compare(_convert(value, expected), expected, 1e-3, "", f"{path!r} of {subject}")


def _convert(value: Any, expected: Any) -> Any:
    """Convert a string of a layout to a number or a bool if one is expected."""
    if isinstance(value, str) and isinstance(expected, bool):
        return {"true": True, "false": False}.get(value.lower(), value)
    if isinstance(value, str) and isinstance(expected, int | float):
        with suppress(ValueError):
            return int(value) if isinstance(expected, int) and value.isdecimal() else float(value)
    return value
