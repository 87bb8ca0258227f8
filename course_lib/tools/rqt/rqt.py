"""`%rqt …`: selects and displays the views."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.graph.graph import current_graph
from course_lib.ros.notices import print_notice
from course_lib.ros.time import pace
from course_lib.ros.time.driving import running_nodes, wait_for
from course_lib.ros.time.pace import SECONDS_WITHOUT_A_PAGE
from course_lib.tools.rqt.graph import GraphView
from course_lib.tools.rqt.monitors import BagView, ConsoleView, PlotView, RobotMonitorView, TopicView
from course_lib.tools.rqt.services import ReconfigureView, ServiceCallerView
from course_lib.tools.rqt.view import RqtView

_CLASSES = (
    GraphView,
    PlotView,
    ConsoleView,
    BagView,
    TopicView,
    ServiceCallerView,
    ReconfigureView,
    RobotMonitorView,
)
VIEWS: Mapping[str, type[RqtView]] = {view.name: view for view in _CLASSES}
# Views of rqt whose function is available elsewhere in the kit.
_ELSEWHERE = {
    "image_view": "the Image display shows images, as in viewer.add('Image', '/camera/image')",
    "publisher": "publish with %ros2 topic pub TOPIC TYPE VALUES",
    "robot_steering": "steer with %ros2 run teleop_twist_keyboard teleop_twist_keyboard",
    "shell": "run commands in a cell, with %ros2 in front of those of ROS",
    "srv": "%ros2 interface show TYPE prints a service",
    "msg": "%ros2 interface show TYPE prints a message",
    "action": "%ros2 interface show TYPE prints an action",
    "tf_tree": "%ros2 run tf2_tools view_frames draws the tree, and the TF display shows the frames",
    "top": "%ros2 node list names the nodes, which share one process",
}
_USAGE = f"Write %rqt {' | '.join(VIEWS)}."


@dataclass
class OpenViews:
    """The open views of a run by their arguments."""

    by_arguments: dict[tuple[str, ...], RqtView] = field(default_factory=dict)


def rqt(words: Sequence[str]) -> None:
    """Run `rqt <words>`: display a view below the cell.

    Raises:
        CourseError: The view does not exist or rejects its arguments.
    """
    match [word for word in words if word != "--force-discover"]:
        case [name, *rest] if not name.startswith("-"):
            plain = name.removeprefix("rqt_")
            if plain in _ELSEWHERE:
                raise CourseError(f"rqt has no view {name!r} here: {_ELSEWHERE[plain]}.")
            if plain not in VIEWS:
                views = f"{', '.join(VIEWS)}{did_you_mean(plain, VIEWS) or '.'}"
                raise CourseError(f"rqt has no view {name!r} here; the views are {views}")
            _show(VIEWS[plain](current_graph(), rest))
        case _:
            raise CourseError(_USAGE)


def _show(view: RqtView) -> None:
    """Display a view that follows the run.

    Without a page, the view receives messages for a fixed time and is displayed as a picture, which
    is updated if the rest of the cell changes it.
    """
    from IPython.core.getipython import get_ipython
    from IPython.display import HTML, display

    opened = current_graph().state(OpenViews).by_arguments
    key = (view.name, *view.arguments)
    # A cell that is run again replaces its view.
    if key in opened:
        opened.pop(key).close()
    opened[key] = view
    if pace.mode() == "real":
        view.show()
        return
    view.listen()
    if running_nodes() and view.listens:
        wait_for(lambda: False, seconds=SECONDS_WITHOUT_A_PAGE)
        print_notice(
            f"No page is watching: rqt received messages for {SECONDS_WITHOUT_A_PAGE:g} s of robot time."
        )
    before = view.static_html()
    handle = display(HTML(before), display_id=True)
    shell: Any = get_ipython()

    def end(*_: object) -> None:
        shell.events.unregister("post_run_cell", end)
        if (now := view.static_html()) != before:
            handle.update(HTML(now))
        view.stop()

    if shell is None:
        view.stop()
    else:
        shell.events.register("post_run_cell", end)
