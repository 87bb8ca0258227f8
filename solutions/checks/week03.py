"""Week 3, detections: hidden scenarios and checks."""

from dataclasses import replace

from course_lib.grading.inputs import Found, detections
from course_lib.grading.task import Call, Scenario, my
from course_lib.grading.vocabulary import (
    expect_marker,
    expect_marker_count,
    expect_rate,
    expect_stamps,
    expect_value,
)

MARKERS = "/detections"
TRUCK = Found(7, "Truck", (-4.0, 1.5, 1.4), (6.0, 2.4, 2.8), 0.4)
DOG = Found(3, "Dog", (1.2, -0.6, 0.3), (0.9, 0.3, 0.6), 0.62)
CHILD = Found(12, "Child", (0.8, 2.0, 0.55), (0.4, 0.4, 1.1), 0.999)
TRUCK_COLOR, CHILD_COLOR = (0.6, 0.4, 0.0, 0.5), (0.001, 0.999, 0.0, 0.5)

# A truck, in another frame, at another rate, for longer.
OTHERS = tuple(detections((TRUCK, DOG, CHILD), at=0.1 + step / 5, frame="odom") for step in range(25))
SURE = replace(DOG, confidence=my("threshold"))  # just sure enough
UNSURE = replace(TRUCK, confidence=my("threshold", times=0.99))
CIRCLING = tuple(
    detections(
        [
            replace(DOG, center=(1.0 - 0.2 * step, 0.1 * step, 0.3)),
            replace(CHILD, center=(0.8, 2.0 - 0.1 * step, 0.55)),
        ],
        at=0.2 + 0.25 * step,
        frame="odom",
    )
    for step in range(12)
)

HIDDEN = {
    "week03.confidence_color": (
        Scenario(
            "other confidences",
            calls=(Call(0.0), Call(0.5), Call(0.31)),
            checks=(
                expect_value((1.0, 0.0, 0.0, 0.5), call=0),
                expect_value((0.5, 0.5, 0.0, 0.5), call=1),
                expect_value((0.69, 0.31, 0.0, 0.5), call=2),
            ),
        ),
    ),
    "week03.boxes": (
        Scenario(
            "other objects",
            seconds=5.0,  # [s]
            seed=7,
            inputs=OTHERS,
            checks=(
                expect_marker_count(MARKERS, 3, type="CUBE"),
                expect_marker(
                    MARKERS,
                    type="CUBE",
                    id=7,
                    frame="odom",
                    position=(-4.0, 1.5, 1.4),
                    scale=(6.0, 2.4, 2.8),
                    color=TRUCK_COLOR,
                    lifetime=1.0,
                ).worth(2),
                expect_rate(MARKERS, 5.0),
                expect_stamps(MARKERS),
            ),
        ),
    ),
    "week03.labels": (
        Scenario(
            "other objects",
            seconds=5.0,  # [s]
            seed=11,
            inputs=OTHERS,
            checks=(
                expect_marker_count(MARKERS, 3, type="TEXT_VIEW_FACING"),
                expect_marker(
                    MARKERS,
                    id=12,
                    type="TEXT_VIEW_FACING",
                    text="Child (1.00)",
                    frame="odom",
                    scale=(0.0, 0.0, my("letters")),
                    color=(1.0, 1.0, 1.0, 1.0),
                    lifetime=1.0,
                ).worth(2),
                expect_marker(MARKERS, id=7, position=(-4.0, 1.5, 1.4 + 1.4 + 0.5)),
                expect_stamps(MARKERS),
            ),
        ),
    ),
    "week03.sure_boxes": (
        Scenario(
            "just sure enough",
            seconds=4.0,  # [s]
            seed=13,
            inputs=(
                detections((SURE, UNSURE, CHILD), at=0.5, frame="odom"),
                detections((SURE, UNSURE), at=3.0, frame="odom"),
            ),
            checks=(
                expect_marker_count(MARKERS, 1, type="CUBE").worth(2),
                expect_marker(MARKERS, type="CUBE", id=3, frame="odom", position=(1.2, -0.6, 0.3)),
            ),
        ),
        Scenario(
            "one stays",
            seconds=2.0,  # [s]
            seed=15,
            inputs=(detections((CHILD,), at=0.5),),
            checks=(
                expect_marker(MARKERS, type="CUBE", id=12, scale=CHILD.size, color=CHILD_COLOR),
                expect_stamps(MARKERS),
            ),
        ),
        Scenario(
            "all are gone",
            seconds=2.0,  # [s]
            seed=17,
            inputs=(detections((CHILD,), at=0.5), detections((), at=1.0)),
            checks=(expect_marker_count(MARKERS, 0, type="CUBE"),),
        ),
    ),
    "week03.velocity_arrows": (
        Scenario(
            "two objects on their ways",
            seconds=3.0,  # [s]
            seed=19,
            inputs=CIRCLING,
            checks=(
                expect_marker(
                    MARKERS,
                    type="ARROW",
                    id=3,
                    frame="odom",
                    points=((-1.2, 1.1, 0.3), (-2.0, 1.5, 0.3)),
                    scale=(0.08, 0.2, 0.0),
                    color=(0.0, 0.0, 1.0, 1.0),
                ),
                expect_marker(MARKERS, type="ARROW", id=12, points=((0.8, 0.9, 0.55), (0.8, 0.5, 0.55))),
                expect_stamps(MARKERS),
            ),
        ),
    ),
}
