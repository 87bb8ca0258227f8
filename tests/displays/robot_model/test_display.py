"""Statuses of RViz's RobotModel (robot_model_display.cpp, tf_link_updater.cpp)."""

from pathlib import Path

import numpy as np
import pytest
from std_msgs.msg import String

from course_lib.displays.panel.panels import display_rows
from course_lib.displays.robot_model import DrawnLink, LinkSettings
from course_lib.displays.viewer import Viewer
from course_lib.displays.writer import member_config
from course_lib.errors import CourseError
from course_lib.robots.robot import load_robot
from course_lib.ros.graph.topics import Qos
from course_lib.ros.programs.packages import packages
from course_lib.viewer.drawables import Solids
from tests.displays.bench import START_NS, Bench
from tests.displays.robot_model.robots import (
    ARM,
    CYLINDER,
    LATCHED,
    MISSING,
    ROBOT,
    robot,
    standing,
    visible_drawables,
)


def test_latched_description_is_received_even_with_volatile_durability() -> None:
    display = Bench().session.add(ROBOT, "Robot", {"Description Topic": "/robot_description"})
    assert display["Description Topic/Durability Policy"] == "Volatile"
    assert display.subscriptions[0].qos == LATCHED
    display["Description Topic/Depth"] = 7
    assert display.subscriptions[0].qos == Qos(depth=7)


@pytest.mark.parametrize("text", ["", "hello", "<robot", "<robot name='r'/>", "<html><body/></html>"])
def test_invalid_description_is_an_error_with_rviz_text_and_a_hint(text: str) -> None:
    bench = Bench()
    display = standing(bench)
    bench.publish("/robot_description", String(data=text), qos=LATCHED)
    bench.update()
    assert bench.status(display, "URDF") == ("error", "URDF failed Model parse")
    assert bench.hints(display)
    assert not visible_drawables(bench)
    assert [prop.label for prop in display.properties if prop.path[:2] == ("Links", "arm")] == []


def test_missing_mesh_is_an_error_and_other_shapes_are_shown() -> None:
    bench = Bench()
    bench.transform("map", "base")
    bench.transform("map", "arm")
    display = robot(bench, MISSING)
    text = (
        "Errors loading geometries:\n"
        "• for link 'arm':\nCould not load mesh resource 'package://nobody/arm.stl'"
    )
    assert bench.status(display, "URDF") == ("error", text)
    assert bench.status(display, "arm") == ("ok", "Transform OK")
    assert list(visible_drawables(bench)) == ["base/visual/0"]


def test_packages_are_searched_once_for_all_meshes_of_a_description(monkeypatch: pytest.MonkeyPatch) -> None:
    searches = 0

    def count_searches(**settings: bool) -> dict[str, Path]:
        nonlocal searches
        searches += 1
        return packages(**settings)

    bench, arm = Bench(), load_robot("ur10")
    monkeypatch.setattr("course_lib.robots.robot.packages", count_searches)
    assert arm.urdf.count("<mesh") == 14
    bench.session.add(ROBOT, "Robot", {"Description Topic": {"Value": "/robot_description"}})
    bench.publish("/robot_description", String(data=arm.urdf), qos=LATCHED)
    loading = searches
    for joint in arm.tree.joints.values():
        bench.transform(arm.tree.root, joint.child)
    bench.transform("map", arm.tree.root)
    bench.update()
    assert (loading, searches) == (1, 2)
    assert any("/visual/" in path for path in visible_drawables(bench))


def test_invalid_mesh_file_is_reported_as_in_rviz(tmp_path: Path) -> None:
    (tmp_path / "arm.stl").write_text("not a mesh")
    bench = Bench()
    display = robot(bench, f'<mesh filename="file://{tmp_path}/arm.stl"/>')
    assert bench.status(display, "URDF") == (
        "error",
        f"Errors loading geometries:\n• for link 'arm':\nCould not load mesh resource 'file://{tmp_path}/arm.stl'",
    )


def test_link_settings_of_a_layout_are_kept_until_the_links_are_loaded() -> None:
    bench = Bench()
    for child in ("base", "arm"):
        bench.transform("map", child)
    links = {"base": {"Value": False}, "arm": {"Alpha": 0.25}}
    config = {"Description Topic": {"Value": "/robot_description"}, "Links": links}
    display = bench.session.add(ROBOT, "Robot", config)
    bench.publish("/robot_description", String(data=ARM.format(arm=CYLINDER)), qos=LATCHED)
    bench.update()
    assert display["Links/arm/Alpha"] == 0.25
    assert list(visible_drawables(bench)) == ["arm/visual/0"]


