"""Time of the kit's import: `python tests/benchmarks/bench_start.py`, ratios against numpy."""

import statistics
import subprocess
import sys
import time

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


def main() -> None:
    """Print one line per program: median, and how much more than numpy alone."""
    times = {name: list[float]() for name in PROGRAMS}
    for _ in range(RUNS):
        for name, code in PROGRAMS.items():
            times[name].append(seconds(code))
    peer = statistics.median(times["import numpy"])
    for name, measured in times.items():
        median = statistics.median(measured)
        print(f"{name:28} {median:.3f} s   {median - peer:+.3f} s   {median / peer:.2f} x numpy")


if __name__ == "__main__":
    main()
