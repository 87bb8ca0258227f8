"""A small robot for tests of the RobotModel display."""

from typing import Any

from std_msgs.msg import String

from course_lib.displays.display import Display
from course_lib.ros.graph.topics import Qos
from course_lib.viewer.drawables import Drawable
from tests.displays.bench import Bench

ROBOT = "rviz_default_plugins/RobotModel"
LATCHED = Qos(depth=1, durability="transient_local")
ARM = """<robot name="r">
  <material name="blue"><color rgba="0 0 1 0.5"/></material>
  <link name="base">
    <visual><geometry><box size="1 2 3"/></geometry><material name="blue"/></visual>
    <collision><geometry><sphere radius="1"/></geometry></collision>
    <inertial><mass value="11340"/><inertia ixx="1" iyy="1" izz="1"/></inertial>
  </link>
  <link name="arm"><visual><origin xyz="0 0 1"/><geometry>{arm}</geometry></visual></link>
  <link name="tool"/>
  <joint name="j" type="revolute">
    <parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
  <joint name="k" type="fixed"><parent link="arm"/><child link="tool"/></joint>
</robot>"""
CYLINDER = '<cylinder radius="0.5" length="2"/>'
MISSING = '<mesh filename="package://nobody/arm.stl"/>'


def robot(bench: Bench, arm: str = CYLINDER, **properties: Any) -> Display:
    topic = {"Description Topic": {"Value": "/robot_description"}}
    display = bench.session.add(ROBOT, "Robot", topic, **properties)
    bench.publish("/robot_description", String(data=ARM.format(arm=arm)), qos=LATCHED)
    bench.update()
    return display


def standing(bench: Bench, **properties: Any) -> Display:
    """Return a robot whose link transforms are known."""
    for child in ("base", "arm", "tool"):
        bench.transform("map", child, (1.0, 0.0, 0.0))
    return robot(bench, **properties)


def visible_drawables(bench: Bench) -> dict[str, Drawable]:
    """Return the visible drawables of the robot, by link/kind/number."""
    start = "displays/Robot/links/"
    objects = bench.scene.objects().items()
    return {path.removeprefix(start): drawable for path, drawable in objects if bench.scene.is_visible(path)}
