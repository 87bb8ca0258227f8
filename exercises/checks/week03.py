"""Week 3, detections: tasks, hints and public checks."""

from dataclasses import replace
from typing import Any

from course_lib.grading import (
    Call,
    Check,
    Message,
    Scenario,
    Task,
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
ABOVE = 0.5  # [m] between the top of a box and its label

PERSON = inputs.DetectedObject(1, "Person", (2.0, 1.0, 0.9), (0.5, 0.5, 1.8), 0.95)
CAR = inputs.DetectedObject(2, "Car", (5.0, -2.0, 0.8), (4.5, 2.0, 1.6), 0.9, yaw=0.4)
# A box is drawn for an unsure detection, too.
BICYCLE = inputs.DetectedObject(5, "Bicycle", (3.0, 3.0, 0.5), (1.8, 0.6, 1.0), 0.25)
OBJECTS = (PERSON, CAR, BICYCLE)
COUNT = 6  # messages, twice a second
# The detector needs this long, so that the stamp of a message is not the time when it arrives.
DELAY = 0.2  # [s]


def walked(found: inputs.DetectedObject, steps: int) -> inputs.DetectedObject:
    """The same object some steps of 0.3 m to the left."""
    x, y, z = found.center
    return replace(found, center=(x, y + 0.3 * steps, z))


TWICE_A_SECOND = tuple(
    inputs.detections((walked(PERSON, step + 1 - COUNT), CAR, BICYCLE), at=0.4 + step / 2, delay=DELAY)
    for step in range(COUNT)
)
# The dog leaves after the second message, and its marker has to go.
DOG = inputs.DetectedObject(8, "Dog", (-1.5, -2.0, 0.3), (0.9, 0.3, 0.6), 0.7)
DOG_LEAVES = tuple(
    inputs.detections((PERSON, CAR, *[DOG] * (step < 2)), at=0.4 + step / 2, delay=DELAY)
    for step in range(COUNT)
)


def color_of(confidence: float) -> tuple[float, float, float, float]:
    """RGBA: the redder the less sure."""
    return 1.0 - confidence, confidence, 0.0, 0.5


def expected_box(found: inputs.DetectedObject) -> dict[str, Any]:
    """Return the fields of a detection's box that a check compares."""
    color = color_of(found.confidence)
    place = {"position": found.center, "scale": found.size, "yaw": found.yaw}
    return {"type": "CUBE", "id": found.track, **place, "color": color}


def above(found: inputs.DetectedObject) -> tuple[float, float, float]:
    """Return the centre of the label, [m]."""
    x, y, z = found.center
    return x, y, z + found.size[2] / 2 + ABOVE


def ghost(found: inputs.DetectedObject) -> Message:
    """The expected picture of one box."""
    place = (found.center, found.size, color_of(found.confidence), found.track)
    return inputs.ghost(1, *place, frame="base_link", yaw=found.yaw)


def from_messages(namespace: str, *content: Check, at: float | None = None) -> tuple[Check, ...]:
    """The checks of content; namespace, frame and stamps are formal."""
    return with_formal(
        content,
        expect_marker(MARKERS, ns=namespace, at=at).titled(f"in the namespace {namespace}"),
        expect_frame(MARKERS, "base_link").titled("in the frame of the detections"),
        expect_stamps(MARKERS, delay=DELAY).titled("stamped like the detections"),
    )


def for_each_message(namespace: str, count: Check, *details: Check) -> tuple[Check, ...]:
    """Return the checks of one array per message; the count is checked first."""
    again = expect_topic(MARKERS, ARRAY, at_least=COUNT).titled("a MarkerArray for each message").worth(0)
    no_more = expect_topic(MARKERS, ARRAY, at_most=COUNT).titled("one MarkerArray for each message")
    first = count.requiring(again)
    content = (first, *(check.requiring(again) for check in details), no_more.requiring(first).worth(0.25))
    return (again, *from_messages(namespace, *content))


def one_leaves(kind: str, things: str) -> Scenario:
    """Return a scenario at whose end the marker of the dog has gone with its detection."""
    again = (
        expect_topic(MARKERS, ARRAY, at_least=COUNT).titled(f"a MarkerArray of {things} each time").worth(0)
    )
    count = expect_marker_count(MARKERS, 2, type=kind).titled(f"two {things}, after one thing has left")
    checks = (again, count.requiring(again).worth(0.25))
    return Scenario("one leaves", seconds=3.0, seed=2, inputs=DOG_LEAVES, checks=checks)


CONFIDENCE_COLOR = Task(
    "week03.confidence_color",
    title="A color for a confidence",
    kind="function",
    name="confidence_color",
    hints=(
        "A confident detection is green, an unsure one is red. Which color is half sure?",
        "Green is the confidence itself. Red and green add up to 1.",
        "Red is `1.0 - confidence`, and green is the confidence.",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(Call(1.0), Call(0.75), Call(0.0)),
            checks=(
                expect_value(color_of(1.0), call=0, name="the color of 1.0", axes="red green blue alpha"),
                expect_value(color_of(0.75), call=1, name="the color of 0.75", axes="red green blue alpha"),
                expect_value(color_of(0.0), call=2, name="the color of 0.0", axes="red green blue alpha"),
            ),
        ),
    ),
)

