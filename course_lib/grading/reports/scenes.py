"""Scenes of reports, small enough to be sent, and expected scenes."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_lib.course.state import write_whole
from course_lib.errors import CourseError
from course_lib.grading.evidence import Evidence
from course_lib.grading.personal import build
from course_lib.grading.run.job import Run
from course_lib.grading.task import Message, Task
from course_lib.grading.time_limit import time_limit
from course_lib.recording import Recording
from course_lib.robots.resources import packages_only
from course_lib.ros.clock import START_NS
from course_lib.ros.graph import Sample
from course_lib.ros.messages import serialize, type_name
from course_lib.ros.qos import Qos

if TYPE_CHECKING:
    from markupsafe import Markup

    from course_lib.viewer.scene import Scene

SPEEDS = ((None, 3e6), (5, 6e6), (1, 12e6))  # frames/s, None: as RViz; bytes of what may be filmed with it
SCENE_SECONDS = 5.0  # [s] of processor time for each
MESSAGE = 500  # [B] that a message counts as, however small it is


@dataclass(frozen=True)
class Figure:
    """A scene of a page: its element, "" if there is none, a caption and a note."""

    caption: str
    view: "Markup | str"
    note: str = ""


def figures(task: Task, runs: Iterable[Run], room: int) -> list[Figure]:
    """Draw the messages of the first public scenario, and beside them the expected messages.

    Args:
        task: Its ghost is what was expected.
        runs: Of the whole exercise.
        room: Characters that each scene may have.
    """
    run = next((run for run in runs if run.evidence.task == task.id and not run.hidden), None)
    if run is None or not (run.evidence.samples or task.ghost):
        return []
    inputs, evidence = run.scenario.inputs, run.evidence
    made = [_figure("Yours", seen(evidence, inputs), room)]
    if task.ghost:
        made.append(_figure("Expected", expected(task, evidence.personal, inputs), room))
    return made


def shared_script(folder: Path) -> str:
    """Write the viewer into a folder, if it is not there yet, and return the file's name."""
    from course_lib.viewer import assets, html

    path = folder / f"viewer-{assets.bundle_name().rpartition('_')[2]}.js"
    if not path.is_file():
        write_whole(path, html.bundle_code().encode())
    return path.name


def _figure(caption: str, recording: Recording, room: int) -> Figure:
    if not recording.samples:
        return Figure(caption, "", "Nothing was published.")
    try:
        with packages_only(), time_limit(SCENE_SECONDS):
            return _fitting(caption, recording, room)
    except Exception as error:  # what students publish may be anything; the reasons matter more than the view
        return Figure(caption, "", f"This scene can't be drawn: {error}")


def _fitting(caption: str, recording: Recording, room: int) -> Figure:
    """Play the scene in as many frames a second as there is room for, else show its end."""
    from markupsafe import Markup

    from course_lib.displays.render import film_of, scene_of
    from course_lib.viewer.html import scene_fragment

    size = sum(len(sample.cdr) + MESSAGE for sample in recording.samples)
    for rate, most in SPEEDS:
        if size <= most:
            view = scene_fragment(film_of(recording, frame_rate=rate)[0], label=f"{caption}: 3D view")
            if len(view) <= room:
                return Figure(caption, Markup(view), f"Thinned to {rate} a second, to fit." if rate else "")
    view = scene_fragment(scene_of(recording), label=f"{caption}: 3D view")
    if len(view) > room:
        raise CourseError(f"it has {len(view) // 1000} kB, and a report has room for {room // 1000} kB")
    return Figure(caption, Markup(view), "Too much to be played here: this is its end.")


PALE = 0.3  # alpha
NAMESPACE = "expected"


def expected(task: Task, personal: Mapping[str, Any], inputs: Iterable[Message] = ()) -> Recording:
    """Return a recording of the expected messages, with the scenario's inputs."""
    return _recording(_published(inputs, personal), [(m.topic, build(m, personal)) for m in task.ghost])


def seen(evidence: Evidence, inputs: Iterable[Message]) -> Recording:
    """Return a recording of inputs and evidence; without the inputs' transforms a scene lacks its frames."""
    samples = (*_published(inputs, evidence.personal), *evidence.samples)
    return Recording(sorted(samples, key=lambda sample: sample.stamp_ns))


def compared(task: Task, evidence: Evidence) -> "Scene":
    """Draw the student's scene, with the expected markers in it, pale."""
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
