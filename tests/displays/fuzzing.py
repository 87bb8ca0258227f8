"""Malformed messages and URDFs for all displays, made from well-formed ones by a seed."""

import random
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from typing import Any

import numpy as np
from geometry_msgs.msg import TransformStamped
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from course_lib.displays.display import Display, TopicDisplay
from course_lib.displays.interactive import InteractiveMarkersDisplay
from course_lib.displays.properties import LimitedConversion, Property, flag
from course_lib.displays.registry import REGISTRY
from course_lib.displays.statuses import DisplayFaultWarning
from course_lib.errors import CourseError
from course_lib.robots.kinematics import link_poses
from course_lib.robots.robot import load_robot
from course_lib.ros.graph.graph import Sample
from course_lib.ros.messages import RosMessage, serialize, type_name
from course_lib.viewer.renderer import draw
from tests.displays.bench import START_NS, Bench
from tests.displays.samples import FRAME, SAMPLES, messages
from tests.displays.test_every_property import LATCHED
from tests.robots.urdfs import ALL_KINDS, ARM_2R

FLOATS = (0.0, -0.0, 1.0, -1.0, 1e-320, 1e-30, 1e30, -1e38, 1e308, float("nan"), float("inf"), float("-inf"))
WHOLE = (0, 1, 2, 3, -1, 7, 100, 255, 256, 32767, 65535, 2**31 - 1, -(2**31), 2**32 - 1, 2**63 - 1)
WORDS = (
    "",
    "/",
    "map",
    FRAME,
    "a/b",
    "rgb8",
    "32FC1",
    "bayer_rggb8",
    "x" * 300,
    "\0",
    "é",
    "<a>",
    "package://a/b.stl",
)
LONGEST = 40  # elements of a sequence that a mutation has made


def mutate(chance: random.Random, message: Any, changes: int) -> None:
    """Change values of a message in place, each to a value that a publisher can send."""
    for _ in range(changes):
        _mutate_once(chance, message)


def _mutate_once(chance: random.Random, message: RosMessage) -> None:
    names = [*message._KINDS]
    if not names:
        return
    name = chance.choice(names)
    value = getattr(message, name)
    try:
        if isinstance(value, RosMessage):
            _mutate_once(chance, value)
        elif isinstance(value, str | bool | int | float):
            setattr(message, name, _other(chance, value))
        else:
            setattr(message, name, _other_sequence(chance, value))
    except AssertionError:
        # The value is out of range for this field, so it cannot be published.
        return


def _other(chance: random.Random, value: Any) -> Any:
    if isinstance(value, bool):
        return not value
    if isinstance(value, str):
        return chance.choice(WORDS)
    return chance.choice(FLOATS) if isinstance(value, float) else chance.choice(WHOLE)


def _other_sequence(chance: random.Random, values: Any) -> Any:
    """Return a shorter or longer sequence, or one with another element."""
    items = list(values)
    what = chance.randrange(4)
    if what == 0 and items:
        del items[chance.randrange(len(items)) :]
    elif what == 1:
        items = (items * chance.randint(1, 3))[:LONGEST]
    elif items:
        index = chance.randrange(len(items))
        if isinstance(items[index], RosMessage):
            _mutate_once(chance, items[index])
        elif not isinstance(items[index], bytes):
            other = items[index].item() if isinstance(items[index], np.generic) else items[index]
            items[index] = _other(chance, other)
    return np.array(items, values.dtype) if isinstance(values, np.ndarray) else items


def mutated_bytes(chance: random.Random, cdr: bytes) -> bytes:
    """Return bytes of a message that were cut, or of which a few are others."""
    data = bytearray(cdr)
    for _ in range(chance.randint(1, 4)):
        data[chance.randrange(len(data))] = chance.randrange(256)
    return bytes(data[: chance.randrange(len(data))] if chance.random() < 0.3 else data)


def value_for(chance: random.Random, prop: Property) -> Any:
    """Return a value that a property may be set to, right or wrong."""
    convert = prop.convert
    if isinstance(convert, LimitedConversion) and convert.editor == "enum":
        return chance.choice(convert.options)
    if convert is flag:
        return chance.random() < 0.5
    if isinstance(prop.default, int | float):
        return chance.choice((*FLOATS, *WHOLE))
    if isinstance(prop.default, tuple):
        return tuple(chance.choice(WHOLE) for _ in range(3))
    return chance.choice(WORDS)


