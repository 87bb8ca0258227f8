"""Compare the DDS link to rclpy with rclpy itself: `python tests/benchmarks/bench_dds.py`.

Words choose parts: `round_trip`, which needs REAL_ROS_PYTHON or `course ros --install`, `mutated`
(100,000 datagrams with changed bytes), `structured` (with changed lengths, numbers and times) and
`refused` (1,000 attempts to send what is not allowed).
`round_trip` measures its pairs in turn, several times, on UDP or TCP on loopback; rclpy with its
shared memory is faster.
"""

import random
import statistics
import struct
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from course_lib.real.environment import find_environment  # noqa: E402
from course_lib.real.process import RealProcesses, linked_graph  # noqa: E402
from course_lib.ros.dds.link import DdsLink  # noqa: E402
from course_lib.ros.dds.participant import LEASE_SECONDS, Participant  # noqa: E402
from course_lib.ros.graph.topics import Qos  # noqa: E402
from course_lib.ros.messages import deserialize, message_class, serialize  # noqa: E402
from course_lib.ros.programs import import_path  # noqa: E402
from course_lib.ros.robot.robot_graph import RobotGraph  # noqa: E402
from course_lib.ros.robot.sending import Permissions  # noqa: E402
from course_lib.ros.time import wall  # noqa: E402
from course_lib.ros.zenoh.link import ZenohLink  # noqa: E402
from tests.ros.zenoh.conftest import Routers  # noqa: E402

MUTATED, REFUSED, TRIPS, ROUNDS = 100_000, 1_000, 200, 3
# Messages of the measurement of throughput, and how many of them are on their way at a time.
FLOOD, IN_FLIGHT = 500, 5
# Time from the discovery of the echo to the first message [s].
SETTLE_SECONDS = 2.0
# Domains whose ports Linux does not use for outgoing connections.
DOMAINS = range(1, 101)
STRING = "std_msgs/msg/String"
SIZES = (20, 100_000)  # [B]
# Size of the header of a datagram [B], and numbers at the limits of the fields of RTPS.
HEADER, DATA_FRAG = 20, 0x16
EDGES = (*range(5), 0x7F, 0xFF, 0x7FFF, 0xFFFC, 0xFFFF, 0x10000, 2**26, 2**31 - 1, 2**31, 2**32 - 1)
SUBMESSAGES = (0x01, 0x06, 0x07, 0x08, 0x09, 0x0C, 0x0E, 0x12, 0x13, 0x15, DATA_FRAG, 0x80)
PARAMETERS = (0x00, 0x01, 0x05, 0x07, 0x15, 0x1A, 0x2F, 0x32, 0x50, 0x5A, 0x70, 0x71, 0x83, 0x800F)
ECHO = """
import rclpy
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node("echo")
publisher = node.create_publisher(String, "back", 10)
node.create_subscription(String, "there", publisher.publish, 10)
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    pass
"""
PING = f"""
import statistics, sys, time
import rclpy
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node("ping")
publisher = node.create_publisher(String, "there", 10)
heard = []
node.create_subscription(String, "back", heard.append, 10)
while not (publisher.get_subscription_count() and node.count_publishers("back")):
    rclpy.spin_once(node, timeout_sec=0.1)
time.sleep(0.5)
for size in {SIZES}:
    message, times, cpu = String(data="x" * size), [], time.process_time()
    for _ in range({TRIPS}):
        heard.clear()
        begin = time.perf_counter()
        publisher.publish(message)
        while not heard and time.perf_counter() - begin < 1.0:
            rclpy.spin_once(node, timeout_sec=0.1)
        times.append((time.perf_counter() - begin) * 1e3)
    cpu = (time.process_time() - cpu) / {TRIPS} * 1e3
    heard.clear()
    begin, sent = time.perf_counter(), 0
    while len(heard) < {FLOOD} and time.perf_counter() - begin < 20.0:
        while sent - len(heard) < {IN_FLIGHT} and sent < {FLOOD}:
            publisher.publish(message)
            sent += 1
        rclpy.spin_once(node, timeout_sec=0.1)
    rate = len(heard) / (time.perf_counter() - begin)
    print(size, statistics.median(times), sorted(times)[int(0.9 * {TRIPS})], cpu, rate, flush=True)
"""


