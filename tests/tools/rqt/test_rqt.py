import asyncio
from collections.abc import Callable, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import yaml  # type: ignore[import-untyped]  # PyYAML ships no types
from rclpy.node import Node
from std_msgs.msg import Bool

from course_lib.errors import CourseError
from course_lib.ros.graph import Graph
from course_lib.tools.rqt.rqt import VIEWS, OpenViews, rqt

Show = Callable[..., str]


class Shell:
    """Stands for IPython: calls what was registered when a cell ends."""

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
    """Runs %rqt and then what follows in its cell; gives what stands below the cell."""
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
def test_without_a_page_each_view_is_a_picture(show: Show, arm: Node, name: str) -> None:
    words: Sequence[str] = ["/arm/joint_states/position[0]"] if name == "plot" else []
    assert VIEWS[name].title in show(name, *words)


def test_without_a_page_views_that_listen_hear_some_seconds(
    show: Show, arm: Node, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "20.00" in show("rqt_topic")
    assert capsys.readouterr().out == "No page is watching: rqt listened for 5 s of robot time.\n"


def test_without_a_page_a_view_hears_the_rest_of_its_cell_and_no_more(show: Show, arm: Node) -> None:
    logger = arm.get_logger()
    shown = show("console", then=lambda: logger.info("in this cell"))
    assert "Displaying 1 of 1 messages" in shown
    assert "in this cell" in shown
    assert "in this cell" not in show("console", then=lambda: logger.info("in the next"))


def test_a_perspective_brings_views_back_as_they_were(show: Show, arm: Node, tmp_path: Path) -> None:
    file = str(tmp_path / "f.perspective")
    show("graph")
    show("plot", "/arm/joint_states/position[0]")
    show("save", file)
    views = yaml.safe_load(Path(file).read_text())
    assert [view["view"] for view in views] == ["graph", "plot"]
    views[0]["controls"]["Show"] = "Nodes only"
    Path(file).write_text(yaml.safe_dump(views))
    shown = show("--force-discover", "--perspective-file", file)
    assert "Node Graph" in shown
    assert "/arm/joint_states/position[0] = " in shown
    show("save", file)
    assert yaml.safe_load(Path(file).read_text()) == views


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[", "is not a perspective"),
        ("a: 1", "is not a perspective of %rqt"),
        ("- view: grahp", "Did you mean graph"),
        ("- {}", "write view, words and controls"),
        ("- {view: graph, controls: {Shw: x}}", "has no control 'Shw'. Did you mean Show"),
        ("- {view: graph, words: 5}", "write view, words and controls"),
        ("- {view: graph, controls: 5}", "write view, words and controls"),
    ],
)
def test_a_broken_perspective_is_an_error(show: Show, tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "f").write_text(text)
    with pytest.raises(CourseError, match=said):
        show("--perspective-file", str(tmp_path / "f"))


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("grap", "rqt has no view 'grap' here, but graph, plot, "),
        ("", "Write %rqt graph | plot"),
        ("--perspective-file /nowhere/f", "Can't read /nowhere/f"),
        ("save /nowhere/f", "Can't write /nowhere/f"),
    ],
)
def test_a_wrong_word_is_explained(show: Show, words: str, said: str) -> None:
    with pytest.raises(CourseError) as error:
        show(*words.split())
    assert said in str(error.value)


def test_a_control_that_cannot_be_set_now_is_said(show: Show, arm: Node, tmp_path: Path) -> None:
    (tmp_path / "f").write_text("- {view: service_caller, controls: {Service: /gone}}")
    assert "“Service” can&#x27;t be &#x27;/gone&#x27; now." in show("--perspective-file", str(tmp_path / "f"))


def test_a_view_that_fits_nothing_now_is_left_out_and_named(
    show: Show, arm: Node, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "f").write_text("- {view: plot, words: [/gone/x]}\n- {view: graph}")
    assert "Node Graph" in show("--perspective-file", str(tmp_path / "f"))
    assert "MatPlot is left out: topic /gone/x does not exist" in capsys.readouterr().out


@pytest.mark.parametrize("topic", ["/rosout", "/parameter_events", "/diagnostics"])
def test_a_topic_of_a_wrong_type_disturbs_no_view(graph: Graph, arm: Node, topic: str) -> None:
    views = [kind(graph, []) for name, kind in VIEWS.items() if name != "bag"]
    for view in views:
        view.listen()
        view.body()
    arm.create_publisher(Bool, topic, 1).publish(Bool(data=True))
    for view in views:
        view.refresh()
        assert "Bool" not in view.notice.value


@pytest.mark.parametrize("name", [name for name in VIEWS if name != "bag"])
def test_in_a_page_every_control_has_a_name_and_close_ends_listening(
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


def test_a_cell_that_is_run_again_closes_its_former_view(show: Show, graph: Graph, arm: Node) -> None:
    show("graph")
    (former,) = graph.part(OpenViews).by_words.values()
    show("graph")
    assert former.closed
    assert len(graph.part(OpenViews).by_words) == 1
