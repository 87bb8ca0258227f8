import os
import random
import secrets
import threading
import uuid
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.ros.programs.program import seed_generators
from course_lib.ros.time import virtual_time
from course_lib.ros.time.time_lock import time_lock
from tests.patience import join


def reseeded(source: Any, draw: Callable[[], float]) -> float:
    source.seed()
    return draw()


SOURCES: dict[str, Callable[[], Any]] = {
    "random": random.random,
    "random.seed()": lambda: reseeded(random, random.random),
    "Random()": lambda: random.Random().random(),
    "SystemRandom()": lambda: random.SystemRandom().random(),
    "secrets": lambda: secrets.token_hex(8),
    "os.urandom": lambda: os.urandom(8),
    "uuid4": uuid.uuid4,
    "np.random": np.random.rand,
    "np.random.seed()": lambda: reseeded(np.random, np.random.rand),
    "RandomState()": lambda: np.random.RandomState().rand(),
    "default_rng()": lambda: np.random.default_rng().random(),
    "SeedSequence()": lambda: np.random.SeedSequence().entropy,
}


@pytest.mark.parametrize("name", SOURCES)
def test_every_random_generator_repeats_per_seed_and_differs_between_seeds(name: str) -> None:
    drawn = []
    for seed in (1, 1, 2):
        with use_graph(Graph()), seed_generators(seed), time_lock.hold():
            drawn.append([SOURCES[name]() for _ in range(3)])
    assert drawn[0] == drawn[1] != drawn[2]
    assert drawn[0][0] != drawn[0][1]


def test_generator_states_are_restored_afterwards() -> None:
    before, state = os.urandom, random.getstate()
    with seed_generators(1):
        random.random()
    assert os.urandom is before
    assert random.getstate() == state


def test_ordinary_threads_keep_unseeded_generators() -> None:
    virtual_time.install()
    drawn: list[bytes] = []
    for _ in range(2):
        with seed_generators(1):
            thread = threading.Thread(target=lambda: drawn.append(os.urandom(8)))
            thread.start()
            join(thread)
    assert drawn[0] != drawn[1]
