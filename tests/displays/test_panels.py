import asyncio
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from visualization_msgs.msg import InteractiveMarkerUpdate

from course_lib.displays.layout import read_layout
from course_lib.displays.panel.panels import PanelController
from course_lib.displays.session import RvizSession
from course_lib.displays.viewer import Viewer
from course_lib.displays.views import FrameAligned, XYOrbit
from course_lib.errors import CourseError
from course_lib.ros.graph.graph import Graph
from course_lib.ros.graph.topics import Qos
from course_lib.viewer.page_link import PageLink
from course_lib.viewer.scene import Scene
from tests.displays.bench import marker
from tests.displays.stage import publish
from tests.displays.test_layout import LAYOUT


class Page:
    """The state of a page, assembled from the messages to it."""

    def __init__(self, session: RvizSession, graph: Graph | None = None) -> None:
        self.told: dict[str, Any] = {}
        self.told_rows: dict[str, dict[str, Any]] = {}
        self.link = PageLink(session.context.scene, self._take)
        self.controller = PanelController(session, self.link, graph)
        self.ask(act="OpenPanels")

    def ask(self, **command: Any) -> None:
        self.link.receive({"type": "panels", "page": "one", "number": 0, **command})

    def rows(self) -> list[dict[str, Any]]:
        return [self.told_rows[key] for key in self.told["tree"]]

    def key(self, label: str) -> str:
        return str(next(row["key"] for row in self.rows() if row["label"] == label))

    def _take(self, content: dict[str, Any], _: list[bytes]) -> None:
        if content["type"] == "panels":
            self.told |= content["changed"]
            self.told_rows |= content["rows"]
            for key in content["gone"]:
                del self.told_rows[key]


@pytest.fixture
def viewer(graph: Graph) -> Viewer:
    viewer = Viewer()
    viewer.add("Marker", topic="/m")
    publish(graph, "/m", marker())
    viewer.refresh()
    return viewer


