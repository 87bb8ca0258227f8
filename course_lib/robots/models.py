"""Robots that come with the kit, in the data of example-robot-data."""

import xml.etree.ElementTree as ET
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from transforms3d.quaternions import quat2mat

from course_lib.arrays import Matrix
from course_lib.errors import CourseError, did_you_mean
from course_lib.robots.resources import resolve


@dataclass(frozen=True)
class Model:
    """Files of a robot below the data's folder `robots`.

    Args:
        urdf: Its description.
        srdf: Holds its postures.
        posture: The name of the one that it rests in; else all joints stand at 0.
    """

    urdf: str
    srdf: str = ""
    posture: str = ""


@dataclass(frozen=True, eq=False)
class Posture:
    """Positions of joints by name, [rad] or [m], others at 0; transform_root_to_ground, shape (4, 4)."""

    positions: Mapping[str, float] = field(default_factory=dict)
    transform_root_to_ground: Matrix = field(default_factory=lambda: np.eye(4))


MODELS = {
    "a1": Model("a1_description/urdf/a1.urdf", "a1_description/srdf/a1.srdf", "standing"),
    "alex_nub_hands": Model("alex_description/urdf/alex_nub_hands.urdf"),
    "alex_psyonic_hands": Model(
        "alex_description/urdf/alex_psyonic_hands.urdf",
        "alex_description/srdf/alex_psyonic_hands.srdf",
        "default",
    ),
    "alex_sake_hands": Model(
        "alex_description/urdf/alex_sake_hands.urdf", "alex_description/srdf/alex_sake_hands.srdf", "default"
    ),
    "alexander": Model(
        "alexander_description/urdf/alexander_v1.lowerBodyOnly.urdf",
        "alexander_description/srdf/alexander.srdf",
        "default",
    ),
    "allegro_left_hand": Model("allegro_hand_description/urdf/allegro_left_hand.urdf"),
    "allegro_right_hand": Model("allegro_hand_description/urdf/allegro_right_hand.urdf"),
    "anymal": Model(
        "anymal_b_simple_description/robots/anymal.urdf",
        "anymal_b_simple_description/srdf/anymal.srdf",
        "standing",
    ),
    "anymal_c": Model(
        "anymal_c_simple_description/urdf/anymal.urdf",
        "anymal_c_simple_description/srdf/anymal.srdf",
        "standing",
    ),
    "anymal_kinova": Model(
        "anymal_b_simple_description/robots/anymal-kinova.urdf",
        "anymal_b_simple_description/srdf/anymal-kinova.srdf",
        "standing_with_arm_up",
    ),
    "asr_twodof": Model("asr_twodof_description/urdf/TwoDofs.urdf"),
    "b1": Model("b1_description/urdf/b1.urdf", "b1_description/srdf/b1.srdf", "standing"),
    "b1_z1": Model(
        "b1_description/urdf/b1-z1.urdf", "b1_description/srdf/b1-z1.srdf", "standing_with_arm_home"
    ),
    "baxter": Model(
        "baxter_description/urdf/baxter.urdf", "baxter_description/srdf/baxter_manipulation.srdf", "neutral"
    ),
    "bluevolta_bravo7_gripper": Model(
        "bluevolta_description/urdf/bluevolta_bravo7_gripper.urdf",
        "bluevolta_description/srdf/bluevolta_bravo7_gripper.srdf",
        "standing",
    ),
    "bluevolta_bravo7_no_ee": Model(
        "bluevolta_description/urdf/bluevolta_bravo7_no_ee.urdf",
        "bluevolta_description/srdf/bluevolta_bravo7_no_ee.srdf",
        "standing",
    ),
    "bolt": Model("bolt_description/robots/bolt.urdf", "bolt_description/srdf/bolt.srdf", "standing"),
    "borinot": Model(
        "borinot_description/urdf/borinot_flying_arm_2.urdf",
        "borinot_description/srdf/borinot_flying_arm_2.srdf",
        "home",
    ),
    "bravo7_gripper": Model(
        "bravo7_description/urdf/bravo7_gripper.urdf",
        "bravo7_description/srdf/bravo7_gripper.srdf",
        "standing",
    ),
    "bravo7_no_ee": Model(
        "bravo7_description/urdf/bravo7_no_ee.urdf", "bravo7_description/srdf/bravo7_no_ee.srdf", "standing"
    ),
    "centauro": Model(
        "centauro_description/urdf/centauro.urdf",
        "centauro_description/srdf/centauro.srdf",
        "homing_balanced",
    ),
    "double_pendulum": Model("double_pendulum_description/urdf/double_pendulum.urdf"),
    "double_pendulum_continuous": Model("double_pendulum_description/urdf/double_pendulum_continuous.urdf"),
    "double_pendulum_simple": Model("double_pendulum_description/urdf/double_pendulum_simple.urdf"),
    "falcon_bravo7_gripper": Model(
        "falcon_description/urdf/falcon_bravo7_gripper.urdf",
        "falcon_description/srdf/falcon_bravo7_gripper.srdf",
        "standing",
    ),
    "falcon_bravo7_no_ee": Model(
        "falcon_description/urdf/falcon_bravo7_no_ee.urdf",
        "falcon_description/srdf/falcon_bravo7_no_ee.srdf",
        "standing",
    ),
    "finger_edu": Model(
        "finger_edu_description/robots/finger_edu.urdf",
        "finger_edu_description/srdf/finger_edu.srdf",
        "hanging",
    ),
    "g1": Model("g1_description/urdf/g1_29dof_rev_1_0.urdf"),
    "g1_with_hands": Model("g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf"),
    "go1": Model("go1_description/urdf/go1.urdf", "go1_description/srdf/go1.srdf", "standing"),
    "go2": Model("go2_description/urdf/go2.urdf", "go2_description/srdf/go2.srdf", "standing"),
    "hector": Model("hector_description/robots/quadrotor_base.urdf"),
    "hextilt": Model(
        "hextilt_description/urdf/hextilt_flying_arm_5.urdf",
        "hextilt_description/srdf/hextilt_flying_arm_5.srdf",
        "home",
    ),
    "human": Model("human_description/robots/human.urdf"),
    "hyq": Model("hyq_description/robots/hyq_no_sensors.urdf", "hyq_description/srdf/hyq.srdf", "standing"),
    "icub": Model("icub_description/robots/icub.urdf", "icub_description/srdf/icub.srdf", "half_sitting"),
    "icub_reduced": Model(
        "icub_description/robots/icub_reduced.urdf", "icub_description/srdf/icub.srdf", "half_sitting"
    ),
    "iris": Model("iris_description/robots/iris_simple.urdf"),
    "kinova": Model("kinova_description/robots/kinova.urdf", "kinova_description/srdf/kinova.srdf", "arm_up"),
    "laikago": Model("laikago_description/urdf/laikago.urdf"),
    "panda": Model("panda_description/urdf/panda.urdf", "panda_description/srdf/panda.srdf", "default"),
    "panda_collision": Model("panda_description/urdf/panda_collision.urdf"),
    "pr2": Model("pr2_description/urdf/pr2.urdf", "pr2_description/srdf/pr2.srdf", "tuck_left_arm"),
    "quadruped": Model("quadruped_description/urdf/quadruped.urdf"),
    "romeo": Model("romeo_description/urdf/romeo.urdf"),
    "simple_humanoid": Model(
        "simple_humanoid_description/urdf/simple_humanoid.urdf",
        "simple_humanoid_description/srdf/simple_humanoid.srdf",
        "half_sitting",
    ),
    "simple_humanoid_classical": Model(
        "simple_humanoid_description/urdf/simple_humanoid_classical.urdf",
        "simple_humanoid_description/srdf/simple_humanoid_classical.srdf",
        "half_sitting",
    ),
    "so100": Model("so_arm_description/urdf/so100.urdf"),
    "so101": Model("so_arm_description/urdf/so101.urdf"),
    "solo12": Model("solo_description/robots/solo12.urdf", "solo_description/srdf/solo.srdf", "standing"),
    "solo8": Model("solo_description/robots/solo.urdf", "solo_description/srdf/solo.srdf", "standing"),
    "talos": Model("talos_data/robots/talos_reduced.urdf", "talos_data/srdf/talos.srdf", "half_sitting"),
    "talos_arm": Model("talos_data/robots/talos_left_arm.urdf", "talos_data/srdf/talos.srdf", "half_sitting"),
    "talos_box": Model(
        "talos_data/robots/talos_reduced_box.urdf", "talos_data/srdf/talos.srdf", "half_sitting"
    ),
    "talos_full": Model("talos_data/robots/talos_full_v2.urdf", "talos_data/srdf/talos.srdf", "half_sitting"),
    "talos_full_box": Model(
        "talos_data/robots/talos_full_v2_box.urdf", "talos_data/srdf/talos.srdf", "half_sitting"
    ),
    "talos_legs": Model("talos_data/robots/talos_reduced.urdf", "talos_data/srdf/talos.srdf", "half_sitting"),
    "tiago": Model("tiago_description/robots/tiago.urdf"),
    "tiago_dual": Model("tiago_description/robots/tiago_dual.urdf"),
    "tiago_no_hand": Model("tiago_description/robots/tiago_no_hand.urdf"),
    "tiago_pro": Model("tiago_pro_description/robots/tiago_pro.urdf"),
    "ur10": Model("ur_description/urdf/ur10_robot.urdf"),
    "ur10_limited": Model("ur_description/urdf/ur10_joint_limited_robot.urdf"),
    "ur3": Model("ur_description/urdf/ur5_robot.urdf"),
    "ur3_gripper": Model("ur_description/urdf/ur3_gripper.urdf"),
    "ur3_limited": Model("ur_description/urdf/ur3_joint_limited_robot.urdf"),
    "ur5": Model("ur_description/urdf/ur5_robot.urdf"),
    "ur5_gripper": Model("ur_description/urdf/ur5_gripper.urdf"),
    "ur5_limited": Model("ur_description/urdf/ur5_joint_limited_robot.urdf"),
    "xarm7": Model("xarm_description/urdf/xarm7.urdf", "xarm_description/srdf/xarm7.srdf", "home"),
    "z1": Model("z1_description/urdf/z1.urdf", "z1_description/srdf/z1.srdf", "arm_up"),
}
_NO_URDF = ("cassie",)


