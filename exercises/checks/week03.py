"""Week 3, detections: tasks, hints and public checks."""

from dataclasses import replace
from typing import Any

from course_lib.grading.inputs import Found, detections, xyz
from course_lib.grading.task import Call, Message, Scenario, Task, my
from course_lib.grading.vocabulary import expect_marker, expect_marker_count, expect_stamps, expect_value

MARKERS = "/detections"
ABOVE = 0.5  # [m] between the top of a box and its label

PERSON = Found(1, "Person", (2.0, 1.0, 0.9), (0.5, 0.5, 1.8), 0.95)
CAR = Found(2, "Car", (5.0, -2.0, 0.8), (4.5, 2.0, 1.6), 0.88)
BICYCLE = Found(5, "Bicycle", (3.0, 3.0, 0.5), (1.8, 0.6, 1.0), 0.75)
OBJECTS = (PERSON, CAR, BICYCLE)
TWICE_A_SECOND = tuple(detections(OBJECTS, at=0.4 + step / 2) for step in range(6))


def color_of(confidence: float) -> tuple[float, float, float, float]:
    """RGBA: the redder the less sure."""
    return 1.0 - confidence, confidence, 0.0, 0.5


def expected_box(found: Found) -> dict[str, Any]:
    """What a check of the box of a detection compares."""
    color = color_of(found.confidence)
    return {"id": found.track, "position": found.center, "scale": found.size, "color": color}


def ghost(found: Found) -> Message:
    """The expected picture of one box."""
    fields = {
        "header": {"frame_id": "base_link"},
        "ns": "expected",
        "id": found.track,
        "type": 1,
        "pose": {"position": xyz(found.center)},
        "scale": xyz(found.size),
        "color": dict(zip("rgba", color_of(found.confidence), strict=True)),
    }
    return Message("/expected", "visualization_msgs/msg/Marker", fields)


CONFIDENCE_COLOR = Task(
    "week03.confidence_color",
    title="The colour of a confidence",
    kind="function",
    name="confidence_color",
    hints=(
        "A sure detection is green, an unsure one is red. What is half sure?",
        "Green is the confidence itself. Red is what is missing to 1.",
        "return (1.0 - confidence, confidence, 0.0, 0.5)",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(Call(1.0), Call(0.75)),
            checks=(
                expect_value(color_of(1.0), call=0, name="the colour of 1.0"),
                expect_value(color_of(0.75), call=1, name="the colour of 0.75"),
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
        "One marker per detection, all in one MarkerArray. Which field makes a good marker id?",
        "The centre is detection.bbox.center, the size is detection.bbox.size. Ids are texts: use int(...).",
        "In the loop: marker.header = message.header, marker.pose = detection.bbox.center, marker.scale = "
        "detection.bbox.size, marker.lifetime = Duration(seconds=1.0).to_msg().",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=3.0,  # [s]
            seed=1,
            inputs=TWICE_A_SECOND,
            checks=(
                expect_marker_count(MARKERS, 3, type="CUBE").titled("three boxes"),
                expect_marker(MARKERS, type="CUBE", frame="base_link", **expected_box(CAR)).titled(
                    "the car's box: place, size and colour"
                ),
                expect_marker(MARKERS, lifetime=1.0).titled("a lifetime of 1 s"),
                expect_stamps(MARKERS).titled("stamped like the detections"),
            ),
        ),
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
        'marker.text = f"{label} ({score:.2f})", and pose.position.z = center.z + size.z / 2 + 0.5.',
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=3.0,  # [s]
            seed=1,
            inputs=TWICE_A_SECOND,
            checks=(
                expect_marker_count(MARKERS, 3, type="TEXT_VIEW_FACING").titled("three labels"),
                expect_marker(MARKERS, id=1, text="Person (0.95)").titled("what the person's label says"),
                expect_marker(MARKERS, id=2, position=(5.0, -2.0, 0.8 + 0.8 + ABOVE)).titled(
                    "0.5 m above the car's top"
                ),
                expect_marker(MARKERS, type="TEXT_VIEW_FACING", scale=(0.0, 0.0, my("letters"))).titled(
                    "letters of your height, white"
                ),
            ),
        ),
    ),
    personal={"letters": (0.2, 0.25, 0.35, 0.4, 0.45)},  # [m]; 0.3 is left out: it is the lesson's
)

SURE = Task(
    "week03.sure_boxes",
    title="Only what is sure, and nothing stale",
    kind="node",
    name="SureBoxNode",
    hints=(
        "Two things: leave out what is below the threshold, and remove what was drawn before but is gone.",
        "An array is worked through in order. What could its first marker do?",
        "Begin every array with Marker(action=Marker.DELETEALL), then add the boxes with score >= THRESHOLD.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=3.0,  # [s]
            seed=1,
            inputs=(detections(OBJECTS, at=0.5), detections((PERSON, BICYCLE), at=2.0)),
            checks=(
                expect_marker(MARKERS, type="CUBE", **expected_box(PERSON)).titled(
                    "the person's box is there"
                ),
                expect_marker_count(MARKERS, 1, type="CUBE").titled(
                    "at the end only what is sure and still there"
                ),
            ),
        ),
    ),
    personal={"threshold": (0.77, 0.79, 0.81, 0.83, 0.85, 0.87)},
    ghost=(ghost(PERSON),),
)

VELOCITY = Task(
    "week03.velocity_arrows",
    title="Stretch: arrows of velocity",
    kind="node",
    name="VelocityNode",
    hints=(
        "A velocity needs two messages. What do you have to remember from the first?",
        "Keep time and centre by track id. The stamp of the message is the time that counts.",
        "velocity = (centre - old) / (now - then); the arrow's points are centre and centre + velocity.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=2.0,  # [s]
            seed=1,
            inputs=tuple(
                detections([replace(PERSON, center=(2.0 + 0.5 * step, 1.0, 0.9))], at=0.1 + 0.5 * step)
                for step in range(4)
            ),
            checks=(
                expect_marker(MARKERS, type="ARROW", id=1).titled("an arrow for the person"),
                expect_marker(MARKERS, type="ARROW", points=((3.5, 1.0, 0.9), (4.5, 1.0, 0.9))).titled(
                    "from the centre to where it will be in 1 s"
                ),
            ),
        ),
    ),
)

TASKS = (CONFIDENCE_COLOR, BOXES, LABELS, SURE, VELOCITY)
