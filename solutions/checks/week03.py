"""Week 3, detections: hidden scenarios and checks."""

from dataclasses import replace

from course_lib.grading import (
    Call,
    Check,
    Scenario,
    expect_frame,
    expect_marker,
    expect_marker_count,
    expect_stamps,
    expect_topic,
    expect_value,
    inputs,
    my,
    with_formal,
)

MARKERS, ARRAY = "/detections", "visualization_msgs/msg/MarkerArray"
TRUCK = inputs.DetectedObject(7, "Truck", (-4.0, 1.5, 1.4), (6.0, 2.4, 2.8), 0.4, yaw=-1.1)
DOG = inputs.DetectedObject(3, "Dog", (1.2, -0.6, 0.3), (0.9, 0.3, 0.6), 0.62)
CHILD = inputs.DetectedObject(12, "Child", (0.8, 2.0, 0.55), (0.4, 0.4, 1.1), 0.999)
TRUCK_COLOR, CHILD_COLOR = (0.6, 0.4, 0.0, 0.5), (0.001, 0.999, 0.0, 0.5)

# A truck, in another frame, at another rate, for longer.
COUNT = 25  # messages
DELAY = 0.3  # [s] from the stamp of a message to its arrival
OTHERS = tuple(
    inputs.detections((TRUCK, DOG, CHILD), at=0.1 + step / 5, frame="odom", delay=DELAY)
    for step in range(COUNT)
)
# The dog leaves after five messages.
DOG_LEAVES = tuple(
    inputs.detections((TRUCK, CHILD, *[DOG] * (step < 5)), at=0.1 + step / 5, frame="odom", delay=DELAY)
    for step in range(16)
)
SURE = replace(DOG, confidence=my("threshold"))  # just sure enough
UNSURE = replace(TRUCK, confidence=my("threshold", times=0.99))
CIRCLING = tuple(
    inputs.detections(
        [
            replace(DOG, center=(1.0 - 0.2 * step, 0.1 * step, 0.3)),
            replace(CHILD, center=(0.8, 2.0 - 0.1 * step, 0.55)),
        ],
        at=0.2 + 0.25 * step,
        frame="odom",
        delay=DELAY,
    )
    for step in range(12)
)


def from_messages(namespace: str, *content: Check, at: float | None = None) -> tuple[Check, ...]:
    """The checks of content; namespace, frame and stamps are formal."""
    formal = (
        expect_marker(MARKERS, ns=namespace, at=at),
        expect_frame(MARKERS, "odom"),
        expect_stamps(MARKERS, delay=DELAY),
    )
    return with_formal(content, *formal)


def for_each_message(namespace: str, count: Check, *details: Check) -> tuple[Check, ...]:
    """Return the checks of one array per message; the count is checked first."""
    again = expect_topic(MARKERS, ARRAY, at_least=COUNT)
    first = count.requiring(again)
    no_more = expect_topic(MARKERS, ARRAY, at_most=COUNT).requiring(first).worth(0.25)
    return from_messages(namespace, first, *(check.requiring(again) for check in details), no_more)


def one_leaves(kind: str) -> Scenario:
    """Return a scenario at whose end the marker of the dog has gone with its detection."""
    again = expect_topic(MARKERS, ARRAY, at_least=16).worth(0)
    checks = (expect_marker_count(MARKERS, 2, type=kind).requiring(again),)
    return Scenario("the dog leaves", seconds=3.2, seed=8, inputs=DOG_LEAVES, checks=checks)


HIDDEN = {
    "week03.confidence_color": (
        Scenario(
            "other confidences",
            calls=(Call(0.0), Call(0.5), Call(0.31)),
            checks=(
                expect_value((1.0, 0.0, 0.0, 0.5), call=0, axes="red green blue alpha"),
                expect_value((0.5, 0.5, 0.0, 0.5), call=1, axes="red green blue alpha"),
                expect_value((0.69, 0.31, 0.0, 0.5), call=2, axes="red green blue alpha"),
            ),
        ),
    ),
    "week03.boxes": (
        Scenario(
            "other objects",
            seconds=5.0,  # [s]
            seed=7,
            inputs=OTHERS,
            checks=for_each_message(
                "boxes",
                expect_marker_count(MARKERS, 3, type="CUBE"),
                expect_marker(
                    MARKERS,
                    type="CUBE",
                    id=7,
                    position=(-4.0, 1.5, 1.4),
                    yaw=-1.1,
                    scale=(6.0, 2.4, 2.8),
                    color=TRUCK_COLOR,
                ).worth(3),
                expect_marker(MARKERS, lifetime=1.0),
            ),
        ),
        one_leaves("CUBE"),
    ),
    "week03.labels": (
        Scenario(
            "other objects",
            seconds=5.0,  # [s]
            seed=11,
            inputs=OTHERS,
            checks=for_each_message(
                "labels",
                expect_marker_count(MARKERS, 3, type="TEXT_VIEW_FACING"),
                expect_marker(MARKERS, id=12, text="Child (1.00)").worth(2),
                expect_marker(MARKERS, id=7, position=(-4.0, 1.5, 1.4 + 1.4 + 0.5)).worth(2),
                expect_marker(MARKERS, scale=(None, None, my("letters"))).worth(4),
                expect_marker(MARKERS, color=(1.0, 1.0, 1.0, 1.0)),
                expect_marker(MARKERS, lifetime=1.0),
            ),
        ),
        one_leaves("TEXT_VIEW_FACING"),
    ),
    "week03.sure_boxes": (
        Scenario(
            "just sure enough",
            seconds=4.0,  # [s]
            seed=13,
            inputs=(
                inputs.detections((SURE, UNSURE, CHILD), at=0.5, frame="odom", delay=DELAY),
                inputs.detections((SURE, UNSURE), at=2.0, frame="odom", delay=DELAY),
                inputs.detections((), at=3.5, frame="odom", delay=DELAY),
            ),
            checks=from_messages(
                "boxes",
                expect_marker_count(MARKERS, 2, type="CUBE", at=1.5),
                expect_marker(
                    MARKERS, type="CUBE", id=12, scale=CHILD.size, color=CHILD_COLOR, lifetime=0.0, at=1.5
                ),
                expect_marker(MARKERS, type="CUBE", id=3, position=(1.2, -0.6, 0.3), at=3.0),
                expect_marker_count(MARKERS, 1, type="CUBE", at=3.0),
                expect_marker_count(MARKERS, 0, type="CUBE")
                .requiring(expect_marker(MARKERS, type="CUBE", at=1.5))
                .worth(0.5),
                at=1.5,
            ),
        ),
    ),
    "week03.velocity_arrows": (
        Scenario(
            "two objects on their ways",
            seconds=3.0,  # [s]
            seed=19,
            inputs=CIRCLING,
            checks=from_messages(
                "velocities",
                *(
                    check.requiring(expect_topic(MARKERS, ARRAY, at_least=11))
                    for check in (
                        expect_marker_count(MARKERS, 2, type="ARROW"),
                        expect_marker(
                            MARKERS, type="ARROW", id=3, points=((-1.2, 1.1, 0.3), (-2.0, 1.5, 0.3))
                        ),
                        expect_marker(
                            MARKERS, type="ARROW", id=12, points=((0.8, 0.9, 0.55), (0.8, 0.5, 0.55))
                        ),
                        expect_marker(
                            MARKERS, type="ARROW", scale=(0.08, 0.2, None), color=(0.0, 0.0, 1.0, 1.0)
                        ),
                    )
                ),
            ),
        ),
    ),
}
