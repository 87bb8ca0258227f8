"""The view below a failed check: what the student drew, and pale in it what is expected."""

from typing import Any

from IPython.display import display
from ipywidgets import HTML, Checkbox, HBox, Layout

from course_lib.grading.evidence import Evidence
from course_lib.grading.reports.scenes import NAMESPACE, compared
from course_lib.grading.task import Task
from course_lib.viewer.scene import described
from course_lib.viewer.widget import SceneWidget

HEIGHT = 260  # [px]
LEGEND = "Full colour: what you drew. Pale: what is expected."


def show_ghost(task: Task, evidence: Evidence) -> None:
    """Display the legend, a box that hides what is expected, and the view."""
    scene = compared(task, evidence)
    pale = [node.path for node in scene.nodes() if node.path.endswith(f"/{NAMESPACE}")]
    tick = Checkbox(
        value=True, description="Show what is expected", indent=False, layout=Layout(width="auto")
    )

    def toggle(change: dict[str, Any]) -> None:
        for path in pale:
            scene.set_visible(path, change["new"])

    tick.observe(toggle, "value")
    display(HBox([tick, HTML(LEGEND, layout=Layout(margin="0 0 0 16px"))]))  # type: ignore[no-untyped-call]  # IPython does not annotate it
    display(SceneWidget(scene, HEIGHT, LEGEND, words=described(scene, LEGEND)))  # type: ignore[no-untyped-call]
