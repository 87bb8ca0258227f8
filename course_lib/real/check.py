"""`course check --ros`: the public checks, applied to an exercise's messages in the real ROS 2.

The student's own code runs on the student's own computer, as with `course run`. Grading never uses
this. Times differ from run to run there, so they are reported and not counted. Values are compared
with those that the program published in the kit.
"""

import re
import signal
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

from course_lib.course.exercise import current_identity, find_notebook
from course_lib.errors import CourseError, format_count
from course_lib.export.module import Statement, collect_needed_statements, read_cells, statements
from course_lib.grading.evidence import Check, Evidence
from course_lib.grading.inputs import build, personal_values
from course_lib.grading.judge import judge_task
from course_lib.grading.records import CheckResult, Run
from course_lib.grading.run.run import Job, plan_scenarios, run_scenarios
from course_lib.grading.run.scenario import INPUT_NODE, SET_PARAMETERS, rejection_reasons
from course_lib.grading.submissions.notebook import parse_notebook
from course_lib.grading.submissions.submission import NO_EXERCISE, unpack
from course_lib.grading.task import Catalog, Message, Scenario, Task, shipped_catalog
from course_lib.grading.vocabulary import motion, topics
from course_lib.real.environment import RealEnvironment, find_environment
from course_lib.real.process import NOT_ROS_OWN, RealProcesses, linked_graph, temporary_folder
from course_lib.ros.graph.graph import START_NS, Sample, use_graph
from course_lib.ros.graph.topics import OWN_TOPICS, SERVICE_HEADER, Qos, service_topics
from course_lib.ros.messages import deserialize, message_class, serialize, to_plain
from course_lib.ros.programs import import_path
from course_lib.ros.robot.robot_graph import RobotGraph
from course_lib.ros.time import wall
from course_lib.ros.time.interrupts import SIGNALED

# One recording may begin later than the other by this number of messages, or by this time. On
# a busy computer, the first hundreds of messages of a fast topic are missed.
MAX_OFFSET, MAX_OFFSET_NS = 30, 1_500_000_000
# The share of a topic's messages that arrives on a busy computer.
MIN_SHARE = 0.8
# Stamps closer than this to the start of a run belong to the run [ns].
NEAR_NS = 86_400 * 10**9
TIME = "builtin_interfaces/Time"


@dataclass(frozen=True)
class TopicComparison:
    """Messages on a topic in the kit and on ROS.

    Args:
        topic: The topic's name.
        kit_count: Number of messages in the kit.
        ros_count: Number of messages on ROS.
        pairs: Number of compared pairs.
        equal: Number of pairs that are equal in all bytes except stamps.
        different_field: A field that differs, or "".
    """

    topic: str
    kit_count: int
    ros_count: int
    pairs: int
    equal: int
    different_field: str = ""

    def __str__(self) -> str:
        if not self.pairs:
            return f"{self.topic}: kit {self.kit_count}, ROS {self.ros_count} messages"
        different = f", others differ in {self.different_field}" if self.different_field else ""
        return (
            f"{self.topic}: kit {self.kit_count}, ROS {self.ros_count} messages; {self.equal} of "
            f"{self.pairs} pairs bit-equal{different}"
        )


def _stamps(message: Any) -> Iterator[Any]:
    """Yield the stamps in a message."""
    for name, text in message.get_fields_and_field_types().items():
        value = getattr(message, name)
        if text == TIME:
            yield value
        elif hasattr(value, "get_fields_and_field_types"):
            yield from _stamps(value)
        elif isinstance(value, list) and value and hasattr(value[0], "get_fields_and_field_types"):
            for element in value:
                yield from _stamps(element)


def move_stamps(message: Any, by_ns: int, near_ns: int) -> Any:
    """Shift the stamps in a message that belong to the run, in place. Return the message."""
    for stamp in _stamps(message):
        stamp_ns = stamp.sec * 10**9 + stamp.nanosec
        if abs(stamp_ns - near_ns) < NEAR_NS:
            stamp.sec, stamp.nanosec = divmod(max(stamp_ns + by_ns, 0), 10**9)
    return message


def _bytes_without_stamps(sample: Sample) -> bytes:
    """Return the CDR bytes of a sample's message with all stamps set to 0."""
    message = sample.message()
    for stamp in _stamps(message):
        stamp.sec = stamp.nanosec = 0
    return serialize(message)


