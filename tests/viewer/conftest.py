import pytest

from course_lib.viewer import page_link
from tests.viewer.page_wire import Wire


@pytest.fixture
def wire() -> Wire:
    return Wire()


@pytest.fixture
def by_hand(monkeypatch: pytest.MonkeyPatch) -> None:
    """Batches are sent by `flush` alone."""
    monkeypatch.setattr(page_link.PageLink, "_send_batches", lambda self: None)
