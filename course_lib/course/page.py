"""Showing a widget where there is a page, and its text where there is none."""

import sys
from collections.abc import Callable
from typing import Any


def in_notebook() -> bool:
    """Whether this code runs in a notebook's kernel."""
    ipython = sys.modules.get("IPython")
    return ipython is not None and hasattr(ipython.get_ipython(), "kernel")


def show(build_widget: Callable[[], Any], text: str) -> None:
    """Display the widget that `build_widget()` makes; without widgets its `text`; in a script print that."""
    if not in_notebook():
        print(text)  # noqa: T201  a script's page is its terminal
        return
    from IPython.display import display

    bundle = build_widget()._repr_mimebundle_()
    display({**bundle, "text/plain": text}, raw=True)  # type: ignore[no-untyped-call]  # IPython has no types here