def compare(in_kit: Sequence[Sample], in_ros: Sequence[Sample]) -> list[TopicComparison]:
    """Compare two recordings topic by topic.

    One recording may begin later, so the offset with the fewest differences is used.
    """
    comparisons: list[TopicComparison] = []
    for topic in sorted({sample.topic for sample in (*in_kit, *in_ros)} - set(OWN_TOPICS)):
        sides = [[sample for sample in side if sample.topic == topic] for side in (in_kit, in_ros)]
        kit_messages, ros_messages = ([_bytes_without_stamps(sample) for sample in side] for side in sides)
        best: list[tuple[bytes, bytes]] = []
        different: list[tuple[bytes, bytes]] = []
        # The numbers of samples in the first MAX_OFFSET_NS of both recordings.
        early_counts = [sum(s.stamp_ns < side[0].stamp_ns + MAX_OFFSET_NS for s in side) for side in sides]
        limit = max(MAX_OFFSET, *early_counts)
        for offset in sorted(range(-limit, limit + 1), key=abs):
            pairs = list(zip(kit_messages[max(0, offset) :], ros_messages[max(0, -offset) :], strict=False))
            # An offset must not be selected because it leaves few messages to compare.
            is_long = 2 * len(pairs) >= min(len(kit_messages), len(ros_messages))
            unequal = [pair for pair in pairs if pair[0] != pair[1]]
            # Compare the fraction of unequal pairs, because later offsets have fewer pairs.
            if pairs and is_long and (not best or len(unequal) * len(best) < len(different) * len(pairs)):
                best, different = pairs, unequal
        different_field = ""
        if different:
            kind = message_class(sides[0][0].type_name)
            kit, ros = (dict(_flatten(to_plain(deserialize(cdr, kind)))) for cdr in different[0])
            different_field = next((name for name in {**kit, **ros} if kit.get(name) != ros.get(name)), "")
        comparisons.append(
            TopicComparison(
                topic,
                kit_count=len(kit_messages),
                ros_count=len(ros_messages),
                pairs=len(best),
                equal=len(best) - len(different),
                different_field=different_field,
            )
        )
    return comparisons


