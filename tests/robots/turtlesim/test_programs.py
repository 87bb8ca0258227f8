import math

import pytest
import rclpy
from turtlesim.srv import Spawn

from course_lib.robots.turtlesim import DrawSquare, TurtleMimic, TurtlesimNode, TurtleTeleop
from course_lib.ros.time.driving import spin_for
from course_lib.tools.executables import key_buttons
from tests.robots.turtlesim.student import MIDDLE, Student


@pytest.mark.slow
def test_draw_square_returns_to_its_start(
    run: tuple[TurtlesimNode, Student], capfd: pytest.CaptureFixture[str]
) -> None:
    simulator, student = run
    student.call(Spawn, "spawn", name="leo")
    spin_for(28.0, simulator, student, DrawSquare())
    assert set(simulator.turtles) == {"turtle1"}
    corners = [(MIDDLE, MIDDLE), (MIDDLE + 2, MIDDLE), (MIDDLE + 2, MIDDLE + 2), (MIDDLE, MIDDLE + 2)]
    for corner in corners:
        assert min(math.dist(corner, point) for s in simulator.canvas.strips for point in s.points) < 0.25
    errors = capfd.readouterr().err
    assert "New goal [7.5" in errors
    assert errors.count("Reached goal") >= 7


def test_mimic_moves_one_turtle_like_another(run: tuple[TurtlesimNode, Student]) -> None:
    rclpy.shutdown()
    rules = ("input/pose:=turtle1/pose", "output/cmd_vel:=leo/cmd_vel")
    rclpy.init(args=["--ros-args", *(word for rule in rules for word in ("-r", rule))])
    simulator = TurtlesimNode()
    student, mimic = Student(simulator), TurtleMimic()
    student.call(Spawn, "spawn", name="leo", x=2.0, y=2.0)
    student.drive(1.0, 1.0)
    spin_for(3.0, simulator, student, mimic)
    leo, first = simulator.turtles["leo"], simulator.turtles["turtle1"]
    assert (leo.x - 2.0, leo.y - 2.0) == pytest.approx((first.x - MIDDLE, first.y - MIDDLE), abs=0.06)


@pytest.mark.parametrize(
    ("keys", "place"),
    [("↑", (7.54, 5.54, 0.0)), ("↓", (3.54, 5.54, 0.0)), ("←", (5.54, 5.54, 2.0)), ("R", (5.54, 5.54, 1.57))],
)
def test_arrow_keys_steer_the_first_turtle(
    run: tuple[TurtlesimNode, Student], keys: str, place: tuple[float, float, float]
) -> None:
    simulator, student = run
    teleop = TurtleTeleop()
    teleop.press(keys)
    spin_for(3.0, simulator, student, teleop)
    assert student.place == pytest.approx(place, abs=0.06)


def test_key_f_cancels_a_rotation(run: tuple[TurtlesimNode, Student]) -> None:
    simulator, student = run
    teleop = TurtleTeleop()
    buttons = {button.description: button for button in key_buttons(teleop.press, teleop.KEYS).children}
    buttons["D"].click()
    spin_for(1.0, simulator, student, teleop)
    buttons["F"].click()
    spin_for(2.0, simulator, student, teleop)
    assert 0.9 < abs(student.place[2]) < 1.2
