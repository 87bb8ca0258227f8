"""What tf2 does not take as a transform."""

from math import isnan

from course_lib.ros.tf2_transform import Transform

_NORM_TOLERANCE = 10e-3  # of the squared norm of a quaternion


def complaints_about(transform: Transform, parent: str, child: str, authority: str) -> tuple[str, ...]:
    """Return what tf2 logs about a transform that it does not take."""
    by = f'from authority "{authority}"'
    x, y, z, w = transform.rotation
    rotation = f"({x:f} {y:f} {z:f} {w:f})"
    translation = "({:f} {:f} {:f})".format(*transform.translation)
    rules = (
        (
            parent == child,
            f'TF_SELF_TRANSFORM: Ignoring transform {by} with frame_id and  child_frame_id "{child}" '
            "because they are the same",
        ),
        (not child, f"TF_NO_CHILD_FRAME_ID: Ignoring transform {by} because child_frame_id not set "),
        (
            not parent,
            f'TF_NO_FRAME_ID: Ignoring transform with child_frame_id "{child}"  {by} '
            "because frame_id not set",
        ),
        (
            any(isnan(value) for value in (*transform.translation, *transform.rotation)),
            f'TF_NAN_INPUT: Ignoring transform for child_frame_id "{child}" {by} because of a nan value '
            f"in the transform {translation} {rotation}",
        ),
        (
            not abs(x * x + y * y + z * z + w * w - 1.0) < _NORM_TOLERANCE,
            f'TF_DENORMALIZED_QUATERNION: Ignoring transform for child_frame_id "{child}" {by} because of '
            f"an invalid quaternion in the transform {rotation}",
        ),
    )
    return tuple(text for broken, text in rules if broken)
