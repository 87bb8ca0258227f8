"""The outputs that a new structure of the code must keep; `python -m tests.golden --write` renews them."""

import pytest

from course_lib.tools.ros2 import VERBS
from tests import test_seed_programs as seeds
from tests.golden.parts import HERE, PARTS, kept_file, text_of
from tests.once import Once

SLOW = [name for name, part in PARTS.items() if part.is_slow]


def assert_kept(name: str) -> None:
    now, kept = text_of(name).splitlines(), kept_file(name).read_text("utf-8").splitlines()
    assert now == kept, f"if you meant to change this: python -m tests.golden --write {name}"


@pytest.mark.parametrize("name", [name for name in PARTS if name not in SLOW])
def test_output_equals_golden_file(name: str) -> None:
    assert_kept(name)


@pytest.mark.slow
@pytest.mark.parametrize("name", SLOW)
def test_output_of_whole_programs_equals_golden_file(
    name: str, once: Once, monkeypatch: pytest.MonkeyPatch
) -> None:
    # tests/notebooks/test_answers.py needs the same rehearsals and runs.
    monkeypatch.setattr("tests.golden.parts.rehearse", once.rehearse)
    monkeypatch.setattr("tests.notebooks.graded.run_scenarios", once.run_scenarios)
    if name == "seeds" and not seeds.DOCUMENTS:
        pytest.skip("COURSE_SEEDS names no folder with the documents")
    assert_kept(name)


def test_every_ros2_verb_has_a_golden_file() -> None:
    commands = (HERE / "inputs" / "ros2_commands.txt").read_text("utf-8").splitlines()
    tried = [command.split() for command in commands]
    missing = [v.words for v in VERBS if not any(words[: len(v.words)] == v.words for words in tried)]
    assert missing == [], "add a command to tests/golden/inputs/ros2_commands.txt"
