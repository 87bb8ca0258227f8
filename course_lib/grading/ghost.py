"""The expected picture of a task, as its text states it: shown pale over what a student's code drew."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from course_lib.grading.evidence import Evidence
from course_lib.grading.message_data import build
from course_lib.grading.task import Task
from course_lib.recording import Recording
from course_lib.ros.clock import START_NS
from course_lib.ros.graph import Sample
from course_lib.ros.messages import serialize
from course_lib.ros.qos import Qos

if TYPE_CHECKING:
    from course_lib.viewer.scene import Scene

PALE = 0.3  # alpha
NAMESPACE = "expected"


def expected(task: Task, personal: Mapping[str, Any]) -> Recording:
    """What a right answer looks like."""
    return Recording(_samples([(m.topic, build(m, personal)) for m in task.ghost], START_NS))


def compared(task: Task, evidence: Evidence) -> "Scene":
    """The student's scene with the expected one in it, pale."""
    from course_lib.displays.render import scene_of

    ghosts = [(message.topic, build(message, evidence.personal)) for message in task.ghost]
    for _, marker in ghosts:
        marker.ns, marker.color.a = NAMESPACE, marker.color.a * PALE
    end_ns = evidence.samples[-1].stamp_ns if evidence.samples else START_NS
    return scene_of(Recording((*evidence.samples, *_samples(ghosts, end_ns))))


def _samples(messages: Sequence[tuple[str, Any]], stamp_ns: int) -> tuple[Sample, ...]:
    return tuple(
        Sample(stamp_ns, topic, message._TYPE_NAME, serialize(message), Qos(), 0)
        for topic, message in messages
    )
