"""Our side of a scenario: its graph with clock, inputs and recorder."""

import pickle
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any

from course_lib.grading.evidence import Evidence
from course_lib.grading.personal import build
from course_lib.grading.run.outcome import Outcome, plain
from course_lib.grading.task import Message, Scenario, Task, resolve
from course_lib.ros.clock import START_NS
from course_lib.ros.graph import Graph, Sample
from course_lib.ros.graph_server import PICTURES
from course_lib.ros.messages import deserialize, message_class, serialize
from course_lib.ros.qos import Qos
from course_lib.ros.topics import OWN_TOPICS, SERVICE_HEADER, SERVICE_TOPICS

INPUT_NODE = "scenario"
SET_PARAMETERS = "rcl_interfaces/srv/SetParameters"
MOST_INPUTS, LARGE = 2048, 10_000  # inputs that are kept as they are published, and the bytes of a larger one
MOST_REJECTIONS = 10  # of a scenario
LONGEST_REASON = 200  # characters


@dataclass(frozen=True)
class Instructions:
    """The part of a scenario that the student's side gets: kind of the task, seed, arguments of calls."""

    kind: str
    seed: int
    calls: Sequence[tuple[Sequence[Any], dict[str, Any]]] = ()


class ScenarioGraph:
    """The graph of one scenario, with its inputs and a recorder of the student's messages.

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
        self._rejections: list[str] = []
        self._room = ImageRoom()
        self.graph.tap(self._record)
        for message in scenario.inputs:
            is_request = "/srv/" in message.type_name
            if is_request:
                prefix, suffix = SERVICE_TOPICS[0]
                topic, type_name = f"{prefix}{message.topic}{suffix}", f"{message.type_name}_Request"
                message = replace(message, topic=topic, type_name=type_name)
            fields = pickle.dumps(resolve(message.fields, personal))
            made = _input if len(fields) < LARGE else _input.__wrapped__
            cdr = made(message.topic, message.type_name, fields)
            endpoint = self.graph.add_publisher(self._ours, message.topic, message.type_name, Qos())
            publish = partial(
                self.graph.publish, endpoint, SERVICE_HEADER.pack(endpoint, 1) * is_request + cdr
            )
            due_ns = START_NS + round(message.at * 1e9)
            self.graph.call_at(due_ns, publish, node=self._ours, entity=endpoint)
        asked = {one.topic for one in scenario.inputs if one.type_name == SET_PARAMETERS}
        for service in sorted(asked):
            self._hear_rejections(service)
        calls = [plain(resolve((call.args, call.kwargs), personal)) for call in scenario.calls]
        self.part = Instructions(task.kind, scenario.seed, calls)

    def evidence(self, outcome: Outcome, *, output: str = "", stopped: str = "") -> Evidence:
        """Return the evidence, with the messages recorded so far."""
        return Evidence(
            task=self._task.id,
            scenario=self._scenario.name,
            seconds=self._scenario.seconds,
            samples=tuple(self._samples),
            returns=tuple(outcome.returns),
            output="".join(self._rejections) + output,
            errors=tuple(outcome.errors),
            stopped=stopped,
            personal=self._personal,
        )

    def _hear_rejections(self, service: str) -> None:
        """Keep what `ros2 param set` would print of a parameter that is rejected."""

        def hear(data: bytes, source_ns: int, _: int) -> None:
            seconds, reasons = (source_ns - START_NS) * 1e-9, rejections(data[SERVICE_HEADER.size :])
            told = [f"At {seconds:.2f} s: Setting parameter failed: {reason}\n" for reason in reasons]
            self._rejections += told[: MOST_REJECTIONS - len(self._rejections)]

        prefix, suffix = SERVICE_TOPICS[1]
        topic = f"{prefix}{service}{suffix}"
        self.graph.add_subscription(self._ours, 0, topic, f"{SET_PARAMETERS}_Response", Qos(), hear)

    def _record(self, sample: Sample) -> None:
        # /rosout names files, and those of cells are called otherwise in each process.
        if sample.node != self._ours and sample.topic not in OWN_TOPICS:
            self._samples.append(self._room.fitted(sample))


@lru_cache(maxsize=MOST_INPUTS)
def _input(topic: str, type_name: str, fields: bytes) -> bytes:
    """Return an input as it is published; building one takes ten times as long as pickling its fields."""
    return serialize(build(Message(topic, type_name, pickle.loads(fields)), {}))


def rejections(cdr: bytes) -> list[str]:
    """Return the reasons of the rejected parameters in the reply of a student's node."""
    try:
        reply: Any = deserialize(cdr, message_class(f"{SET_PARAMETERS}_Response"))
    except Exception:  # the bytes come from a student's process: they may be anything
        return []
    reasons = [result.reason or "(no reason)" for result in reply.results if not result.successful]
    return [reason[:LONGEST_REASON] for reason in reasons[:MOST_REJECTIONS]]


ROOM = 4 << 20  # bytes for each topic
ALL = 8 << 20  # bytes for all topics


class ImageRoom:
    """A limit on the bytes of pictures in evidence, by topic and in all."""

    def __init__(self) -> None:
        self._taken = Counter[str]()
        self._kept = 0

    def fitted(self, sample: Sample) -> Sample:
        """Return the sample, without its pixels where there is no more room for them."""
        if sample.type_name not in PICTURES:
            return sample
        self._taken[sample.topic] += len(sample.cdr)
        if self._taken[sample.topic] > ROOM or self._kept + len(sample.cdr) > ALL:
            return _without_pixels(sample)
        self._kept += len(sample.cdr)
        return sample


def _without_pixels(sample: Sample) -> Sample:
    try:
        message: Any = sample.message()
    except Exception:  # the bytes come from a student's process: what is no picture has no header to keep
        return replace(sample, cdr=b"")
    message.data = []
    return replace(sample, cdr=serialize(message))
