"""The words that check files are written in; each gives a `Check`."""

from course_lib.grading.vocabulary.diagnostics import expect_fact, expect_level, expect_levels
from course_lib.grading.vocabulary.joints import (
    expect_joint_states,
    expect_joint_swing,
    expect_joints_still,
    expect_trajectory,
)
from course_lib.grading.vocabulary.layouts import (
    expect_colors_apart,
    expect_display,
    expect_displays_on,
    expect_drawn,
    expect_layout,
)
from course_lib.grading.vocabulary.markers import expect_marker, expect_marker_count
from course_lib.grading.vocabulary.motion import (
    expect_circle,
    expect_circling_frame,
    expect_path,
    expect_transform,
)
from course_lib.grading.vocabulary.silence import expect_gone, expect_nothing_before
from course_lib.grading.vocabulary.topics import (
    expect_frame,
    expect_images,
    expect_message,
    expect_rate,
    expect_stamps,
    expect_throughout,
    expect_topic,
)
from course_lib.grading.vocabulary.values import expect_length, expect_parameters, expect_text, expect_value

__all__ = [
    "expect_circle", "expect_circling_frame", "expect_colors_apart", "expect_display",
    "expect_displays_on", "expect_drawn", "expect_fact", "expect_frame", "expect_gone",
    "expect_images", "expect_joint_states", "expect_joint_swing", "expect_joints_still",
    "expect_layout", "expect_length", "expect_level", "expect_levels", "expect_marker",
    "expect_marker_count", "expect_message", "expect_nothing_before", "expect_parameters",
    "expect_path", "expect_rate", "expect_stamps", "expect_text", "expect_throughout",
    "expect_topic", "expect_trajectory", "expect_transform", "expect_value",
]  # fmt: skip
