"""Streams that a hostile process could send, by hypothesis: judging them raises nothing."""

import socket
import struct
from dataclasses import astuple
from typing import Any

import msgpack
from hypothesis import strategies as st

from course_lib.grading import expect_marker, expect_rate, expect_value
from course_lib.grading.evidence import Evidence
from course_lib.grading.jail.filters import Isolation
from course_lib.grading.judge import judge_task
from course_lib.grading.records import Run
from course_lib.grading.run.outcome import Outcome
from course_lib.grading.run.run import ExerciseRun, Step, pack, unpack
from course_lib.grading.run.scenario import ScenarioGraph
from course_lib.grading.run.submission_run import CellLog, _drive
from course_lib.grading.task import Call, Scenario, Task
from course_lib.ros.graph.remote import Channel, ChannelError, RecordingBudget
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import serialize
from course_lib.ros.time import wall

TOPIC, MARKER = "/visualization_marker", "visualization_msgs/msg/Marker"
CHECKS = (
    expect_marker(TOPIC, type="CUBE", frame="map", position=(0, 0, 0.5), color=(1, 0, 0)),
    expect_rate(TOPIC, 1.0),
    expect_value(2.0, unit="m"),
)
SCENARIO = Scenario("public", seconds=2.0, calls=(Call(1.0),), checks=CHECKS)
TASK = Task("week01.any", "Anything", "function", "any", ("a", "b", "c"), (SCENARIO,))
QOS = list(astuple(Qos()))
PUBLISHER = [["node", 2, "n", "/"], ["pub", 3, 2, TOPIC, MARKER, QOS]]  # node 1 is the scenario's

numbers = st.integers(-(2**63), 2**64 - 1) | st.integers(0, 5) | st.floats()
texts = st.text(max_size=20) | st.sampled_from([TOPIC, MARKER, "/", "std_msgs/msg/String", "no/type"])
leaves = st.none() | st.booleans() | numbers | texts | st.binary(max_size=300)
values = st.recursive(leaves, lambda v: st.lists(v, max_size=4) | st.dictionaries(texts, v, max_size=4))
cdrs = st.binary(max_size=300) | st.floats().map(lambda z: _cube(z))
NAMES = "node unnode pub sub unend publish alarm cancel nodes endpoints idle result exit cell"
names = st.sampled_from(NAMES.split())
frames = st.one_of(
    st.tuples(names, st.lists(values, max_size=5)).map(lambda pair: [pair[0], *pair[1]]),
    st.integers(1, 6).map(lambda number: ["node", number, "n", "/"]),
    st.integers(1, 6).map(lambda number: ["pub", number, 2, TOPIC, MARKER, QOS]),
    st.integers(1, 6).map(lambda number: ["sub", number, 2, 0, TOPIC, MARKER, QOS]),
    st.tuples(st.just("publish"), st.integers(2, 4), cdrs).map(list),
    st.tuples(st.just("alarm"), st.integers(0, 3), numbers, st.just(2), st.just(0)).map(list),
    st.tuples(st.just("result"), st.lists(values, max_size=2), st.lists(texts, max_size=2)).map(list),
    st.just(["idle"]) | st.just(["exit", 0, 0.1]),
)


def packed(frame: Any) -> bytes:
    body: bytes = msgpack.packb(frame, unicode_errors="surrogatepass")
    return struct.pack("!I", len(body)) + body


streams = st.tuples(
    st.tuples(st.sampled_from([[], PUBLISHER]), st.lists(frames, max_size=12)).map(
        lambda pair: b"".join(map(packed, [*pair[0], *pair[1]]))
    ),
    st.binary(max_size=50),
    st.integers(0, 10**6),
).map(lambda parts: _spoilt(*parts))


def _cube(z: float) -> bytes:
    from visualization_msgs.msg import Marker

    marker = Marker(type=Marker.CUBE)
    marker.pose.position.z = z
    return serialize(marker)


def _spoilt(stream: bytes, garbage: bytes, place: int) -> bytes:
    """Occasionally replace some bytes in the middle."""
    at = place % (4 * (len(stream) + 1))
    return stream if at > len(stream) else stream[:at] + garbage + stream[at + len(garbage) :]


def swallow(stream: bytes) -> Evidence:
    """Read a stream as that of a submission, store the evidence, and judge it."""
    stage = ScenarioGraph(TASK, SCENARIO, {})
    own_end, other_end = socket.socketpair()
    channel = Channel(own_end)
    channel.deadline = wall.monotonic() + 5.0
    other_end.sendall(stream)
    other_end.shutdown(socket.SHUT_WR)
    try:
        outcome = _drive(channel, stage, RecordingBudget())
    except ChannelError as error:
        outcome = Outcome(errors=[str(error)])
    finally:
        channel.close()
        other_end.close()
    evidence = stage.evidence(outcome)
    judge_evidence(evidence)
    return evidence


def judge_evidence(evidence: Evidence) -> None:
    """Keep and judge any evidence; its mark is a number from 0 to the points."""
    run = Run(SCENARIO, evidence)
    stored = ExerciseRun((run,), CellLog(), Isolation())
    kept = pack(stored)
    assert pack(unpack(kept, [Step(TASK, SCENARIO)])) == kept  # as bytes: NaN is not equal to itself
    evidence.recording.digest()
    assert 0.0 <= judge_task(TASK, 100.0, False, [run]).score <= 100.0
