"""Time of the kit's import: `python -m tests.benchmarks.bench_start`, beside numpy's."""

import statistics
import subprocess
import sys
import time
from collections.abc import Iterator

from tests.benchmarks.table import Row, markdown

RUNS = 7
PROGRAMS = {
    "import numpy": "import numpy",
    "import numpy, course_lib": "import numpy, course_lib",
    "a node, its first message": (
        "from course_lib.ros import standin_path; standin_path.install()\n"
        "import rclpy; from std_msgs.msg import String; rclpy.init(); node = rclpy.create_node('n')\n"
        "node.create_publisher(String, 't', 10).publish(String(data='x'))"
    ),
}


def seconds(code: str) -> float:
    """Wall time of a fresh Python that runs `code`, [s]."""
    start = time.perf_counter()
    subprocess.run([sys.executable, "-c", code], check=True)
    return time.perf_counter() - start


def rows() -> Iterator[Row]:
    """Yield the median of each program, beside numpy's import alone."""
    times = {name: list[float]() for name in PROGRAMS}
    for _ in range(RUNS):
        for name, code in PROGRAMS.items():
            times[name].append(seconds(code))
    medians = {name: statistics.median(values) for name, values in times.items()}
    peer = medians.pop("import numpy")
    for name, median in medians.items():
        yield Row(f"{name}, a fresh Python", "s", median, {"import numpy": peer})


if __name__ == "__main__":
    print(markdown(rows()))
