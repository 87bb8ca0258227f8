"""Run by Debian's Python: asks tf2's own C++ buffer (package python3-tf2-ros).

Reads cases from a JSON file and writes the answers into another one.
"""

import json
import sys
from pathlib import Path
from typing import Any

import rospy  # type: ignore[import-not-found]  # Debian's, not the kit's
from geometry_msgs.msg import TransformStamped
from tf2_py import BufferCore, TransformException  # Debian's


def time(stamp_ns: int) -> Any:
    return rospy.Time(*divmod(stamp_ns, 10**9))


def fill(core: Any, parent: str, child: str, stamp_ns: int, pose: list[float], is_static: bool) -> None:
    message: Any = TransformStamped()
    message.header.frame_id, message.child_frame_id, message.header.stamp = parent, child, time(stamp_ns)
    shift, turn = message.transform.translation, message.transform.rotation
    shift.x, shift.y, shift.z, turn.x, turn.y, turn.z, turn.w = pose
    (core.set_transform_static if is_static else core.set_transform)(message, "me")


def ask(core: Any, query: list[Any]) -> list[Any]:
    """Return [can it, stamp, pose], or [can it, name of the exception, its text]."""
    arguments = [time(word) if isinstance(word, int) else word for word in query]
    full = len(arguments) > 3
    can = (core.can_transform_full_core if full else core.can_transform_core)(*arguments)[0]
    try:
        found = (core.lookup_transform_full_core if full else core.lookup_transform_core)(*arguments)
    except TransformException as error:
        return [bool(can), type(error).__name__, str(error)]
    shift, turn = found.transform.translation, found.transform.rotation
    pose = [shift.x, shift.y, shift.z, turn.x, turn.y, turn.z, turn.w]
    return [bool(can), found.header.stamp.to_nsec(), pose]


def answers(case: Any) -> list[Any]:
    core: Any = BufferCore(rospy.Duration(10))
    for transform in case["transforms"]:
        fill(core, *transform)
    return [ask(core, query) for query in case["queries"]]


if __name__ == "__main__":
    cases = json.loads(Path(sys.argv[1]).read_text())
    Path(sys.argv[2]).write_text(json.dumps([answers(case) for case in cases]))
