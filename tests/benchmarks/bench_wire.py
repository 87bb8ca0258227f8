"""Cost of the kit's own wire beside rosbags': `python -m tests.benchmarks.bench_wire`."""

import gc
import time
from collections.abc import Callable, Iterator

from course_lib.ros import standin_path
from tests.benchmarks.table import Row, markdown

CALLS = 200


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
    """Yield a row for each direction."""
    standin_path.install()
    from geometry_msgs.msg import Point
    from visualization_msgs.msg import Marker

    from course_lib.ros.messages import deserialize, serialize
    from course_lib.ros.messages.definitions import typestore

    marker = Marker(points=[Point(x=1.0)] * 20)
    cdr, store, name = serialize(marker), typestore(), marker._TYPE_NAME
    twin = store.deserialize_cdr(cdr, name)
    pairs: dict[str, tuple[Callable[[], object], Callable[[], object]]] = {
        "serialise": (lambda: serialize(marker), lambda: store.serialize_cdr(twin, name)),
        "deserialise": (lambda: deserialize(cdr, Marker), lambda: store.deserialize_cdr(cdr, name)),
    }
    for title, calls in pairs.items():
        ours, theirs = (1e6 * best(call) for call in calls)
        yield Row(f"{title} a Marker of 20 points", "µs", ours, {"rosbags": theirs})


if __name__ == "__main__":
    print(markdown(rows()))
