"""A base that drives to every side, and on it a UR10."""

import xml.etree.ElementTree as ET
from functools import lru_cache

from course_lib.robots.load import load_robot
from course_lib.robots.resources import resolve
from course_lib.robots.robot import Robot

PREFIX = "ur10"  # before the names of the arm's joints and links
ARM_URDF = "package://example-robot-data/robots/ur_description/urdf/ur10_robot.urdf"
START = {f"{PREFIX}shoulder_lift_joint": -1.2, f"{PREFIX}elbow_joint": 0.5}  # [rad] the other joints at 0

# base_link is on the ground, below the middle of the base. The arm stands ahead of it and high: stretched
# down it ends above the ground, and does not touch the base.
MOUNT = (0.9, 0.0, 1.2)  # [m] of the arm in base_link
_SHAPES = [  # what the base is made of, where, turned by
    ('<box size="0.8 0.6 0.25"/>', "0 0 0.2", "0 0 0"),
    ('<box size="0.14 0.14 0.875"/>', "0.2 0 0.7625", "0 0 0"),
    ('<box size="0.9 0.2 0.05"/>', "0.575 0 1.175", "0 0 0"),
    *(
        ('<cylinder radius="0.1" length="0.08"/>', f"{x} {y} 0.1", "1.5708 0 0")
        for x in (-0.27, 0.27)
        for y in (-0.31, 0.31)
    ),
]


@lru_cache(maxsize=1)
def mobile_manipulator() -> Robot:
    """Return the robot: base_link, and ur10base_link … ur10tool0 on it; only the arm has joints."""
    shapes = [f'<origin xyz="{at}" rpy="{turn}"/><geometry>{shape}</geometry>' for shape, at, turn in _SHAPES]
    looks = '<material name="base"><color rgba="0.55 0.6 0.65 1"/></material>'
    base = "".join(f"<visual>{s}{looks}</visual><collision>{s}</collision>" for s in shapes)
    mount = f"""<joint name="{PREFIX}base_joint" type="fixed"><parent link="base_link"/>
        <child link="{PREFIX}base_link"/><origin xyz="{" ".join(map(str, MOUNT))}"/></joint>"""
    arm = "".join(ET.tostring(part, encoding="unicode") for part in _arm())
    link = f'<link name="base_link">{base}</link>'
    return load_robot(f'<robot name="mobile_manipulator">{link}{mount}{arm}</robot>')


def _arm() -> list[ET.Element]:
    """The links and joints of a UR10, renamed; without the world that it stands on."""
    arm = ET.fromstring(resolve(ARM_URDF).read_text(encoding="utf-8"))
    parts = [part for kind in ("link", "joint") for part in arm.findall(kind)]
    parts = [part for part in parts if part.get("name") not in ("world", "world_joint")]
    for element in parts:
        element.set("name", PREFIX + element.get("name", ""))
        for end in (*element.findall("parent"), *element.findall("child")):
            end.set("link", PREFIX + end.get("link", ""))
    return parts
