"""Week 1, the first marker: tasks, hints and public checks."""

import math

from course_lib.grading import (
    Check,
    Scenario,
    Task,
    expect_circle,
    expect_frame,
    expect_marker,
    expect_marker_count,
    expect_message,
    expect_rate,
    expect_stamps,
    expect_throughout,
    inputs,
    my,
    with_formal,
)

TOPIC = "/visualization_marker"
RED = (1.0, 0.0, 0.0)
YELLOW = (1.0, 1.0, 0.0)
GREEN = (0.0, 1.0, 0.0)
BLUE = (0.0, 0.0, 1.0)
PURPLE = (1.0, 0.0, 1.0)
LAMPS = (("red", RED, 1.8), ("yellow", YELLOW, 1.3), ("green", GREEN, 0.8))  # centre height [m]
SQUARE = ((1.0, 1.0, 0.0), (-1.0, 1.0, 0.0), (-1.0, -1.0, 0.0), (1.0, -1.0, 0.0))  # [m]


def steady(*content: Check, hz: float, by_marker: bool = False) -> tuple[Check, ...]:
    """Return checks of content for the whole scenario; the rate [Hz], stamps and frame are formal."""
    always = expect_throughout(TOPIC, hz=hz).titled("published the whole time").worth(0)
    formal = (
        expect_frame(TOPIC, "map").titled("in the frame map"),
        expect_rate(TOPIC, hz, by_marker=by_marker).titled(
            f"{hz:g} times a second" if hz > 1 else "once a second"
        ),
        expect_stamps(TOPIC).titled("stamped with the time of publishing"),
    )
    return (always, *with_formal([check.requiring(always) for check in content], *formal))


RED_CUBE = Task(
    "week01.red_cube",
    title="A red cube on the ground",
    kind="node",
    name="RedCubeNode",
    hints=(
        "Which fields does a marker need to be visible? Look at section 2 of the lesson.",
        "The cube's edge is 1 m, so its centre is half an edge above the ground. Scales are lengths.",
        "Set `pose.position.z = 0.5`, `scale.x = 1.0` and the other scales, `color.r = 1.0`, "
        "and `color.a = 0.8`.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=6.0,  # [s]
            seed=1,
            checks=steady(
                expect_marker(TOPIC, type="CUBE", scale=(1.0, 1.0, 1.0)).titled("a cube with 1 m edges"),
                expect_marker(TOPIC, position=(0.0, 0.0, 0.5)).titled("above the origin, on the ground"),
                expect_marker(TOPIC, color=(*RED, 0.8)).titled("red, alpha 0.8"),
                hz=1.0,
            ),
        ),
    ),
    ghost=(inputs.ghost(1, (0.0, 0.0, 0.5), (1.0, 1.0, 1.0), RED),),
)

BLUE_CYLINDER = Task(
    "week01.blue_cylinder",
    title="A blue cylinder of your height",
    kind="node",
    name="BlueCylinderNode",
    hints=(
        "pose.position is the centre of the cylinder, not its lower end.",
        "scale.x and scale.y are diameters, scale.z is the height. Half of the height lies below the centre.",
        "With your own height: `pose.position.z = height / 2` and `scale.z = height`.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=6.0,  # [s]
            seed=1,
            checks=steady(
                expect_marker(TOPIC, type="CYLINDER", scale=(0.4, 0.4, my("height"))).titled(
                    "a cylinder, 0.4 m wide, of your height"
                ),
                expect_marker(TOPIC, position=(1.0, 0.0, my("height", times=0.5))).titled(
                    "on the ground at x = 1 m"
                ),
                expect_marker(TOPIC, color=(*BLUE, 1.0)).titled("blue, alpha 1"),
                hz=1.0,
            ),
        ),
    ),
    personal={"height": (0.6, 0.8, 1.2, 1.4, 1.6, 1.8)},  # [m]; without 1.0, the value in the lesson
    ghost=(inputs.ghost(3, (1.0, 0.0, my("height", times=0.5)), (0.4, 0.4, my("height")), BLUE),),
)

TRAFFIC_LIGHT = Task(
    "week01.traffic_light",
    title="A traffic light of three spheres",
    kind="node",
    name="TrafficLightNode",
    hints=(
        "Compare each line with the list in the task: the frame letter by letter, then place, alpha and id.",
        "Is the alpha of a new marker 1? Which of x, y and z points up? What if two markers share ns and id?",
        '`header.frame_id = "map"`, `pose.position.z = height`, `color.a = 1.0`, and `id=number` from '
        "`enumerate(LAMPS)`.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=6.0,  # [s]
            seed=1,
            checks=steady(
                expect_marker_count(TOPIC, 3, type="SPHERE").titled("three spheres at once"),
                *(
                    expect_marker(
                        TOPIC,
                        type="SPHERE",
                        ns="traffic_light",
                        position=(0.0, 0.0, height),
                        scale=(0.4, 0.4, 0.4),
                        color=(*color, 1.0),
                    ).titled(f"the {name} lamp")
                    for name, color, height in LAMPS
                ),
                hz=1.0,
                by_marker=True,
            ),
        ),
    ),
    ghost=tuple(
        inputs.ghost(2, (0.0, 0.0, height), (0.4, 0.4, 0.4), color, number)
        for number, (_, color, height) in enumerate(LAMPS)
    ),
)

