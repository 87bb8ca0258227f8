"""Sphinx extension: what pages of the book take from the kit when it is built."""

import re
import subprocess
import sys
from typing import Any

from numpy.typing import ArrayLike
from sphinx.application import Sphinx
from sphinx.util.typing import stringify_annotation

COMMANDS = "% the help of all commands, written when the book is built\n"
ARRAY = re.compile(
    r"~?(numpy\.)?ndarray\[~?tuple\[~?(typing\.)?Any, \.\.\.\], ~?(numpy\.)?dtype\[~?[\w.]+\]\]"
)


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the hooks; Sphinx calls this."""
    app.connect("source-read", fill_page)
    app.connect("autodoc-process-signature", shorten)
    app.connect("autodoc-process-docstring", keep_colons, priority=400)  # before napoleon
    return {"parallel_read_safe": True}


def fill_page(app: Sphinx, page: str, source: list[str]) -> None:
    """Put what is generated into a page."""
    if COMMANDS in source[0]:
        source[0] = source[0].replace(COMMANDS, command_line())


def command_line() -> str:
    """Return the help of each command as Markdown, by typer's own tool."""
    command = [sys.executable, "-m", "typer", "course_lib.cli", "utils", "docs", "--name", "course"]
    done = subprocess.run(command, check=True, capture_output=True, encoding="utf-8")
    return done.stdout.partition("## `course")[1] + done.stdout.partition("## `course")[2]


def shorten(
    app: Sphinx, what: str, name: str, thing: Any, options: Any, signature: str | None, result: str | None
) -> tuple[str | None, str | None]:
    """Write ArrayLike and ndarray where a signature has all that they stand for."""
    return signature and _short(signature), result and _short(result)


def _short(text: str) -> str:
    return ARRAY.sub("ndarray", text.replace(stringify_annotation(ArrayLike, "smart"), "ArrayLike"))


def keep_colons(app: Sphinx, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Keep napoleon from reading a property's first words as its type."""
    if what in ("property", "attribute"):
        lines.insert(0, "")
