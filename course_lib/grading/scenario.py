"""A scenario's stage, which is ours: clock, inputs and recorder; and a whole run of it in this process."""

from collections.abc import Mapping
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import replace
from functools import partial
from typing import Any

from course_lib.grading.evidence import Evidence
from course_lib.grading.image_room import ImageRoom
from course_lib.grading.message_data import build
from course_lib.grading.perform import Outcome, Part, perform
from course_lib.grading.plain import plain
from course_lib.grading.printed import Bounded
from course_lib.grading.task import Scenario, Task, resolve
from course_lib.grading.watchdog import watchdog
from course_lib.ros.clock import START_NS
from course_lib.ros.graph import Graph, Sample
from course_lib.ros.messages import serialize
from course_lib.ros.qos import Qos
from course_lib.ros.topics import SERVICE_HEADER, SERVICE_TOPICS
from course_lib.ros.tracebacks import line_of_traceback

INPUT_NODE = "scenario"
# Every node's own; /rosout names files besides, and those of cells are called otherwise in each process.
NOT_EVIDENCE = ("/rosout", "/parameter_events")
WALL_LIMIT = 20.0  # [s] of the wall clock for a run in this process


class Stage:
    """The graph of one scenario, with our inputs on it and a recorder of what the student's side publishes.

    Args:
        task: Whose scenario it is.
        scenario: What runs.
        personal: The student's own values.
    """

    def __init__(self, task: Task, scenario: Scenario, personal: Mapping[str, Any]) -> None:
        self._task, self._scenario, self._personal = task, scenario, personal
        self.seconds = scenario.seconds
        self.graph = Graph(end_ns=START_NS + round(scenario.seconds * 1e9))
        self._ours = self.graph.add_node(INPUT_NODE, "/")
        self._samples: list[Sample] = []
        self._room = ImageRoom()
        self.graph.tap(self._record)
        for message in scenario.inputs:
            is_request = "/srv/" in message.type_name
            if is_request:
                prefix, suffix = SERVICE_TOPICS[0]
                topic, type_name = f"{prefix}{message.topic}{suffix}", f"{message.type_name}_Request"
                message = replace(message, topic=topic, type_name=type_name)
            cdr = serialize(build(message, personal))
            endpoint = self.graph.add_publisher(self._ours, message.topic, message.type_name, Qos())
            publish = partial(
                self.graph.publish, endpoint, SERVICE_HEADER.pack(endpoint, 1) * is_request + cdr
            )
            due_ns = START_NS + round(message.at * 1e9)
            self.graph.call_at(due_ns, publish, node=self._ours, entity=endpoint)
        calls = [plain(resolve((call.args, call.kwargs), personal)) for call in scenario.calls]
        self.part = Part(task.kind, scenario.seed, calls)

    def evidence(self, outcome: Outcome, *, output: str = "", stopped: str = "") -> Evidence:
        """What came out, so far."""
        return Evidence(
            task=self._task.id,
            scenario=self._scenario.name,
            seconds=self._scenario.seconds,
            samples=tuple(self._samples),
            returns=tuple(outcome.returns),
            output=output,
            errors=tuple(outcome.errors),
            stopped=stopped,
            personal=self._personal,
        )

    def _record(self, sample: Sample) -> None:
        if sample.node != self._ours and sample.topic not in NOT_EVIDENCE:
            self._samples.append(self._room.fitted(sample))


def run_here(
    task: Task,
    scenario: Scenario,
    subject: Any,
    personal: Mapping[str, Any],
    *,
    wall_limit: float = WALL_LIMIT,
) -> Evidence:
    """Run a scenario in this process, interrupted after `wall_limit` [s] of the wall clock."""
    stage, outcome, output = Stage(task, scenario, personal), Outcome(), Bounded()
    stopped = ""
    with redirect_stdout(output), redirect_stderr(output), watchdog(wall_limit) as dog:
        try:
            perform(stage.part, subject, stage.graph, outcome)
        except KeyboardInterrupt as interrupt:
            if not dog.barked:
                raise
            stopped = "time"
            line = line_of_traceback(interrupt.__traceback__) or dog.line
            outcome.errors.append(still_running(wall_limit, line))
    return stage.evidence(outcome, output=output.getvalue(), stopped=stopped)


def still_running(seconds: float, line: str = "") -> str:
    """Return the message about code that does not come to an end; `line` is where it was, if known."""
    where = line and f" ({line})"
    return f"still running after {seconds:.3g} s{where}: an endless loop? It was stopped."
