"""Pages of docs/ that are made from the kit when the book is built."""

import io
import re
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from course_lib.displays.registry import REGISTRY
from docs import gallery

DOCS = Path(__file__).parents[2] / "docs"


def test_the_gallery_shows_each_display_and_not_only_the_grid(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("COURSE_PACE", "fast")
    shown = {name: (alt, np.array(Image.open(io.BytesIO(png)))) for name, alt, png in gallery.pictures()}
    assert {f"rviz_default_plugins/{name}" for name in shown} == set(REGISTRY)
    for name, (alt, picture) in shown.items():
        colours = len(np.unique(picture.reshape(-1, picture.shape[-1]), axis=0))
        assert len(alt) > 10
        assert name == "Grid" or colours > 3, name


def test_each_page_is_in_the_index_and_each_comment_is_replaced() -> None:
    pytest.importorskip("sphinx")
    sys.modules.setdefault("gallery", gallery)
    from docs import generated

    pages = {path.stem: path.read_text("utf-8") for path in DOCS.glob("*.md")}
    asked = {line for text in pages.values() for line in text.splitlines() if line in generated.GENERATED}
    assert asked == set(generated.GENERATED)
    listed = f"{pages['index']}\n{generated.other_pages(DOCS)}".splitlines()
    assert set(pages) - {"index"} <= set(listed)


def test_the_command_line_page_has_every_command() -> None:
    pytest.importorskip("sphinx")
    from typer.main import get_command

    from course_lib.cli import app
    from docs import generated

    page = generated.command_line(DOCS)
    assert set(re.findall(r"^## `course ([\w-]+)`", page, re.MULTILINE)) == set(get_command(app).commands)  # type: ignore[attr-defined]


def test_the_weeks_and_the_contributors_page_have_no_link_out_of_the_book() -> None:
    pytest.importorskip("sphinx")
    from docs import generated

    weeks, contributing = generated.weeks(DOCS), generated.contributing(DOCS)
    pictures = re.findall(r"^:::\{figure\} (.+)$", weeks, re.MULTILINE)
    assert len(pictures) == 10
    links = re.findall(r"\]\((?!https?:|#)([^)#]+)", contributing)
    assert [link for link in (*pictures, *links) if not (DOCS / link).is_file()] == []