BOXES = Task(
    "week03.boxes",
    title="A box for each detection",
    kind="node",
    name="BoxNode",
    hints=(
        "Make one marker per detection, all in one MarkerArray. Which field makes a good marker id?",
        "The center is detection.bbox.center, the size is detection.bbox.size. The id of a "
        "detection is a string: int(...) makes a number of it.",
        "In the loop set `header = message.header`, `pose = detection.bbox.center`, "
        "`scale = detection.bbox.size` and `lifetime = Duration(seconds=1.0).to_msg()`.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=3.0,  # [s]
            seed=1,
            inputs=TWICE_A_SECOND,
            checks=for_each_message(
                "boxes",
                expect_marker_count(MARKERS, 3, type="CUBE").titled("three boxes"),
                *(
                    expect_marker(MARKERS, **expected_box(found)).titled(
                        f"the {found.label.lower()}'s box: id, place, turn, size and color"
                    )
                    for found in OBJECTS
                ),
                expect_marker(MARKERS, lifetime=1.0).titled("a lifetime of 1 s"),
            ),
        ),
        one_leaves("CUBE", "boxes"),
    ),
    ghost=tuple(ghost(found) for found in OBJECTS),
)

LABELS = Task(
    "week03.labels",
    title="Labels above the boxes",
    kind="node",
    name="LabelNode",
    hints=(
        "The centre of a box is not its top. How far is the top above the centre?",
        "z is centre + half the height + 0.5 m. The height of the letters is scale.z.",
        'The text is f"{label} ({score:.2f})"; z is the centre\'s, plus half the height, plus 0.5.',
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=3.0,  # [s]
            seed=1,
            inputs=TWICE_A_SECOND,
            checks=for_each_message(
                "labels",
                expect_marker_count(MARKERS, 3, type="TEXT_VIEW_FACING").titled("three labels"),
                *(
                    expect_marker(MARKERS, id=found.track, text=text).titled(
                        f"what the {found.label.lower()}'s label says"
                    )
                    for found, text in ((PERSON, "Person (0.95)"), (CAR, "Car (0.90)"))
                ),
                *(
                    expect_marker(MARKERS, id=found.track, position=above(found)).titled(
                        f"0.5 m above the {found.label.lower()}'s top"
                    )
                    for found in (PERSON, CAR)
                ),
                expect_marker(MARKERS, scale=(None, None, my("letters")))
                .titled("letters of your height")
                .worth(4),
                expect_marker(MARKERS, color=(1.0, 1.0, 1.0, 1.0)).titled("white, alpha 1"),
                expect_marker(MARKERS, lifetime=1.0).titled("a lifetime of 1 s"),
            ),
        ),
        one_leaves("TEXT_VIEW_FACING", "labels"),
    ),
    personal={"letters": (0.2, 0.25, 0.35, 0.4, 0.45)},  # [m]; without 0.3, the value in the lesson
)

JUST_SURE = inputs.DetectedObject(9, "Sign", (1.0, -3.0, 1.0), (0.6, 0.1, 0.6), my("threshold"))
NOT_SURE = inputs.DetectedObject(8, "Post", (4.0, 1.0, 0.5), (0.1, 0.1, 1.0), my("threshold", times=0.99))
A_BOX = expect_marker(MARKERS, type="CUBE", at=1.0).titled("a box is there at first")

