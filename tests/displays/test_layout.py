from pathlib import Path

import pytest

from course_lib.displays.layout import Layout, read_layout
from course_lib.displays.session import RvizSession
from course_lib.displays.writer import document
from course_lib.errors import CourseError
from course_lib.ros.graph.topics import Qos
from course_lib.viewer.scene import Scene

LAYOUT = """\
Panels:
  - Class: rviz_common/Displays
    Name: Displays
Visualization Manager:
  Class: ""
  Displays:
    - Alpha: 0.5
      Cell Size: 2
      Class: rviz_default_plugins/Grid
      Enabled: true
      Line Style:
        Line Width: 0.1
        Value: Billboards
      Name: My grid
      Value: true
    - Class: rviz_common/Group
      Displays:
        - Class: rviz_default_plugins/MarkerArray
          Enabled: false
          Name: Boxes
          Namespaces:
            {}
          Topic:
            Depth: 7
            Durability Policy: Transient Local
            History Policy: Keep Last
            Reliability Policy: Best Effort
            Value: /boxes
      Name: Group
    - Class: rviz_default_plugins/Marker
      Name: Old
      Queue Size: 3
      Topic: /old
      Unreliable: true
    - Class: rviz/Grid
      Name: From ROS 1
  Enabled: true
  Global Options:
    Background Color: 200; 220; 255
    Fixed Frame: /world
    Frame Rate: 10
  Views:
    Current:
      Class: rviz_default_plugins/XYOrbit
      Distance: 3.5
      Focal Point:
        X: 1
        Y: 2
        Z: 0
      Near Clip Distance: 0.1
      Pitch: 0.3
      Target Frame: <Fixed Frame>
      Value: XYOrbit (rviz)
      Yaw: 1.5
    Saved: ~
"""


@pytest.fixture
def session(tmp_path: Path) -> RvizSession:
    path = tmp_path / "view.rviz"
    path.write_text(LAYOUT)
    session = RvizSession(Scene())
    session.apply(read_layout(path))
    return session


def test_layout_sets_options_displays_and_view(session: RvizSession) -> None:
    assert (session.fixed_frame, session.time.frame_rate) == ("world", 10)
    assert session.context.scene.background == (200, 220, 255)
    assert [display.name for display in session.displays] == ["My grid", "Boxes", "Old", "From ROS 1"]
    view = session.view
    assert repr(view) == "XYOrbit"
    labels = ("Distance", "Yaw", "Pitch", "Focal Point", "Near Clip Distance")
    assert [view[label] for label in labels] == [3.5, 1.5, 0.3, (1.0, 2.0, 0.0), 0.1]


def test_properties_are_read_by_rviz_labels(session: RvizSession) -> None:
    grid, boxes = session.displays[:2]
    labels = ("Alpha", "Cell Size", "Line Style", "Line Width", "Enabled")
    assert [grid[label] for label in labels] == [0.5, 2.0, "Billboards", 0.1, True]
    assert not boxes.enabled
    boxes["Enabled"] = True
    (subscription,) = boxes.subscriptions
    assert subscription.topic == "/boxes"
    assert subscription.qos == Qos(depth=7, reliability="best_effort", durability="transient_local")


def test_topics_in_the_format_before_galactic_are_read(session: RvizSession) -> None:
    old = session.displays[2].subscriptions[0]
    assert old.topic == "/old"
    assert old.qos == Qos(depth=3, reliability="best_effort")


def test_displays_in_a_disabled_group_are_not_shown(tmp_path: Path) -> None:
    path = tmp_path / "view.rviz"
    text = LAYOUT.replace("Enabled: false", "Enabled: true").replace(
        "Group\n    ", "Group\n      Enabled: false\n    "
    )
    path.write_text(text)
    session = RvizSession(Scene())
    session.apply(read_layout(path))
    grid, boxes = session.displays[:2]
    assert grid.enabled
    assert boxes["Enabled"]
    assert not boxes.enabled
    group = session.tree.find_group_of(boxes)
    group.is_enabled = True
    session.tree.update_visibility()
    assert boxes.enabled


def test_ros_1_class_fails_as_in_rviz2(session: RvizSession) -> None:
    error, hint = session.displays[3].rows()
    assert error.level == "error"
    assert "'rviz/Grid', could not be loaded" in error.text
    assert hint.level == "hint"
    assert hint.text == "rviz/Grid is ROS 1's name. RViz2 has the class rviz_default_plugins/Grid."


@pytest.mark.parametrize(
    ("required", "suggested"),
    {
        "rviz/Group": "rviz_common/Group",
        "rviz_common/Grid": "rviz_default_plugins/Grid",
        "rviz_default_plugin/Markr": "rviz_default_plugins/Marker",
        "Path": "rviz_default_plugins/Path",
        "rviz_plugins/Path": "",
        "autoware_rviz_plugins/PoseWithCovariance": "",
    }.items(),
)
def test_class_of_another_package_has_no_hint(required: str, suggested: str) -> None:
    session = RvizSession(Scene())
    session.apply(Layout(displays=({"Class": required, "Name": "it"},)))
    hints = [row.text for row in session.displays[0].rows() if row.level == "hint"]
    expected = [f"{suggested}."] if suggested else []
    assert [hint.rpartition("RViz2 has the class ")[2] for hint in hints] == expected


