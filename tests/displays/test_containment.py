"""An exception inside a display becomes its status: it leaves neither publish() nor the other displays."""

import warnings
from pathlib import Path
from typing import Any, ClassVar

import pytest
from geometry_msgs.msg import Point, PointStamped
from std_msgs.msg import String

from course_lib.displays import statuses
from course_lib.displays.display import Display, DrawnDisplay
from course_lib.displays.panel.panels import PanelController
from course_lib.displays.registry import REGISTRY, OwnDisplay, register
from course_lib.displays.statuses import DisplayFaultWarning
from course_lib.displays.viewer import Viewer
from course_lib.ros.graph.graph import Graph, Sample
from course_lib.ros.graph.topics import Qos
from tests.displays.bench import START_NS, Bench
from tests.displays.fuzzing import show_mutations, show_urdfs
from tests.displays.stage import LATCHED, publish, wait

FINE = "displays/Fine/drawn/points"


class FaultyDisplay(DrawnDisplay):
    """A display of the kit with a fault in one of its methods."""

    class_name = "rviz_default_plugins/Faulty"
    type_name = "geometry_msgs/msg/PointStamped"
    fails_in: ClassVar[str] = ""

    def _fail(self, method: str) -> None:
        if self.fails_in == method:
            raise KeyError(f"in {method}")

    def start(self) -> None:
        self._fail("start")
        super().start()

    def receive(self, message: Any) -> None:
        self._fail("receive")
        super().receive(message)

    def convert(self, message: Any, transform_frame_to_fixed: Any) -> Any:
        self._fail("convert")
        return message

    def drawables(self) -> Any:
        self._fail("drawables")
        return {}

    def update(self) -> None:
        self._fail("update")
        super().update()

    def on_property_change(self, label: str) -> None:
        self._fail("on_property_change")
        super().on_property_change(label)

    def rows(self) -> Any:
        self._fail("rows")
        return super().rows()

    def on_view_turn(self, camera: Any) -> None:
        self._fail("on_view_turn")

    def message_at(self, path: str) -> Any:
        self._fail("message_at")


@pytest.fixture(autouse=True)
def faults(monkeypatch: pytest.MonkeyPatch) -> None:
    """Issue each warning again, and know the faulty display."""
    monkeypatch.setattr(statuses, "_warned", set())
    monkeypatch.setattr(statuses, "KIT", str(Path(__file__).parents[2]))
    monkeypatch.setattr(statuses, "line_of_traceback", lambda trace: "")
    monkeypatch.setitem(REGISTRY, FaultyDisplay.class_name, FaultyDisplay)


def bench_with(method: str, monkeypatch: pytest.MonkeyPatch) -> tuple[Bench, Display]:
    monkeypatch.setattr(FaultyDisplay, "fails_in", method)
    bench = Bench()
    bench.transform("map", "base")
    faulty = bench.session.add(FaultyDisplay.class_name, "Faulty", {"Topic": "/points"})
    bench.session.add("rviz_default_plugins/PointStamped", "Fine", {"Topic": "/points"})
    return bench, faulty


def point(x: float = 1.0) -> PointStamped:
    message = PointStamped(point=Point(x=x))
    message.header.frame_id = "base"
    return message


