"""Week 6, tooling and diagnostics: tasks, hints and public checks."""

import re
from collections.abc import Iterable

from course_lib.grading import (
    Call,
    Check,
    Evidence,
    Message,
    Row,
    Scenario,
    Task,
    Verdict,
    expect_display,
    expect_drawn,
    expect_fact,
    expect_images,
    expect_layout,
    expect_length,
    expect_levels,
    expect_message,
    expect_rate,
    expect_stamps,
    expect_throughout,
    expect_value,
    failed,
    inputs,
    lightly_weighted,
    my,
    passed,
)

IMAGES, DIAGNOSTICS = "/camera/image_raw", "/diagnostics"


def robot_messages(at: float) -> Iterable[Message]:
    """Return the messages of a robot at a time, [s]."""
    place = (1.0, 0.0, 0.0)  # [m]
    links = (inputs.pose("base_link", name, (0.2, 0.0, 0.0)) for name in ("laser_link", "camera_link"))
    yield inputs.transforms((inputs.pose("odom", "base_link", place), *links), at)
    yield inputs.scan([2.0] * 31, at, "laser_link", first=-1.5, step=0.1, topic="/robot/scan")
    yield inputs.odometry("/robot/odom", at, place)
    yield inputs.path("/robot/plan", at, (place, (2.0, 0.0, 0.0)))
    yield inputs.marker_array("/robot/annotations", at, "camera_link", (2.0, 0.0, 0.0), (0.5, 0.5, 0.5))


ROBOT = tuple(message for n in range(1, 5) for message in robot_messages(n / 2))
MEASURED = ("image_rate", "image_width", "threshold", "trigger_service")  # and nobody guesses them
FACTS = [expect_fact(name, serial=my("serial")) for name in MEASURED]

ROBOT_FACTS = Task(
    "week06.robot_facts",
    title="Five facts about a robot",
    kind="function",
    name="robot_facts",
    hints=(
        "%ros2 topic -h, %ros2 param -h and %ros2 service -h list what you can ask for.",
        "For example: %timeout 5 ros2 topic hz /robot/front_cam/image_raw. The last block counts.",
        "topic hz, topic echo --once --field width, topic info -v, param get, service list -t.",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(Call(),),
            checks=(*FACTS, expect_fact("scan_reliability", serial=my("serial")).worth(0.4)),
        ),
    ),
    personal={"serial": (11, 17, 23, 26, 32, 38, 44, 47, 53, 59, 62, 68)},
)

PIXELS = expect_images(IMAGES).requiring(expect_throughout(IMAGES))
REJECTION = re.compile(r"^At (\d+\.\d+) s: Setting parameter failed: *(.*)", re.MULTILINE)


def accepted(title: str, *settings: tuple[float, str, float | str]) -> Check:
    """Return a check that `ros2 param set` does not fail for each of (time [s], parameter, value)."""

    def accepts(evidence: Evidence) -> Verdict:
        reasons = {float(at): reason for at, reason in REJECTION.findall(evidence.output)}
        for begin, name, value in settings:
            if begin in reasons:
                message = f"ros2 param set /camera {name} {value} failed: {reasons[begin]}"
                return failed(message, "a value is wrong: the accepted values")
        return passed("ros2 param set succeeds")

    return Check(title, accepts).worth(0)


ACCEPTED = accepted(
    "ros2 param set accepts 5 Hz and a frame", (3.0, "frame_rate", 5.0), (4.0, "frame_id", "front")
)
LIMITS_ACCEPTED = accepted(
    "ros2 param set accepts 60 and 1 Hz", (1.0, "frame_rate", 60.0), (2.0, "frame_rate", 1.0)
)
FOLLOWS = expect_rate(IMAGES, 5.0, begin=3.1, end=5.9).requiring(PIXELS, ACCEPTED).titled("5 Hz from 3 s on")
REJECTED = [expect_rate(IMAGES, 5.0, begin=at, end=at + 1.8).requiring(FOLLOWS) for at in (6.1, 8.1)]
FRAME_SET = expect_message(IMAGES, {"header.frame_id": "front"}).requiring(PIXELS, ACCEPTED)
FRAME_AT_FIRST = expect_message(IMAGES, {"header.frame_id": "camera_link"}).requiring(PIXELS)


