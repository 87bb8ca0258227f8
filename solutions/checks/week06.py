"""Week 6, tooling and diagnostics: hidden scenarios and checks."""

import re
from collections.abc import Iterable, Iterator

from course_lib.grading import (
    Call,
    Check,
    Evidence,
    Message,
    Scenario,
    Verdict,
    expect_display,
    expect_drawn,
    expect_fact,
    expect_images,
    expect_layout,
    expect_levels,
    expect_message,
    expect_rate,
    expect_stamps,
    expect_throughout,
    expect_value,
    failed,
    inputs,
    my,
    passed,
)

IMAGES, DIAGNOSTICS = "/camera/image_raw", "/diagnostics"
MEASURED = ("image_rate", "image_width", "threshold", "trigger_service")


def robot_messages(at: float) -> Iterator[Message]:
    """Return the messages of a robot with another pose."""
    place = (-3.0, 2.0, 0.0)  # [m]
    links = (inputs.pose("base_link", name, (0.1, 0.0, 0.4)) for name in ("laser_link", "camera_link"))
    yield inputs.transforms((inputs.pose("odom", "base_link", place, 1.5), *links), at)
    yield inputs.scan([1.0] * 21, at, "laser_link", first=0.0, step=0.05, topic="/robot/scan")
    yield inputs.odometry("/robot/odom", at, place)
    yield inputs.path("/robot/plan", at, (place, (0.0, 0.0, 0.0)))
    yield inputs.marker_array(
        "/robot/annotations", at, "laser_link", (0.0, 0.0, 0.0), (0.4, 0.4, 0.4), kind=2
    )


def camera_images(hz: float, begin: float, end: float, frame: str = "") -> Iterable[Message]:
    """Return images as cameras publish them, with Best Effort, at the rate `hz` [1/s], times in [s]."""
    frames = (frame,) if frame else ()
    return inputs.images(IMAGES, hz, begin, end, *frames, best_effort=True)


ROBOT = tuple(message for n in range(1, 5) for message in robot_messages(n / 2))

PIXELS = expect_images(IMAGES).requiring(expect_throughout(IMAGES))
FOLLOWS = expect_rate(IMAGES, 60.0, begin=5.1, end=5.9).requiring(PIXELS)
REJECTION = re.compile(r"^At (\d+\.\d+) s: Setting parameter failed", re.MULTILINE)


def rejects_rates(evidence: Evidence) -> Verdict:
    """Expect `ros2 param set` to fail for 0 Hz, set at 6 s, and for 75 Hz, set at 8 s."""
    times = [float(at) for at in REJECTION.findall(evidence.output)]  # [s]
    for rate, begin in ((0.0, 6.0), (75.0, 8.0)):  # [Hz], [s]
        if not any(begin <= at < begin + 2.0 for at in times):
            message = f"ros2 param set /camera frame_rate {rate} succeeded, expected that it is rejected"
            return failed(message, "a value is wrong")
    return passed("ros2 param set reports that setting the parameter failed")


TF_DRAWN = expect_drawn("TF", ROBOT)
OTHER_TOPICS = expect_value(
    [
        ["/b", 3 / 2.25, 200.0, 200.0 * 3 / 2.25, 1.5],
        ["/a", 2.0, 20.0, 40.0, 0.5],
        ["/large", 0.02, 1000.0, 20.0, 50.0],
        ["/silent", 0.0, 0.0, 0.0, 0.0],
        ["/single", 0.0, 12.0, 0.0, 0.0],
    ],
    call=0,
)
STRANGERS = expect_value([0.085, 0.1, 0.5], call=0)
LEVELS = expect_levels(
    ("WARN", "above normal", "40"),
    ("WARN", "below normal", "11"),
    ("ERROR", "low", "9"),
    ("ERROR", "low", "none"),
    ("OK", "normal", "34"),
    ("OK", "normal", "26"),
)
NAMES = {"status.0.name": "Front camera", "status.0.hardware_id": my("hardware_id")}
KEY_VALUE = {"status.0.values.0.key": "Rate (Hz)", "status.0.values.0.value": "26"}