@pytest.fixture
def page(viewer: Viewer, graph: Graph, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Page:
    monkeypatch.chdir(tmp_path)
    return Page(viewer.session, graph)


def test_rows_are_listed_after_their_parent_rows(page: Page) -> None:
    known = {""}
    for row in page.rows():
        assert row["parent"] in known
        known.add(row["key"])


def test_changed_rows_are_sent_between_commands_only_while_a_panel_is_open(
    page: Page, viewer: Viewer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("course_lib.displays.panel.panels.PERIOD", 0.0)
    viewer.add("Axes")
    assert page.told["status"]["text"].endswith("No tf data.  Actual error: Frame [map] does not exist")
    assert "Axes" not in [row["label"] for row in page.rows()]
    page.ask(act="WatchRows", watched=True)
    assert "Axes" in [row["label"] for row in page.rows()]
    viewer.add("Grid")
    assert "Grid" in [row["label"] for row in page.rows()]
    page.ask(act="WatchRows", watched=False)
    viewer.add("Path")
    assert "Path" not in [row["label"] for row in page.rows()]


def test_open_panel_shows_values_set_by_a_program_while_no_node_runs(
    page: Page, viewer: Viewer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("course_lib.displays.panel.panels.PERIOD", 0.0)
    page.ask(act="WatchRows", watched=True)
    viewer.options["Look"] = "Studio"
    viewer["Grid"]["Alpha"] = 0.25
    viewer.view["Distance"] = 3.0
    values = {row["label"]: row.get("value") for row in page.told_rows.values()}
    assert (values["Look"], values["Alpha"], values["Distance"]) == ("Studio", 0.25, 3.0)


def test_page_that_was_closed_with_an_open_panel_gets_no_rows(
    page: Page, viewer: Viewer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("course_lib.displays.panel.panels.PERIOD", 0.0)
    page.ask(act="WatchRows", watched=True)
    page.link.receive({"type": "views", "page": "two", "number": 0, "count": 1})
    page.link.receive({"type": "views", "page": "one", "number": 0, "count": 0})
    viewer.add("Axes")
    assert "Axes" not in [row["label"] for row in page.rows()]


@pytest.mark.parametrize("sight", ["hide", "away"])
def test_hidden_page_receives_changed_rows_when_it_is_visible_again(
    sight: str, page: Page, viewer: Viewer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("course_lib.displays.panel.panels.PERIOD", 0.0)
    page.link.receive({"type": sight, "page": "one", "number": 0})
    viewer.add("Axes")
    assert "Axes" not in [row["label"] for row in page.rows()]
    page.link.receive({"type": "ready", "page": "one", "number": 0})
    assert "Axes" in [row["label"] for row in page.rows()]


def test_only_changed_rows_are_sent(page: Page, viewer: Viewer, monkeypatch: pytest.MonkeyPatch) -> None:
    posted: list[dict[str, Any]] = []
    monkeypatch.setattr(page.link, "post", posted.append)
    page.controller.post()
    assert posted == []
    viewer["Grid"]["Alpha"] = 0.25
    page.controller.post()
    assert (posted[-1]["changed"], list(posted[-1]["rows"])) == ({}, ["displays/Grid#Alpha"])


def test_creating_rows_does_not_search_for_similar_names(
    page: Page, viewer: Viewer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("course_lib.displays.properties.nearest", lambda name, *_: pytest.fail(name))
    viewer.add("Axes")
    page.controller.post()
    assert "Axes" in [row["label"] for row in page.rows()]


def test_marker_namespace_has_a_check_box(page: Page, viewer: Viewer) -> None:
    page.ask(act="SetValue", row="displays/Marker#Namespaces#n", value=False)
    assert viewer["Marker"]["Namespaces"] == {"n": False}
    assert not [path for path in viewer.scene.objects() if path.startswith("displays/Marker")]


HIDDEN_ROWS: tuple[tuple[str, dict[str, Any], set[str], set[str]], ...] = (
    ("Pose", {}, {"Shaft Length"}, {"Axes Length"}),
    ("Pose", {"Shape": "Axes"}, {"Axes Length"}, {"Color", "Alpha", "Shaft Length"}),
    ("PoseArray", {}, {"Arrow Length", "Color"}, {"Shaft Length", "Axes Radius"}),
    ("Path", {}, {"Color"}, {"Line Width", "Length", "Pose Color"}),
    ("Path", {"Pose Style": "Arrows"}, {"Pose Color", "Head Diameter"}, {"Length"}),
    ("Grid", {"Line Style": "Billboards"}, {"Line Width"}, set()),
    ("PointCloud2", {}, {"Size (m)"}, {"Size (Pixels)", "Channel Name", "Axis", "Color"}),
    ("PointCloud2", {"Style": "Points"}, {"Size (Pixels)"}, {"Size (m)"}),
    (
        "PointCloud2", {"Color Transformer": "Intensity"},
        {"Invert Rainbow"}, {"Min Color", "Min Intensity", "Autocompute Value Bounds", "Min Value"},
    ),
    (
        "LaserScan", {"Color Transformer": "AxisColor", "Autocompute Value Bounds": False},
        {"Axis", "Min Value"}, {"Channel Name", "Min Intensity"},
    ),
    ("Temperature", {"Color Transformer": "Intensity"}, {"Min Intensity"}, {"Color Transformer"}),
    (
        "DepthCloud", {"Auto Size": False},
        {"Auto Size", "Color Transformer"},
        {"Auto Size Factor", "Occlusion Time-Out", "Position Transformer"},
    ),
    ("Image", {}, {"Topic"}, {"Normalize Range", "Min Value", "Median window"}),
    ("Odometry", {"Covariance/Orientation/Color Style": "RGB"}, {"Color Style", "Frame"}, {"Axes Length"}),
    ("RobotModel", {}, {"Description Topic", "Depth"}, {"Description File", "Links"}),
    ("RobotModel", {"Description Source": "File"}, {"Description File"}, {"Description Topic", "Depth"}),
)  # fmt: skip


@pytest.mark.parametrize(("name", "values", "shown", "hidden"), HIDDEN_ROWS)
def test_panel_hides_rows_without_an_effect_as_rviz_does(
    name: str, values: dict[str, Any], shown: set[str], hidden: set[str], page: Page, viewer: Viewer
) -> None:
    display = viewer.add(name)
    for label, value in values.items():
        display[label] = value
    page.ask(act="OpenPanels")
    (*_, above) = [row["key"] for row in page.rows() if row["label"] == name]
    labels = {row["label"] for row in page.rows() if row["key"].startswith(f"{above}#")}
    assert shown <= labels
    assert not hidden & labels


def test_size_from_the_camera_is_read_only_as_in_rviz(page: Page, viewer: Viewer) -> None:
    cloud = viewer.add("DepthCloud")
    page.ask(act="OpenPanels")
    size = f"{page.key('DepthCloud')}#Size (m)"
    kinds = []
    for is_automatic in (True, False):
        cloud["Auto Size"] = is_automatic
        page.ask(act="RequestUpdate")
        kinds.append(next(row for row in page.rows() if row["key"] == size)["editor"]["kind"])
    assert kinds == ["none", "number"]


def test_rows_of_properties_have_the_descriptions_of_rviz(page: Page, viewer: Viewer) -> None:
    viewer.add("PointCloud2", topic="/c")
    page.ask(act="OpenPanels")
    titles = {row["key"]: row.get("title", "") for row in page.rows()}
    cloud = page.key("PointCloud2")
    assert titles[f"{cloud}#Topic"] == "sensor_msgs/msg/PointCloud2 topic to subscribe to."
    assert titles[f"{cloud}#Decay Time"].startswith("Duration, in seconds, to keep the incoming points.")
    assert titles["options#Fixed Frame"].startswith("Frame into which all data is transformed")


def test_invalid_value_is_reported_and_changes_nothing(page: Page, viewer: Viewer) -> None:
    page.ask(act="SetValue", row="displays/Grid#Cell Size", value=None)
    assert page.told["notice"]["level"] == "error"
    assert "'Cell Size' is None, expected a number" in page.told["notice"]["text"]
    assert viewer["Grid"]["Cell Size"] == 1.0


@pytest.mark.parametrize(
    "command",
    [
        {"act": "nothing"}, {}, {"act": "SetValue"}, {"act": "SetValue", "row": "options", "value": 1},
        {"act": "AddDisplay", "display": "No/Such"}, {"act": "RemoveRow", "row": "options"},
        {"act": "TurnView", "eye": [0, 0, "x"], "target": [0, 0, 0], "up": [0, 0, 1], "scale": 0},
        {"act": "PublishGesture", "tool": "2D Goal Pose", "point": None},
        {"act": "PublishGesture", "tool": "Laser"},
        {"act": "SaveLayout", "name": "../over/there"}, {"act": "LoadLayout", "name": "absent.rviz"},
        {"act": "ChangeView", "view": "Sideways"}, {"act": "UseView", "index": 7},
        {"act": "RemoveView", "index": -1},
        {"act": "RequestUpdate", "hard": True}, {"act": "RenameRow", "row": 1, "name": "x"},
        {"act": "AddDisplay", "display": "rviz_default_plugins/Grid", "topic": None},
    ],
    ids=str,
)  # fmt: skip
def test_invalid_requests_are_answered_with_an_error(page: Page, command: dict[str, Any]) -> None:
    page.ask(**command)
    assert page.told["notice"]["level"] == "error"


def test_group_is_toggled_and_removed_along_with_its_displays(page: Page, viewer: Viewer) -> None:
    Path("old.rviz").write_text(LAYOUT.replace("Enabled: false", "Enabled: true"))
    page.ask(act="LoadLayout", name="old.rviz")
    page.ask(act="SetValue", row=page.key("Group"), value=False)
    assert not viewer["Boxes"].enabled
    page.ask(act="SetValue", row=page.key("Group"), value=True)
    assert viewer["Boxes"].enabled
    page.ask(act="RemoveRow", row=page.key("Group"))
    assert [display.name for display in viewer.displays] == ["My grid", "Old", "From ROS 1"]


def test_views_without_a_name_are_named_by_their_type(page: Page, viewer: Viewer) -> None:
    page.ask(act="SaveView", name=" ")
    page.ask(act="RenameView", index=0, name="")
    assert [view.name for view in viewer.session.saved_views] == ["Orbit"]


def test_layouts_written_in_lessons_can_be_loaded_and_saved(page: Page) -> None:
    Path("my_files").mkdir()
    Path("my_files/old.rviz").write_text(LAYOUT)
    page.ask(act="RequestUpdate")
    assert "my_files/old.rviz" in page.told["layouts"]["files"]
    page.ask(act="LoadLayout", name="my_files/old.rviz")
    page.ask(act="SaveLayout", name="my_files/new.rviz")
    assert page.told["notice"] == {"level": "ok", "text": "Saved my_files/new.rviz."}
    assert Path("my_files/new.rviz").is_file()


def test_duplicated_display_has_the_same_properties(page: Page, viewer: Viewer) -> None:
    viewer["Grid"]["Cell Size"] = 3.0
    page.ask(act="RequestUpdate")
    page.ask(act="DuplicateDisplay", row="displays/Grid")
    assert viewer.displays[-1]["Cell Size"] == 3.0
    assert viewer.displays[-1].path != "displays/Grid"


def test_topics_of_the_graph_can_be_added_before_the_first_message(page: Page, graph: Graph) -> None:
    node = graph.add_node("silent", "/")
    graph.add_publisher(node, "/scan", "sensor_msgs/msg/LaserScan", Qos())
    page.ask(act="RequestUpdate")
    display = "rviz_default_plugins/LaserScan"
    expected = {"topic": "/scan", "type": "sensor_msgs/msg/LaserScan", "display": display}
    assert expected in page.told["topics"]


def test_display_can_be_added_with_any_topic_name(page: Page, viewer: Viewer) -> None:
    page.ask(act="AddDisplay", display="rviz_default_plugins/RobotModel", topic="/robot_description")
    assert viewer.displays[-1]["Description Topic"] == "/robot_description"


def test_tools_do_not_publish_into_a_recording() -> None:
    page = Page(RvizSession(Scene()))
    page.ask(act="PublishGesture", tool="2D Goal Pose", point=[0, 0, 0], angle=0)
    assert "recording" in page.told["notice"]["text"]


def test_node_of_the_tools_is_removed_with_the_viewer(page: Page, viewer: Viewer, graph: Graph) -> None:
    page.ask(act="PublishGesture", tool="Publish Point", point=[1, 2, 3])
    assert page.told["notice"]["text"] == "Published (1.00, 2.00, 3.00) in map on /clicked_point."
    assert [node.name for node in graph.nodes()][-1] == "rviz2"
    viewer.close()
    assert "rviz2" not in [node.name for node in graph.nodes()]


def test_layout_sets_the_topic_of_a_tool(page: Page, graph: Graph) -> None:
    tools = "  Tools:\n    - Class: rviz_default_plugins/SetGoal\n      Topic: /move_base_simple/goal\n"
    Path("old.rviz").write_text(LAYOUT.replace("  Views:\n", tools + "  Views:\n"))
    page.ask(act="LoadLayout", name="old.rviz")
    page.ask(act="PublishGesture", tool="2D Goal Pose", point=[0, 0, 0], angle=0)
    assert [end.topic for end in graph.endpoints()][-1] == "/move_base_simple/goal"


def test_tool_properties_are_edited_and_saved(page: Page, viewer: Viewer, graph: Graph) -> None:
    page.ask(act="SetValue", row="tool 2D Pose Estimate#Covariance x", value=0.5)
    page.ask(act="SetValue", row="tool 2D Goal Pose#Topic", value="/my_goal")
    page.ask(act="SetValue", row="tool 2D Goal Pose#Topic#Reliability Policy", value="Best Effort")
    page.ask(act="SetValue", row="tool Publish Point#Single click", value=False)
    page.ask(act="SetValue", row="tool Measure#Line color", value=[1, 2, 3])
    assert page.told["settings"] == {"single": False, "color": "rgb(1, 2, 3)"}
    page.ask(act="PublishGesture", tool="2D Goal Pose", point=[1.0, 2.0, 0.0], angle=0.0)
    (end,) = (end for end in graph.endpoints() if end.topic == "/my_goal")
    assert (end.qos.reliability, end.qos.depth) == ("best_effort", 5)
    page.ask(act="SaveLayout", name="tools.rviz")
    reloaded = RvizSession(Scene())
    reloaded.apply(read_layout("tools.rviz"))
    assert [reloaded.tools[5]["Covariance x"], reloaded.tools[6]["Topic"]] == [0.5, "/my_goal"]


def test_displays_are_added_to_the_selected_group(page: Page, viewer: Viewer) -> None:
    page.ask(act="AddDisplay", display="rviz_common/Group")
    row = page.key("Group")
    page.ask(act="AddDisplay", display="rviz_default_plugins/Axes", row=row)
    assert [row["parent"] for row in page.rows() if row["label"] == "Axes"] == [row]
    page.ask(act="SetValue", row=row, value=False)
    assert not viewer["Axes"].enabled


def test_update_topic_of_a_marker_server_adds_a_display(page: Page, viewer: Viewer) -> None:
    publish(viewer._graph, "/menu/update", InteractiveMarkerUpdate())
    page.ask(act="RequestUpdate")
    shown = next(shown for shown in page.told["topics"] if shown["topic"] == "/menu/update")
    page.ask(act="AddDisplay", topic=shown["topic"], display=shown["display"])
    assert viewer["InteractiveMarkers"]["Interactive Markers Namespace"] == "/menu"


def test_key_z_resets_a_view(page: Page, viewer: Viewer) -> None:
    viewer.view = XYOrbit(distance=3.0, focal_point=(1.0, 2.0, 0.0))
    page.ask(act="HomeView")
    assert (viewer.view["Distance"], viewer.view["Focal Point"]) == (10.0, (0.0, 0.0, 0.0))


def test_page_receives_the_mouse_settings_of_each_view(page: Page, viewer: Viewer) -> None:
    viewer.view = XYOrbit()
    page.ask(act="RequestUpdate")
    assert page.told["drag"] == {
        "inPlace": False, "aligned": False, "locked": False, "lift": 0.2, "ground": 0.0,
        "focalSize": 0.05, "focalFixed": True,
    }  # fmt: skip
    viewer.view = FrameAligned(lock_camera=True)
    page.ask(act="RequestUpdate")
    drag_rules = page.told["drag"]
    assert (drag_rules["inPlace"], drag_rules["aligned"], drag_rules["locked"], drag_rules["lift"]) == (
        True,
        True,
        True,
        0.0,
    )


def test_unselectable_cloud_cannot_be_selected(page: Page, viewer: Viewer) -> None:
    cloud = viewer.add("PointCloud2")
    page.ask(act="SelectObject", path=f"{cloud.path}/drawn", index=1)
    assert page.told["selection"].startswith("PointCloud2")
    cloud["Selectable"] = False
    page.ask(act="SelectObject", path=f"{cloud.path}/drawn", index=1)
    assert not page.told["selection"].startswith("PointCloud2")


def test_summary_lists_objects_with_their_positions(viewer: Viewer) -> None:
    words = viewer.summary()
    assert "Fixed frame map. Displays: Grid, Marker." in words
    assert "displays/Marker/n/0" in words
    assert "1 box at (0, 0, 0)" in words
    assert "messages received" in words


async def _picked(viewer: Viewer) -> object:
    return await viewer.pick()


def test_waiting_for_a_click_without_a_page_fails_immediately(viewer: Viewer) -> None:
    with pytest.raises(CourseError, match="No page shows this viewer"):
        asyncio.run(_picked(viewer))


def test_click_callbacks_are_called(viewer: Viewer, graph: Graph) -> None:
    received: list[Any] = []
    callback: Callable[[Any], None] = viewer.on_click(received.append)
    assert callback == received.append
    viewer._repr_mimebundle_()
    assert viewer._cell._view is not None
    click = {"type": "click", "page": "one", "number": 0, "origin": [0, 0, 1], "direction": [0, 0, -1]}
    viewer._cell._view.link.receive(click)
    assert [(one.path, one.origin) for one in received] == [(None, (0, 0, 1))]
    viewer.close()