def test_tf_prefix_is_prepended_to_frames_so_that_several_robots_can_be_shown() -> None:
    bench = Bench()
    bench.transform("map", "left/base")
    bench.transform("map", "right/base", (0.0, 5.0, 0.0))
    left, right = robot(bench, tf_prefix="left"), robot(bench, tf_prefix="right")
    assert bench.status(left, "left/base") == ("ok", "Transform OK")
    assert bench.status(right, "right/arm") == ("error", "No transform from [right/arm] to [map]")
    where = bench.scene.world_transform("displays/Robot 2/links/base/visual/0")
    np.testing.assert_array_equal(where[:3, 3], [0, 5, 0])
    left["TF Prefix"] = "right"
    assert bench.status(left, "left/base") is None


def test_robot_description_can_be_read_from_a_file(tmp_path: Path) -> None:
    file = tmp_path / "arm.urdf"
    bench = Bench()
    bench.transform("map", "base")
    config = {"Description Source": "File", "Description File": str(file)}
    display = bench.session.add(ROBOT, "Robot", config)
    assert bench.status(display, "URDF") == ("error", "URDF is empty")
    assert not display.subscriptions
    file.write_text(ARM.format(arm=CYLINDER))
    display["Enabled"] = False
    display["Enabled"] = True
    assert bench.status(display, "URDF") == ("ok", "URDF parsed OK")
    assert "base/visual/0" in visible_drawables(bench)


def test_links_are_placed_once_per_update_interval() -> None:
    bench = Bench()
    bench.transform("map", "base", static=False)
    robot(bench, update_interval=1.0)
    node = "displays/Robot/links/base/visual"
    for at, x in ((0.5, 0.0), (1.5, 2.0)):
        bench.transform("map", "base", (2.0, 0.0, 0.0), at=at, static=False)
        bench.session.update(START_NS + int(at * 1e9))
        assert bench.scene.transform(node)[0, 3] == x


def test_changed_fixed_frame_keeps_the_robot() -> None:
    bench = Bench()
    display = standing(bench)
    bench.session.fixed_frame = "base"
    assert "arm/visual/0" in visible_drawables(bench)
    assert bench.status(display, "arm") == ("ok", "Transform OK")


def test_unchanged_frames_send_no_scene_changes() -> None:
    bench = Bench()
    standing(bench)
    bench.update(0.1)
    received: list[tuple[str, str]] = []
    bench.scene.listen(lambda what, path: received.append((what, path)))
    bench.update(0.2)
    assert received == []


def test_disabled_robot_removes_its_objects() -> None:
    bench = Bench()
    display = standing(bench)
    display["Enabled"] = False
    assert not visible_drawables(bench)
    assert not display.rows()


def test_tf_loop_is_an_error_of_its_links() -> None:
    bench = Bench()
    bench.transform("arm", "base", at=0.1, static=False)
    bench.transform("base", "arm", at=0.1, static=False)
    display = robot(bench)
    assert bench.status(display, "base") == ("error", "No transform from [base] to [map]")


def test_nan_transform_keeps_the_link_pose_and_is_reported() -> None:
    bench = Bench()
    display = standing(bench)
    bench.transform("map", "base", (float("nan"), 0.0, 0.0), at=0.1)
    bench.update(0.1)
    node = "displays/Robot/links/base/visual"
    np.testing.assert_array_equal(bench.scene.transform(node)[:3, 3], [1, 0, 0])
    assert bench.status(display, "base") == ("ok", "Transform OK")
    hints = [row.text for row in bench.session.rows() if row.level == "hint"]
    assert any("nan" in text and "base" in text for text in hints)


def test_viewer_adds_a_robot_model_by_topic() -> None:
    display = Viewer("map").add("RobotModel", "/robot_description")
    assert display["Description Topic"] == "/robot_description"


def test_properties_of_links_are_read_only_after_a_change(monkeypatch: pytest.MonkeyPatch) -> None:
    bench = Bench()
    display = standing(bench)
    settings: list[LinkSettings] = []
    monkeypatch.setattr(DrawnLink, "show", lambda link, new: settings.append(new))
    for seconds in (1.0, 2.0):
        bench.transform("map", "base", at=seconds)
        bench.update(seconds)
    assert settings == []
    display["Alpha"] = 0.5
    bench.update(3.0)
    assert [one.alpha for one in settings] == [0.5] * 3
    display["Links/arm/Show Axes"] = True
    bench.update(4.0)
    assert [one.shown["axes"] for one in settings[3:]] == [True, False, False]


