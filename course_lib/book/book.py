"""`course book OUT`: the lessons and guides of a course as web pages, which open without a network."""

import shutil
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from importlib.util import find_spec
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from course_lib.course.installation import extras, lessons_dir, material_root
from course_lib.course.state import write_whole
from course_lib.errors import CourseError

NEEDED = ("sphinx", "myst_nb", "sphinx_book_theme")
MARK = ".course_book"  # a file in every book: what may be replaced
VIEWER = "_scenes/viewer.js"


@dataclass(frozen=True)
class Book:
    """A book that was built.

    Args:
        index: Its first page.
        pages: How many it has.
        warnings: What is wrong in its sources, line by line: links to nowhere, pictures that are missing.
    """

    index: Path
    pages: int
    warnings: tuple[str, ...]


def build(out: Path, tell: Callable[[str], object] = print) -> Book:
    """Build the book of the installed course; what was there is replaced once all is well.

    Args:
        out: A new or empty folder, or a former book.
        tell: Is told what happens, line by line.

    Raises:
        CourseError: Sphinx is missing, the folder holds something else, or a lesson fails.
        OSError: The disk is full, or the folder cannot be written.
    """
    _refuse_without_sphinx()
    out = _free_place(out)
    out.parent.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory(prefix=f".{out.name}.", dir=out.parent) as folder:
        draft = Path(folder)
        _write_sources(draft / "sources", draft / "students", tell)
        warnings = _run_sphinx(draft / "sources", draft / "book", draft / "doctrees")
        write_whole(draft / "book" / MARK, b"")
        if out.exists():
            out.replace(draft / "former")
        (draft / "book").replace(out)
    pages = [path for path in out.rglob("*.html") if "_static" not in path.parts]
    return Book(out / "index.html", len(pages), warnings)


def _refuse_without_sphinx() -> None:
    if missing := [name for name in NEEDED if find_spec(name) is None]:
        raise CourseError(f'{missing[0]} is missing, which builds the book: pip install "course-lib[docs]"')


def _free_place(out: Path) -> Path:
    out = out.expanduser().resolve()
    if out.exists() and not (out.is_dir() and ((out / MARK).is_file() or not any(out.iterdir()))):
        raise CourseError(f"{out} is neither empty nor a book. Name a new folder, or remove it first.")
    if material_root().is_relative_to(out) or out.is_relative_to(material_root() / "docs"):
        raise CourseError(f"{out} is part of the course itself. Name a folder elsewhere.")
    return out


def _write_sources(sources: Path, students: Path, tell: Callable[[str], object]) -> None:
    """Write the pages that Sphinx reads: the course's docs/, and its lessons with their outputs."""
    from course_lib.book.guides import write_guides
    from course_lib.book.lessons import make_page

    write_guides(sources)
    for lesson in sorted([*lessons_dir().glob("week*.ipynb"), *extras()]):
        tell(f"Running {lesson.name}")
        make_page(lesson, sources, students / lesson.stem)
    write_whole(sources / "_extra" / VIEWER, viewer_script().encode())


def viewer_script() -> str:
    """Return the script that all pages share: the viewer, and what loads the scenes of a page."""
    from course_lib.viewer.html import bundle_code

    return bundle_code((Path(__file__).parent / "static" / "scenes.js").read_text("utf-8"))


def _run_sphinx(sources: Path, out: Path, doctrees: Path) -> tuple[str, ...]:
    """Build the pages; returns the warnings."""
    from sphinx.application import Sphinx
    from sphinx.errors import SphinxError
    from sphinx.util.console import nocolor
    from sphinx.util.docutils import docutils_namespace, patch_docutils

    nocolor()
    said = StringIO()
    try:
        with patch_docutils(str(sources)), docutils_namespace():
            app = Sphinx(sources, sources, out, doctrees, "html", status=None, warning=said)
            app.connect("html-page-context", _add_viewer)
            app.build()
    except SphinxError as error:
        raise CourseError(f"Sphinx can't build the book: {error}. Correct docs/, then try again.") from error
    with suppress(OSError):
        shutil.rmtree(out / "_sources")
    lines = [line.replace(f"{sources}/", "") for line in said.getvalue().splitlines() if line.strip()]
    if failed := [line for line in lines if "Errno" in line or "OSError" in line]:  # Sphinx goes on
        raise CourseError(f"The book can't be written: {failed[0]}")
    return tuple(lines)


def _add_viewer(app: Any, page: str, template: str, context: dict[str, Any], tree: Any) -> None:
    """Load the viewer's script in pages that have a scene."""
    if 'data-scene="' in context.get("body", ""):
        app.add_js_file(f"../{VIEWER}", loading_method="defer")
