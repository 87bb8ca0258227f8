"""Sphinx extension: what pages of the book take from the kit when it is built."""

import re
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from importlib import import_module
from io import BytesIO
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike
from PIL import Image
from sphinx.application import Sphinx
from sphinx.util.typing import stringify_annotation

from course_lib.course.material import extras, lessons, material_root

WEEK = re.compile(r"^\| (.+?) \| (.+?) \|.*<img src=\"docs/(.+?)\".* alt=\"(.+?)\"", re.MULTILINE)
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
    """Replace the comments of a page that ask for something generated."""
    for comment, made in GENERATED.items():
        if comment in source[0]:
            source[0] = source[0].replace(comment, made(Path(app.srcdir)))


def command_line(sources: Path) -> str:
    """Return the help of each command as Markdown, by typer's own tool."""
    command = [sys.executable, "-m", "typer", "course_lib.cli", "utils", "docs", "--name", "course"]
    done = subprocess.run(command, check=True, capture_output=True, encoding="utf-8")
    return "".join(done.stdout.partition("## `course")[1:])


def displays(sources: Path) -> str:
    """Draw each display, and return the pictures side by side."""
    folder = sources / "images" / "displays"
    folder.mkdir(parents=True, exist_ok=True)
    figures = []
    for name, words, png in import_module("gallery").pictures():
        picture = Image.open(BytesIO(png)).quantize(64)  # half as large
        picture.save(folder / f"{name}.webp", lossless=True, method=6)
        figures.append(
            _figure(f"images/displays/{name}.webp", words, f"[{name}](displays.md#{name.lower()})")
        )
    return _side_by_side(figures)


def weeks(sources: Path) -> str:
    """Return the weeks of the README's table, with their pictures side by side."""
    text = (material_root() / "README.md").read_text("utf-8")
    return _side_by_side([_figure(*row) for row in _rows(text)])


def _rows(text: str) -> Iterator[tuple[str, str, str]]:
    """Yield picture, words for it and caption of each week; its name leads to the lesson."""
    pages = {lesson.name.partition("_")[0]: lesson.name for lesson in (*lessons(), *extras())}
    for week, learned, picture, alt in WEEK.findall(text):
        page = pages[Path(picture).name.partition("_")[0]]
        yield picture, alt, f"[{week}](lessons/{page}): {learned}"


def _figure(picture: str, alt: str, caption: str) -> str:
    return f":::{{figure}} {picture}\n:alt: {alt}\n\n{caption}\n:::\n"


def _side_by_side(figures: Sequence[str]) -> str:
    return "\n".join([":::::{container} gallery", *figures, ":::::"])


def contributing(sources: Path) -> str:
    """Return the page for contributors; the code that it links to is not in the book."""
    text = (material_root() / "CONTRIBUTING.md").read_text("utf-8")
    return re.sub(r"\[([^\]]+)\]\(course_lib/[^)]*\)", r"\1", text).replace("](docs/", "](")


def other_pages(sources: Path) -> str:
    """Return the pages that the index does not name."""
    index = (sources / "index.md").read_text("utf-8").splitlines()
    return "\n".join(sorted({page.stem for page in sources.glob("*.md")} - {*index, "index"}))


GENERATED: Mapping[str, Callable[[Path], str]] = {
    "% the help of all commands": command_line,
    "% the help of all ros2 commands": lambda sources: import_module("lookup").commands(),
    "% the properties that displays share": lambda sources: import_module("lookup").common_rows(),
    "% the properties of each display": lambda sources: import_module("lookup").display_rows(),
    "% the properties of each view": lambda sources: import_module("lookup").view_rows(),
    "% a picture of each display": displays,
    "% the table of weeks in README.md": weeks,
    "% CONTRIBUTING.md": contributing,
    "% other pages": other_pages,
}


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
        lines[:0] = ["..", ""]  # an empty comment: napoleon skips empty lines before it reads a type