def test_links_have_their_pose_in_the_fixed_frame_which_layouts_do_not_contain() -> None:
    bench = Bench()
    bench.transform("map", "base", (1.0, 2.0, 3.0))
    display = robot(bench, ARM)
    assert display["Links/base/Position"] == (1.0, 2.0, 3.0)
    assert display["Links/base/Orientation"] == (0.0, 0.0, 0.0, 1.0)
    assert display["Links/arm/Position"] == ""
    bench.transform("map", "base", (4.0, 2.0, 3.0))
    assert display["Links/base/Position"] == (4.0, 2.0, 3.0)
    assert "Position" not in str(member_config(display))


def test_details_of_links_are_expanded_on_request() -> None:
    bench = Bench()
    display = robot(bench, ARM)

    def expanded() -> set[str]:
        rows = display_rows(bench.session).values()
        return {entry.row.label for entry in rows if entry.row.open} & {"base", "arm"}

    assert expanded() == set()
    display["Expand Link Details"] = True
    assert expanded() == {"base", "arm"}


def tree_of(bench: Bench) -> list[str]:
    """Return the rows of links and joints in the panel, each indented by its depth."""
    keys = [key.split("#")[1:] for key in display_rows(bench.session)]
    names = ("base", "arm", "tool", "j", "k")
    below = [key for key in keys if key[:1] == ["Links"] and key[-1] in names]
    return ["." * (len(key) - 2) + key[-1] for key in below]


@pytest.mark.parametrize(
    ("style", "top", "expected"),
    [
        ("Links in Alphabetic Order", "Links", ["arm", "base", "tool"]),
        ("Joints in Alphabetic Order", "Joints", ["j", "k"]),
        ("Tree of links", "Link Tree", ["base", ".arm", "..tool"]),
        (
            "Tree of links and joints",
            "Link/Joint Tree",
            ["base", ".j", "..arm", "...k", "....tool"],
        ),
    ],
)
def test_link_tree_style_arranges_the_rows_of_links_and_joints(
    style: str, top: str, expected: list[str]
) -> None:
    bench = Bench()
    display = robot(bench)
    display["Expand Link Details"] = True
    display["Link Tree Style"] = style
    assert tree_of(bench) == expected
    rows = display_rows(bench.session)
    assert next(entry.row.label for key, entry in rows.items() if key.endswith("#Links")) == top
    assert display["Expand Link Details"] is (style == "Links in Alphabetic Order")


def test_expand_properties_open_the_rows_of_the_tree_and_their_details() -> None:
    bench = Bench()
    display = robot(bench, **{"Link Tree Style": "Tree of links and joints"})

    def expanded() -> set[str]:
        rows = display_rows(bench.session).items()
        keys = [key for key, entry in rows if entry.row.open and "#Links" in key]
        return {"/".join(key.split("#")[2:]) for key in keys}

    assert expanded() == set()
    display["Expand Tree"] = True
    links, joints = {"base", "base/j/arm", "base/j/arm/k/tool"}, {"base/j", "base/j/arm/k"}
    assert expanded() == links | joints
    display["Expand Tree"] = False
    display["Expand Joint Details"] = True
    assert expanded() == {f"{joint}/Details" for joint in joints}
    display["Expand Link Details"] = True
    assert expanded() == {f"{row}/Details" for row in links | joints}


def test_joint_rows_describe_the_joint() -> None:
    bench = Bench()
    origin = '<child link="arm"/><origin xyz="0 0 2" rpy="0 0 1.5707963267948966"/>'
    for child in ("base", "arm", "tool"):
        bench.transform("map", child, (1.0, 0.0, 0.0))
    display = robot(bench, **{"Link Tree Style": "Joints in Alphabetic Order"})
    text = ARM.format(arm=CYLINDER).replace('<child link="arm"/>', origin)
    bench.publish("/robot_description", String(data=text), qos=LATCHED)
    bench.update()
    assert display["Joints/j/Position"] == (1.0, 0.0, 2.0)
    assert display["Joints/j/Orientation"] == pytest.approx((0.0, 0.0, 0.707107, 0.707107))
    labels = [prop.path[-1] for prop in display.properties if prop.path[:2] == ("Joints", "j")]
    assert {label: display[f"Joints/j/{label}"] for label in labels[4:]} == {
        "Type": "revolute",
        "Lower Limit": -1.0,
        "Upper Limit": 1.0,
        "Show Joint Axis": False,
        "Joint Axis": (0.0, 0.0, 1.0),
    }
    labels = [prop.path[-1] for prop in display.properties if prop.path[:2] == ("Joints", "k")]
    assert labels == ["Show Axes", "Position", "Orientation", "Type"]


