"""Compare the kit's CDR serialization with rosbags: `python -m tests.benchmarks.bench_wire`."""

import gc
import time
from collections.abc import Callable, Iterator
from typing import Any

from course_lib.ros.programs import import_path
from tests.benchmarks.table import Row, markdown

CALLS = 1000


def best(call: Callable[[], object]) -> float:
    """The least time of a call, [s]."""
    gc.disable()
    times = []
    for _ in range(CALLS):
        start = time.perf_counter()
        call()
        times.append(time.perf_counter() - start)
    gc.enable()
    return min(times)


def rows() -> Iterator[Row]:
    """Yield a row for each direction and message."""
    import_path.install()
    from geometry_msgs.msg import Point
    from sensor_msgs.msg import JointState
    from std_msgs.msg import Int32
    from visualization_msgs.msg import Marker

    names, numbers = [f"joint_{number}" for number in range(6)], [0.1] * 6
    for title, message in {
        "a Marker of 20 points": Marker(points=[Point(x=1.0)] * 20),
        "a JointState of 6 joints": JointState(name=names, position=numbers, velocity=numbers),
        "an Int32": Int32(data=3),
    }.items():
        yield from rows_of(title, message)


def rows_of(title: str, message: Any) -> Iterator[Row]:
    """Yield a row for each direction."""
    from course_lib.ros.messages import deserialize, serialize
    from course_lib.ros.messages.definitions import typestore

    cdr, store, name = serialize(message), typestore(), message._TYPE_NAME
    twin = store.deserialize_cdr(cdr, name)
    pairs: dict[str, tuple[Callable[[], object], Callable[[], object]]] = {
        "serialise": (lambda: serialize(message), lambda: store.serialize_cdr(twin, name)),
        "deserialise": (lambda: deserialize(cdr, type(message)), lambda: store.deserialize_cdr(cdr, name)),
    }
    for verb, calls in pairs.items():
        ours, theirs = (1e6 * best(call) for call in calls)
        yield Row(f"{verb} {title}", "µs", ours, {"rosbags": theirs})


if __name__ == "__main__":
    print(markdown(rows()))
