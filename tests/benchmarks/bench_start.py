"""Compare the kit's start-up time with numpy's import: `python -m tests.benchmarks.bench_start`.

On a busy machine the processor's time is steadier than the wall clock's; both are measured.
"""

import resource
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.benchmarks.table import Row, markdown

RUNS = 7
PROGRAMS = {
    "import numpy": "import numpy",
    "import numpy, course_lib": "import numpy, course_lib",
    "a node, its first message": (
        "from course_lib.ros.programs import import_path; import_path.install()\n"
        "import rclpy; from std_msgs.msg import String; rclpy.init(); node = rclpy.create_node('n')\n"
        "node.create_publisher(String, 't', 10).publish(String(data='x'))"
    ),
}


COMMANDS = {
    "course run of a small node": "run {program}",
    "course ros2 topic list over it": "ros2 --run {program} topic list",
}
NODE = """
import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("n")
publisher = node.create_publisher(String, "t", 10)
node.create_timer(0.5, lambda: publisher.publish(String(data="x")))
rclpy.spin(node)
"""


def seconds(command: list[str]) -> tuple[float, float]:
    """Return the wall time and the processor's time of a command, [s]."""
    start, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    return time.perf_counter() - start, used


def rows() -> Iterator[Row]:
    """Yield the median time of each program and command, and of the import of numpy."""
    with TemporaryDirectory() as folder:
        program = Path(folder, "node.py")
        program.write_text(NODE, encoding="utf-8")
        course = [sys.executable, "-m", "course_lib"]
        started = {f"{name}, a fresh Python": [sys.executable, "-c", code] for name, code in PROGRAMS.items()}
        started |= {
            name: [*course, *words.format(program=program).split()] for name, words in COMMANDS.items()
        }
        times = {name: list[tuple[float, float]]() for name in started}
        for _ in range(RUNS):
            for name, command in started.items():
                times[name].append(seconds(command))
    for index, clock in enumerate(("wall", "processor")):
        medians = {name: statistics.median(pair[index] for pair in pairs) for name, pairs in times.items()}
        peer = medians.pop("import numpy, a fresh Python")
        for name, median in medians.items():
            yield Row(f"{name}, {clock}", "s", median, {"import numpy": peer})


if __name__ == "__main__":
    print(markdown(rows()))