SURE = Task(
    "week03.sure_boxes",
    title="Find the faults: only what is sure, and nothing stale",
    kind="node",
    name="SureBoxNode",
    hints=(
        "At which place in the array must DELETEALL be? Which detections does > leave out, compared to >=?",
        "Two markers with the same ns and id are one marker. And is every detection in the frame map?",
        "Begin with Marker(action=Marker.DELETEALL); take score >= threshold, int(detection.id) "
        "and message.header.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=3.0,  # [s]
            seed=1,
            inputs=(
                # Here >, < and <= all leave another number of boxes than >=.
                inputs.detections((PERSON, CAR, JUST_SURE, NOT_SURE), at=0.5, delay=DELAY),
                inputs.detections((PERSON, BICYCLE), at=1.5, delay=DELAY),
                inputs.detections((), at=2.5, delay=DELAY),
            ),
            checks=from_messages(
                "boxes",
                expect_marker_count(MARKERS, 3, type="CUBE", at=1.0).titled(
                    "at first the person, the car, and a sign exactly at your threshold"
                ),
                expect_marker(MARKERS, at=1.0, **expected_box(CAR)).titled("the car's box is right"),
                expect_marker(MARKERS, at=1.0, id=JUST_SURE.track, position=JUST_SURE.center).titled(
                    "at least your threshold (equal counts)"
                ),
                expect_marker(MARKERS, at=1.0, lifetime=0.0).titled("no lifetime").worth(0.5),
                expect_marker(MARKERS, at=2.0, **expected_box(PERSON)).titled(
                    "then the person's box is still there"
                ),
                expect_marker_count(MARKERS, 1, type="CUBE", at=2.0).titled(
                    "and the boxes of the others are gone"
                ),
                expect_marker_count(MARKERS, 0, type="CUBE")
                .titled("where nothing is detected, nothing is left")
                .requiring(A_BOX)
                .worth(0.5),
                expect_topic(MARKERS, ARRAY, at_most=3)
                .titled("one MarkerArray for each message")
                .requiring(A_BOX)
                .worth(0.25),
                at=1.0,
            ),
        ),
    ),
    personal={"threshold": (0.77, 0.79, 0.81, 0.83, 0.85, 0.87)},
    ghost=(ghost(PERSON),),
)

# The last two are in different seconds, so that nanosec alone is no time. The last one has a fraction
# below 0.1 s, so that f"{sec}.{nanosec}", which loses its leading zeros, is no time either.
STAMPS = (0.1, 0.25, 0.45, 1.05)  # [s]
# The intervals differ, so that velocities must be computed from the stamps.
DELAYS = (DELAY, DELAY, DELAY + 0.04, DELAY)  # [s]
SEEN = (
    (PERSON,),
    (replace(PERSON, center=(2.5, 1.0, 0.9)), BICYCLE),
    (replace(PERSON, center=(3.0, 1.0, 0.9)), replace(BICYCLE, center=(3.0, 3.2, 0.5))),
    (replace(PERSON, center=(3.6, 1.0, 0.9)), replace(BICYCLE, center=(3.0, 3.5, 0.8)), CAR),
)
MET = tuple(
    inputs.detections(found, at=stamp + delay, delay=delay)
    for found, stamp, delay in zip(SEEN, STAMPS, DELAYS, strict=True)
)
ORIGIN = (0.0, 0.0, 0.0)  # [m]: the pose of a marker moves its points, too
PERSON_ARROW = ((3.6, 1.0, 0.9), (4.6, 1.0, 0.9))  # [m], at 1 m/s
BICYCLE_ARROW = ((3.0, 3.5, 0.8), (3.0, 4.0, 1.3))  # [m], at 0.5 m/s to the left and up
ARROWS_AGAIN = expect_topic(MARKERS, ARRAY, at_least=3).titled("arrows from the second message on").worth(0)

VELOCITY = Task(
    "week03.velocity_arrows",
    title="Stretch: arrows of velocity",
    kind="node",
    name="VelocityNode",
    hints=(
        "A velocity needs two messages. What must you keep from the first one?",
        "Keep time and centre by track id. Use the stamp of the message as the time.",
        "velocity = (centre - old) / (now - then); the arrow's points are centre and centre + velocity.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=2.0,  # [s]
            seed=1,
            inputs=MET,
            checks=(
                ARROWS_AGAIN,
                *from_messages(
                    "velocities",
                    *(
                        check.requiring(ARROWS_AGAIN)
                        for check in (
                            expect_marker_count(MARKERS, 2, type="ARROW").titled(
                                "an arrow for each detection with an earlier message"
                            ),
                            expect_marker(
                                MARKERS, type="ARROW", id=1, position=ORIGIN, points=PERSON_ARROW
                            ).titled("the person's arrow: from the centre to where it will be in 1 s"),
                            expect_marker(
                                MARKERS, type="ARROW", id=5, position=ORIGIN, points=BICYCLE_ARROW
                            ).titled("the bicycle's arrow: from the centre to where it will be in 1 s"),
                            expect_marker(
                                MARKERS,
                                type="ARROW",
                                scale=(0.08, 0.2, None),
                                color=(0.0, 0.0, 1.0, 1.0),
                            ).titled("blue, shaft 0.08 m, head 0.2 m"),
                        )
                    ),
                ),
            ),
        ),
    ),
)

TASKS = (CONFIDENCE_COLOR, LABELS, BOXES, SURE, VELOCITY)
