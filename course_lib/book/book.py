"""`course book OUT`: build the lessons and guides of a course as web pages that work offline."""

import base64
import os
import re
import shutil
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from importlib.util import find_spec
from io import StringIO
from pathlib import Path
from subprocess import DEVNULL
from typing import Any

import nbclient
import nbformat
from nbclient.exceptions import CellExecutionError, CellTimeoutError

from course_lib.course.course_file import shipped_course_file
from course_lib.course.exercise import notebook_text, read_notebook, source
from course_lib.course.material import extras, lessons_dir, material_root
from course_lib.course.questions import NO_PREDICTION
from course_lib.course.student_folder import prepare
from course_lib.errors import CourseError
from course_lib.files import draft_folder, write_atomically

NEEDED = ("sphinx", "myst_nb", "sphinx_book_theme")
# A file in the folder of every book. Only folders with this file may be replaced.
MARK = ".course_book"
VIEWER = "_scenes/viewer.js"


@dataclass(frozen=True)
class Book:
    """A finished book.

    Args:
        index: Its first page.
        pages: The number of pages.
        warnings: Sphinx's warnings about the sources, like broken links and missing pictures.
    """

    index: Path
    pages: int
    warnings: tuple[str, ...]


def build(out: Path, tell: Callable[[str], object] = print) -> Book:
    """Build the book of the installed course. A previous book is replaced if the build succeeds.

    Args:
        out: A new or empty folder, or the folder of a previous book.
        tell: Called with each line of progress.

    Raises:
        CourseError: Sphinx is missing, the folder has other contents, or a lesson fails.
        OSError: The disk is full, or the folder cannot be written.
    """
    if missing := [name for name in NEEDED if find_spec(name) is None]:
        raise CourseError(
            f'The book needs {missing[0]}, which is not installed: pip install "course-lib[docs]"'
        )
    out = out.expanduser().resolve()
    if out.exists() and not (out.is_dir() and ((out / MARK).is_file() or not any(out.iterdir()))):
        raise CourseError(
            f"{out} is neither empty nor a book. Choose another folder, or remove this one first."
        )
    if material_root().is_relative_to(out) or out.is_relative_to(material_root() / "docs"):
        raise CourseError(f"{out} is part of the course itself. Choose a folder outside of it.")
    with draft_folder(out) as draft:
        sources = draft / "sources"
        students = draft / "students"

        write_guides(sources)
        for lesson in sorted([*lessons_dir().glob("week*.ipynb"), *extras()]):
            tell(f"Running {lesson.name}")
            make_page(lesson, sources, students / lesson.stem)
        write_atomically(sources / "_extra" / VIEWER, viewer_script().encode())
        warnings = _run_sphinx(draft / "sources", draft / "book", draft / "doctrees")
        write_atomically(draft / "book" / MARK, b"")
        if out.exists():
            out.replace(draft / "former")
        (draft / "book").replace(out)
    pages = [path for path in out.rglob("*.html") if "_static" not in path.parts]
    return Book(out / "index.html", len(pages), warnings)


def viewer_script() -> str:
    """Return the script of all pages: the viewer and the code that loads a page's scenes."""
    from course_lib.viewer.html import bundle_code

    return bundle_code((Path(__file__).parent / "static" / "scenes.js").read_text("utf-8"))


def _run_sphinx(sources: Path, out: Path, doctrees: Path) -> tuple[str, ...]:
    """Build the pages with Sphinx and return its warnings."""
    from sphinx.application import Sphinx
    from sphinx.errors import SphinxError
    from sphinx.util.console import nocolor
    from sphinx.util.docutils import docutils_namespace, patch_docutils

    nocolor()
    warnings = StringIO()
    try:
        with patch_docutils(str(sources)), docutils_namespace():
            app = Sphinx(sources, sources, out, doctrees, "html", status=None, warning=warnings)
            app.connect("html-page-context", _add_viewer)
            app.build()
    except SphinxError as error:
        raise CourseError(f"Sphinx can't build the book: {error}. Correct docs/, then try again.") from error
    with suppress(OSError):
        shutil.rmtree(out / "_sources")
    lines = [line.replace(f"{sources}/", "") for line in warnings.getvalue().splitlines() if line.strip()]
    # Sphinx reports this error as a warning and continues.
    if failed := [line for line in lines if "Errno" in line or "OSError" in line]:
        raise CourseError(f"The book can't be written: {failed[0]}")
    return tuple(lines)


