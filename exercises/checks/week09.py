"""Week 9, Occupancy maps: tasks, hints and public checks."""

from course_lib.grading import (
    Check,
    Scenario,
    Task,
    expect_frame,
    expect_marker,
    expect_rate,
    expect_stamps,
    expect_throughout,
    my,
    with_formal,
)

TOPIC = "/post"


def steady(*content: Check) -> tuple[Check, ...]:
    """Return checks of content for the whole scenario; rate, stamps and frame get a tenth of the points."""
    always = expect_throughout(TOPIC).titled("published from beginning to end").worth(0)
    formal = (
        expect_frame(TOPIC, "map").titled("in the frame map"),
        expect_rate(TOPIC, 1.0).titled("once a second"),
        expect_stamps(TOPIC).titled("stamped with the time of publishing"),
    )
    return (always, *with_formal([check.requiring(always) for check in content], *formal))


POST = Task(
    "week09.post",  # the week, and the name that has points in course.toml
    title="A post of your height",
    kind="node",
    name="PostNode",  # the class in the notebook
    hints=(  # three, from a nudge to nearly the answer
        "Which lines of the lesson's post change when it gets another height?",
        "pose.position is the centre, so half of the height is below it. scale.z is the height.",
        "With HEIGHT as your height: pose.position.z = HEIGHT / 2 and scale.z = HEIGHT.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=6.0,  # [s] of robot time
            seed=1,
            checks=steady(
                expect_marker(TOPIC, type="CYLINDER", scale=(0.2, 0.2, my("height"))).titled(
                    "a cylinder, 0.2 m wide, of your height"
                ),
                expect_marker(TOPIC, position=(0.0, 0.0, my("height", times=0.5))).titled(
                    "on the ground, above the origin"
                ),
                expect_marker(TOPIC, color=(0.0, 0.0, 1.0, 1.0)).titled("blue, alpha 1"),
            ),
        ),
    ),
    personal={"height": (0.6, 0.8, 1.2, 1.4)},  # [m] each student has one; 1.0 is that of the lesson
)

TASKS = (POST,)
