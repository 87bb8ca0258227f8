"""The pages of a course that are written by hand: its docs/, or its README.md where it has none."""

import os
import re
import shutil
from pathlib import Path

from course_lib.course.course_file import shipped_course_file
from course_lib.course.installation import extras, lessons_dir, material_root
from course_lib.course.state import write_whole
from course_lib.errors import CourseError

LESSONS = "lessons"  # of the book
LINK = re.compile(r'(?P<before>!?\[[^\]\n]*\]\(|<img src=")(?P<path>[\w./-]+)(?P<after>(?:#[\w-]+)?[)"])')
CONTENTS = """
```{{toctree}}
:caption: {caption}
:glob:
:maxdepth: 1

{pages}
```
"""


def write_guides(sources: Path) -> None:
    """Write the pages, the settings and the index into the sources of a book.

    Links to lessons lead to their pages in the book; those to other files of the project become plain text.
    """
    root = material_root()
    sources.mkdir(parents=True)
    if (root / "docs").is_dir():
        _copy(root / "docs", sources)
    for page in sources.rglob("*.md"):
        place = page.relative_to(sources)
        text = _relinked(page.read_text("utf-8"), root / "docs" / place.parent, place.parent)
        page.write_text(text, "utf-8")
    if not (sources / "conf.py").is_file():
        write_whole(sources / "conf.py", b"from course_lib.book.settings import *  # noqa: F403\n")
    if not (sources / "index.md").is_file():
        write_whole(sources / "index.md", _index(sources).encode())


def _copy(docs: Path, sources: Path) -> None:
    hidden = shutil.ignore_patterns(".*", "__pycache__")
    try:
        shutil.copytree(docs, sources, ignore=hidden, dirs_exist_ok=True)
    except shutil.Error as error:  # which hides the reasons in a list
        raise CourseError(f"{docs} can't be copied: {error.args[0][0][2]}") from error


def _index(sources: Path) -> str:
    """Return a first page: the README, and the contents."""
    readme = material_root() / "README.md"
    title = f"# {shipped_course_file().title}\n"
    text = _relinked(readme.read_text("utf-8"), readme.parent, Path()) if readme.is_file() else title
    patterns = [f"{LESSONS}/week*", *([f"{LESSONS}/*"] if extras() else [])]
    text += CONTENTS.format(caption="Lessons", pages="\n".join(patterns))
    return text + (CONTENTS.format(caption="Guides", pages="*") if any(sources.glob("*.md")) else "")


def _relinked(text: str, folder: Path, place: Path) -> str:
    """Return a page's text with links that fit the book.

    Args:
        text: In Markdown.
        folder: Where it lies in the project.
        place: The folder in the book's sources that it goes into.
    """

    def fitted(link: re.Match[str]) -> str:
        before, path, after = link["before"], link["path"], link["after"]
        target = (folder / path).resolve()
        in_book = _in_book(target)
        if in_book is not None:
            return f"{before}{os.path.relpath(in_book, place).replace(os.sep, '/')}{after}"
        if target.exists() and before.startswith("["):
            return before[1:-2]
        return link[0]

    return LINK.sub(fitted, text)


def _in_book(target: Path) -> Path | None:
    """Return where a file of the project lies in the book's sources, or None."""
    if target.parent == lessons_dir() and target.suffix == ".ipynb":
        return Path(LESSONS, target.name)
    docs = material_root() / "docs"
    return target.relative_to(docs) if target.is_relative_to(docs) and target.exists() else None