PURPLE_CIRCLE = Task(
    "week01.purple_circle",
    title="A purple sphere on a circle",
    kind="node",
    name="PurpleCircleNode",
    hints=(
        "A point on a circle: x = r cos(angle), y = r sin(angle). What must change between two calls?",
        "math.cos takes radians. A full turn is 2 pi, and it takes 10 s at 10 calls a second.",
        "Start with `self.angle = 0.0`; use it in every call, then `self.angle += 2 * math.pi / 100`.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=12.0,  # [s]
            seed=1,
            checks=steady(
                expect_marker(TOPIC, type="SPHERE", scale=(0.5, 0.5, 0.5), color=(*PURPLE, 1.0)).titled(
                    "a purple sphere, 0.5 m in diameter"
                ),
                expect_circle(TOPIC, radius=2.0, height=0.5).titled(
                    "on a circle of radius 2 m, 0.5 m above the ground"
                ),
                expect_circle(TOPIC, radius=2.0, period=10.0, counter_clockwise=True).titled(
                    "counter-clockwise, one turn in 10 s"
                ),
                expect_marker_count(TOPIC, 1).titled("one sphere, without a trail"),
                hz=10.0,
            ),
        ),
    ),
    ghost=tuple(
        inputs.ghost(
            2,
            (2.0 * math.cos(number * math.pi / 6), 2.0 * math.sin(number * math.pi / 6), 0.5),
            (0.5, 0.5, 0.5),
            PURPLE,
            number,
        )
        for number in range(12)
    ),
)

HEADING_ARROW = Task(
    "week01.heading_arrow",
    title="An arrow with your heading",
    kind="node",
    name="HeadingArrowNode",
    hints=(
        "A turn about z changes two of the four numbers of a quaternion. Which two? The lesson says it.",
        "math.sin and math.cos take radians, and a quaternion holds half of the angle.",
        "With your heading in radians: `orientation.z = math.sin(heading / 2)` and "
        "`orientation.w = math.cos(heading / 2)`.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=6.0,  # [s]
            seed=1,
            checks=steady(
                expect_marker(TOPIC, type="ARROW", yaw=my("heading", times=math.pi / 180)).titled(
                    "the arrow points along your heading"
                ),
                expect_marker(
                    TOPIC, type="ARROW", position=(0.0, 0.0, 0.5), scale=(1.5, 0.15, 0.15), points=()
                )
                .worth(0.25)
                .titled("1.5 m long, 0.5 m above the origin"),
                hz=1.0,
            ),
        ),
    ),
    # [degrees]; at 90 a swap of z and w would go unnoticed.
    personal={"heading": (40.0, 110.0, 150.0, -35.0, -70.0, -130.0)},
)

SQUARE_ROUTE = Task(
    "week01.square_route",
    title="Stretch: a closed square route",
    kind="node",
    name="SquareRouteNode",
    hints=(
        "A LINE_STRIP connects each point to the next one, and it doesn't close by itself.",
        "Points are geometry_msgs/msg/Point. The width of the line is scale.x; a width of 0 draws nothing.",
        "Append the four corners to marker.points, then the first corner once more; `scale.x = 0.05`.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=6.0,  # [s]
            seed=1,
            checks=steady(
                expect_marker(TOPIC, type="LINE_STRIP", points=(*SQUARE, SQUARE[0])).titled(
                    "the corners of the square"
                ),
                expect_marker(TOPIC, type="LINE_STRIP", loop=SQUARE).titled(
                    "from corner to corner, and back to the first one"
                ),
                expect_message(TOPIC, {"scale.x": 0.05, "color.a": 1.0}).titled("0.05 m wide, alpha 1"),
                expect_marker(TOPIC, type="LINE_STRIP", position=(0.0, 0.0, 0.0))
                .worth(0.25)
                .titled("the marker's own position is the origin"),
                hz=1.0,
            ),
        ),
    ),
    ghost=tuple(
        inputs.ghost(2, corner, (0.25, 0.25, 0.25), YELLOW, number) for number, corner in enumerate(SQUARE)
    ),
)

TASKS = (RED_CUBE, BLUE_CYLINDER, PURPLE_CIRCLE, TRAFFIC_LIGHT, HEADING_ARROW, SQUARE_ROUTE)
