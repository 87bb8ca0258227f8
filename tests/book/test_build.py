import json
import shutil
import sys
from pathlib import Path

import pytest
from nbclient import NotebookClient

from course_lib.book import book
from course_lib.book.book import build, make_page
from course_lib.course.material import material_root
from course_lib.errors import CourseError


def lesson_of(folder: Path, *cells: str) -> Path:
    """Write a lesson of these cells."""
    parts = [
        {"cell_type": "code", "id": f"c{number}", "source": code, "metadata": {}, "outputs": []}
        | {"execution_count": None}
        for number, code in enumerate(cells)
    ]
    path = folder / "week09_maps.ipynb"
    path.write_text(json.dumps({"cells": parts, "metadata": {}, "nbformat": 4, "nbformat_minor": 5}))
    return path


def test_missing_sphinx_is_an_error_with_the_install_command(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(book, "find_spec", lambda name: None if name == "sphinx" else object())
    with pytest.raises(CourseError, match=r'The book needs sphinx.* pip install "course-lib\[docs\]"'):
        build(tmp_path / "book")


@pytest.mark.slow
def test_output_folder_with_other_files_is_rejected_and_kept(tmp_path: Path) -> None:
    pytest.importorskip("sphinx_book_theme")
    (tmp_path / "thesis.txt").write_text("years")
    with pytest.raises(CourseError, match="is neither empty nor a book"):
        build(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]


@pytest.mark.slow
def test_failing_lesson_is_reported_with_cell_and_error(tmp_path: Path) -> None:
    lesson = lesson_of(tmp_path, "x = 0", "1 / x")
    with pytest.raises(CourseError, match=r"week09_maps.ipynb, cell 2, '1 / x': ZeroDivisionError: division"):
        make_page(lesson, tmp_path / "book", tmp_path / "student")


@pytest.mark.slow
def test_page_has_a_read_only_notice_and_no_local_paths(tmp_path: Path) -> None:
    lesson = lesson_of(tmp_path, "import sys\nprint(sys.prefix)")
    content = json.loads(lesson.read_text())
    text = "# Maps\n\nDo `week08_arms.ipynb` first, then `week09_exercise.ipynb`."
    content["cells"].insert(0, {"cell_type": "markdown", "id": "c", "source": text, "metadata": {}})
    lesson.write_text(json.dumps(content))
    (tmp_path / "week08_arms.ipynb").touch()
    make_page(lesson, tmp_path / "book", tmp_path / "student")
    page = (tmp_path / "book" / "lessons" / lesson.name).read_text("utf-8")
    source = "".join(json.loads(page)["cells"][0]["source"])
    assert source.startswith("# Maps\n\n:::{note}\n")
    assert "type `course lab` and open `week09_maps.ipynb`" in source
    assert "Do [`week08_arms.ipynb`](week08_arms.ipynb) first, then `week09_exercise.ipynb`." in source
    assert sys.prefix not in page


@pytest.mark.slow
def test_killed_kernel_ends_the_build_without_hanging(tmp_path: Path) -> None:
    lesson = lesson_of(tmp_path, "import os", "os._exit(1)")
    with pytest.raises(CourseError, match=r"week09_maps.ipynb, cell 2, 'os._exit\(1\)': its kernel died"):
        make_page(lesson, tmp_path / "book", tmp_path / "student")


@pytest.mark.slow
def test_ctrl_c_ends_the_build_and_its_kernel(tmp_path: Path) -> None:
    stop = "import os, signal, time\nos.kill(os.getppid(), signal.SIGINT)\ntime.sleep(60)"
    with pytest.raises(KeyboardInterrupt):
        make_page(lesson_of(tmp_path, stop), tmp_path / "book", tmp_path / "student")


def test_kernel_start_timeout_ends_the_build(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def starts_late(*_: object, **__: object) -> None:
        raise RuntimeError("Kernel didn't respond in 180 seconds")

    monkeypatch.setattr(NotebookClient, "execute", starts_late)
    lesson = lesson_of(tmp_path, "x = 0")
    with pytest.raises(
        CourseError, match=r"week09_maps.ipynb, before its first cell: its kernel died or did"
    ):
        make_page(lesson, tmp_path / "book", tmp_path / "student")


@pytest.mark.slow
def test_unwritable_scene_ends_the_build(tmp_path: Path) -> None:
    lesson = lesson_of(tmp_path, "%load_ext course_lib", "from course_lib import Viewer\nViewer()")
    (tmp_path / "book" / "_extra").mkdir(parents=True)
    (tmp_path / "book" / "_extra" / "_scenes").write_text("a file where the folder should be")
    with pytest.raises(CourseError, match=r"week09_maps.ipynb, after its last cell: FileExistsError"):
        make_page(lesson, tmp_path / "book", tmp_path / "student")


@pytest.mark.slow
def test_full_disk_is_an_error_even_if_sphinx_continues(tmp_path: Path, small_disk: Path) -> None:
    pytest.importorskip("sphinx_book_theme")
    sources = tmp_path / "sources"
    sources.mkdir()
    (sources / "_extra").mkdir()
    (sources / "conf.py").write_text("from course_lib.book.settings import *")
    (sources / "index.md").write_text("# A course\n")
    with pytest.raises((CourseError, OSError), match="No space left on device"):
        book._run_sphinx(sources, small_disk / "book", tmp_path / "doctrees")


@pytest.mark.slow
def test_settings_of_the_shipped_book_build_a_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("sphinx_book_theme")
    monkeypatch.chdir(tmp_path)
    sources = tmp_path / "sources"
    pages = shutil.ignore_patterns("*.md", "images", "reference", "__pycache__")
    shutil.copytree(material_root() / "docs", sources, ignore=pages)
    (sources / "_extra").mkdir()
    (sources / "index.md").write_text("# A course\n")
    assert book._run_sphinx(sources, tmp_path / "book", tmp_path / "doctrees") == ()
    assert "instructor" in (tmp_path / "book" / "_static" / "language_data.js").read_text("utf-8")


@pytest.mark.parametrize(
    ("written", "in_book"),
    [
        ("[a](author.md#the-book)", "[a](author.md#the-book)"),
        ("[a](../notebooks/week01_first_marker.ipynb)", "[a](lessons/week01_first_marker.ipynb)"),
        ("[the gateway](../course_lib/gateway/README.md)", "the gateway"),
        ("[a](https://example.org/x.md)", "[a](https://example.org/x.md)"),
        ("[a](not_there.md)", "[a](not_there.md)"),
    ],
)
def test_links_point_to_pages_of_the_book_or_become_text(written: str, in_book: str) -> None:
    docs = material_root() / "docs"
    assert book._rewrite_links(written, docs, Path()) == in_book


def test_readme_links_point_to_pages_of_the_book() -> None:
    root = material_root()
    assert book._rewrite_links("[a](docs/author.md)", root, Path()) == "[a](author.md)"
    assert book._rewrite_links("![a](docs/images/x.png)", root, Path()) == "![a](docs/images/x.png)"
