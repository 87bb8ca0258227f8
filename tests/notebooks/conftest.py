from collections.abc import Iterator

import pytest


@pytest.fixture(scope="module", autouse=True)
def own_values_again() -> Iterator[None]:
    """Remove the values of a student that `graded.defined` gives to this process."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("course_lib.grading.personal._given", None)
        yield
