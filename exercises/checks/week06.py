"""Week 6, tooling and diagnostics: tasks, hints and public checks."""

from collections.abc import Iterable, Iterator
from typing import Any

from course_lib.grading.evidence import Check, Evidence, Verdict, failed, passed
from course_lib.grading.inputs import header, pose, scan, transforms, xyz
from course_lib.grading.task import Call, Message, Row, Scenario, Task, my
from course_lib.grading.vocabulary import (
    expect_display,
    expect_drawn,
    expect_fact,
    expect_layout,
    expect_level,
    expect_message,
    expect_rate,
    expect_stamps,
    expect_topic,
    expect_value,
)

IMAGES, DIAGNOSTICS = "/camera/image_raw", "/diagnostics"
LENGTH = (80, 200)  # words of a text
FACTS = ("image_rate", "image_width", "scan_reliability", "threshold", "trigger_service")


def set_parameter(at: float, name: str, **value: Any) -> Message:
    """What `ros2 param set /camera …` asks."""
    fields = {"parameters": [{"name": name, "value": value}]}
    return Message("/camera/set_parameters", "rcl_interfaces/srv/SetParameters", fields, at=at)


def images(hz: float, begin: float, end: float) -> Iterator[Message]:
    """Small images, as often as that, between two times [s]."""
    for number in range(round(hz * (end - begin))):
        at = begin + (number + 0.5) / hz
        fields = {"header": header(at, "camera_link"), "width": 1, "height": 1, "step": 1, "data": [0]}
        yield Message(IMAGES, "sensor_msgs/msg/Image", {**fields, "encoding": "mono8"}, at=at)


def frames(at: float, x: float = 1.0) -> Message:
    """The robot's frames, as it stands there."""
    base = pose("odom", "base_link", (x, 0.0, 0.0))
    names = ("laser_link", "camera_link")
    return transforms((base, *(pose("base_link", name, (0.2, 0.0, 0.0)) for name in names)), at)


def robot_messages(at: float, x: float = 1.0) -> Iterable[Message]:
    """What a robot publishes at a time, [s]."""
    ranges = scan([2.0] * 31, at, "laser_link", first=-1.5, step=0.1)
    odometry = {
        "header": header(at, "odom"),
        "child_frame_id": "base_link",
        "pose": {"pose": {"position": xyz((x, 0.0, 0.0)), "orientation": {"w": 1.0}}},
    }
    stops = [{"pose": {"position": xyz((p, 0.0, 0.0)), "orientation": {"w": 1.0}}} for p in (x, x + 1)]
    marker = {
        "header": header(at, "camera_link"),
        "ns": "boxes",
        "type": 1,
        "pose": {"position": xyz((2.0, 0.0, 0.0)), "orientation": {"w": 1.0}},
        "scale": xyz((0.5, 0.5, 0.5)),
        "color": {"g": 1.0, "a": 1.0},
    }
    yield frames(at, x)
    yield Message("/robot/scan", ranges.type_name, ranges.fields, at=at)
    yield Message("/robot/odom", "nav_msgs/msg/Odometry", odometry, at=at)
    plan = {"header": header(at, "odom"), "poses": stops}
    yield Message("/robot/plan", "nav_msgs/msg/Path", plan, at=at)
    markers = {"markers": [marker]}
    yield Message("/robot/annotations", "visualization_msgs/msg/MarkerArray", markers, at=at)


ROBOT = tuple(message for n in range(1, 5) for message in robot_messages(n / 2))
BEST_EFFORT = ("/robot/scan",)

ROBOT_FACTS = Task(
    "week06.robot_facts",
    title="Five facts about a robot",
    kind="function",
    name="robot_facts",
    hints=(
        "%ros2 topic -h, %ros2 param -h and %ros2 service -h show what can be asked.",
        "For example: %timeout 5 ros2 topic hz /robot/front_cam/image_raw. The last block counts.",
        "topic hz, topic echo --once --field width, topic info -v, param get, service list -t.",
    ),
    scenarios=(
        Scenario(
            "public", calls=(Call(),), checks=tuple(expect_fact(name, serial=my("serial")) for name in FACTS)
        ),
    ),
    personal={"serial": (11, 17, 23, 26, 32, 38, 44, 47, 53, 59, 62, 68)},
)

CAMERA = Task(
    "week06.camera",
    title="A camera that can be tuned",
    kind="node",
    name="Camera",
    hints=(
        "declare_parameter before get_parameter(...).value; a timer has its period from the start on.",
        "add_on_set_parameters_callback calls you before a value changes: p.name, p.value. Return a "
        "SetParametersResult.",
        "There: if the rate is out of range, successful=False; else destroy_timer, and create_timer anew.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=6.0,  # [s]
            inputs=(set_parameter(3.0, "frame_rate", type=3, double_value=5.0),),
            checks=(
                expect_topic(IMAGES, "sensor_msgs/msg/Image").titled("images are published"),
                expect_rate(IMAGES, my("frame_rate"), end=2.9).titled("your own rate at first"),
                expect_rate(IMAGES, 5.0, begin=3.1).titled("5 Hz from 3 s on"),
                expect_message(IMAGES, {"header.frame_id": "camera_link"}).titled("the frame"),
            ),
        ),
    ),
    personal={"frame_rate": (12.0, 15.0, 18.0, 20.0, 24.0, 28.0)},  # [Hz]
)