def show_mutations(seed: int, count: int, pictures: int = 0) -> Iterator[str]:
    """Show each class of display so many mutated messages; yield every fault.

    Args:
        seed: Of the mutations.
        count: Messages for each class.
        pictures: After how many messages a picture is drawn by numpy; 0 draws none.
    """
    for class_name in sorted(REGISTRY):
        if class_name.rpartition("/")[2] in SAMPLES or class_name.endswith(("/TF", "/Axes", "/Grid")):
            chance = random.Random(f"{seed} {class_name}")
            yield from _show_class(chance, class_name, count, pictures)


def _show_class(chance: random.Random, class_name: str, count: int, pictures: int) -> Iterator[str]:
    bench = Bench()
    bench.transform("map", "base", (1.0, 0.0, 0.0), yaw=0.3)
    display = bench.session.add(class_name, "It", {})
    neighbour = bench.session.add("rviz_default_plugins/PointStamped", "Neighbour", {"Topic": "/fine"})
    if isinstance(display, TopicDisplay):
        display[display.topic_label] = "/t/image"
    if isinstance(display, InteractiveMarkersDisplay):
        display[display.topic_label] = "/t"
    for number in range(count):
        seconds = number * 0.05
        bench.transform("base", FRAME, (0.0, 2.0, 0.0), at=seconds, static=False)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            _show_one(chance, bench, display, class_name, seconds)
            if pictures and number % pictures == 0:
                bench.session.rows()
                bench.session.summary()
                draw(bench.scene, (32, 24))
        yield from (
            f"{class_name}, message {number}: {one.category.__name__}: {one.message}"
            for one in caught
            if issubclass(one.category, DisplayFaultWarning | RuntimeWarning)
        )
        if display not in bench.session.displays or neighbour not in bench.session.displays:
            yield f"{class_name}, message {number}: a display is gone"


def _show_one(chance: random.Random, bench: Bench, display: Display, class_name: str, seconds: float) -> None:
    """Publish one message, perhaps set a property, and look."""
    now_ns = START_NS + round(seconds * 1e9)
    for topic, message in messages(class_name, chance.randrange(2)):
        mutate(chance, message, chance.choice((0, 1, 1, 1, 2, 4, 9)))
        cdr = serialize(message)
        if chance.random() < 0.1:
            cdr = mutated_bytes(chance, cdr)
        bench.session.receive(Sample(now_ns, topic, type_name(message), cdr, LATCHED, 1))
    if chance.random() < 0.1:
        transform = TransformStamped(child_frame_id=FRAME)
        transform.header.frame_id = "base"
        transforms = TFMessage(transforms=[transform])
        mutate(chance, transforms, 3)
        bench.publish("/tf", transforms, seconds)
    if chance.random() < 0.1:
        prop = chance.choice(display.properties)
        if not prop.is_read_only and prop.label not in ("Enabled", "Topic", "Description File"):
            # The error message contains the reason for a wrong value.
            with suppress(CourseError):
                display[prop.label] = value_for(chance, prop)
    bench.session.update(now_ns + 1)


