"""Memory of robot, router and kit during a flood of images through a router into a viewer.

`python tests/benchmarks/bench_flood.py [SECONDS WIDTH HEIGHT HZ]` prints a row every 30 s; the kit
is busy for three of them. It fails where the memory of a process is larger by a tenth in the second
half than in the first, within which the buffers of a busy kit fill.
"""

import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))
SECONDS, WIDTH, HEIGHT, HZ = 300.0, 640, 480, 30.0
EVERY = 30.0  # [s] between two rows
BUSY = 3.0  # duration of the pauses in which the kit processes nothing [s]
LOOK = 0.05  # [s] between two looks of the viewer
GROWTH = 1.1  # of the most memory from the first half to the second
TOPIC, IMAGE = "/image", "sensor_msgs/msg/Image"


def memory(pid: int) -> float:
    """Return the resident memory of a process, [MB]."""
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def robot(port: int, width: int, height: int, hz: float) -> None:
    """Publish images for ever."""
    from course_lib.ros.graph.topics import Qos
    from course_lib.ros.messages import message_class, serialize
    from course_lib.ros.robot.connect import RobotAddress, link_to

    graph = link_to(RobotAddress(f"127.0.0.1:{port}", everything=True))
    out = graph.add_publisher(graph.add_node("camera", "/"), TOPIC, IMAGE, Qos(depth=5))
    image: Any = message_class(IMAGE)(width=width, height=height, step=3 * width, encoding="rgb8")
    image.header.frame_id, number, begun = "camera", 0, time.monotonic()
    while True:
        number += 1
        image.data = bytes([number % 256]) * (3 * width * height)
        image.header.stamp.sec, image.header.stamp.nanosec = divmod(graph.now_ns, 10**9)
        graph.publish(out, serialize(image))
        while time.monotonic() < begun + number / hz:
            graph.advance()


class Kit:
    """A linked graph with a viewer that shows the images."""

    def __init__(self, port: int) -> None:
        from course_lib import Viewer
        from course_lib.ros.graph.graph import use_graph
        from course_lib.ros.robot.connect import RobotAddress, link_to

        self.graph = link_to(RobotAddress(f"127.0.0.1:{port}"))
        self.shown, self.bytes = 0, 0
        with use_graph(self.graph):
            self._viewer = Viewer("camera")
        self._viewer.add("Image", TOPIC)
        self.graph.tap(lambda sample: self._count(len(sample.cdr)), lambda: ())

    def _count(self, size: int) -> None:
        self.shown, self.bytes = self.shown + 1, self.bytes + size

    def drive(self, seconds: float) -> None:
        """Receive messages and look, for so long."""
        end, look = time.monotonic() + seconds, 0.0
        while time.monotonic() < end:
            self.graph.advance()
            if time.monotonic() >= look:
                self._viewer.refresh()
                look = time.monotonic() + LOOK


def flood(seconds: float, width: int, height: int, hz: float) -> bool:
    """Print a row every 30 s; return whether the memory stayed flat."""
    from tests.ros.zenoh.conftest import Routers

    routers = Routers()
    command = [sys.executable, __file__, "robot", *map(str, (routers.port, width, height, hz))]
    with subprocess.Popen(command, stderr=subprocess.DEVNULL) as camera:
        kit = Kit(routers.port)
        pids = {"kit": os.getpid(), "router": routers.pid, "robot": camera.pid}
        rate = 3 * width * height * hz / 1e6
        print(f"{width} x {height} at {hz:g} Hz: {rate:.0f} MB/s for {seconds:.0f} s")
        rows = list[dict[str, float]]()
        for number in range(1, round(seconds / EVERY) + 1):
            before, begun = kit.bytes, time.monotonic()
            kit.drive(EVERY - BUSY)
            rate = (kit.bytes - before) / (time.monotonic() - begun) / 1e6
            rows.append({name: memory(pid) for name, pid in pids.items()})
            shown = ", ".join(f"{name} {size:6.1f} MB" for name, size in rows[-1].items())
            print(f"{number * EVERY:5.0f} s  {shown}; {rate:6.1f} MB/s shown", flush=True)
            time.sleep(BUSY)
        link_rows = [f"{name}: {value}" for name, value in kit.graph.link_report() if name == TOPIC]
        print("doctor:", *link_rows)
        camera.kill()
    kit.graph.close()
    routers.kill()
    halves = rows[: len(rows) // 2], rows[len(rows) // 2 :]
    most = [{name: max(row[name] for row in half) for name in pids} for half in halves]
    grown = {name: most[1][name] / most[0][name] for name in pids}
    print("growth from half to half:", ", ".join(f"{name} {part:.2f} x" for name, part in grown.items()))
    return max(grown.values()) < GROWTH


def main() -> None:
    """Flood once; the exit code is 1 where the memory grows."""
    from course_lib.ros.programs import import_path

    import_path.install()
    if sys.argv[1:2] == ["robot"]:
        robot(int(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4]), float(sys.argv[5]))
    words = [float(word) for word in sys.argv[1:]] or [SECONDS, WIDTH, HEIGHT, HZ]
    seconds, width, height, hz = words
    sys.exit(0 if flood(seconds, round(width), round(height), hz) else 1)


if __name__ == "__main__":
    main()