def rejects_rates(evidence: Evidence) -> Verdict:
    """Expect `ros2 param set` to fail for 61 Hz, set at 6 s, and for 0.5 Hz, set at 8 s."""
    times = [float(at) for at, _ in REJECTION.findall(evidence.output)]  # [s]
    for rate, begin in ((61.0, 6.0), (0.5, 8.0)):  # [Hz], [s]
        if "Node not found" in evidence.output:
            return failed("ros2 param set finds no node /camera", "a node is missing")
        if evidence.errors and not evidence.samples:
            return failed("no parameter was set: your code stopped before", "a value is missing")
        if not any(begin <= at < begin + 2.0 for at in times):
            message = f"ros2 param set /camera frame_rate {rate} succeeded, expected that it is rejected"
            return failed(message, "a value is wrong")
    return passed("ros2 param set reports that setting the parameter failed")


RATES_REJECTED = Check("ros2 param set reports 61 and 0.5 Hz as rejected", rejects_rates)

CAMERA = Task(
    "week06.camera",
    title="A camera that can be tuned",
    kind="node",
    name="Camera",
    hints=(
        "declare_parameter has a name and a default. A new period needs a new timer.",
        "The callback is called before a value changes. Each parameter has .name and .value; "
        "return a SetParametersResult at the end, too.",
        "Out of range: successful=False, with a reason. Else destroy_timer, then create_timer.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=10.0,  # [s]
            inputs=(
                inputs.set_parameters("/camera", 3.0, frame_rate=5.0),
                inputs.set_parameters("/camera", 4.0, frame_id="front"),
                inputs.set_parameters("/camera", 6.0, frame_rate=61.0),
                inputs.set_parameters("/camera", 8.0, frame_rate=0.5),
            ),
            checks=lightly_weighted(
                PIXELS.titled("images with pixels").worth(0.2),
                ACCEPTED,
                expect_rate(IMAGES, my("frame_rate"), tolerance=0.03, end=2.9).titled(
                    "your own rate at first"
                ),
                FOLLOWS,
                FRAME_SET.titled("the frame that was set"),
                REJECTED[0].titled("61 Hz is rejected: it continues with 5 Hz"),
                REJECTED[1].titled("0.5 Hz is rejected: it continues with 5 Hz"),
                RATES_REJECTED.requiring(FOLLOWS),
                expect_stamps(IMAGES).worth(0.2).requiring(PIXELS).titled("the stamp"),
            ),
        ),
        Scenario(
            "nobody sets the frame, and the limits are allowed",
            seconds=7.0,  # [s]
            inputs=(
                inputs.set_parameters("/camera", 1.0, frame_rate=60.0),
                inputs.set_parameters("/camera", 2.0, frame_rate=1.0),
            ),
            checks=lightly_weighted(
                LIMITS_ACCEPTED,
                *(
                    expect_rate(IMAGES, hz, begin=begin, end=end)
                    .requiring(PIXELS, LIMITS_ACCEPTED)
                    .titled(f"{hz:g} Hz is allowed")
                    for hz, begin, end in ((60.0, 1.1, 1.9), (1.0, 2.1, None))
                ),
                FRAME_AT_FIRST.worth(0.2).titled("the frame at first"),
            ),
        ),
        Scenario(
            "both are set in one call",
            seconds=4.0,  # [s]
            inputs=(
                inputs.set_parameters(
                    "/camera",
                    2.0,
                    at_once=True,
                    frame_id="front",
                    frame_rate=7.5,
                ),
            ),
            checks=lightly_weighted(
                expect_rate(IMAGES, 7.5, begin=2.1)
                .requiring(PIXELS)
                .titled("frame_id and frame_rate in one call: 7.5 Hz from 2 s on")
            ),
        ),
    ),
    personal={"frame_rate": (12.0, 15.0, 18.0, 20.0, 24.0, 28.0)},  # [Hz]
)

# The order of the ifs, one of the faults, must not decide about the last part: all others require it.
LEVELS = expect_levels(
    ("OK", "normal", "30 images in a second"),
    ("WARN", "above normal", "36 images in a second"),
    ("ERROR", "low", "9 images in a second"),
    ("WARN", "below normal", "24 images in a second"),
)
KEY_VALUE = {"status.0.values.0.key": "Rate (Hz)", "status.0.values.0.value": "24"}
NAMES = {"status.0.name": "Front camera", "status.0.hardware_id": my("hardware_id")}


