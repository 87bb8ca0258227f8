import json
import queue
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from example_interfaces.srv import AddTwoInts
from geometry_msgs.msg import Twist
from sensor_msgs.msg import Image, LaserScan
from std_msgs.msg import String
from std_srvs.srv import SetBool
from tf2_msgs.msg import TFMessage

from course_lib.ros.graph.graph import Graph
from course_lib.ros.graph.topics import SERVICE_HEADER
from course_lib.ros.messages import deserialize, serialize, type_name
from course_lib.ros.messages.definitions import type_hash, typestore
from course_lib.ros.messages.interface_files import kit_files
from course_lib.tools.ros2 import ros2
from course_lib.tools.sources import GraphSource
from tests.patience import PATIENCE
from tests.processes import Program
from tests.ros.zenoh.conftest import Kits, zenoh_link
from tests.ros.zenoh.test_two_kits import LATCHED, VOLATILE, connect, listener, say, talker

USED = (
    "std_msgs",
    "geometry_msgs",
    "sensor_msgs",
    "tf2_msgs",
    "builtin_interfaces",
    "action_msgs",
    "nav_msgs",
    "unique_identifier_msgs",
)
SERVICES = ("example_interfaces/srv/AddTwoInts.srv", "std_srvs/srv/SetBool.srv")
WRONG_THERE = {"std_msgs/msg/Char"}  # its hash is published: see test_hashes.py

THEIR_HASHES = """
import json, logging, pathlib, sys
from zenoh_ros2_sdk.message_registry import get_registry
from zenoh_ros2_sdk.utils import compute_type_hash_from_msg, load_dependencies_recursive

logging.disable(logging.WARNING)
registry, found = get_registry(sys.argv[1]), {}
for file in pathlib.Path(sys.argv[1]).glob("*/msg/*.msg"):
    name, text = f"{file.parent.parent.name}/msg/{file.stem}", file.read_text()
    needed = load_dependencies_recursive(name, text, registry)
    found[name] = compute_type_hash_from_msg(name, text, needed)
print(json.dumps(found))
"""


