"""Commands that lessons, exercises and the README show."""

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from course_lib.course.exercise import read_notebook, source

FENCE = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)
INLINE = re.compile(r"(?<!`)`([^`\n]+)`(?!`)")
COMMAND = re.compile(r"(%|!|(%timeout \S+ )?ros2 |course |python -m course_lib)")
SHELL = ("", "sh", "bash", "console")  # languages of fenced blocks that hold commands


@dataclass(frozen=True)
class Shown:
    """A command: the file that shows it, its text, and whether a code cell runs it."""

    file: str
    text: str
    in_cell: bool = False


def commands_of(path: Path) -> list[Shown]:
    """Return the commands of a notebook or a Markdown file, in their order."""
    if path.suffix == ".md":
        return [Shown(path.name, text) for text in _of_markdown(path.read_text(encoding="utf-8"))]
    shown = []
    for cell in read_notebook(path)["cells"]:
        if cell["cell_type"] == "markdown":
            shown += [Shown(path.name, text) for text in _of_markdown(source(cell))]
        else:
            lines = re.sub(r"\\\n", "", source(cell)).splitlines()
            shown += [Shown(path.name, line.strip(), in_cell=True) for line in lines if _is_magic(line)]
    return shown


def _is_magic(line: str) -> bool:
    return bool(re.match(r"\s*(!|%(ros2|rqt|timeout|system|sx|bash)\b)", line))


def _of_markdown(text: str) -> Iterator[str]:
    for language, block in FENCE.findall(text):
        if language in SHELL:
            for line in _lines(block):
                yield from (part for part in line.split(" && ") if COMMAND.match(part))
    yield from (span for span in INLINE.findall(FENCE.sub("", text)) if COMMAND.match(span))


def _lines(block: str) -> Iterator[str]:
    """Yield the lines of a shell's input, without comments; an open quotation mark continues the line."""
    pending = ""
    for line in re.sub(r"\\\n", "", block).splitlines():
        pending += line
        try:
            words = shlex.split(pending, comments=True)
        except ValueError:
            continue
        yield re.sub(r"\s+#.*", "", pending).strip() if words else ""
        pending = ""