def camera_images(hz: float, begin: float, end: float) -> Iterable[Message]:
    """Return images as cameras publish them, with Best Effort, at the rate `hz` [1/s], times in [s]."""
    return inputs.images(IMAGES, hz, begin, end, best_effort=True)


CAMERA_MONITOR = Task(
    "week06.camera_monitor",
    title="Four faults in a monitor",
    kind="node",
    name="CameraMonitor",
    hints=(
        "Where does it publish? How does the number of images change over time? What is in the header?",
        "A wrong topic, a count that only grows, two tests in the wrong order, a header without a stamp.",
        "/diagnostics; self.count = 0 at the end of report; count < 10 first; array.header.stamp is now.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=12.5,  # [s]
            inputs=(
                *camera_images(30.0, 0.0, 3.0),
                *camera_images(36.0, 3.0, 6.0),
                *camera_images(9.0, 6.0, 9.0),
                *camera_images(24.0, 9.0, 12.5),
            ),
            checks=lightly_weighted(
                *LEVELS,
                expect_message(DIAGNOSTICS, NAMES)
                .requiring(LEVELS[0])
                .worth(6)
                .titled("name and hardware_id"),
                expect_message(DIAGNOSTICS, KEY_VALUE).requiring(LEVELS[0]).titled("the KeyValue"),
                expect_rate(DIAGNOSTICS, 1.0).worth(0.2).titled("once a second"),
                expect_stamps(DIAGNOSTICS).worth(0.2).titled("the stamp"),
            ),
        ),
        Scenario(
            "at the limits, and silent",
            seconds=12.5,  # [s]
            inputs=(
                *camera_images(25.0, 0.0, 3.0),
                *camera_images(35.0, 3.0, 6.0),
                *camera_images(10.0, 9.0, 12.5),
            ),
            checks=lightly_weighted(
                *expect_levels(
                    ("OK", "normal", "25 images in a second"),
                    ("OK", "normal", "35 images in a second"),
                    ("ERROR", "low", "no images"),
                    ("WARN", "below normal", "10 images in a second"),
                )
            ),
        ),
    ),
    personal={"hardware_id": ("front_cam_003", "front_cam_007", "front_cam_012", "front_cam_021")},
)

ONE = [["/scan", 10.0, 400.0, 4000.0, 0.1]]
THREE = [
    ["/image", 1.0, 500.0, 500.0, 1.0],
    ["/map", 0.01, 9000.0, 90.0, 100.0],
    ["/imu", 10.0, 8.0, 80.0, 0.1],
    ["/silent", 0.0, 0.0, 0.0, 0.0],
]
TWO = [["/image", 2.0, 7000 / 3, 14000 / 3, 0.75], ["/load", 0.0, 8.0, 0.0, 0.0]]
COLUMNS = ("topic", "rate", "size", "bandwidth", "gap")

PERFORMANCE_TABLE = Task(
    "week06.performance_table",
    title="A performance report",
    kind="function",
    name="performance_table",
    hints=(
        "What must exist before a line can use it? rows first; then one round of the loop for each topic.",
        "n messages have n - 1 gaps: that shows which of the two lines with rate = is wrong.",
        "Order: rows, for, times, sizes, size, rate = gap = 0.0, if, rate, gap, append, return.",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(
                Call({"/scan": [(0.0, 400), (0.1, 400), (0.2, 400)]}),
                Call({"/load": [(1.0, 8)], "/image": [(0.5, 1000), (0.75, 2000), (1.5, 4000)]}),
                # The images have the highest bandwidth, the map the largest size, and the imu the
                # highest rate, which /silent must not get.
                Call(
                    {
                        "/imu": [(0.0, 8), (0.1, 8)],
                        "/silent": [],
                        "/map": [(0.0, 9000), (100.0, 9000)],
                        "/image": [(0.0, 500), (1.0, 500)],
                    }
                ),
            ),
            checks=lightly_weighted(
                expect_value(ONE, call=0, name="the table of one topic", parts=COLUMNS),
                expect_value(TWO, call=1, name="the table of two topics", parts=COLUMNS),
                expect_value(THREE, call=2, name="the table with a silent topic", parts=COLUMNS),
            ),
        ),
    ),
)

