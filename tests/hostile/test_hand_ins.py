"""Names that students choose, in downloads of every platform."""

import random

import pytest

from tests.hostile.hand_ins import collect_class, read_class


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(8))
def test_files_of_generated_classes_are_collected_for_their_owners(seed: int) -> None:
    chance = random.Random(seed)
    for _ in range(10):
        collect_class(chance)
    for _ in range(50):
        read_class(chance)
