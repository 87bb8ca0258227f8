from collections.abc import Iterator

import pytest

from tests.once import Once


@pytest.fixture(scope="module", autouse=True)
def shared_runs(once: Once) -> Iterator[None]:
    """Run each notebook once, also if several files judge it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("tests.notebooks.graded.run_scenarios", once.run_scenarios)
        yield
