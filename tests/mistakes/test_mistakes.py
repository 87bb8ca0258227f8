"""The tables of typical mistakes are up to date; `python -m tests.mistakes` regenerates them."""

import pytest
from _pytest.mark import ParameterSet

from tests.mistakes.rows import ALL, LEAST, path_of, table
from tests.python_messages import without_python_version


def tables() -> list[ParameterSet]:
    """Return all tables; the longer ones, of mistakes that strangers made, are slow."""
    return [pytest.param(one, marks=pytest.mark.slow if one.endswith("_strangers") else ()) for one in ALL]


@pytest.mark.parametrize("week", tables())
def test_table_of_typical_mistakes_matches_the_messages_shown_to_students(week: str) -> None:
    kept = path_of(week).read_text(encoding="utf-8")
    actual, expected = without_python_version(table(week)), without_python_version(kept)
    assert actual == expected, f"if the new messages are right: python -m tests.mistakes {week}"
    assert int(kept.split()[0]) >= LEAST


@pytest.mark.parametrize("week", ALL)
def test_every_mistake_has_a_message_or_hint(week: str) -> None:
    rows = path_of(week).read_text(encoding="utf-8").split("\n\n")[1:]
    silent = [row.splitlines()[0] for row in rows if not row.strip().partition("\n")[2]]
    assert silent == []
