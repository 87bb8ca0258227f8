"""Compare TF lookups with pytransform3d: `python -m tests.benchmarks.bench_tf2`, with the extra bench.

A chain of moving frames is remembered for ten seconds at 100 Hz; each lookup asks for the transform
from one end to the other at another time between two samples.
"""

import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from pytransform3d.trajectories import pqs_from_transforms
from pytransform3d.transform_manager import NumpyTimeseriesTransform, TemporalTransformManager

from course_lib.errors import format_count
from course_lib.ros.programs.import_path import install

install()

from rclpy.time import Time  # noqa: E402  # needs the stand-in's packages
from tf2_ros import Buffer  # noqa: E402  # as above

from course_lib.ros.tf2 import BufferCore, Transform  # noqa: E402  # as above
from tests.benchmarks.table import Row, markdown  # noqa: E402  # as above

START, RATE, SECONDS = 1_000, 100, 10  # [s], [Hz], [s]
LENGTHS = (1, 3, 10)  # frames between the ends
LOOKUPS = 2_000


def chains(length: int) -> tuple[BufferCore, Buffer, TemporalTransformManager]:
    """Remember the same chain in each of the three."""
    core, manager = BufferCore(), TemporalTransformManager(check=False)
    stamps = START + np.arange(RATE * SECONDS) / RATE
    for number in range(length):
        angle = 0.3 * (stamps - START) + number
        poses = np.tile(np.eye(4), (len(stamps), 1, 1))
        poses[:, 0, 0], poses[:, 1, 1] = np.cos(angle), np.cos(angle)
        poses[:, 1, 0], poses[:, 0, 1] = np.sin(angle), -np.sin(angle)
        poses[:, 0, 3] = np.sin(stamps)
        pqs = pqs_from_transforms(poses)  # x, y, z and a quaternion (w, x, y, z)
        manager.add_transform(f"f{number + 1}", f"f{number}", NumpyTimeseriesTransform(stamps, pqs))
        for stamp, (x, y, z, qw, qx, qy, qz) in zip(stamps, pqs.tolist(), strict=True):
            shift, turn = (x, y, z), (qx, qy, qz, qw)
            core.set_transform(Transform(f"f{number}", f"f{number + 1}", round(stamp * 1e9), shift, turn))
    buffer = Buffer()
    buffer._core = core
    return core, buffer, manager


def per_second(lookup: Callable[[float], object], times: list[float]) -> float:
    """Count lookups per second of wall time; the best of three rounds."""
    rounds = []
    for _ in range(3):
        start = time.perf_counter()
        for when in times:
            lookup(when)
        rounds.append(len(times) / (time.perf_counter() - start))
    return max(rounds)


def rows() -> Iterator[Row]:
    """Yield lookups per second by length of the chain: of the buffer's core, of Buffer, at its newest end."""
    chance = np.random.default_rng(1)
    times = chance.uniform(START + 0.1, START + SECONDS - 0.1, LOOKUPS).tolist()
    recent = (START + SECONDS - chance.uniform(0.02, 0.1, LOOKUPS)).tolist()
    for length in LENGTHS:
        yield from measured(length, times, recent)


def measured(length: int, times: list[float], recent: list[float]) -> Iterator[Row]:
    """Measure lookups through a chain, after a look whether the answers are the same."""
    core, buffer, manager = chains(length)
    last = f"f{length}"

    def ours(when: float) -> Transform:
        return core.lookup("f0", last, round(when * 1e9))

    def from_buffer(when: float) -> object:
        return buffer.lookup_transform("f0", last, Time(nanoseconds=round(when * 1e9)))

    def theirs(when: float) -> Any:
        return manager.get_transform_at_time(last, "f0", when)

    # Between samples tf2 moves along a line, pytransform3d along a screw.
    np.testing.assert_allclose(theirs(times[0]), ours(times[0]).matrix(), atol=1e-4)
    rates = {
        "tf2 core": per_second(ours, times),
        "tf2_ros.Buffer": per_second(from_buffer, times),
        "tf2_ros.Buffer, recent times": per_second(from_buffer, recent),
    }
    peer = {"pytransform3d": per_second(theirs, times)}
    for name, rate in rates.items():
        yield Row(f"{name}, lookups over {format_count(length, 'frame')}", "1/s", rate, peer, less=False)


if __name__ == "__main__":
    print(markdown(rows()))
