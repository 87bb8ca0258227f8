"""Errors that a handler in the student's code hides."""

import linecache
import sys
from textwrap import indent
from typing import Any

import pytest

from course_lib.grading.caught_errors import CaughtErrors


def caught(body: str) -> CaughtErrors:
    """Return what was caught when a function with this body ran."""
    source = f"def act():\n{indent(body, '    ')}\n"
    names: dict[str, Any] = {}
    linecache.cache["<caught>"] = (len(source), None, source.splitlines(keepends=True), "<caught>")
    exec(compile(source, "<caught>", "exec"), names)
    before = sys.gettrace()
    with CaughtErrors(source) as found:
        names["act"]()
    assert sys.gettrace() is before
    return found


@pytest.mark.parametrize(
    ("body", "head"),
    [
        ("try:\n    marker\nexcept:\n    pass", "except:"),
        ("try:\n    marker\nexcept Exception as error:\n    print(error)", "except Exception as error:"),
        ("try:\n    marker\nexcept (KeyError, Exception):\n    return", "except (KeyError, Exception):"),
        ("import contextlib\nwith contextlib.suppress(Exception):\n    marker", "with contextlib.suppress("),
    ],
)
def test_mistake_hidden_by_a_catch_all_handler_is_reported(body: str, head: str) -> None:
    text = caught(body).mistake
    assert text.startswith(f'"{head}')
    assert "hides this error: NameError: name 'marker' is not defined (line " in text


@pytest.mark.parametrize(
    "body",
    [
        "try:\n    try:\n        marker\n    except NameError:\n        pass\nexcept Exception:\n    pass",
        "for _ in iter([]):\n    pass",
    ],
)
def test_error_not_caught_by_a_catch_all_handler_is_not_a_mistake(body: str) -> None:
    assert caught(body).mistake == ""


def test_possibly_expected_error_is_reported_separately_from_mistakes() -> None:
    found = caught("import math\ntry:\n    math.acos(2)\nexcept Exception:\n    pass")
    assert found.mistake == ""
    assert "ValueError: math domain error" in found.other
    assert "invalid literal" in caught("try:\n    int('x')\nexcept ValueError:\n    pass").other


def test_error_that_is_raised_again_is_not_hidden() -> None:
    inner = "try:\n    int('x')\nexcept ValueError:\n    raise"
    assert caught(f"try:\n{indent(inner, '    ')}\nexcept ValueError:\n    pass").other.startswith(
        '"except ValueError:" hides'
    )


def test_code_without_a_handler_is_not_traced() -> None:
    with CaughtErrors("def act():\n    pass\n"):
        assert sys.gettrace() is None or "coverage" in repr(sys.gettrace())