@pytest.fixture(scope="module")
def messages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write interface files where the SDK finds them, which would download them."""
    folder = tmp_path_factory.mktemp("messages")
    for name in (name for name in typestore().fielddefs if name.split("/")[:2] in [[p, "msg"] for p in USED]):
        lines: list[str] = []
        ros2(["interface", "show", "--no-comments", name], GraphSource(Graph()), lines.append)
        file = folder / f"{name}.msg"
        file.parent.mkdir(parents=True, exist_ok=True)
        own = [line for line in "".join(lines).splitlines() if not line.startswith("\t")]
        file.write_text("\n".join(own) + "\n")
    for service in SERVICES:
        (folder / service).parent.mkdir(parents=True, exist_ok=True)
        (folder / service).write_text(kit_files()[service])
    return folder


class Robot:
    """The process of the SDK, and its output."""

    def __init__(self, port: str, messages: Path) -> None:
        command = [sys.executable, str(Path(__file__).with_name("sdk_robot.py")), port, str(messages)]
        pipe = subprocess.PIPE
        self.process = Program(command, stdin=pipe, stdout=pipe, bufsize=1)
        self.lines: list[str] = []
        self._came = queue.Queue[str]()
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        for line in self.process.stdout or ():
            self._came.put(line.strip())

    def said(self, text: str) -> bool:
        while not self._came.empty():
            self.lines.append(self._came.get_nowait())
        return any(text in line for line in self.lines)

    def order(self, line: str) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(f"{line}\n")


@pytest.fixture
def robot(kits: Kits, messages: Path) -> Iterator[Robot]:
    robot = Robot(kits.address.rpartition(":")[2], messages)
    kits.until(lambda: robot.said("up"), "the SDK's robot")
    yield robot
    robot.process.kill()
    robot.process.communicate()


@pytest.mark.slow
def test_images_scans_transforms_and_strings_from_the_sdk_are_received(kits: Kits, robot: Robot) -> None:
    kit = kits.join()
    kinds: dict[str, Any] = {"/chatter": String, "/scan": LaserScan, "/tf": TFMessage, "/image": Image}
    heard = {topic: listener(kit, topic, type_name(kind)) for topic, kind in kinds.items()}
    kits.until(lambda: all(heard.values()), "all topics")
    chatter, scan, tf, image = (deserialize(heard[topic][0], kind) for topic, kind in kinds.items())
    assert chatter.data == "hello from the SDK"
    np.testing.assert_allclose(scan.ranges, np.linspace(1.0, 2.0, 90), atol=1e-6)
    assert (tf.transforms[0].child_frame_id, tf.transforms[0].transform.translation.x) == ("base_link", 0.5)
    np.testing.assert_array_equal(
        np.frombuffer(image.data, np.uint8), np.arange(640 * 480 * 3).astype(np.uint8)
    )
    assert {node.name for node in kit.nodes()} >= {"sdk_chatter", "sdk_adder", "sdk_hears_cmd_vel"}


@pytest.mark.slow
def test_sdk_receives_commands_and_latched_messages_before_and_after_joining(
    kits: Kits, robot: Robot
) -> None:
    kit = kits.join(send="/cmd_vel /early /late")
    drive = talker(kit, "/cmd_vel", "geometry_msgs/msg/Twist")
    for topic in ("/early", "/late"):
        out = talker(kit, topic, qos=LATCHED)
        for text in ("old", "new"):
            say(kit, out, text)
    command = Twist()
    command.linear.x = 0.25
    connect(kits, kit, drive, [], command, lambda: robot.said("heard /cmd_vel 0.25"))
    kits.until(lambda: robot.said("heard /cmd_vel 0.0"), "the stop")
    kits.until(lambda: robot.said("heard /early new"), "the latched message, early")
    robot.order("late")
    kits.until(lambda: robot.said("heard /late new"), "the latched message, late")
    assert not robot.said("heard /late old")


@pytest.mark.slow
def test_services_are_called_in_both_directions(kits: Kits, robot: Robot) -> None:
    kit = kits.join(call="/add_two_ints /set_bool")
    node, heard = kit.add_node("kit", "/"), list[bytes]()
    name = "/add_two_ints"
    ask = kit.add_publisher(node, f"rq{name}Request", type_name(AddTwoInts.Request), VOLATILE)
    kit.add_subscription(
        node,
        0,
        f"rr{name}Reply",
        type_name(AddTwoInts.Response),
        VOLATILE,
        lambda data, *_: heard.append(data),
    )
    kits.until(lambda: (name, "example_interfaces/srv/AddTwoInts") in served(kit), "the SDK's service")
    kit.publish(ask, SERVICE_HEADER.pack(ask, 1) + serialize(AddTwoInts.Request(a=2**40, b=2)))
    kits.until(lambda: heard, "the response")
    assert deserialize(heard[0][SERVICE_HEADER.size :], AddTwoInts.Response).sum == 2**40 + 2

    reply = kit.add_publisher(node, "rr/set_boolReply", type_name(SetBool.Response), VOLATILE)

    def answer(data: bytes, *_: int) -> None:
        request = deserialize(data[SERVICE_HEADER.size :], SetBool.Request)
        response = SetBool.Response(success=True, message=f"set to {request.data}")
        kit.publish(reply, data[: SERVICE_HEADER.size] + serialize(response))

    kit.add_subscription(node, 0, "rq/set_boolRequest", type_name(SetBool.Request), VOLATILE, answer)
    robot.order("call")
    kits.until(lambda: robot.said("answer True set to True"), "the SDK's call")


def served(graph: Graph) -> set[tuple[str, str] | None]:
    return {info.service for info in graph.endpoints() if info.is_service}


@pytest.mark.slow
def test_command_line_of_the_sdk_lists_nodes_of_the_kit(kits: Kits, messages: Path) -> None:
    kit = kits.join(send="/scan", call="/trigger")
    talker(kit, "/scan", "sensor_msgs/msg/LaserScan")
    node = kit.add_node("server", "/")
    kit.add_subscription(
        node, 0, "rq/triggerRequest", "std_srvs/srv/Trigger_Request", VOLATILE, lambda *_: None
    )
    kits.until(lambda: zenoh_link(kit).domains() == [0], "its own tokens")
    listing = sdk_line(kits, "topic", "list", "-t")
    assert "/scan [sensor_msgs/msg/LaserScan]" in listing
    assert "/trigger [std_srvs/srv/Trigger]" in sdk_line(kits, "service", "list", "-t")
    info = sdk_line(kits, "topic", "info", "-v", "/scan")
    assert "talker" in info
    assert type_hash("sensor_msgs/msg/LaserScan") in info


def sdk_line(kits: Kits, *words: str) -> str:
    program = Path(sys.executable).with_name("zenoh-ros2")
    command = [str(program), "--no-daemon", "--router", kits.address.removeprefix("tcp/"), *words]
    return subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=True).stdout


def test_type_hashes_agree_with_the_sdk_except_for_its_incorrect_hashes(messages: Path) -> None:
    output = subprocess.run(
        [sys.executable, "-c", THEIR_HASHES, str(messages)],
        capture_output=True,
        text=True,
        check=True,
        timeout=PATIENCE,
    )
    theirs = json.loads(output.stdout)
    different = {name for name, found in theirs.items() if found != type_hash(name)}
    assert different == WRONG_THERE
    assert len(theirs) > 80