def _flatten(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the path and the value of each field of a message, like `ranges[3]`, and lengths."""
    if isinstance(value, dict):
        for name, item in value.items():
            yield from _flatten(item, f"{path}.{name}" if path else str(name))
    elif isinstance(value, list):
        yield f"{path}.length", len(value)
        for index, item in enumerate(value):
            yield from _flatten(item, f"{path}[{index}]")
    else:
        yield path, value


# Checks of times, and of rates that a program measures. Other programs on the computer change both.
TIMING = ("expect_level", "expect_nothing_before", "expect_rate", "expect_stamps", "expect_throughout")
# The mistakes reported by checks that find a gap.
GAPS = {topics.NOT_ALL_THE_TIME, topics.FALLS_SILENT, motion.NOT_ALL_THE_TIME}
MY_VALUES = "from course_lib import my_values"
CALL = re.compile(r"""my_values\(["']([\w.]+)["']\)""")
# Prefix of the line that the program prints when it creates its nodes.
BEGIN = "begin "
# Time limit for starting Python and importing rclpy and the notebook's packages [s].
START_SECONDS = 20.0
# Maximum delay of a timer that is due at the end [ns].
LATE_NS = 15_000_000
# Time for receiving the last messages [s].
LAST_SECONDS = 0.3


@dataclass(frozen=True)
class RealResult:
    """The result of a task on the real ROS 2.

    Args:
        task: The task.
        skipped: Why it was not run, or "". With errors it counts as failed.
        checks: Results, and for each whether it depends only on times.
        errors: The errors raised by the task's code.
        comparisons: Comparisons with the messages published in the kit.
        packages: Packages of the kit that the task used.
    """

    task: Task
    skipped: str = ""
    checks: tuple[tuple[CheckResult, bool], ...] = ()
    errors: tuple[str, ...] = ()
    comparisons: tuple[TopicComparison, ...] = ()
    packages: tuple[str, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether all checks pass, except checks of times."""
        return not self.errors and all(check.passed for check, is_timing in self.checks if not is_timing)

    def lines(self) -> list[str]:
        """Return the result as lines for a terminal."""
        if self.skipped:
            return [f"{self.task.id}: not run on ROS, {self.skipped}"]
        counted_checks = [check for check, is_timing in self.checks if not is_timing]
        number = sum(check.passed for check in counted_checks)
        rows = [
            f"{self.task.id}: {number} of {format_count(len(counted_checks), 'check')} pass on the real ROS 2"
        ]
        rows += [f"  {error}" for error in self.errors]
        # Checks with the same outcome share a line.
        titles: dict[tuple[str, str], list[str]] = {}
        for check, is_timing in self.checks:
            mark = "ok" if check.passed else "~~" if is_timing else "NO"
            about = f": {check.message}" if is_timing or not check.passed else ""
            note = " (timing: not counted)" if is_timing else ""
            titles.setdefault((mark, about + note), []).append(check.title)
        rows += [f"  {mark} {'; '.join(names)}{about}" for (mark, about), names in titles.items()]
        rows += [f"  {comparison}" for comparison in self.comparisons]
        return rows


def check_on_ros(path: Path) -> bool:
    """Run the nodes of an exercise on the real ROS 2 and print the results.

    Return whether all tasks pass.

    Raises:
        CourseError: The real rclpy is not installed, or the file is not an exercise.
    """
    environment = find_environment()
    results = list[RealResult]()
    for result in results_on_ros(path, environment):
        if not results:
            print(f"On {environment}, compared with the same run in the kit:")  # noqa: T201  the terminal is its page
        print(*result.lines(), sep="\n", flush=True)  # noqa: T201
        results.append(result)
    kits = sorted({name for result in results for name in result.packages})
    if kits:
        print(f"{NOT_ROS_OWN}: {', '.join(kits)}.")  # noqa: T201
    return all(result.passed for result in results)


def results_on_ros(path: Path, environment: RealEnvironment) -> Iterator[RealResult]:
    """Yield the result of each task of an exercise; see `check_on_ros`."""
    path = find_notebook(path)
    notebook, catalog = parse_notebook(unpack(path)[0], path.name), shipped_catalog()
    tasks = catalog.tasks_of_week((notebook.exercise or "").split("_")[0])
    if not tasks:
        raise CourseError(f"{path} {NO_EXERCISE}")
    import_path.install()
    student = notebook.student or current_identity()
    code = statements(read_cells(path))
    nodes = [task for task in tasks if task.kind == "node"]
    steps = plan_scenarios(nodes, catalog, with_hidden=False)
    result = run_scenarios(Job(notebook.cells, student, steps, catalog.course.limits))
    for task in tasks:
        in_kit = [run.evidence for run in result.runs if run.evidence.task == task.id]
        yield _check_task(task, code, in_kit, catalog, environment, student)


def _check_task(
    task: Task,
    code: Sequence[Statement],
    in_kit: Sequence[Evidence],
    catalog: Catalog,
    environment: RealEnvironment,
    student: str | None,
) -> RealResult:
    personal = personal_values(task, student)
    if task.kind != "node":
        return RealResult(task, f"as it is not a node but a {task.kind}")
    errors = [error for evidence in in_kit for error in evidence.errors]
    if errors and errors[0].startswith("NotImplementedError"):
        return RealResult(task, f"as it is not finished: {errors[0]}", errors=(errors[0],))
    try:
        text = _module_text(task, code, catalog, student)
    except CourseError as error:
        return RealResult(task, f"because of this: {error}", errors=(str(error),))
    runs, kit_runs, comparisons, packages = [], [], list[TopicComparison](), set[str]()
    with temporary_folder() as folder:
        module = folder / f"{task.id.replace('.', '_')}.py"
        module.write_text(text, encoding="utf-8")
        for scenario, kits in zip(task.scenarios, in_kit, strict=True):
            run = ScenarioOnRos(task, scenario, personal, environment, folder)
            evidence = run.evidence(module)
            if "ModuleNotFoundError" in "".join(evidence.errors):
                return RealResult(task, f"as a package has no wheel: {evidence.errors[0]}")
            runs.append(Run(_without_timing(scenario), evidence))
            kit_runs.append(Run(_without_timing(scenario), kits))
            comparisons += compare(kits.samples, evidence.samples)
            packages |= set(run.packages)
    result, kit_result = (judge_task(task, *catalog.points(task), side) for side in (runs, kit_runs))
    timing = [_is_timing(check) for run in runs for check in run.scenario.checks]
    # On a busy computer messages are late, so a check that finds a gap is not counted, nor one that
    # the kit's messages pass although they have the same values.
    is_late = are_equal_in_value(comparisons)
    checks = tuple(
        (check, is_timing or (not check.passed and (check.mistake in GAPS or (is_late and in_kit.passed))))
        for check, in_kit, is_timing in zip(result.checks, kit_result.checks, timing, strict=True)
    )
    return RealResult(task, "", checks, result.errors, tuple(comparisons), tuple(sorted(packages)))


def are_equal_in_value(comparisons: Sequence[TopicComparison]) -> bool:
    """Return whether all messages equal the kit's except for their stamps, and few are missing."""
    return bool(comparisons) and all(
        topic.equal == topic.pairs and topic.ros_count >= MIN_SHARE * topic.kit_count > 0
        for topic in comparisons
    )


def _module_text(
    task: Task,
    code: Sequence[Statement],
    catalog: Catalog,
    student: str | None,
) -> str:
    """Return the part of a notebook that creates a task's nodes, as a module.

    Calls of `my_values` are replaced by the student's values, as a program for a robot would
    contain them.

    Raises:
        CourseError: No cell defines the task, or it uses course_lib, which robots do not have.
    """
    root = next((s for s in reversed(code) if task.name in s.bindings and not s.is_import), None)
    if root is None:
        raise CourseError(f"No cell defines {task.name}: define it, then check again.")
    parts = [part for part in collect_needed_statements(root, code, []) if part.text != MY_VALUES]
    kit_imports = [part.text for part in parts if part.is_import and "course_lib" in part.text]
    if kit_imports:
        raise CourseError(
            f"{task.name} uses course_lib ({kit_imports[0]}), which robots do not have: "
            "remove it from the node."
        )
    text = "\n\n".join(part.text for part in parts)
    return CALL.sub(lambda call: repr(dict(personal_values(catalog.task(call[1]), student))), text) + "\n"


def _without_timing(scenario: Scenario) -> Scenario:
    """Return a scenario whose checks do not require checks of times."""

    def keep(check: Check) -> Check:
        return replace(
            check, requires=tuple(keep(other) for other in check.requires if not _is_timing(other))
        )

    return replace(scenario, checks=tuple(keep(check) for check in scenario.checks))


def _is_timing(check: Check) -> bool:
    return check.origin is not None and check.origin.check_function in TIMING


@dataclass(eq=False, repr=False)
class ScenarioOnRos:
    """A scenario of a task. The nodes run on the real rclpy; inputs and recorder run in the kit."""

    _task: Task
    _scenario: Scenario
    _personal: Mapping[str, Any]
    _environment: RealEnvironment
    _folder: Path
    _samples: list[Sample] = field(default_factory=list)
    # Rejected parameters: the time of the reply, [ns] since 1970, and the reason.
    _rejections: list[tuple[int, str]] = field(default_factory=list)
    _input_node: int = -1
    packages: list[str] = field(default_factory=list)

    def evidence(self, module: Path) -> Evidence:
        """Run the scenario and return its evidence, with times relative to the kit's START_NS."""
        outputs = [self._folder / f"{self._scenario.name}.{name}" for name in ("out", "err")]
        programs = RealProcesses(self._environment, self._folder, [module], lambda line: None)
        graph = linked_graph(programs, lambda line: None, sends=True)
        self._input_node = graph.add_node(INPUT_NODE, "/")
        graph.tap(self._record)
        inputs = [self._publisher(graph, message) for message in self._scenario.inputs]
        services = {m.topic for m in self._scenario.inputs if m.type_name == SET_PARAMETERS}
        for service in services:
            self._watch_rejections(graph, service)
        begin_ns = graph.now_ns
        try:
            with use_graph(graph), outputs[0].open("w") as out, outputs[1].open("w") as err:
                topics = [m.topic for m in self._scenario.inputs if "/srv/" not in m.type_name]
                programs.start(module, topics, subject=self._task.name, streams=(out, err))
                begin_ns = self._wait_for_begin(graph, programs, outputs[0]) or begin_ns
                for publish, message in zip(inputs, self._scenario.inputs, strict=True):
                    due_ns = begin_ns + round(message.at * 1e9)
                    graph.call_at(due_ns, partial(publish, begin_ns), node=self._input_node, entity=0)
                end_ns = begin_ns + round((self._scenario.seconds + LAST_SECONDS) * 1e9)
                while programs.are_running() and graph.now_ns < end_ns:
                    graph.advance()
                is_early = not programs.are_running()
                code = programs.end(graph.advance)
        finally:
            programs.end(graph.advance)
            graph.close()
        self.packages = programs.kit_packages()
        text, errors = (output.read_text(encoding="utf-8", errors="replace") for output in outputs)
        lines = [line for line in errors.splitlines() if line.strip()]
        if code > SIGNALED:
            lines = [f"It was ended by {signal.Signals(code - SIGNALED).name}, as errors in C and C++ do."]
        raised = (lines[-1] if lines else f"It ended with exit code {code}.",) if is_early and code else ()
        # As in the kit's evidence, which checks read.
        rejections = [
            f"At {(at_ns - begin_ns) * 1e-9:.2f} s: Setting parameter failed: {reason}\n"
            for at_ns, reason in self._rejections
        ]
        return Evidence(
            task=self._task.id,
            scenario=self._scenario.name,
            seconds=self._scenario.seconds,
            samples=tuple(self._shift_samples(begin_ns)),
            output="".join(rejections) + text.partition("\n")[2] + errors,
            errors=raised,
            personal=self._personal,
        )

    def _record(self, sample: Sample) -> None:
        if sample.node != self._input_node and sample.topic not in OWN_TOPICS:
            self._samples.append(sample)

    def _shift_samples(self, begin_ns: int) -> Iterator[Sample]:
        """Yield the samples of the scenario, with all times shifted to the kit's time."""
        shift_ns, end_ns = START_NS - begin_ns, START_NS + round(self._scenario.seconds * 1e9)
        for sample in self._samples:
            stamp_ns = max(sample.stamp_ns + shift_ns, START_NS)
            if stamp_ns <= end_ns + LATE_NS:
                message = move_stamps(sample.message(), shift_ns, begin_ns)
                yield replace(sample, stamp_ns=min(stamp_ns, end_ns), cdr=serialize(message))

    def _publisher(self, graph: RobotGraph, message: Message) -> Callable[[int], None]:
        """Return a function that publishes an input or sends a request.

        Its argument is the start of the run.
        """
        topic, type_name, header = message.topic, message.type_name, b""
        if "/srv/" in type_name:
            (topic, type_name), _ = service_topics(topic, type_name)
        built = build(replace(message, topic=topic, type_name=type_name), self._personal)
        endpoint = graph.add_publisher(self._input_node, topic, type_name, Qos())
        if "/srv/" in type_name:
            header = SERVICE_HEADER.pack(endpoint, 1)

        def publish(begin_ns: int) -> None:
            # The stamps of inputs are relative to the kit's clock.
            graph.publish(endpoint, header + serialize(move_stamps(built, begin_ns - START_NS, START_NS)))

        return publish

    def _watch_rejections(self, graph: RobotGraph, service: str) -> None:
        def on_reply(data: bytes, source_ns: int, received_ns: int) -> None:
            reasons = rejection_reasons(data[SERVICE_HEADER.size :])
            self._rejections += [(wall.time_ns(), reason) for reason in reasons]

        _, replies = service_topics(service, SET_PARAMETERS)
        graph.add_subscription(self._input_node, 0, *replies, Qos(), on_reply)

    def _wait_for_begin(
        self,
        graph: RobotGraph,
        programs: RealProcesses,
        output: Path,
    ) -> int | None:
        """Return the time at which the program creates its nodes, [ns] since 1970."""
        deadline = wall.monotonic() + START_SECONDS
        while programs.are_running() and wall.monotonic() < deadline:
            graph.advance()
            line = output.read_text(encoding="utf-8", errors="replace").partition("\n")
            if line[0].startswith(BEGIN) and line[1]:
                return int(line[0].removeprefix(BEGIN))
        return None
