"""The expected picture of a task, as its text states it: shown pale over what a student's code drew."""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from course_lib.grading.evidence import Evidence
from course_lib.grading.message_data import build
from course_lib.grading.task import Message, Task
from course_lib.recording import Recording
from course_lib.ros.clock import START_NS
from course_lib.ros.graph import Sample
from course_lib.ros.messages import serialize, type_name
from course_lib.ros.qos import Qos

if TYPE_CHECKING:
    from course_lib.viewer.scene import Scene

PALE = 0.3  # alpha
NAMESPACE = "expected"


def expected(task: Task, personal: Mapping[str, Any], inputs: Iterable[Message] = ()) -> Recording:
    """What a right answer looks like, among what our side published."""
    return _recording(_published(inputs, personal), [(m.topic, build(m, personal)) for m in task.ghost])


def seen(evidence: Evidence, inputs: Iterable[Message]) -> Recording:
    """What both sides published: without our transforms a scene lacks its frames."""
    samples = (*_published(inputs, evidence.personal), *evidence.samples)
    return Recording(sorted(samples, key=lambda sample: sample.stamp_ns))


def compared(task: Task, evidence: Evidence) -> "Scene":
    """The student's scene with the expected one in it, pale."""
    from course_lib.displays.render import scene_of

    ghosts = [(message.topic, build(message, evidence.personal)) for message in task.ghost]
    for _, marker in ghosts:
        marker.ns, marker.color.a = NAMESPACE, marker.color.a * PALE
    return scene_of(_recording(evidence.samples, ghosts))


def _recording(samples: tuple[Sample, ...], messages: Iterable[tuple[str, Any]]) -> Recording:
    end_ns = samples[-1].stamp_ns if samples else START_NS
    return Recording((*samples, *(_sample(end_ns, topic, message) for topic, message in messages)))


def _published(inputs: Iterable[Message], personal: Mapping[str, Any]) -> tuple[Sample, ...]:
    shown = (message for message in inputs if "/srv/" not in message.type_name)
    ordered = sorted(shown, key=lambda message: message.at)
    return tuple(_sample(START_NS + round(m.at * 1e9), m.topic, build(m, personal)) for m in ordered)


def _sample(stamp_ns: int, topic: str, message: Any) -> Sample:
    return Sample(stamp_ns, topic, type_name(message), serialize(message), Qos(), 0)