# Values with which a mutation replaces an attribute.
VALUES = (
    "", " ", "x", "0", "1", "-1", "1 2", "1 2 3", "1 2 3 4", "1 2 3 4 5", "1,2,3", "0 0 0", "0.5 0.5 0.5 1",
    "red", "nan", "nan nan nan", "inf", "1e308", "1e308 1e308 1e308 1e308", "1e400", "1e-320", "base",
    "upper", "no_such", "revolute", "fixed", "planar", "package://a/b.stl", "file:///etc/hostname",
    "http://a/b", "é", "1\t2\n3",
)  # fmt: skip
PIECES = (
    "<box/>", '<box size="1 1 1"/>', "<cone/>", '<mesh filename="package://a/b.stl"/>', "<link/>",
    "<joint/>", '<link name="base"/>', "<visual/>", "<geometry/>", '<material name="m"/>', "<color/>",
    '<color rgba="red"/>', '<texture filename="package://a/t.png"/>', "<inertial/>",
    '<origin xyz="1 2" rpy="a"/>', "<limit/>", "<mimic/>", '<mimic joint="no_such"/>',
    '<axis xyz="0 0 0"/>', "<parent/>", "<child/>", "<!-- -->", "&amp;", "<a>", "</a>", "&b;",
)  # fmt: skip
PAINTED = """<?xml version="1.0"?>
<robot name="painted">
  <material name="blue"><color rgba="0 0 1 1"/></material>
  <link name="base">
    <inertial><origin xyz="0 0 0.1" rpy="0 0 0"/><mass value="1"/>
      <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
    <visual><origin xyz="0 0 0" rpy="0 0 1"/><geometry><box size="1 2 3"/></geometry>
      <material name="blue"/></visual>
    <visual><geometry><sphere radius="1"/></geometry></visual>
    <collision><geometry><cylinder radius="1" length="3"/></geometry></collision>
  </link>
  <link name="upper">
    <visual><geometry><mesh filename="package://a/b.stl" scale="1 1 1"/></geometry>
      <material name="red"><color rgba="1 0 0 1"/></material></visual>
    <visual><geometry><box size="1 1 1"/></geometry>
      <material name="t"><texture filename="package://a/t.png"/></material></visual>
  </link>
  <joint name="j" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="1 0 0" rpy="0 0 0"/>
    <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>"""


def mutated_urdf(chance: random.Random) -> str:
    """Return a URDF with a few attributes, elements or characters changed."""
    text = chance.choice((ALL_KINDS, ARM_2R, PAINTED, PAINTED))
    for _ in range(chance.choice((1, 1, 1, 2, 3, 6))):
        text = chance.choice(_CHANGES)(chance, text)
    return text


def _change_attribute(chance: random.Random, text: str) -> str:
    places = [place for place, sign in enumerate(text) if sign == '"']
    if len(places) < 2:
        return text
    first = 2 * chance.randrange(len(places) // 2)
    return text[: places[first] + 1] + chance.choice(VALUES) + text[places[first + 1] :]


def _insert(chance: random.Random, text: str) -> str:
    ends = [place + 1 for place, sign in enumerate(text) if sign == ">"]
    place = chance.choice(ends or [0])
    return text[:place] + chance.choice(PIECES) + text[place:]


def _remove_tag(chance: random.Random, text: str) -> str:
    starts = [place for place, sign in enumerate(text) if sign == "<"]
    if not starts:
        return text
    start = chance.choice(starts)
    return text[:start] + text[text.find(">", start) + 1 :]


def _change_characters(chance: random.Random, text: str) -> str:
    place = chance.randrange(len(text) + 1)
    return text[:place] + chance.choice('<>"&/ x\0é1') + text[place + chance.randrange(3) :]


_CHANGES: Sequence[Callable[[random.Random, str], str]] = (
    _change_attribute,
    _change_attribute,
    _change_attribute,
    _insert,
    _remove_tag,
    _change_characters,
)


def show_urdfs(seed: int, count: int) -> Iterator[str]:
    """Show mutated URDFs in RobotModel and Effort displays, and load them; yield every fault."""
    chance = random.Random(seed)
    bench = Bench("base")
    bench.transform("base", "upper", (0.0, 2.0, 0.0))
    robot = bench.session.add("rviz_default_plugins/RobotModel", "Robot", {})
    bench.session.add("rviz_default_plugins/Effort", "Effort", {})
    robot["Description Topic"] = "/robot_description"
    for number in range(count):
        text = mutated_urdf(chance)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            try:
                bench.publish("/robot_description", String(data=text), number * 0.05, LATCHED)
                bench.update(number * 0.05 + 0.01)
                if number % 20 == 0:
                    bench.session.rows()
                    draw(bench.scene, (32, 24))
                loaded = load_robot(text if "<" in text else f"<{text}")
                link_poses(loaded, {})
            except CourseError:
                # The caller of load_robot reads the reason.
                pass
            except Exception as error:
                yield f"URDF {number}: {type(error).__name__}: {error}\n{text}"
        yield from (
            f"URDF {number}: {one.category.__name__}: {one.message}\n{text}"
            for one in caught
            if issubclass(one.category, DisplayFaultWarning | RuntimeWarning)
        )
