"""Pages of docs/ that are made from the kit when the book is built."""

import io
import re
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from course_lib.course.material import lessons_dir
from course_lib.displays.display import DrawnDisplay
from course_lib.displays.registry import REGISTRY
from course_lib.displays.views import VIEWS
from course_lib.tools.ros2 import VERBS
from docs import gallery, lookup

DOCS = Path(__file__).parents[2] / "docs"


@pytest.mark.slow
def test_gallery_shows_every_display_with_visible_content(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("COURSE_PACE", "fast")
    shown = {name: (alt, np.array(Image.open(io.BytesIO(png)))) for name, alt, png in gallery.pictures()}
    assert {f"rviz_default_plugins/{name}" for name in shown} == set(REGISTRY)
    for name, (alt, picture) in shown.items():
        colours = len(np.unique(picture.reshape(-1, picture.shape[-1]), axis=0))
        assert len(alt) > 10
        assert name == "Grid" or colours > 3, name


def test_every_page_is_in_the_index_and_every_placeholder_is_replaced() -> None:
    pytest.importorskip("sphinx")
    sys.modules.setdefault("gallery", gallery)
    from docs import generated

    pages = {path.stem: path.read_text("utf-8") for path in DOCS.glob("*.md")}
    asked = {line for text in pages.values() for line in text.splitlines() if line in generated.GENERATED}
    assert asked == set(generated.GENERATED)
    listed = f"{pages['index']}\n{generated.other_pages(DOCS)}".splitlines()
    assert set(pages) - {"index"} <= set(listed)


def test_command_line_page_lists_every_command() -> None:
    pytest.importorskip("sphinx")
    from typer.main import get_command

    from course_lib.cli import app
    from docs import generated

    page = generated.command_line(DOCS)
    assert set(re.findall(r"^## `course ([\w-]+)`", page, re.MULTILINE)) == set(get_command(app).commands)  # type: ignore[attr-defined]


def test_display_page_lists_every_property_with_its_default_value() -> None:
    page = lookup.common_rows() + lookup.display_rows() + lookup.view_rows()
    sections = dict(re.findall(r"^### (\w+)$(.*?)(?=^### |\Z)", page, re.MULTILINE | re.DOTALL))
    kinds = {name.rpartition("/")[2]: kind for name, kind in REGISTRY.items()} | VIEWS
    assert set(sections) == set(kinds)
    shared = {one.label for one in DrawnDisplay.properties}
    for name, kind in kinds.items():
        wanted = {one.label for one in kind.properties}
        rows = set(re.findall(r"^\| `([^`]+)` \|", sections[name], re.MULTILINE))
        assert rows <= wanted <= rows | shared, name
    assert "| `Size (m)` | `0.01` | a number from 0.0001 |" in sections["LaserScan"]
    assert "| `Topic` | `visualization_marker_array` |" in sections["MarkerArray"]


def test_ros2_command_page_contains_the_help_of_every_command() -> None:
    page = lookup.commands()
    titles = re.findall(r"^## ros2 (.+)$", page, re.MULTILINE)
    assert sorted(titles) == sorted(" ".join(verb.words) for verb in VERBS)
    assert "usage: ros2 topic hz [-h] [-w WINDOW]" in page


def test_search_scorer_is_found_from_any_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    pytest.importorskip("sphinx")
    from docs import conf

    monkeypatch.chdir(tmp_path)
    assert "var Scorer" in Path(conf.html_search_scorer).read_text("utf-8")


def test_text_before_a_colon_in_a_property_docstring_is_not_parsed_as_its_type() -> None:
    pytest.importorskip("sphinx")
    from sphinx.ext.napoleon.docstring import GoogleDocstring

    from docs import generated

    lines = ["RViz's Global Options: `viewer.options[...]`."]
    generated.keep_colons(None, "property", "options", None, None, lines)  # type: ignore[arg-type]  # takes no app
    read = GoogleDocstring(lines, what="property", name="options").lines()
    assert read[-1] == "RViz's Global Options: `viewer.options[...]`."


def test_week_pages_and_contributing_page_have_no_links_outside_the_book() -> None:
    pytest.importorskip("sphinx")
    from docs import generated

    weeks, contributing = generated.weeks(DOCS), generated.contributing(DOCS)
    pictures = re.findall(r"^:::\{figure\} (.+)$", weeks, re.MULTILINE)
    assert len(pictures) == 10
    links = re.findall(r"\]\((?!https?:|#)([^)#]+)", contributing)
    assert [link for link in (*pictures, *links) if not (DOCS / link).is_file()] == []
    lessons = re.findall(r"\]\(lessons/([^)]+)\)", weeks)
    assert len(lessons) == 10
    assert [name for name in lessons if not (lessons_dir() / name).is_file()] == []