CAMERA_MONITOR = Task(
    "week06.camera_monitor",
    title="The camera monitor",
    kind="node",
    name="CameraMonitor",
    hints=(
        "A callback counts the images. A timer of 1 s reports, and sets the count back to 0.",
        "The levels are DiagnosticStatus.OK, .WARN and .ERROR. Ask for less than 10 first.",
        "array = DiagnosticArray(status=[status]); array.header.stamp = self.get_clock().now().to_msg()",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=9.5,  # [s]
            inputs=(*images(30.0, 0.0, 3.0), *images(20.0, 3.0, 6.0), *images(5.0, 6.0, 9.5)),
            checks=(
                expect_stamps(DIAGNOSTICS).titled("the stamp"),
                expect_message(
                    DIAGNOSTICS,
                    {"status.0.name": "Front camera", "status.0.hardware_id": my("hardware_id")},
                ).titled("name and hardware_id"),
                expect_level("OK", says="normal", begin=0.0, end=3.0).titled("30 images in a second"),
                expect_level("WARN", says="below normal", begin=3.0, end=6.0).titled("20 images in a second"),
                expect_level("ERROR", says="low", begin=6.0, end=9.0).titled("5 images in a second"),
            ),
        ),
    ),
    personal={"hardware_id": ("front_cam_003", "front_cam_007", "front_cam_012", "front_cam_021")},
)

PERFORMANCE_TABLE = Task(
    "week06.performance_table",
    title="A performance report",
    kind="function",
    name="performance_table",
    hints=(
        "Begin with one topic: its times and its sizes as two lists. n messages have n - 1 gaps.",
        "rate = (n - 1) / (last - first); zip(times, times[1:]) gives the pairs for the gaps.",
        "sorted(rows, key=lambda row: row[3], reverse=True)",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(
                Call({"/scan": [(0.0, 400), (0.1, 400), (0.2, 400)]}),
                Call({"/load": [(1.0, 8)], "/image": [(0.5, 1000), (0.75, 2000), (1.5, 3000)]}),
            ),
            checks=(
                expect_value([["/scan", 10.0, 400.0, 4000.0, 0.1]], call=0, name="the table of one topic"),
                expect_value(
                    [["/image", 2.0, 2000.0, 4000.0, 0.75], ["/load", 0.0, 8.0, 0.0, 0.0]],
                    call=1,
                    name="the table of two topics",
                ),
            ),
        ),
    ),
)

INSPECTION_LAYOUT = Task(
    "week06.inspection_layout",
    title="A layout for an inspection",
    kind="function",
    name="inspection_layout",
    hints=(
        "Add → By topic knows which display fits. Then Ctrl+S, with the name inspection.rviz.",
        "The scan and the images need Reliability Policy: Best Effort. Keep is below Odometry.",
        "made.add('LaserScan', '/robot/scan', **{'Topic/Reliability Policy': 'Best Effort'})",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(Call(),),
            checks=(
                expect_layout(fixed_frame="odom").titled("the Fixed Frame"),
                expect_drawn("LaserScan", ROBOT, best_effort=BEST_EFFORT).titled("the scan is drawn"),
                expect_display("Odometry", "/robot/odom", properties={"Keep": my("keep")}).titled(
                    "the odometry, with your Keep"
                ),
                expect_display(
                    "Image",
                    "/robot/front_cam/image_raw",
                    properties={"Topic/Reliability Policy": "Best Effort"},
                ).titled("the images"),
            ),
        ),
    ),
    personal={"keep": (20, 30, 40, 50, 60, 80)},
)


def words(evidence: Evidence) -> Verdict:
    """A text of about the length that was asked for."""
    text = evidence.returns[0] if evidence.returns else ""
    count = len(str(text or "").split())
    low, high = LENGTH
    if 0.8 * low <= count <= 1.25 * high:
        return passed(f"{count} words")
    return failed(f"{count} words, expected {low} to {high}", "the text has another length")


FINDINGS = Task(
    "week06.findings",
    title="Findings",
    kind="written",
    name="findings",
    hints=(
        "Begin with what you measured, then what you saw, then what follows from it.",
        "A number alone says little: name its topic, its unit, and the tool that gave it.",
        "I measured ... with ...; LaserScan shows ...; I recommend ..., because ... is ...",
    ),
    scenarios=(Scenario("public", checks=(Check("its length", words),)),),
    rubric=(
        Row("Measured: three numbers, each with the tool that gave it", 4),
        Row("Seen: what two displays of the layout show about the robot", 3),
        Row("Recommended: one thing to change, with a reason that follows from a number", 3),
    ),
)

DETECTION_LATENCY = Task(
    "week06.detection_latency",
    title="From image to detection",
    kind="function",
    name="detection_latency",
    hints=(
        "Each detection has the stamp of its image. A dict from stamp to arrival finds the image.",
        "round(stamp * 1000) is a key that forgives less than a millisecond.",
        "times = [arrival - arrivals[key] for …]; lost = 1 - images with a detection / all images.",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(
                Call([[0.02, 0.0], [0.12, 0.1]], [[0.07, 0.0]]),
                Call([[0.02, 0.0], [0.12, 0.1], [0.22, 0.2]], []),
            ),
            checks=(
                expect_value([0.05, 0.05, 0.5], call=0, name="one of two images"),
                expect_value([0.0, 0.0, 1.0], call=1, name="no detection"),
            ),
        ),
    ),
)

TASKS = (
    ROBOT_FACTS,
    CAMERA,
    CAMERA_MONITOR,
    PERFORMANCE_TABLE,
    INSPECTION_LAYOUT,
    FINDINGS,
    DETECTION_LATENCY,
)