TF_DRAWN = expect_drawn("TF", ROBOT)
WITH_KEEP = expect_display("Odometry", "/robot/odom", properties={"Keep": my("keep")})
BEST_EFFORT_IMAGES = expect_display(
    "Image", "/robot/front_cam/image_raw", properties={"Topic/Reliability Policy": "Best Effort"}
)

INSPECTION_LAYOUT = Task(
    "week06.inspection_layout",
    title="A layout for an inspection",
    kind="function",
    name="inspection_layout",
    hints=(
        "Add → By topic knows which display fits. Then Ctrl+S, with the name inspection.rviz.",
        "The scan and the images need Reliability Policy: Best Effort. Keep is a property of Odometry.",
        "made.add('LaserScan', '/robot/scan', **{'Topic/Reliability Policy': 'Best Effort'})",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(Call(),),
            checks=(
                expect_layout(fixed_frame="odom").requiring(TF_DRAWN).worth(0.5).titled("the Fixed Frame"),
                TF_DRAWN.titled("the frames are drawn"),
                expect_drawn("LaserScan", ROBOT, best_effort=("/robot/scan",)).titled("the scan is drawn"),
                WITH_KEEP.titled("the odometry, with your Keep").worth(3),
                expect_drawn("Odometry", ROBOT).titled("the odometry is drawn"),
                expect_drawn("Path", ROBOT).titled("the plan is drawn"),
                expect_drawn("MarkerArray", ROBOT).titled("the annotations are drawn"),
                BEST_EFFORT_IMAGES.titled("the images"),
            ),
        ),
    ),
    personal={"keep": (20, 30, 40, 50, 60, 80)},
)

FINDINGS = Task(
    "week06.findings",
    title="Findings",
    kind="written",
    name="findings",
    hints=(
        "Start with what you measured, then what you saw, then what follows from it.",
        "A number alone says little: name its topic, its unit, and the tool that gave it.",
        "I measured ... with ...; LaserScan shows ...; I recommend ..., because ... is ...",
    ),
    scenarios=(Scenario("public", checks=(expect_length(80, 200),)),),
    rubric=(
        Row("Measured: three numbers, each with the tool that gave it", 4),
        Row("Seen: what two displays of the layout show about the robot", 3),
        Row("Recommended: one thing to change, with a reason that follows from a number", 3),
    ),
)

TIMES = ("mean time", "longest time", "fraction without a detection")
ONE_OF_TWO = expect_value([0.05, 0.05, 0.5], call=0, name="the answer for one of two images", parts=TIMES)

LATENCY = Task(
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
                Call([[0.02, 0.0], [0.12, 0.1], [0.22, 0.2]], [[0.05, 0.0], [0.21, 0.1]]),
                Call([[0.02, 0.0], [0.12, 0.1]], [[0.32, 0.104], [0.07, 0.0]]),
                Call([[0.02, 0.0], [0.12, 0.1]], [[0.17, 0.0997]]),
                Call([[0.02, 0.0], [0.12, 0.1], [0.22, 0.2]], []),
                Call([], [[0.07, 0.0]]),
            ),
            checks=lightly_weighted(
                ONE_OF_TWO,
                expect_value(
                    [0.06, 0.09, 1 / 3], call=1, name="the answer for two of three images", parts=TIMES
                ),
                expect_value(
                    [0.05, 0.05, 0.5],
                    call=2,
                    name="the answer for a detection of a strange image",
                    parts=TIMES,
                ),
                expect_value(
                    [0.05, 0.05, 0.5], call=3, name="the answer for stamps that differ by 0.3 ms", parts=TIMES
                ),
                expect_value(
                    [0.0, 0.0, 1.0], call=4, name="the answer for no detection", parts=TIMES
                ).requiring(ONE_OF_TWO),
                expect_value([0.0, 0.0, 0.0], call=5, name="the answer for no image", parts=TIMES).requiring(
                    ONE_OF_TWO
                ),
            ),
        ),
    ),
)

TASKS = (ROBOT_FACTS, CAMERA, CAMERA_MONITOR, PERFORMANCE_TABLE, INSPECTION_LAYOUT, FINDINGS, LATENCY)