class Measured(NamedTuple):
    """A measurement of one size of messages.

    Args:
        median_ms: Median of the round trips, [ms].
        high_ms: Round trip that 90 % do not exceed, [ms].
        cpu_ms: CPU of the measuring process for each round trip, [ms].
        rate: Messages per second there and back, with several on their way.
    """

    size: int
    median_ms: float
    high_ms: float
    cpu_ms: float
    rate: float


def round_trip() -> None:
    """Measure rclpy and rclpy, the kit and rclpy over DDS, and two kits over DDS and Zenoh, in turn."""
    import_path.install()
    environment = find_environment()
    found: dict[tuple[str, int], list[Measured]] = {}

    def add(pair: str, rows: Iterable[Measured]) -> None:
        for row in rows:
            found.setdefault((pair, row.size), []).append(row)

    with tempfile.TemporaryDirectory() as folder:
        echo, ping, out = (Path(folder) / name for name in ("echo.py", "ping.py", "out.txt"))
        echo.write_text(ECHO)
        ping.write_text(PING)
        for _ in range(ROUNDS):
            programs = RealProcesses(environment, Path(folder), [echo], print)
            # As on a robot: with the interface list of `course run --ros` Fast DDS sends each
            # datagram twice.
            for name in ("FASTDDS_DEFAULT_PROFILES_FILE", "FASTRTPS_DEFAULT_PROFILES_FILE"):
                del programs._variables[name]
            programs._variables["FASTDDS_BUILTIN_TRANSPORTS"] = "UDPv4"
            programs.start(echo)
            with out.open("w") as stream:
                programs.start(ping, streams=(stream, None))
                programs.processes[1].wait(120)
            programs.processes.pop()
            lines = (line.split() for line in out.read_text().splitlines())
            add("rclpy - rclpy, UDP", (Measured(int(size), *map(float, values)) for size, *values in lines))
            graph = linked_graph(programs, print, sends=True)
            add("kit - rclpy, DDS", measured_in_kit(graph))
            programs.end(graph.advance)
            graph.close()
            domain = random.choice(DOMAINS)
            with echo_in_kit(echo, "dds/127.0.0.1", domain):
                graph = RobotGraph(DdsLink("127.0.0.1", domain), Permissions(allows_everything=True), print)
                add("kit - kit, DDS", measured_in_kit(graph))
                graph.close()
            with router() as address, echo_in_kit(echo, address, domain):
                graph = RobotGraph(ZenohLink(address, domain), Permissions(allows_everything=True), print)
                add("kit - kit, Zenoh", measured_in_kit(graph))
                graph.close()
    for (pair, size), rows in found.items():
        median, high, cpu, rate = (
            statistics.median(getattr(row, name) for row in rows)
            for name in ("median_ms", "high_ms", "cpu_ms", "rate")
        )
        sys.stdout.write(
            f"{pair:19} {size:6} B: round trip {median:5.2f} ms (90 %: {high:5.2f}), {cpu:4.2f} ms of CPU; "
            f"{IN_FLIGHT} in flight: {rate:5.0f}/s, {rate * size * 1e-6:5.1f} MB/s each way\n"
        )


def measured_in_kit(graph: RobotGraph) -> Iterator[Measured]:
    """Measure messages to an echo that a graph is linked to."""
    node = graph.add_node("ping", "/")
    there = graph.add_publisher(node, "/there", STRING, Qos())
    heard: list[bytes] = []
    graph.add_subscription(node, 0, "/back", STRING, Qos(), lambda cdr, *_: heard.append(cdr))
    string = message_class(STRING)
    settled = wall.monotonic() + SETTLE_SECONDS
    while wall.monotonic() < settled:
        graph.advance()
        if "/there" not in {info.topic for info in graph.endpoints() if info.kind == "sub"}:
            settled = wall.monotonic() + SETTLE_SECONDS
    for size in SIZES:
        message, times, cpu = string(data="x" * size), [], time.process_time()
        for _ in range(TRIPS):
            heard.clear()
            begin = time.perf_counter()
            graph.publish(there, serialize(message))
            while not heard and time.perf_counter() - begin < 1.0:
                graph.advance()
            deserialize(heard[-1], string)
            times.append((time.perf_counter() - begin) * 1e3)
        used = (time.process_time() - cpu) / TRIPS * 1e3
        heard.clear()
        begin, sent, returned = time.perf_counter(), 0, 0
        while returned < FLOOD and time.perf_counter() - begin < 20.0:
            while sent - returned < IN_FLIGHT and sent < FLOOD:
                graph.publish(there, serialize(message))
                sent += 1
            graph.advance()
            while heard:
                deserialize(heard.pop(), string)
                returned += 1
        rate = returned / (time.perf_counter() - begin)
        yield Measured(size, statistics.median(times), sorted(times)[int(0.9 * TRIPS)], used, rate)


