"""Rules for all notebooks of a course: layout, headings, sentences, pictures."""

import re
from collections.abc import Callable, Iterator
from itertools import pairwise

from course_lib.authoring.page import NotebookPage, parsed
from course_lib.course.exercise import notebook_text

Rule = Callable[[NotebookPage], Iterator[str]]
MAX_CELL = 25  # lines
AVERAGE_SENTENCE, LONGEST_SENTENCE = 12, 30  # words
IMPORT = "from course_lib import "
VAGUE = {"here", "this", "link", "click here"}


def stripped(page: NotebookPage) -> Iterator[str]:
    """Yield cells with outputs, ids that occur twice, another kernel, another layout."""
    full = [cell["id"] for cell in page.cells if cell.get("outputs") or cell.get("execution_count")]
    if full:
        yield f"the cells {full} have outputs: clear all outputs"
    if len({cell["id"] for cell in page.cells}) < len(page.cells):
        yield "two cells have one id"
    if page.notebook["metadata"].get("kernelspec", {}).get("name") != "python3":
        yield "its kernel is not python3"
    if page.path.read_text(encoding="utf-8") != notebook_text(page.notebook):
        yield "its JSON has another layout: open it in JupyterLab and save it"


def short_cells(page: NotebookPage) -> Iterator[str]:
    """Yield cells that are too long to be read at once."""
    for cell in page.code_cells:
        if len(cell.splitlines()) > MAX_CELL:
            yield f"the cell {_first(cell)!r} has {len(cell.splitlines())} lines, expected at most {MAX_CELL}"


def first_cell(page: NotebookPage) -> Iterator[str]:
    """Yield a first cell without the extension, and imports that nothing uses."""
    first, *rest = page.code_cells or [""]
    if first.splitlines()[:1] != ["%load_ext course_lib"]:
        yield "the first code cell must begin with: %load_ext course_lib"
    lines = [line for line in first.splitlines()[1:] if line.startswith(IMPORT)]
    if len(lines) != 1:
        yield f"the first code cell has {len(lines)} lines {IMPORT!r}, expected 1"
    names = [name for line in lines for name in line.removeprefix(IMPORT).split(", ")]
    for name in names:
        if not re.search(rf"\b{re.escape(name)}\b", "\n".join(rest)):
            yield f"{name} is imported from course_lib, but not used"


def parses(page: NotebookPage) -> Iterator[str]:
    """Yield code cells that are not Python with magics."""
    for cell in page.code_cells:
        try:
            parsed(cell)
        except SyntaxError as error:
            yield f"the cell {_first(cell)!r}, line {error.lineno}: SyntaxError: {error.msg}"


def headings_in_order(page: NotebookPage) -> Iterator[str]:
    """Yield headings of more than one title, or below a level that is left out."""
    levels = [level for level, _ in page.headings]
    if levels[:1] != [1] or levels.count(1) != 1:
        yield "expected one title (# …), above all other headings"
    for (above, _), (level, title) in pairwise(page.headings):
        if level > above + 1:
            yield f"the heading {title!r} is of level {level}, below one of level {above}"


def described_links(page: NotebookPage) -> Iterator[str]:
    """Yield pictures without a description, and links whose words do not name where they lead."""
    for bang, text, _ in re.findall(r"(!?)\[([^\]]*)\]\(([^)]+)\)", page.markdown):
        if len(text) <= (30 if bang else 3) or text.lower() in VAGUE:
            kind = "picture" if bang else "link"
            yield f"the {kind} {text!r} needs words for those who do not see where it leads"
    if "<img" in page.markdown:
        yield "<img is HTML: write ![a description](attachment:picture.png)"


def present_pictures(page: NotebookPage) -> Iterator[str]:
    """Yield pictures that are neither attached nor a file."""
    cells = page.notebook["cells"]
    attached = {f"attachment:{name}" for cell in cells for name in cell.get("attachments", {})}
    for target in re.findall(r"!\[[^\]]*\]\(([^)\s]+)", page.markdown):
        is_file = "://" in target or (page.path.parent / target).is_file()
        if target not in attached and not is_file:
            yield f"the picture {target!r} is not there: drag it into the cell once more"


def sentences(text: str) -> list[list[str]]:
    """Return the words of each sentence of the prose: no tables, no code, no pictures."""
    prose = re.sub(r"^\|[^\n]*$|^```.*?^```|!\[.*?\]\(.*?\)", "", text, flags=re.MULTILINE | re.DOTALL)
    prose = re.sub(r"^(#+|[-*>]|\d+\.) ", "\n", re.sub(r"`[^`]*`", "x", prose), flags=re.MULTILINE)
    parts = re.split(r"[.:?!;](?=\s)|\n\n", prose)
    return [words for part in parts if len(words := re.findall(r"\w+", part)) > 1]


def short_sentences(page: NotebookPage) -> Iterator[str]:
    """Yield sentences that a tired reader loses, and an average that is too high."""
    found = sentences(page.markdown)
    average = sum(map(len, found)) / max(len(found), 1)
    if average > AVERAGE_SENTENCE:
        yield f"a sentence has {average:.1f} words on average, expected at most {AVERAGE_SENTENCE}"
    for words in found:
        if len(words) > LONGEST_SENTENCE:
            begin = " ".join(words[:8])
            yield f"a sentence has {len(words)} words, at most {LONGEST_SENTENCE}: {begin} …"


def _first(cell: str) -> str:
    return (cell.splitlines() or [""])[0][:50]


FOR_ALL: tuple[Rule, ...] = (
    stripped,
    short_cells,
    first_cell,
    parses,
    headings_in_order,
    described_links,
    present_pictures,
    short_sentences,
)
