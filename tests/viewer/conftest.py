import pytest

from course_lib.viewer import stream
from tests.viewer.page_wire import Wire


@pytest.fixture
def wire() -> Wire:
    return Wire()


@pytest.fixture
def by_hand(monkeypatch: pytest.MonkeyPatch) -> None:
    """Batches are sent by `flush` alone."""
    monkeypatch.setattr(stream.Stream, "_send_batches", lambda self: None)