def test_check_box_of_a_joint_hides_its_link_and_in_a_tree_all_links_below() -> None:
    bench = Bench()
    joint = '<joint name="l" type="fixed"><parent link="world"/><child link="base"/></joint>'
    world = f'<link name="world"/>{joint}</robot>'
    text = ARM.format(arm=CYLINDER).replace("</robot>", world)
    display = standing(bench)
    bench.publish("/robot_description", String(data=text), qos=LATCHED)
    bench.update()
    display["Joints/l"] = False
    assert list(visible_drawables(bench)) == ["arm/visual/0"]
    display["Link Tree Style"] = "Tree of links and joints"
    assert (display["Joints/l"], display["Joints/j"]) == (False, True)
    display["Joints/l"] = True
    display["Joints/l"] = False
    assert not visible_drawables(bench)
    assert (display["Joints/j"], display["All Links Enabled"]) == (False, False)
    display["All Links Enabled"] = True
    assert display["Joints/l"] is True
    # Nothing with geometry moves with the last joint.
    rows = display_rows(bench.session)
    labels = {key.rpartition("#")[2]: entry.row.value for key, entry in rows.items()}
    assert (labels["j"], labels["k"]) == (True, None)


def test_joint_without_a_check_box_in_the_style_rejects_a_value() -> None:
    bench = Bench()
    joints = "".join(
        f'<joint name="{name}" type="fixed"><parent link="{parent}"/><child link="{child}"/></joint>'
        for name, parent, child in (("m", "root", "world"), ("l", "world", "base"))
    )
    text = ARM.format(arm=CYLINDER).replace(
        "</robot>", f'<link name="root"/><link name="world"/>{joints}</robot>'
    )
    display = standing(bench, **{"Link Tree Style": "Joints in Alphabetic Order"})
    bench.publish("/robot_description", String(data=text), qos=LATCHED)
    bench.update()
    with pytest.raises(CourseError, match="joint 'm' has no check box, because its link has no geometry"):
        display["Joints/m"] = False
    display["Link Tree Style"] = "Tree of links and joints"
    display["Joints/m"] = False
    assert not visible_drawables(bench)


def test_axes_of_a_joint_are_drawn_in_its_frame() -> None:
    bench = Bench()
    bench.transform("map", "base", (1.0, 0.0, 0.0))
    origin = '<child link="arm"/><origin xyz="0 0 2" rpy="1.5707963267948966 0 0"/>'
    display = robot(bench)
    text = ARM.format(arm=CYLINDER).replace('<child link="arm"/>', origin)
    bench.publish("/robot_description", String(data=text), qos=LATCHED)
    bench.update()
    node, layout = "displays/Robot/joints/j", member_config(display)
    display["Joints/j/Show Axes"] = display["Joints/j/Show Joint Axis"] = True
    bench.update()
    assert {path for path in bench.scene.objects() if path.startswith(node)} == {
        f"{node}/{name}" for name in ("axes", "shaft", "head")
    }
    np.testing.assert_allclose(bench.scene.world_transform(f"{node}/axes")[:3, 3], [1, 0, 2])
    shaft = bench.scene.objects()[f"{node}/shaft"]
    assert isinstance(shaft, Solids)
    center = bench.scene.world_transform(f"{node}/shaft") @ shaft.placements[0][:, 3]
    np.testing.assert_allclose(center[:3], [1, -0.075, 2], atol=1e-9)
    assert member_config(display) == layout
    display["Joints/j"] = False
    bench.update()
    assert not {path for path in bench.scene.objects() if path.startswith(node)}


@pytest.mark.parametrize("style", ["Joints in Alphabetic Order", "Tree of links and joints"])
def test_link_settings_are_restored_with_every_style(style: str) -> None:
    display = robot(Bench(), **{"Link Tree Style": style})
    display["Links/arm/Alpha"], display["Expand Joint Details"] = 0.25, True
    layout = member_config(display)
    bench = Bench()
    restored = bench.session.add(ROBOT, "Robot", layout)
    bench.publish("/robot_description", String(data=ARM.format(arm=CYLINDER)), qos=LATCHED)
    bench.update()
    assert (restored["Links/arm/Alpha"], restored["Expand Joint Details"]) == (0.25, True)
    assert member_config(restored) == layout
    assert "Joints" not in layout
