"""Median time of a look, without noise: `python tests/benchmarks/bench_sensors.py`."""

import statistics
import time
from collections.abc import Callable

import numpy as np

from course_lib.ros.programs.import_path import install

install()

from course_lib.sensors.sensor_nodes import Pinhole, beams_at  # noqa: E402  # needs the stand-in's packages
from course_lib.sensors.world import (  # noqa: E402  # as above
    Thing,
    World,
    box,
    circle,
    cylinder,
    placed,
    plane,
    sphere,
)  # fmt: skip

RUNS = 30
OPTICAL = np.array([[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 1], [0, 0, 0, 1]], float)  # looks along x


def room() -> World:
    """Return a world of a floor and 20 objects around the sensor, four of which move."""
    chance, solids = np.random.default_rng(1), (box(1, 0.6, 1.8), cylinder(0.4, 1.5), sphere(0.5))
    things = [Thing(plane(), placed(0, 0, 0))]
    for number in range(20):
        angle, away = 2 * np.pi * number / 20, chance.uniform(2, 9)
        x, y = away * np.cos(angle), away * np.sin(angle)
        pose = circle((x, y, 0.5), 0.5, 9.0) if number % 5 == 0 else placed(x, y, 0.5, angle)
        things.append(Thing(solids[number % 3], pose))
    return World(things)


def milliseconds(action: Callable[[], object]) -> float:
    """Median wall time of an action, [ms]."""
    times = []
    for _ in range(RUNS):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return 1000 * statistics.median(times)


def main() -> None:
    """Print one line per measurement."""
    angles = np.linspace(-np.pi, np.pi, 720)
    scan, image = beams_at(angles, np.zeros(720)), Pinhole(320, 240, 277.0).rays
    world, laser = room(), placed(0, 0, 0.4)
    cases: list[tuple[str, Callable[[], object]]] = [
        ("720-beam scan, 21 things (goal 1 ms)", lambda: world.cast(laser, scan, 1.0)),
        ("320x240 depth image, 21 things (goal 50 ms)", lambda: world.cast(OPTICAL, image, 1.0)),
    ]
    for name, action in cases:
        print(f"{name:45} {milliseconds(action):8.2f} ms")


if __name__ == "__main__":
    main()
