import asyncio
from collections.abc import Callable, Sequence
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import pytest
from rclpy.node import Node
from std_msgs.msg import Bool

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import Graph
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import serialize
from course_lib.tools.rqt.rqt import VIEWS, OpenViews, rqt
from course_lib.tools.rqt.view import RqtView

Show = Callable[..., str]


class Shell:
    """A substitute for IPython that calls the registered callbacks at the end of a cell."""

    def __init__(self) -> None:
        self.events = self
        self.ends: list[Callable[[object], None]] = []

    def register(self, name: str, end: Callable[[object], None]) -> None:
        self.ends.append(end)

    def unregister(self, name: str, end: Callable[[object], None]) -> None:
        self.ends.remove(end)

    def end_cell(self) -> None:
        for end in list(self.ends):
            end(None)


@pytest.fixture
def shell(monkeypatch: pytest.MonkeyPatch) -> Shell:
    shell = Shell()
    monkeypatch.setattr("IPython.core.getipython.get_ipython", lambda: shell)
    return shell


@pytest.fixture
def show(monkeypatch: pytest.MonkeyPatch, graph: Graph, shell: Shell) -> Show:
    """Run %rqt and the rest of its cell. Return the output of the cell."""
    shown: list[Any] = []

    def display(html: Any, display_id: bool) -> Any:
        shown.append(html)
        return SimpleNamespace(update=lambda now: shown.__setitem__(shown.index(html), now))

    monkeypatch.setattr("IPython.display.display", display)

    def show(*words: str, then: Callable[[], object] = lambda: None) -> str:
        shown.clear()
        rqt(words)
        then()
        shell.end_cell()
        return "".join(one.data for one in shown)

    return show


@pytest.mark.parametrize("name", [name for name in VIEWS if name != "bag"])
def test_each_view_is_an_image_without_a_page(show: Show, arm: Node, name: str) -> None:
    words: Sequence[str] = ["/arm/joint_states/position[0]"] if name == "plot" else []
    assert VIEWS[name].title in show(name, *words)


def test_subscribing_views_without_a_page_run_for_some_seconds(
    show: Show, arm: Node, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "20.00" in show("rqt_topic")
    assert capsys.readouterr().out == "No page is watching: rqt received messages for 5 s of robot time.\n"


def test_view_without_a_page_receives_messages_until_its_cell_ends(show: Show, arm: Node) -> None:
    logger = arm.get_logger()
    output = show("console", then=lambda: logger.info("in this cell"))
    assert "Displaying 1 of 1 messages" in output
    assert "in this cell" in output
    assert "in this cell" not in show("console", then=lambda: logger.info("in the next"))


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("grap", "rqt has no view 'grap' here; the views are graph, plot, "),
        ("", "Write %rqt graph | plot"),
        ("tf_tree", "%ros2 run tf2_tools view_frames"),
        ("rqt_tf_tree", "%ros2 run tf2_tools view_frames"),
        ("image_view", "the Image display shows images"),
        ("publisher", "%ros2 topic pub"),
        ("robot_steering", "%ros2 run teleop_twist_keyboard"),
    ],
)
def test_invalid_argument_is_explained(show: Show, words: str, message: str) -> None:
    with pytest.raises(CourseError) as error:
        show(*words.split())
    assert message in str(error.value)


@pytest.mark.parametrize("topic", ["/rosout", "/parameter_events", "/diagnostics"])
def test_topic_of_another_type_does_not_affect_views(graph: Graph, arm: Node, topic: str) -> None:
    views = [kind(graph, []) for name, kind in VIEWS.items() if name != "bag"]
    for view in views:
        view.listen()
        view.body()
    # Another context, like another process, may use another type.
    endpoint = graph.add_publisher(graph.add_node("other", "/"), topic, "std_msgs/msg/Bool", Qos())
    graph.publish(endpoint, serialize(Bool(data=True)))
    for view in views:
        view.refresh()
        assert "Bool" not in view.notice.value


@pytest.mark.parametrize("name", [name for name in VIEWS if name != "bag"])
def test_controls_have_descriptions_and_close_ends_the_subscription(
    graph: Graph, arm: Node, name: str
) -> None:
    view = VIEWS[name](graph, [])
    taps = len(graph._taps)

    async def shown() -> Any:
        frame = view.widget()
        await asyncio.sleep(0)
        return frame

    head, controls, _, *_ = asyncio.run(shown()).children
    assert all(one.description for one in (*controls.children, *head.children[1:]))
    assert len(graph._taps) == taps + 1
    view.close()
    assert len(graph._taps) == taps


def test_page_without_widgets_shows_the_first_picture_of_a_view(
    graph: Graph, arm: Node, monkeypatch: pytest.MonkeyPatch
) -> None:
    bundles: list[dict[str, str]] = []
    monkeypatch.setattr("IPython.display.display", lambda data, raw: bundles.append(data))
    view = VIEWS["graph"](graph, [])

    async def show() -> None:
        view.show()

    asyncio.run(show())
    view.close()
    assert "application/vnd.jupyter.widget-view+json" in bundles[0]
    assert "Node Graph" in bundles[0]["text/html"]
    assert "/arm" in bundles[0]["text/html"]
    assert bundles[0]["text/plain"].startswith("A view of rqt was here: Node Graph.")


def test_view_spends_at_most_a_tenth_of_the_time_on_its_pictures(
    graph: Graph, monkeypatch: pytest.MonkeyPatch
) -> None:
    now, starts = 0.0, list[float]()  # [s]
    monkeypatch.setattr("course_lib.ros.time.wall.monotonic", lambda: now)

    class SlowView(RqtView):
        name, title = "slow", "Slow"

        def picture(self) -> str:
            nonlocal now
            starts.append(now)
            now += 0.1
            return ""

    view = SlowView(graph, [])
    endpoint = graph.add_publisher(graph.add_node("other", "/"), "/fast", "std_msgs/msg/Bool", Qos())

    async def follow() -> None:
        nonlocal now
        view.widget()
        starts.clear()
        for _ in range(60):
            graph.publish(endpoint, serialize(Bool()))
            now += 0.05
        view.close()

    asyncio.run(follow())
    assert len(starts) >= 3
    assert min(later - earlier for earlier, later in pairwise(starts)) >= 1.0


def test_rerun_cell_closes_its_previous_view(
    show: Show, graph: Graph, arm: Node, monkeypatch: pytest.MonkeyPatch
) -> None:
    show("graph")
    (previous,) = graph.state(OpenViews).by_arguments.values()
    closed: list[bool] = []
    monkeypatch.setattr(previous, "close", lambda: closed.append(True))
    show("graph")
    assert closed == [True]
    assert len(graph.state(OpenViews).by_arguments) == 1
