"""New fixtures for a repeated test, which must not depend on the state that its failed attempt has left.

pytest-rerunfailures repeats a test with the fixtures of its file as they are: a page on which a panel is open
already, or a kernel that has died. Then the second attempt fails as well, for another reason than the first.
"""

import traceback

import pytest

# Those of a session are results, which no test changes.
RENEWED = ("class", "module", "package")


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """End the fixtures that a failed attempt shares with other tests, so that they are set up again."""
    if not isinstance(item, pytest.Function) or getattr(item, "execution_count", 1) < 2:
        return
    for definitions in item._fixtureinfo.name2fixturedefs.values():
        for definition in definitions:
            if definition.scope in RENEWED:
                try:
                    definition.finish(item._request)  # type: ignore[arg-type]  # it reads the node only
                # A page or server that has failed may not end properly either: it is replaced all the same.
                except Exception:
                    traceback.print_exc()