def _add_viewer(app: Any, page: str, template: str, context: dict[str, Any], tree: Any) -> None:
    """Add the viewer's script to pages with a scene."""
    if 'data-scene="' in context.get("body", ""):
        app.add_js_file(f"../{VIEWER}", loading_method="defer")


# Name of the folder for lessons in a book.
LESSONS = "lessons"
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
    """Write the guides, the settings and the index to the sources of a book.

    Links to lessons are changed to their pages in the book. Links to other files of the project
    become plain text.
    """
    root = material_root()
    sources.mkdir(parents=True)
    if (root / "docs").is_dir():
        docs = root / "docs"
        ignore_hidden = shutil.ignore_patterns(".*", "__pycache__")
        try:
            shutil.copytree(docs, sources, ignore=ignore_hidden, dirs_exist_ok=True)
        # shutil.Error has the reasons in a list of tuples.
        except shutil.Error as error:
            raise CourseError(f"{docs} can't be copied: {error.args[0][0][2]}") from error
    for page in sources.rglob("*.md"):
        place = page.relative_to(sources)
        text = _rewrite_links(page.read_text("utf-8"), root / "docs" / place.parent, place.parent)
        page.write_text(text, "utf-8")
    if not (sources / "conf.py").is_file():
        write_atomically(sources / "conf.py", b"from course_lib.book.settings import *  # noqa: F403\n")
    if not (sources / "index.md").is_file():
        write_atomically(sources / "index.md", _index(sources).encode())


def _index(sources: Path) -> str:
    """Return the first page: the README and the table of contents."""
    readme = material_root() / "README.md"
    title = f"# {shipped_course_file().title}\n"
    text = _rewrite_links(readme.read_text("utf-8"), readme.parent, Path()) if readme.is_file() else title
    patterns = [f"{LESSONS}/week*", *([f"{LESSONS}/*"] if extras() else [])]
    text += CONTENTS.format(caption="Lessons", pages="\n".join(patterns))
    return text + (CONTENTS.format(caption="Guides", pages="*") if any(sources.glob("*.md")) else "")


def _rewrite_links(text: str, folder: Path, place: Path) -> str:
    """Rewrite the links of a page for the book.

    Args:
        text: The page in Markdown.
        folder: The folder of the page in the project.
        place: The folder of the page in the book's sources.
    """

    def adapt(link: re.Match[str]) -> str:
        before, path, after = link["before"], link["path"], link["after"]
        target, docs = (folder / path).resolve(), material_root() / "docs"
        in_book = None
        if target.parent == lessons_dir() and target.suffix == ".ipynb":
            in_book = Path(LESSONS, target.name)
        elif target.is_relative_to(docs) and target.exists():
            in_book = target.relative_to(docs)
        if in_book is not None:
            return f"{before}{os.path.relpath(in_book, place).replace(os.sep, '/')}{after}"
        if target.exists() and before.startswith("["):
            return before[1:-2]
        return link[0]

    return LINK.sub(adapt, text)


# Time limit of a cell [s].
SECONDS = 120
# Replaces the folder of this Python in outputs.
HERE = "…/.venv"
# Time limit [s] for starting a kernel on a busy machine.
START = 180
# Name of the folder for scenes in a book.
SCENES = "_scenes"
KERNEL = "__import__('course_lib.book.kernel', fromlist=['begin'])"
SHOWN_BY_SCRIPTS = "application/vnd.jupyter.widget-view+json"
# The notice that no page is connected, which is removed from the outputs.
NO_PAGE = re.compile(r"^No page is watching: [^\n]*\n", re.MULTILINE)
ATTACHED = re.compile(r"attachment:([^)\s]+)")
NAMED = re.compile(r"(?<!\[)`(\w+\.ipynb)`")
BANNER = """
:::{{note}}
This page is for reading: it shows what the cells of the lesson show. Turn the 3D scenes with the mouse, and
press ▶ below them. To run and change cells, to answer questions and to use the panels,
[install the course](../index.md), type `course lab` and open `{name}`.
:::
"""


