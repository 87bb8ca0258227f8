"""Chance that repeats: `random`, numpy, `uuid` and `os.urandom` seeded for the length of a run."""

import os
import random
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

import numpy as np

from course_lib.ros.baton import baton

_real_urandom = os.urandom
_real_seed = random.Random.seed


@contextmanager
def seeded(seed: int) -> Iterator[None]:
    """Seed every source of chance that a program uses with a number; afterwards all is as before."""
    source = random.Random(seed)
    before = random.getstate(), np.random.get_state()
    random.seed(source.getrandbits(64))
    np.random.seed(source.getrandbits(32))
    with _replaced(_replacements(source)):
        try:
            yield
        finally:
            random.setstate(before[0])
            np.random.set_state(before[1])


def _replacements(source: random.Random) -> tuple[tuple[Any, str, Callable[..., Any]], ...]:
    def urandom(size: int, /) -> bytes:
        return source.randbytes(size) if baton.governs() else _real_urandom(size)

    def seed_generator(generator: random.Random, a: Any = None, version: int = 2) -> None:
        fresh = source.getrandbits(64) if a is None and baton.governs() else a
        _real_seed(generator, fresh, version)

    return (
        (os, "urandom", urandom),
        (random, "_urandom", urandom),  # imported by name there, for SystemRandom; numpy asks that one
        (random.Random, "seed", seed_generator),
        (random, "seed", partial(seed_generator, random._inst)),  # the generator that all share
    )


@contextmanager
def _replaced(replacements: tuple[tuple[Any, str, Callable[..., Any]], ...]) -> Iterator[None]:
    before = [getattr(owner, name) for owner, name, _ in replacements]
    for owner, name, replacement in replacements:
        setattr(owner, name, replacement)
    try:
        yield
    finally:
        for (owner, name, _), original in zip(replacements, before, strict=True):
            setattr(owner, name, original)