@contextmanager
def echo_in_kit(program: Path, address: str, domain: int) -> Iterator[None]:
    """Run the echo in another kit during a `with` block."""
    link = ["--robot", address, "--domain", str(domain), "--send", "/back"]
    command = [sys.executable, "-m", "course_lib", "run", str(program), *link]
    with subprocess.Popen(command, stderr=subprocess.DEVNULL, cwd=ROOT) as process:
        try:
            yield
        finally:
            process.terminate()


@contextmanager
def router() -> Iterator[str]:
    """Run a Zenoh router during a `with` block; the value is its address."""
    routers = Routers()
    try:
        yield f"tcp/127.0.0.1:{routers.port}"
    finally:
        routers.kill()


@contextmanager
def two_participants() -> Iterator[tuple[Participant, Participant, list[bytes]]]:
    """Provide a receiver, a sender, and the datagrams that the receiver got during 20 messages."""
    sent: list[bytes] = []
    receiver = Participant(230, "127.0.0.1", lambda endpoint, has_joined: None)
    original = receiver.receive

    def keep(data: bytes, host: str = "") -> None:
        sent.append(data)
        original(data, host)

    receiver.receive = keep  # type: ignore[method-assign]  # keeps what arrives
    sender = Participant(230, "127.0.0.1", lambda endpoint, has_joined: None)
    receiver.add_reader("rt/chatter", "std_msgs::msg::dds_::String_", Qos(), lambda sample: None)
    writer = sender.add_writer("rt/chatter", "std_msgs::msg::dds_::String_", Qos())
    time.sleep(2.0)
    for number in range(20):
        sender.write(writer, serialize_text("x" * number * 1000))
    time.sleep(1.0)
    receiver.receive = original  # type: ignore[method-assign]
    yield receiver, sender, list(sent)
    sender.close()
    receiver.close()


def receive_all(receiver: Participant, kinds: int, datagrams: Iterable[bytes]) -> None:
    """Pass datagrams to a participant, and print how many were dropped and the slowest one."""
    slowest, before = 0.0, sum(receiver.dropped.values())
    for data in datagrams:
        begin = time.thread_time()
        receiver.receive(data)
        slowest = max(slowest, time.thread_time() - begin)
    sys.stdout.write(
        f"{MUTATED} mutated datagrams of {kinds} kinds: nothing raised, "
        f"{sum(receiver.dropped.values()) - before} dropped as malformed, "
        f"slowest {slowest * 1e3:.1f} ms\n"
    )


def mutated() -> None:
    """Send mutations of the datagrams that two participants exchange to a participant."""

    def change_bytes() -> bytes:
        data = bytearray(generator.choice(samples))
        for _ in range(generator.randint(1, 6)):
            data[generator.randrange(len(data))] = generator.randrange(256)
        return bytes(data[: generator.randint(1, len(data))] if generator.random() < 0.3 else data)

    with two_participants() as (receiver, _, samples):
        generator = random.Random(0)
        receive_all(receiver, len(samples), (change_bytes() for _ in range(MUTATED)))


