"""Cost of the kit's own wire beside rosbags': `python tests/benchmarks/bench_wire.py`.

Printed as times and their ratio, which is to stay below three.
"""

import gc
import time
from collections.abc import Callable

from course_lib.ros import standin_path

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


def main() -> None:
    """Print a row for each direction."""
    standin_path.install()
    from geometry_msgs.msg import Point
    from visualization_msgs.msg import Marker

    from course_lib.ros.messages import deserialize, serialize
    from course_lib.ros.messages.definitions import typestore

    marker = Marker(points=[Point(x=1.0)] * 20)
    cdr, store, name = serialize(marker), typestore(), marker._TYPE_NAME
    twin = store.deserialize_cdr(cdr, name)
    rows: dict[str, tuple[Callable[[], object], Callable[[], object]]] = {
        "serialize": (lambda: serialize(marker), lambda: store.serialize_cdr(twin, name)),
        "deserialize": (lambda: deserialize(cdr, Marker), lambda: store.deserialize_cdr(cdr, name)),
    }
    print("              ours [us]  rosbags [us]  ratio")
    for title, calls in rows.items():
        ours, theirs = map(best, calls)
        print(f"{title:12}  {ours * 1e6:9.1f}  {theirs * 1e6:12.1f}  {ours / theirs:5.2f}")


if __name__ == "__main__":
    main()
