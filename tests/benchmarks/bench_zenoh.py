"""Compare a link with TCP, a gateway and zenoh-ros2-sdk: `python tests/benchmarks/bench_zenoh.py`.

Each sender is a process of its own. Latency is from publishing to the callback, at a rate that all
keep up with; throughput is of a flood. The link and the SDK decode, bare TCP does not.
"""

import logging
import socket
import struct
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))
COUNT, HZ = 200, 100.0  # of latencies
FLOOD = 5000
SECONDS = 20.0  # timeout of a receiver [s]
STAMP = struct.Struct("<q")
STRING = "std_msgs/msg/String"


def paced(publish: Callable[[str], object]) -> None:
    """Publish stamps at a rate, then a flood of them, then the end."""
    for _ in range(COUNT):
        publish(str(time.time_ns()))
        time.sleep(1 / HZ)
    for _ in range(FLOOD):
        publish("flood")
    while True:
        publish("end")
        time.sleep(0.05)


class Received:
    """The latencies and the flood that one receiver sees."""

    def __init__(self) -> None:
        self.delays: list[float] = []  # [s]
        self.flood: list[float] = []  # arrival times [s]
        self.over = False

    def take(self, text: str) -> None:
        """Record a message."""
        if text.isdigit():
            self.delays.append((time.time_ns() - int(text)) * 1e-9)
        elif text == "flood":
            self.flood.append(time.perf_counter())
        elif self.flood:
            self.over = True

    def row(self, name: str, beside: float = 0.0) -> float:
        """Print a row; return the median latency."""
        half = sorted(self.delays)[len(self.delays) // 2]
        rate = (len(self.flood) - 1) / (self.flood[-1] - self.flood[0])
        ratio = f"{half / beside:6.1f} x" if beside else ""
        print(f"{name:10} p50 {half * 1e3:6.2f} ms {ratio:9} flood {rate:8.0f}/s, {len(self.flood)}/{FLOOD}")
        return half


def by_tcp(received: Received, send: Callable[[str, int], None]) -> None:
    """Receive over a bare socket, each message behind its length."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        send("tcp", server.getsockname()[1])
        connection, _ = server.accept()
        stream = connection.makefile("rb")
        while not received.over:
            (size,) = STAMP.unpack(stream.read(STAMP.size))
            received.take(stream.read(size).decode())


def by_kit(received: Received, send: Callable[[str, int], None], port: int, behind: str = "") -> None:
    """Receive in a linked graph, maybe behind a gateway at an address."""
    from course_lib.ros.graph.topics import Qos
    from course_lib.ros.robot.connect import RobotAddress, link_to

    graph = link_to(RobotAddress(behind or f"127.0.0.1:{port}"))
    from std_msgs.msg import String

    from course_lib.ros.messages import deserialize

    node = graph.add_node("bench", "/")
    graph.add_subscription(
        node, 0, "/bench", STRING, Qos(), lambda cdr, *_: received.take(deserialize(cdr, String).data)
    )
    send("kit", port)
    end = time.monotonic() + SECONDS
    while not received.over and time.monotonic() < end:
        graph.advance()
    graph.close()


def by_sdk(received: Received, send: Callable[[str, int], None], port: int) -> None:
    """Receive with zenoh-ros2-sdk, on the same kit's sender."""
    import zenoh_ros2_sdk as sdk

    logging.disable(logging.WARNING)
    kept = sdk.ROS2Subscriber(
        "/bench", STRING, lambda m: received.take(m.data), msg_definition="string data\n", router_port=port
    )
    send("kit", port)
    end = time.monotonic() + SECONDS
    while not received.over and time.monotonic() < end:
        time.sleep(0.01)
    kept.close()


def sender(kind: str, port: int) -> None:
    """Send for ever, in this process."""
    if kind == "tcp":
        connection = socket.create_connection(("127.0.0.1", port))
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        paced(lambda text: connection.sendall(STAMP.pack(len(text)) + text.encode()))
    from course_lib.ros.programs import import_path

    import_path.install()
    from std_msgs.msg import String

    from course_lib.ros.graph.topics import Qos
    from course_lib.ros.messages import serialize
    from course_lib.ros.robot.connect import RobotAddress, link_to

    graph = link_to(RobotAddress(f"127.0.0.1:{port}", send=["/bench"]))
    qos = Qos(history="keep_all")  # as a reliable publisher that loses nothing
    out = graph.add_publisher(graph.add_node("sender", "/"), "/bench", STRING, qos)
    time.sleep(1.0)
    paced(lambda text: graph.publish(out, serialize(String(data=text))))


def main() -> None:
    """Print a row for each way."""
    from course_lib.ros.programs import import_path

    import_path.install()
    from tests.gateway.test_restarts import Gateways
    from tests.ros.zenoh.conftest import Routers

    routers, processes = Routers(), list[subprocess.Popen[bytes]]()
    folder = TemporaryDirectory()
    gateway = Gateways(Path(folder.name), f"tcp/127.0.0.1:{routers.port}")

    def send(kind: str, port: int) -> None:
        command = [sys.executable, __file__, kind, str(port)]
        processes.append(subprocess.Popen(command, stderr=subprocess.DEVNULL))

    bare = 0.0
    for name, receive in (
        ("bare TCP", by_tcp),
        ("link", lambda received, send: by_kit(received, send, routers.port)),
        ("gateway", lambda received, send: by_kit(received, send, routers.port, gateway.address)),
        ("SDK", lambda received, send: by_sdk(received, send, routers.port)),
    ):
        received = Received()
        receive(received, send)
        processes.pop().kill()
        half = received.row(name, bare)
        bare = bare or half
    gateway.kill()
    folder.cleanup()
    routers.kill()


if __name__ == "__main__":
    if len(sys.argv) > 1:
        sender(sys.argv[1], int(sys.argv[2]))
    else:
        main()