def structured() -> None:
    """Change the structure of datagrams, then check that old and new participants are received."""
    seed = random.randrange(1000)
    with two_participants() as (receiver, sender, samples):
        generator, samples = random.Random(seed), [data for data in samples if submessages(data)]
        prefixes = [receiver.prefix, sender.prefix, bytes(12), b"\xff" * 12]
        changed = (change_structure(generator, samples, prefixes) for _ in range(MUTATED))
        receive_all(receiver, len(samples), changed)
        newcomer = Participant(230, "127.0.0.1", lambda endpoint, has_joined: None)
        heard: list[bytes] = []
        for name, participant in (("old", sender), ("new", newcomer)):
            heard.clear()
            topic = f"rt/{name}", "std_msgs::msg::dds_::String_", Qos()
            receiver.add_reader(*topic, lambda sample: heard.append(sample.data))
            begin, writer = time.monotonic(), participant.add_writer(*topic)
            while not heard and time.monotonic() - begin < LEASE_SECONDS:
                participant.write(writer, serialize_text(name))
                time.sleep(0.1)
            result = f"received after {time.monotonic() - begin:.1f} s" if heard else "not received"
            sys.stdout.write(f"seed {seed}: the {name} participant is {result}\n")
        newcomer.close()


def submessages(data: bytes) -> list[bytearray]:
    """Split a datagram into its submessages, without the header."""
    found, at = [], HEADER
    while at + 4 <= len(data):
        size = int.from_bytes(data[at + 2 : at + 4], "little" if data[at + 1] & 1 else "big")
        end = at + 4 + size if size else len(data)
        found.append(bytearray(data[at:end]))
        at = end
    return found


def change_structure(draw: random.Random, samples: list[bytes], prefixes: list[bytes]) -> bytes:
    """Change lengths, numbers, fragments, parameter ids, the sender, times and the order."""
    data = draw.choice(samples)
    head, parts = bytearray(data[:HEADER]), submessages(data)
    for _ in range(draw.randint(1, 4)):
        part, edge = draw.choice(parts), draw.choice(EDGES)
        word = draw.randrange(4, max(5, len(part) - 3)) & ~3
        match draw.randrange(9):
            case 0:
                struct.pack_into("<H", part, 2, edge & 0xFFFF)
            case 1 if len(part) >= word + 4:
                struct.pack_into("<I", part, word, edge)
            case 2 if len(part) >= word + 4:
                struct.pack_into("<HH", part, word, draw.choice(PARAMETERS), edge & 0xFFFF)
            case 3:
                head[8:HEADER] = draw.choice(prefixes)
            case 4:
                part[0] = draw.choice(SUBMESSAGES)
            case 5:
                part[1] ^= 1 << draw.randrange(8)
            case 6:
                # The time of the following messages.
                parts.insert(0, bytearray(struct.pack("<BBHII", 9, 1, 8, edge, edge)))
            case 7:
                other = submessages(draw.choice(samples))
                parts.insert(draw.randrange(len(parts) + 1), draw.choice(other))
            case 8 if part[0] == DATA_FRAG and len(part) > 40:
                count, size = (draw.choice((0, 1, 4, 0xFFFF)) for _ in range(2))
                struct.pack_into("<IHHI", part, 24, edge, count, size, draw.choice(EDGES))
    return bytes(head) + b"".join(map(bytes, parts))


def serialize_text(text: str) -> bytes:
    """Return the bytes of a String."""
    return serialize(message_class(STRING)(data=text))


def refused() -> None:
    """Publish and call without permission, and count the packets that are sent."""
    robot = RobotGraph(DdsLink("127.0.0.1", 231), Permissions(allows_everything=True), lambda line: None)
    student = RobotGraph(DdsLink("127.0.0.1", 231), Permissions(), lambda line: None)
    heard: list[bytes] = []
    node = robot.add_node("robot", "/")
    robot.add_subscription(node, 0, "/cmd", STRING, Qos(), lambda cdr, *_: heard.append(cdr))
    own = student.add_node("student", "/")
    publisher = student.add_publisher(own, "/cmd", STRING, Qos())
    for number in range(REFUSED):
        student.publish(publisher, serialize_text(str(number)))
        student.advance()
        robot.advance()
    end = wall.monotonic() + 2.0
    while wall.monotonic() < end:
        student.advance()
        robot.advance()
    sys.stdout.write(f"{REFUSED} messages that are not allowed: {len(heard)} arrived\n")
    student.close()
    robot.close()


PARTS: dict[str, Callable[[], None]] = {
    "mutated": mutated,
    "structured": structured,
    "refused": refused,
    "round_trip": round_trip,
}


def main() -> None:
    """Run the benchmarks selected on the command line."""
    for name in sys.argv[1:] or PARTS:
        PARTS[name]()


if __name__ == "__main__":
    main()
