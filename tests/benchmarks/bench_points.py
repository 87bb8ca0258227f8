"""The cost of a large marker in multiples of a bare Python object: `python -m tests.benchmarks.bench_points`.

Run it before and after a change of `course_lib/ros/messages`. November 2026: made 4.5x and read
3.8x before their functions were compiled, 1.8x and 2.4x since.
"""

import time
from collections.abc import Callable
from typing import Any

from course_lib.displays.shapes import points_of
from course_lib.ros.messages import deserialize, serialize
from course_lib.ros.programs import import_path

COUNT = 200_000


class Bare:
    """A point without ROS."""

    __slots__ = ("x", "y", "z")

    def __init__(self, x: float, y: float, z: float) -> None:
        self.x, self.y, self.z = x, y, z


def cost(work: Callable[[], Any]) -> tuple[float, Any]:
    """Return the CPU time of a call for each point, [us], and its result."""
    start = time.process_time()
    result = work()
    return (time.process_time() - start) / COUNT * 1e6, result


def main() -> None:
    """Print one line per step on the way of a marker."""
    import_path.install()
    from geometry_msgs.msg import Point
    from visualization_msgs.msg import Marker

    bare, _ = cost(lambda: [Bare(float(i), 0.0, 0.0) for i in range(COUNT)])
    made, many = cost(lambda: [Point(x=float(i), y=0.0, z=0.0) for i in range(COUNT)])
    sent, cdr = cost(lambda: serialize(Marker(type=Marker.POINTS, points=many)))
    read, marker = cost(lambda: deserialize(cdr, Marker))
    drawn, _ = cost(lambda: points_of(marker))
    for name, each in (("bare", bare), ("made", made), ("sent", sent), ("read", read), ("drawn", drawn)):
        print(f"{name:6} {each:5.2f} us for each point  {each / bare:5.1f}x")


if __name__ == "__main__":
    main()
