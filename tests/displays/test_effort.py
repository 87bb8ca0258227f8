from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from course_lib.displays.clouds import rainbow
from course_lib.displays.display import Display
from course_lib.ros.graph.topics import Qos
from tests.displays.bench import Bench

ROBOT = """<robot name="r">
  <link name="base"/><link name="a"/><link name="b"/><link name="wheel"/>
  <joint name="along_z" type="revolute"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="10" velocity="1"/></joint>
  <joint name="along_x" type="revolute"><parent link="base"/><child link="b"/>
    <limit lower="-1" upper="1" effort="10" velocity="1"/></joint>
  <joint name="roll" type="continuous"><parent link="base"/><child link="wheel"/><axis xyz="0 1 0"/></joint>
</robot>"""
LATCHED = Qos(durability="transient_local")


@pytest.fixture
def bench() -> Bench:
    bench = Bench()
    bench.transform("map", "a", (1.0, 0.0, 0.0))
    bench.transform("map", "b", (0.0, 5.0, 0.0))
    return bench


def add(bench: Bench, **properties: Any) -> Display:
    display = bench.session.add("rviz_default_plugins/Effort", "Effort", {"Topic": "/states"}, **properties)
    bench.publish("/robot_description", String(data=ROBOT), qos=LATCHED)
    return display


def publish(bench: Bench, frame: str = "map", **efforts: float) -> None:
    message = JointState(name=list(efforts), effort=list(efforts.values()))
    message.header.frame_id = frame
    bench.publish("/states", message)
    bench.update()


def parts(bench: Bench) -> dict[str, Any]:
    objects = bench.scene.objects()
    return {path.rpartition("/")[2]: part for path, part in objects.items() if "/Effort/" in path}


def test_effort_is_drawn_as_a_circle_scaled_and_colored_by_its_fraction_of_the_limit(bench: Bench) -> None:
    add(bench)
    publish(bench, along_z=5.0)
    circle = parts(bench)["0 along_z circle"]
    distances = np.linalg.norm(circle.points - [1.0, 0.0, 0.0], axis=1)
    np.testing.assert_allclose(distances, 0.05 + 0.55 / 2, rtol=1e-6)  # RViz adds 0.05 to the share of a half
    np.testing.assert_allclose(circle.points[:, 2], 0.0, atol=1e-9)
    np.testing.assert_allclose(circle.colors[:3], rainbow([0.55])[0], rtol=1e-6)
    assert circle.width == 0.02


@pytest.mark.parametrize(("effort", "side"), [(5.0, -1.0), (-5.0, 1.0)])
def test_arrow_points_counterclockwise_for_a_positive_effort(
    bench: Bench, effort: float, side: float
) -> None:
    add(bench)
    publish(bench, along_z=effort)
    (placed,) = parts(bench)["0 along_z tip"].placements
    np.testing.assert_allclose(placed[:3, 2], (side * 0.04, 0.0, 0.0), atol=1e-9)  # from base to tip
    np.testing.assert_allclose(placed[:3, 3], (1.0 + side * 0.02, 0.325, 0.0), atol=1e-9)


def test_circle_of_an_axis_along_x_is_vertical(bench: Bench) -> None:
    add(bench)
    publish(bench, along_x=10.0)
    np.testing.assert_allclose(parts(bench)["0 along_x circle"].points[:, 0], 0.0, atol=1e-9)


def test_joints_missing_in_a_later_message_are_kept(bench: Bench) -> None:
    add(bench)
    publish(bench, along_z=5.0)
    publish(bench, along_x=5.0)
    assert {name.split()[1] for name in parts(bench)} == {"along_z", "along_x"}


def test_history_shows_the_last_messages(bench: Bench) -> None:
    add(bench, **{"History Length": 3})
    for effort in (1.0, 2.0, 3.0, 4.0):
        publish(bench, along_z=effort)
    assert sorted(parts(bench)) == [f"{k} along_z {part}" for k in range(3) for part in ("circle", "tip")]


def test_joints_have_rows_with_their_effort_and_a_check_box(bench: Bench) -> None:
    display = add(bench)
    publish(bench, along_z=5.0, along_x=1.0)
    assert (display["Joints/along_z/Effort"], display["Joints/along_z/Max Effort"]) == (5.0, 10.0)
    display["Joints/along_z"] = False
    assert {name.split()[1] for name in parts(bench)} == {"along_x"}


def test_joint_without_a_limit_is_reported_with_the_text_of_the_rviz_log(bench: Bench) -> None:
    display = add(bench)
    publish(bench, roll=1.0)
    assert parts(bench) == {}
    (hint,) = bench.hints(display)
    assert hint.startswith("RViz's log: Joint 'roll' has no <limit> tag in URDF.")


@pytest.mark.parametrize(
    ("name", "efforts", "text"),
    [
        ("along_z", {"along_z": float("nan")}, "Invalid effort: nan"),
        ("along_z", {"along_z": 1.0}, "Error transforming from frame 'other/a' to frame 'map'"),
    ],
)
def test_joint_that_cannot_be_drawn_has_its_own_status(
    bench: Bench, name: str, efforts: Any, text: str
) -> None:
    display = add(bench, **({"TF Prefix": "other"} if "other" in text else {}))
    publish(bench, **efforts)
    assert bench.status(display, name) == ("error", text)
    assert parts(bench) == {}


def test_joint_state_with_unequal_numbers_of_joints_and_efforts_is_rejected(bench: Bench) -> None:
    display = add(bench)
    message = JointState(name=["along_z"])
    message.header.frame_id = "map"
    bench.publish("/states", message)
    bench.update()
    status = bench.status(display, "Topic")
    assert status == ("error", "Received a joint state msg with different joint names and efforts size!")


def test_missing_or_invalid_robot_description_is_reported(bench: Bench) -> None:
    display = bench.session.add("rviz_default_plugins/Effort", "Effort", {"Topic": "/states"})
    publish(bench, along_z=5.0)
    assert bench.status(display, "Process message") == ("error", "Robot model might not be loaded yet")
    bench.publish("/robot_description", String(data="<robot>"), qos=LATCHED)
    assert bench.status(display, "URDF") == ("error", "Unable to parse robot model description!")


def test_joint_states_without_a_frame_are_dropped_as_in_rviz(bench: Bench) -> None:
    display = add(bench)
    publish(bench, frame="", along_z=5.0)
    assert parts(bench) == {}
    assert any("the frame id of the message is empty" in hint for hint in bench.hints(display))