@pytest.mark.parametrize(
    ("method", "status"),
    [
        ("start", "Start"),
        ("receive", "Message"),
        ("convert", "Message"),
        ("drawables", "Message"),
        ("update", "Update"),
        ("on_property_change", "Properties"),
        ("rows", "Statuses"),
    ],
)
def test_exception_in_a_display_is_its_status_and_other_displays_continue(
    method: str, status: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        bench, faulty = bench_with(method, monkeypatch)
        bench.publish("/points", point())
        bench.update()
        if method == "on_property_change":
            faulty["Topic/Filter size"] = 3
        rows = {row.name: row for row in bench.session.rows() if row.display == "Faulty"}
    assert {warning.category for warning in caught} == {DisplayFaultWarning}
    assert "KeyError" in str(caught[0].message)
    assert "error of the kit" in str(caught[0].message)
    assert rows[status].level == "error"
    assert f"KeyError: 'in {method}'" in rows[status].text
    assert FINE in bench.scene.objects()


def test_exception_in_a_display_is_warned_about_once_with_its_line(monkeypatch: pytest.MonkeyPatch) -> None:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        bench, _ = bench_with("update", monkeypatch)
        for step in range(20):
            bench.update(step / 10)
    (warning,) = [one for one in caught if one.category is DisplayFaultWarning]
    assert "tests/displays/test_containment.py, line" in str(warning.message)


def test_fault_warning_raised_by_a_filter_passes_enclosing_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    bench, _ = bench_with("convert", monkeypatch)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(DisplayFaultWarning):
            bench.publish("/points", point())


def test_exception_status_is_cleared_when_the_display_works_again(monkeypatch: pytest.MonkeyPatch) -> None:
    bench, faulty = bench_with("convert", monkeypatch)
    with pytest.warns(DisplayFaultWarning):
        bench.publish("/points", point())
    monkeypatch.setattr(FaultyDisplay, "fails_in", "")
    bench.publish("/points", point(), 0.1)
    bench.update(0.1)
    assert [row for row in faulty.rows() if row.level == "error"] == []


def test_messages_after_a_failing_one_are_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    bench, _ = bench_with("", monkeypatch)
    shown = []

    def convert(self: Any, message: Any, transform: Any) -> Any:
        if message.point.x == 1.0:
            raise ZeroDivisionError
        shown.append(message.point.x)

    monkeypatch.setattr(FaultyDisplay, "convert", convert)
    for number in range(4):
        late = point(float(number))
        late.header.frame_id = "late"
        bench.publish("/points", late)
    bench.transform("base", "late")
    with pytest.warns(DisplayFaultWarning):
        bench.update(0.1)
    assert shown == [0.0, 2.0, 3.0]


def test_interrupts_are_not_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    bench, _ = bench_with("", monkeypatch)

    def convert(self: Any, message: Any, transform: Any) -> Any:
        raise KeyboardInterrupt

    monkeypatch.setattr(FaultyDisplay, "convert", convert)
    with pytest.raises(KeyboardInterrupt):
        bench.publish("/points", point())


def test_undecodable_message_is_an_error_status_without_a_warning() -> None:
    bench = Bench()
    fine = bench.session.add("rviz_default_plugins/PointStamped", "Fine", {"Topic": "/points"})
    bench.session.receive(
        Sample(START_NS, "/points", "geometry_msgs/msg/PointStamped", b"\0\1\0\0abc", Qos(), 1)
    )
    assert bench.status(fine, "Message") is not None
    level, text = bench.status(fine, "Message") or ("", "")
    assert level == "error"
    assert "These 7 bytes are not a valid geometry_msgs/msg/PointStamped" in text


def test_exception_in_a_custom_display_is_reported_with_its_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.undo()

    @register
    class Careless(OwnDisplay):
        class_name = "my_robot/Careless"
        type_name = "std_msgs/msg/String"

        def process(self, message: Any) -> None:
            raise IndexError("my own")

    bench = Bench()
    try:
        own = bench.session.add("my_robot/Careless", "Careless", {"Topic": "/words"})
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            bench.publish("/words", String(data="x"))
    finally:
        del REGISTRY["my_robot/Careless"]
    level, text = bench.status(own, "Message") or ("", "")
    assert level == "error"
    assert text.startswith("IndexError: my own (test_containment.py, line ")
    assert text.endswith('raise IndexError("my own"))')


class Page:
    """A link to a page, as the panels use it."""

    watched = True

    def __init__(self) -> None:
        self.listeners: dict[str, Any] = {}
        self.posted: list[Any] = []

    def listen(self, kind: str, callback: Any) -> None:
        self.listeners[kind] = callback

    def post(self, content: Any, buffers: Any = ()) -> None:
        self.posted.append(content)


def test_exception_during_a_page_request_is_shown_in_the_page(monkeypatch: pytest.MonkeyPatch) -> None:
    bench, _ = bench_with("message_at", monkeypatch)
    page: Any = Page()
    PanelController(bench.session, page)
    with pytest.warns(DisplayFaultWarning):
        page.listeners["panels"]({"act": "SelectObject", "path": FINE, "index": 0})
    notice = page.posted[-1]["changed"]["notice"]
    assert notice["level"] == "error"
    assert "KeyError: 'in message_at'" in notice["text"]


def test_exception_in_a_panel_does_not_affect_the_publisher() -> None:
    bench = Bench()

    def fail() -> None:
        raise OSError("the page is gone")

    bench.session.after_frame.append(fail)
    with pytest.warns(DisplayFaultWarning):
        bench.update()
    (row,) = [row for row in bench.session.rows() if row.name == "Page"]
    assert (row.display, row.level) == ("Global Status", "error")


RGBA = ("0.8 0 0", "1,0,0,1", "", "red", "0.8 0 0 1 1", "nan 0 0 1", "255 0 0 1", "-1 0 0 1")
BOX = "<geometry><box size='1 1 1'/></geometry>"


def painted(material: str) -> str:
    return f'<robot name="r"><link name="base"><visual>{BOX}{material}</visual></link></robot>'


@pytest.mark.parametrize("rgba", RGBA)
def test_malformed_color_is_reported_and_the_robot_is_drawn(rgba: str, graph: Graph) -> None:
    viewer = Viewer("base")
    viewer.add("RobotModel", "/description")
    material = f'<material name="m"><color rgba="{rgba}"/></material>'
    publish(graph, "/description", String(data=painted(material)), LATCHED)
    wait(graph, 0.1)
    rows = {(row.name, row.level): row.text for row in viewer.statuses() if row.display == "RobotModel"}
    assert rows["URDF", "ok"] == "URDF parsed OK"
    assert "Material [m] has" in rows["URDF", "hint"]
    assert "displays/RobotModel/links/base/visual/0" in viewer.scene.objects()


@pytest.mark.slow
def test_each_display_class_contains_errors_of_malformed_messages() -> None:
    assert list(show_mutations(seed=0, count=40, pictures=10)) == []


@pytest.mark.slow
def test_errors_of_malformed_urdfs_are_contained(capsys: pytest.CaptureFixture[str]) -> None:
    assert list(show_urdfs(seed=0, count=300)) == []
    assert "Traceback" not in capsys.readouterr().err