def model_of(name: str) -> Model:
    """Return a robot of the kit by its name."""
    if name in _NO_URDF:
        raise CourseError(f"{name!r} is described by SDF, not URDF, and cannot be loaded here.")
    if name not in MODELS:
        meant = did_you_mean(name, list(MODELS), 3) or f", like {next(iter(MODELS))}."
        raise CourseError(
            f"There is no robot {name!r} among the {len(MODELS)} models{meant} "
            'A file ends in .urdf, like load_robot("my_robot.urdf").'
        )
    return MODELS[name]


def data_file(inside: str) -> Path:
    """Return a file of the robots' data."""
    try:
        return resolve(f"package://example-robot-data/robots/{inside}")
    except CourseError as error:
        raise CourseError(
            f"The robots' descriptions are in the package example-robot-data, and {inside} of it is missing "
            "on this machine. Run pip install example-robot-data==5.0.0."
        ) from error


def rest_of(model: Model, joints: Collection[str]) -> Posture:
    """Return the posture that a robot rests in, by its joints that move; the file also names others."""
    if not model.srdf:
        return Posture()
    states = ET.parse(data_file(model.srdf)).getroot().findall("group_state")
    (state,) = (state for state in states if state.get("name") == model.posture)
    positions, transform = dict[str, float](), np.eye(4)
    for joint in state.findall("joint"):
        values = list(map(float, joint.get("value", "").split()))
        if len(values) == 7:  # the root's place [m], and its quaternion (x, y, z, w)
            x, y, z, w = values[3:]
            transform[:3, 3], transform[:3, :3] = values[:3], quat2mat((w, x, y, z))
        elif joint.get("name") in joints:
            (positions[joint.get("name", "")],) = values
    return Posture(positions, transform)