def test_unknown_configuration_entries_are_kept(session: RvizSession) -> None:
    assert session.displays[0].config["Value"] == "true"


def test_invalid_values_keep_the_default_and_are_shown_as_hints(tmp_path: Path) -> None:
    path = tmp_path / "view.rviz"
    path.write_text(
        LAYOUT.replace("Cell Size: 2", "Cell Size: wide").replace("3.5", "far").replace("XYO", "O")
    )
    session = RvizSession(Scene())
    session.apply(read_layout(path))
    assert session.displays[0]["Cell Size"] == 1.0
    hints = [row.text for row in session.rows() if row.level == "hint"]
    assert any("'Cell Size' is 'wide', expected a number" in hint for hint in hints)
    assert any("'Distance' is 'far', expected a number" in hint for hint in hints)


@pytest.mark.parametrize("value", ["1e999", ".inf", "1e39", "true"])
def test_numbers_out_of_range_in_rviz_are_ignored(value: str, tmp_path: Path) -> None:
    path = tmp_path / "view.rviz"
    path.write_text(LAYOUT.replace("X: 1", f"X: {value}").replace("Cell Size: 2", f"Cell Size: {value}"))
    session = RvizSession(Scene())
    session.apply(read_layout(path))
    assert (session.view["Focal Point"], session.displays[0]["Cell Size"]) == ((0.0, 0.0, 0.0), 1.0)


def test_unknown_view_becomes_an_orbit_with_a_hint(tmp_path: Path) -> None:
    path = tmp_path / "view.rviz"
    path.write_text(LAYOUT.replace("rviz_default_plugins/XYOrbit", "my_pkg/Drone"))
    session = RvizSession(Scene())
    session.apply(read_layout(path))
    assert repr(session.view) == "Orbit"
    assert any("Drone is not one of Orbit, XYOrbit" in row.text for row in session.rows())


BROKEN = {
    "no end": ("Visualization Manager:\n  Displays: [\n", r"line 3, column 1: this is not valid YAML"),
    "a tab": ("a:\n\t- b\n", r"line 2, column 1: this is not valid YAML: found character '\\t'"),
    "a strange character": ("a: \n  b: \x07\n", "line 2, column 6: this is not valid YAML: the character 7"),
    "a loop": ("a: &a [*a]\n", "this is not valid YAML: it is nested too deeply"),
    "a bomb": (
        "".join(f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9 if n else 'x')}]\n" for n in range(9)),
        "line 1, column 10: with its aliases .* too many values for a layout",
    ),
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_layout_is_reported_with_its_path_and_position(name: str, tmp_path: Path) -> None:
    path = tmp_path / "view.rviz"
    path.write_text(BROKEN[name][0])
    with pytest.raises(CourseError, match=BROKEN[name][1]) as caught:
        read_layout(path)
    assert str(path) in str(caught.value)


ODD = {
    "a list": ("- a\n- b\n", "view.rviz is not an .rviz file: it has no map 'Visualization Manager'."),
    "empty": ("", "view.rviz is not an .rviz file: it has no map 'Visualization Manager'."),
    "another file": ("a: 1\n", "view.rviz is not an .rviz file: it has no map 'Visualization Manager'."),
    "displays as text": (
        "Visualization Manager:\n  Displays: none\n",
        "line 2, column 13: 'Displays' is 'none', expected a list (lines that begin with '- ').",
    ),
    "a display as text": (
        "Visualization Manager:\n  Displays:\n    - Grid\n",
        "line 3, column 7: 'Display 1' is 'Grid', expected a map (lines like 'Name: value').",
    ),
    "a view as list": (
        "Visualization Manager:\n  Views:\n    Current: []\n",
        "line 3, column 14: 'Current' is '[]', expected a map (lines like 'Name: value').",
    ),
    "a colour": (
        "Visualization Manager:\n  Global Options:\n    Background Color: dark; red\n",
        "Global Options: 'Background Color' is 'dark; red', expected a color like '255; 0; 0'.",
    ),
}


@pytest.mark.parametrize("name", ODD)
def test_valid_entries_of_a_partly_invalid_layout_are_loaded_and_others_are_hints(
    name: str, tmp_path: Path
) -> None:
    path = tmp_path / "view.rviz"
    path.write_text(ODD[name][0])
    session = RvizSession(Scene())
    session.apply(read_layout(path))
    assert ODD[name][1] in [row.text for row in session.rows() if (row.name, row.level) == ("Layout", "hint")]
    assert document(session)


def test_missing_or_binary_layout_file_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(CourseError, match=r"Cannot read .*: No such file or directory\. Pass the"):
        read_layout(tmp_path / "missing.rviz")
    with pytest.raises(CourseError, match=r"Cannot read the layout .*: Is a directory\. Pass"):
        read_layout(tmp_path)
    (tmp_path / "picture.rviz").write_bytes(b"\x89PNG\xff\xfe")
    with pytest.raises(CourseError, match="it is not text in UTF-8: save it in this encoding"):
        read_layout(tmp_path / "picture.rviz")
