"""Random trees of frames over time, and questions about them, as plain data."""

from typing import Any

import numpy as np

S, US = 10**9, 10**3  # [ns]; whole microseconds, which texts show exactly


def random_case(chance: np.random.Generator) -> dict[str, Any]:
    """Create one tree, with all the input that tf2 has to cope with, and three questions."""
    frames = [f"f{number}" for number in range(chance.integers(2, 9))]
    common = [int(stamp) * US for stamp in chance.integers(1_000_000, 9_000_000, 6)]
    transforms = []
    for number, child in enumerate(frames):
        parents = frames[:number] if chance.random() > 0.02 else [other for other in frames if other != child]
        if parents and chance.random() > 0.1:
            transforms += _history(chance, child, parents, common)
    queries = [_query(chance, [*frames, *frames, *frames, "unknown", "", "/f0"], common) for _ in range(3)]
    return {"transforms": transforms, "queries": queries}


def _history(chance: np.random.Generator, child: str, parents: list[str], common: list[int]) -> list[Any]:
    """Return one static transform, or several whose stamps differ (ROS 1 refuses the same stamp again)."""
    parent = str(chance.choice(parents))
    if chance.random() < 0.3:
        return [[parent, child, 0, _pose(chance), True]]
    count = int(chance.integers(1, 7))
    own = [int(stamp) * US for stamp in chance.integers(1_000_000, 9_000_000, count)]
    stamps = dict.fromkeys(common if chance.random() < 0.5 else own)
    history = [[parent, child, stamp_ns, _pose(chance), False] for stamp_ns in stamps]
    if chance.random() < 0.1:
        history[-1][0] = str(chance.choice(parents))
    if chance.random() < 0.1:  # too old for the cache
        newest = [parent, child, 12 * S, _pose(chance), False]
        history = [newest, [parent, child, 1 * S, _pose(chance), False]]
    return history


def _pose(chance: np.random.Generator) -> list[float]:
    """Return x, y, z and a quaternion (x, y, z, w), occasionally one that tf2 rejects.

    Jazzy scales quaternions of other lengths to 1. They are left out, because ROS 1 rejects them.
    """
    turn = chance.normal(size=4)
    turn /= np.linalg.norm(turn)
    kind = chance.random()
    if kind < 0.05:
        turn *= 0.0
    elif kind < 0.06:
        turn[0] = np.nan
    return [*chance.normal(scale=5.0, size=3).tolist(), *turn.tolist()]


def _query(chance: np.random.Generator, names: list[str], common: list[int]) -> list[Any]:
    def name() -> str:
        return str(chance.choice(names))

    def time() -> int:
        anywhere = int(chance.integers(500_000, 10_000_000)) * US
        between = (common[0] + common[1]) // 2 // US * US
        return int(chance.choice([0, common[0], common[1], between, anywhere, anywhere]))

    return [name(), time(), name(), time(), name()] if chance.random() < 0.3 else [name(), name(), time()]
