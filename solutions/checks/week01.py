"""Week 1, the first marker: hidden scenarios and checks."""

import math

from course_lib.grading import (
    Check,
    Scenario,
    expect_circle,
    expect_frame,
    expect_marker,
    expect_marker_count,
    expect_message,
    expect_rate,
    expect_stamps,
    expect_throughout,
    my,
    with_formal,
)

TOPIC = "/visualization_marker"
LAMPS = (((1.0, 0.0, 0.0, 1.0), 1.8), ((1.0, 1.0, 0.0, 1.0), 1.3), ((0.0, 1.0, 0.0, 1.0), 0.8))  # RGBA, [m]
SQUARE = ((1.0, 1.0, 0.0), (-1.0, 1.0, 0.0), (-1.0, -1.0, 0.0), (1.0, -1.0, 0.0))  # [m]


def longer(
    *content: Check, hz: float, seconds: float, seed: int, by_marker: bool = False
) -> tuple[Scenario, ...]:
    """Return a longer run with another seed. The requirements must hold to its end."""
    always = expect_throughout(TOPIC, hz=hz).worth(0)
    formal = (expect_frame(TOPIC, "map"), expect_rate(TOPIC, hz, by_marker=by_marker), expect_stamps(TOPIC))
    checks = with_formal([check.requiring(always) for check in content], *formal)
    return (Scenario("longer", seconds=seconds, seed=seed, checks=(always, *checks)),)


HIDDEN = {
    "week01.red_cube": longer(
        expect_marker(TOPIC, type="CUBE", scale=(1.0, 1.0, 1.0)),
        expect_marker(TOPIC, position=(0.0, 0.0, 0.5)),
        expect_marker(TOPIC, color=(1.0, 0.0, 0.0, 0.8)),
        hz=1.0,
        seconds=10.0,  # [s]
        seed=7,
    ),
    "week01.blue_cylinder": longer(
        expect_marker(TOPIC, type="CYLINDER", scale=(0.4, 0.4, my("height"))),
        expect_marker(TOPIC, position=(1.0, 0.0, my("height", times=0.5))),
        expect_marker(TOPIC, color=(0.0, 0.0, 1.0, 1.0)),
        hz=1.0,
        seconds=10.0,  # [s]
        seed=11,
    ),
    "week01.traffic_light": longer(
        expect_marker_count(TOPIC, 3, type="SPHERE"),
        *(
            expect_marker(
                TOPIC,
                type="SPHERE",
                ns="traffic_light",
                position=(0.0, 0.0, height),
                scale=(0.4, 0.4, 0.4),
                color=color,
            )
            for color, height in LAMPS
        ),
        hz=1.0,
        by_marker=True,
        seconds=10.0,  # [s]
        seed=13,
    ),
    "week01.purple_circle": longer(
        expect_marker(TOPIC, type="SPHERE", scale=(0.5, 0.5, 0.5), color=(1.0, 0.0, 1.0, 1.0)),
        expect_circle(TOPIC, radius=2.0, height=0.5),
        expect_circle(TOPIC, radius=2.0, period=10.0, counter_clockwise=True),
        expect_marker_count(TOPIC, 1),
        hz=10.0,
        seconds=25.0,  # [s]
        seed=17,
    ),
    "week01.heading_arrow": longer(
        expect_marker(TOPIC, type="ARROW", yaw=my("heading", times=math.pi / 180)),
        expect_marker(
            TOPIC, type="ARROW", position=(0.0, 0.0, 0.5), scale=(1.5, 0.15, 0.15), points=()
        ).worth(0.25),
        hz=1.0,
        seconds=10.0,  # [s]
        seed=23,
    ),
    "week01.square_route": longer(
        expect_marker(TOPIC, type="LINE_STRIP", points=(*SQUARE, SQUARE[0])),
        expect_marker(TOPIC, type="LINE_STRIP", loop=SQUARE),
        expect_message(TOPIC, {"scale.x": 0.05, "color.a": 1.0}),
        expect_marker(TOPIC, type="LINE_STRIP", position=(0.0, 0.0, 0.0)).worth(0.25),
        hz=1.0,
        seconds=10.0,  # [s]
        seed=19,
    ),
}
