"""Small scenes for reports: the student's drawables, and the expected ones behind them, pale."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from IPython.display import display
from ipywidgets import HTML, Checkbox, HBox, Layout

from course_lib.errors import CourseError
from course_lib.files import write_atomically
from course_lib.grading.evidence import Evidence
from course_lib.grading.inputs import build
from course_lib.grading.records import Run
from course_lib.grading.task import Message, Task, time_limit
from course_lib.recording import Recording
from course_lib.robots.robot import packages_only
from course_lib.ros.graph.graph import START_NS, Sample
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import serialize, type_name
from course_lib.viewer.scene import describe_scene
from course_lib.viewer.widget import SceneWidget

if TYPE_CHECKING:
    from markupsafe import Markup

    from course_lib.viewer.scene import Scene

# Frame rates [1/s] (None: like RViz), each with the maximum size [B] of messages to animate at this
# rate.
SPEEDS = ((None, 3e6), (5, 6e6), (1, 12e6))
SCENE_SECONDS = 5.0  # [s] CPU time per scene
MESSAGE = 500  # [B] minimum size by which a message is counted


@dataclass(frozen=True)
class Figure:
    """A scene of a page: its HTML element or "", a caption and a note."""

    caption: str
    view: "Markup | str"
    note: str = ""


def figures(task: Task, runs: Iterable[Run], room: int) -> list[Figure]:
    """Draw the messages of the first public scenario and, next to it, the expected messages.

    Args:
        task: The task, whose `ghost` is the expected picture.
        runs: The runs of the whole exercise.
        room: Maximum number of characters per scene.
    """
    run = next((run for run in runs if run.evidence.task == task.id and not run.is_hidden), None)
    if run is None or not (run.evidence.samples or task.ghost):
        return []
    inputs, evidence = run.scenario.inputs, run.evidence
    drawn_figures = [_figure("Yours", recording_with_inputs(evidence, inputs), room)]
    if task.ghost:
        drawn_figures.append(_figure("Expected", expected_recording(task, evidence.personal, inputs), room))
    return drawn_figures


def shared_script(folder: Path) -> str:
    """Write the viewer into a folder unless it exists, and return the file's name."""
    from course_lib.viewer import html

    path = folder / f"viewer-{html.bundle().name.rpartition('_')[2]}.js"
    if not path.is_file():
        write_atomically(path, html.bundle_code().encode())
    return path.name


def _figure(caption: str, recording: Recording, room: int) -> Figure:
    """Animate a scene at the highest frame rate that fits, else show its end."""
    if not recording.samples:
        return Figure(caption, "", "Nothing was published.")
    from markupsafe import Markup

    from course_lib.displays.render import record_bag, scene_of
    from course_lib.viewer.html import scene_fragment

    label = f"{caption}: 3D view"
    size = sum(len(sample.cdr) + MESSAGE for sample in recording.samples)
    try:
        with packages_only(), time_limit(SCENE_SECONDS):
            for rate in (rate for rate, max_size in SPEEDS if size <= max_size):
                view = scene_fragment(record_bag(recording, frame_rate=rate)[0], label=label)
                if len(view) <= room:
                    note = f"Reduced to {rate} frames per second, to fit." if rate else ""
                    return Figure(caption, Markup(view), note)
            view = scene_fragment(scene_of(recording), label=label)
            if len(view) > room:
                raise CourseError(
                    f"it has {len(view) // 1000} kB, but a report has room for only {room // 1000} kB"
                )
            return Figure(caption, Markup(view), "Too large to be animated here: this is its end.")
    except Exception as error:
        # Student data can cause any error, and a report is useful without its scene.
        return Figure(caption, "", f"This scene can't be drawn: {error}")


PALE = 0.3  # alpha
NAMESPACE = "expected"


def expected_recording(
    task: Task,
    personal: Mapping[str, Any],
    inputs: Iterable[Message] = (),
) -> Recording:
    """Return a recording of the expected messages, with the scenario's inputs."""
    return _recording(_input_samples(inputs, personal), [(m.topic, build(m, personal)) for m in task.ghost])


def recording_with_inputs(evidence: Evidence, inputs: Iterable[Message]) -> Recording:
    """Return a recording of inputs and evidence. The inputs are needed for their transforms."""
    samples = (*_input_samples(inputs, evidence.personal), *evidence.samples)
    return Recording(sorted(samples, key=lambda sample: sample.stamp_ns))


def comparison_scene(task: Task, evidence: Evidence) -> "Scene":
    """Draw the student's scene together with the expected markers in pale colors."""
    from course_lib.displays.render import scene_of

    ghosts = [(message.topic, build(message, evidence.personal)) for message in task.ghost]
    for _, marker in ghosts:
        marker.ns, marker.color.a = NAMESPACE, marker.color.a * PALE
    return scene_of(_recording(evidence.samples, ghosts))


def _recording(samples: tuple[Sample, ...], messages: Iterable[tuple[str, Any]]) -> Recording:
    end_ns = samples[-1].stamp_ns if samples else START_NS
    return Recording((*samples, *(_sample(end_ns, topic, message) for topic, message in messages)))


def _input_samples(inputs: Iterable[Message], personal: Mapping[str, Any]) -> tuple[Sample, ...]:
    messages = (message for message in inputs if "/srv/" not in message.type_name)
    ordered = sorted(messages, key=lambda message: message.at)
    return tuple(_sample(START_NS + round(m.at * 1e9), m.topic, build(m, personal)) for m in ordered)


def _sample(stamp_ns: int, topic: str, message: Any) -> Sample:
    return Sample(stamp_ns, topic, type_name(message), serialize(message), Qos(), 0)


HEIGHT = 260  # [px]
LEGEND = "Full color: your markers. Pale: the expected markers."


class _Controls(HBox):  # type: ignore[misc]  # ipywidgets is not annotated
    """The box above the view. Pages without a kernel show the legend only."""

    def _repr_mimebundle_(self, **kwargs: Any) -> dict[str, Any]:
        return {**super()._repr_mimebundle_(**kwargs), "text/plain": LEGEND}


def show_ghost(task: Task, evidence: Evidence) -> None:
    """Display the legend, a check box that hides the expected markers, and the view."""
    scene = comparison_scene(task, evidence)
    pale = [node.path for node in scene.nodes() if node.path.endswith(f"/{NAMESPACE}")]
    tick = Checkbox(
        value=True, description="Show the expected markers", indent=False, layout=Layout(width="auto")
    )

    def toggle(change: dict[str, Any]) -> None:
        for path in pale:
            scene.set_visible(path, change["new"])

    tick.observe(toggle, "value")
    display(_Controls([tick, HTML(LEGEND, layout=Layout(margin="0 0 0 16px"))]))
    display(SceneWidget(scene, HEIGHT, LEGEND, words=describe_scene(scene, LEGEND)))
