from collections.abc import Iterator

import pytest

from tests.once import Once


@pytest.fixture(scope="module", autouse=True)
def own_values_again() -> Iterator[None]:
    """Remove the values of a student that `graded.defined` gives to this process."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("course_lib.grading.inputs._values", None)
        yield


@pytest.fixture(scope="module", autouse=True)
def shared_runs(once: Once) -> Iterator[None]:
    """Run each notebook once, also if several files judge it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("tests.notebooks.graded.run_scenarios", once.run_scenarios)
        yield