HIDDEN = {
    "week06.robot_facts": (
        Scenario(
            "again",
            calls=(Call(),),
            checks=(
                *(expect_fact(name, serial=my("serial")) for name in MEASURED),
                expect_fact("scan_reliability", serial=my("serial")).worth(0.4),
            ),
        ),
    ),
    "week06.camera": (
        Scenario(
            "another frame, then faster twice, then two rates that are rejected",
            seconds=10.0,  # [s]
            seed=5,
            inputs=(
                inputs.set_parameters("/camera", 2.0, frame_id="lens"),
                inputs.set_parameters("/camera", 4.0, frame_rate=37.5),
                inputs.set_parameters("/camera", 5.0, frame_rate=60.0),
                inputs.set_parameters("/camera", 6.0, frame_rate=0.0),
                inputs.set_parameters("/camera", 8.0, frame_rate=75.0),
            ),
            checks=(
                expect_rate(IMAGES, my("frame_rate"), tolerance=0.03, end=3.9).requiring(FOLLOWS).worth(3),
                FOLLOWS.worth(3),
                expect_rate(IMAGES, 37.5, begin=4.1, end=4.9).requiring(FOLLOWS),
                Check("ros2 param set reports 0 and 75 Hz as rejected", rejects_rates).requiring(FOLLOWS),
                expect_rate(IMAGES, 60.0, begin=6.1, end=7.9).requiring(FOLLOWS),
                expect_rate(IMAGES, 60.0, begin=8.1).requiring(FOLLOWS),
                expect_message(IMAGES, {"header.frame_id": "lens"}).requiring(PIXELS).worth(2),
                expect_stamps(IMAGES).requiring(PIXELS).worth(0.1),
            ),
        ),
        Scenario(
            "one of two values is wrong, so that nothing changes",
            seconds=3.0,  # [s]
            seed=6,
            inputs=(inputs.set_parameters("/camera", 1.0, at_once=True, frame_id="lens", frame_rate=75.0),),
            checks=(
                expect_rate(IMAGES, my("frame_rate"), tolerance=0.03).requiring(PIXELS).worth(0.1),
                expect_message(IMAGES, {"header.frame_id": "camera_link"}).requiring(PIXELS).worth(0.1),
            ),
        ),
    ),
    "week06.camera_monitor": (
        Scenario(
            "faster, slower, silent, and well again",
            seconds=18.5,  # [s]
            seed=7,
            inputs=(
                *camera_images(40.0, 0.0, 3.0, "lens"),
                *camera_images(11.0, 3.0, 6.0, "lens"),
                *camera_images(9.0, 6.0, 9.0, "lens"),
                *camera_images(34.0, 12.0, 15.0, "lens"),
                *camera_images(26.0, 15.0, 18.5, "lens"),
            ),
            checks=(
                *LEVELS,
                expect_rate(DIAGNOSTICS, 1.0).requiring(LEVELS[0]).worth(0.2),
                expect_stamps(DIAGNOSTICS).requiring(LEVELS[0]).worth(0.2),
                expect_message(DIAGNOSTICS, NAMES).requiring(LEVELS[0]).worth(6),
                expect_message(DIAGNOSTICS, KEY_VALUE).requiring(LEVELS[0]),
            ),
        ),
        Scenario(
            "at the edges",
            seconds=12.5,  # [s]
            seed=8,
            inputs=(
                *camera_images(36.0, 0.0, 3.0),
                *camera_images(10.0, 3.0, 6.0),
                *camera_images(25.0, 6.0, 9.0),
                *camera_images(35.0, 9.0, 12.5),
            ),
            checks=expect_levels(
                ("WARN", "above normal", "36"),
                ("WARN", "below normal", "10"),
                ("OK", "normal", "25"),
                ("OK", "normal", "35"),
            ),
        ),
    ),
    "week06.performance_table": (
        Scenario(
            "other topics",
            calls=(
                Call(
                    {
                        "/a": [(2.0, 10), (2.5, 30)],
                        "/silent": [],
                        "/single": [(3.0, 12)],
                        "/large": [(0.0, 1000), (50.0, 1000)],
                        "/b": [(5.0, 100), (5.5, 100), (7.0, 100), (7.25, 500)],
                    }
                ),
                Call({}),
            ),
            checks=(
                OTHER_TOPICS.worth(2),
                expect_value([], call=1).requiring(OTHER_TOPICS).worth(0.2),
            ),
        ),
    ),
    "week06.inspection_layout": (
        Scenario(
            "the robot elsewhere",
            calls=(Call(),),
            checks=(
                expect_layout(fixed_frame="odom").requiring(TF_DRAWN).worth(0.5),
                TF_DRAWN,
                expect_drawn("LaserScan", ROBOT, best_effort=("/robot/scan",)),
                expect_display("Odometry", "/robot/odom", properties={"Keep": my("keep")}).worth(3),
                expect_drawn("Odometry", ROBOT),
                expect_drawn("Path", ROBOT),
                expect_drawn("MarkerArray", ROBOT),
                expect_display(
                    "Image",
                    "/robot/front_cam/image_raw",
                    properties={"Topic/Reliability Policy": "Best Effort"},
                ),
            ),
        ),
    ),
    "week06.detection_latency": (
        Scenario(
            "strangers, and stamps that differ a little",
            calls=(
                Call(
                    [[1.02, 1.0], [1.12, 1.1], [1.22, 1.2], [1.32, 1.3]],
                    [[1.09, 1.0], [0.95, 0.9], [1.42, 1.2997]],
                ),
                Call([], [[1.0, 0.9]]),
                Call([[2.0, 1.9]], [[1.0, 0.9]]),
            ),
            checks=(
                STRANGERS.worth(3),
                expect_value([0.0, 0.0, 0.0], call=1).requiring(STRANGERS).worth(0.2),
                expect_value([0.0, 0.0, 1.0], call=2).requiring(STRANGERS).worth(0.2),
            ),
        ),
    ),
}