def make_page(lesson: Path, book: Path, work: Path) -> None:
    """Run a lesson, and write it with its outputs, pictures and scenes to the sources of a book.

    Args:
        lesson: The notebook.
        book: The folder of the book's sources.
        work: The working folder, which is set up like a student's.

    Raises:
        CourseError: A cell fails or exceeds the time limit.
    """
    prepare(work)
    notebook = run_lesson(lesson, book / "_extra" / SCENES, work)
    other_lessons = {path.name for path in lesson.parent.glob("*.ipynb")} - {lesson.name}

    def link(match: re.Match[str]) -> str:
        return f"[{match[0]}]({match[1]})" if match[1] in other_lessons else match[0]

    for cell in notebook["cells"]:
        if cell["cell_type"] == "markdown":
            cell["source"] = NAMED.sub(link, cell["source"])
        if cell["cell_type"] == "code":
            cell["outputs"] = [
                publishable for output in cell["outputs"] for publishable in _publishable_outputs(output)
            ]
        for name, kinds in cell.get("attachments", {}).items():
            data = base64.b64decode(next(iter(kinds.values())))
            write_atomically(book / LESSONS / "images" / lesson.stem / name, data)
        if "attachments" in cell:
            cell["source"] = ATTACHED.sub(rf"images/{lesson.stem}/\1", cell["source"])
            del cell["attachments"]
    # The banner is below the title of the lesson.
    first = next((cell for cell in notebook["cells"] if cell["source"].startswith("# ")), None)
    if first is not None:
        title, _, below = first["source"].partition("\n")
        first["source"] = f"{title}\n{BANNER.format(name=lesson.name)}{below}"
    write_atomically(book / LESSONS / lesson.name, notebook_text(notebook).encode())


def run_lesson(lesson: Path, scenes: Path, work: Path) -> Any:
    """Run a lesson headless and return the executed notebook. Its scenes are written to files."""
    plain = read_notebook(lesson)
    begin = f"{KERNEL}.begin({lesson.stem!r}, {str(scenes)!r}, '../{SCENES}')"
    plain["cells"] = [_cell("book-begin", begin), *plain["cells"], _cell("book-end", f"{KERNEL}.end()")]
    notebook: Any = nbformat.reads(notebook_text(plain), as_version=4)
    place = ["before its first cell"]

    def note(cell: Any, cell_index: int) -> None:
        is_last = cell_index == len(notebook["cells"]) - 1
        code = source(cell).partition("\n")[0]
        place[0] = "after its last cell" if is_last else f"cell {cell_index}, {code!r}"

    work_dir = {"metadata": {"path": str(work)}}
    client = nbclient.NotebookClient(
        notebook,
        timeout=SECONDS,
        startup_timeout=START,
        store_widget_state=False,
        resources=work_dir,
        on_cell_start=note,
    )
    try:
        # Robot time runs as fast as possible.
        client.execute(env={**os.environ, "COURSE_PACE": "fast"}, stderr=DEVNULL)
    # nbclient raises a RuntimeError if the kernel dies.
    except (CellExecutionError, CellTimeoutError, RuntimeError) as error:
        raise CourseError(f"{lesson.name}, {place[0]}: {_failure_reason(error)}.") from error
    # nbclient raises an AssertionError if Ctrl+C has ended the kernel.
    except AssertionError as error:
        raise KeyboardInterrupt from error
    notebook["cells"] = notebook["cells"][1:-1]
    return notebook


def _cell(name: str, code: str) -> dict[str, Any]:
    empty: dict[str, Any] = {"execution_count": None, "metadata": {}, "outputs": []}
    return {"cell_type": "code", "id": name, "source": code, **empty}


def _failure_reason(error: Exception) -> str:
    if isinstance(error, CellExecutionError):
        return f"{error.ename}: {error.evalue}. Correct that, then run course book again"
    if isinstance(error, CellTimeoutError):
        return f"it did not end within {SECONDS} s. Let it end by itself, then run course book again"
    return "its kernel died or did not start. Run the lesson in JupyterLab to see why"


def _publishable_outputs(output: Any) -> Iterator[Any]:
    """Yield an output without answers, folders of this machine, or widgets, which need a kernel."""
    if output["output_type"] == "stream":
        output["text"] = NO_PAGE.sub("", output["text"]).replace(sys.prefix, HERE)
        if output["text"].strip():
            yield output
        return
    data = output.get("data", {})
    data.pop(SHOWN_BY_SCRIPTS, None)
    # The page of a book cannot show a comparison either, because nobody can predict in it.
    if "".join(data.get("text/plain", "")) != NO_PREDICTION:
        yield output
