"""Week 9, Occupancy maps: hidden scenarios and checks; other inputs, the same requirements."""

from course_lib.grading import (
    Scenario,
    expect_frame,
    expect_marker,
    expect_rate,
    expect_stamps,
    expect_throughout,
    my,
    with_formal,
)

TOPIC = "/post"
ALWAYS = expect_throughout(TOPIC).worth(0)
CONTENT = (
    expect_marker(TOPIC, type="CYLINDER", scale=(0.2, 0.2, my("height"))).requiring(ALWAYS),
    expect_marker(TOPIC, position=(0.0, 0.0, my("height", times=0.5))).requiring(ALWAYS),
    expect_marker(TOPIC, color=(0.0, 0.0, 1.0, 1.0)).requiring(ALWAYS),
)
FORMAL = (expect_frame(TOPIC, "map"), expect_rate(TOPIC, 1.0), expect_stamps(TOPIC))

HIDDEN = {
    "week09.post": (
        Scenario("longer", seconds=10.0, seed=7, checks=(ALWAYS, *with_formal(CONTENT, *FORMAL))),
    ),
}
