"""docs/author.md: the example runs, and the list of check functions agrees with the code."""

import csv
import json
import re
import shlex
import sys
import tomllib
from importlib import resources
from pathlib import Path

import pytest

from course_lib.authoring.new import parse_notebook
from course_lib.authoring.rules import ASPECTS
from course_lib.course.exercise import notebook_text, read_notebook, source
from tests.authoring.test_new_course import BUILT_HERE, ROOT, install, run
from tests.test_contributing import edit

PAGE = (ROOT / "docs" / "author.md").read_text("utf-8")
BLOCK = re.compile(r"^```(\w+)((?: \w+=\S+)*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
WORD = re.compile(r"^\| `(expect_\w+)` \| [^|]* \| ([^|]*) \|$", re.MULTILINE)
# The machine of the example has one, so that no command starts two processes, each with a jail.
ONE_PROCESSOR = "import os; os.cpu_count = lambda: 1\n"
TOPIC_MISTAKES = PAGE.split("check function with a topic can report three more:")[1].partition("\n| check")[0]


class Author:
    """Carries out the blocks of the page, in a folder for all that is made."""

    def __init__(self, home: Path) -> None:
        self.folder = home
        self.python = Path(sys.executable)

    def do(self, language: str, options: dict[str, str], text: str) -> None:
        """Carry out one block: commands, a change, a new end of a file, or cells."""
        if language == "console":
            for line in text.splitlines():
                self._command(line)
        elif "cells" in options:
            self._cells(self.folder / options["cells"], options["before"], text)
        elif "cell" in options:
            name, _, cell = options["cell"].partition("#")
            self._cell(self.folder / name, cell, text)
        elif language == "diff":
            path = self.folder / options["file"]
            path.write_text(edit(path.read_text("utf-8"), text), "utf-8")
        elif "file" in options:
            with (self.folder / options["file"]).open("a", encoding="utf-8") as file:
                file.write(f"\n{text}")

    def _command(self, line: str) -> None:
        program, *words = shlex.split(line)
        if program == "cd":
            self.folder = self.folder / words[0]
        elif program == "pip":
            self.python = install(self.folder.parent / "venv", self.folder, *BUILT_HERE)
            packages = next(self.python.parents[1].glob("lib/python*/site-packages"))
            (packages / "one_processor.pth").write_text(ONE_PROCESSOR)
        else:
            if words[0] == "grade":
                self._hand_in(self.folder.parent / "submissions" / "ada")
            module = ["course_lib", *words] if program == "course" else words[1:]
            run(self.python, "-m", *module, cwd=self.folder)

    def _cells(self, path: Path, before: str, text: str) -> None:
        notebook = read_notebook(path)
        place = next(i for i, cell in enumerate(notebook["cells"]) if cell["id"] == before)
        notebook["cells"][place:place] = parse_notebook(text, {})["cells"]
        path.write_text(notebook_text(notebook), "utf-8")

    def _cell(self, path: Path, name: str, change: str) -> None:
        notebook = read_notebook(path)
        (cell,) = (cell for cell in notebook["cells"] if cell["id"] == name)
        cell["source"] = edit(source(cell), change).splitlines(keepends=True)
        path.write_text(notebook_text(notebook), "utf-8")

    def _hand_in(self, folder: Path) -> None:
        folder.mkdir(parents=True)
        notebook = read_notebook(self.folder / "solutions" / "week09_solution.ipynb")
        notebook["metadata"]["course"]["student"] = "ada"
        (folder / "week09_exercise.ipynb").write_text(json.dumps(notebook))


@pytest.mark.slow
def test_guide_example_can_be_created_verified_released_and_graded(tmp_path: Path) -> None:
    author = Author(tmp_path)
    for language, options, text in BLOCK.findall(PAGE):
        author.do(language, dict(one.split("=") for one in options.split()), text)
    assert (tmp_path / "for_students" / "exercises" / "week09_exercise.ipynb").is_file()
    (row,) = csv.DictReader((tmp_path / "graded" / "gradebook.csv").read_text().splitlines())
    assert (row["student"], row["score"], row["max_score"]) == ("ada", "100.0", "100.0")
    (result,) = (tmp_path / "graded" / "results").rglob("week09_exercise.json")
    tasks = {task["task"]: task["score"] for task in json.loads(result.read_text())["judgement"]["tasks"]}
    assert tasks == {"week09.post": 60.0, "week09.cell_of": 40.0}


def test_guide_page_lists_every_expect_function() -> None:
    public = (ROOT / "course_lib" / "grading" / "__init__.pyi").read_text("utf-8")
    names, rows = set(re.findall(r"\bexpect_\w+", public)), [word for word, _ in WORD.findall(PAGE)]
    assert names - {*rows} == set(), "docs/author.md lists each check function below Vocabulary"
    assert sorted(rows) == sorted(names)


def test_guide_page_lists_every_mistake_reported_by_a_check() -> None:
    text = resources.files("course_lib.grading.vocabulary").joinpath("hints.toml").read_text("utf-8")
    named = {mistake for _, row in WORD.findall(PAGE) for mistake in row.split("; ")}
    named |= set(re.findall(r'"([^"]+)"', TOPIC_MISTAKES.replace("\n", " ")))
    known = set(tomllib.loads(text))
    assert known - named == set(), "docs/author.md names each mistake in the row of its check function"
    unknown = {mistake for mistake in named - known if mistake != "as `expect_level`"}
    assert unknown == set(), "grading/vocabulary/hints.toml has no hint for these mistakes of docs/author.md"


def test_guide_page_describes_every_column_of_the_verification_table() -> None:
    for aspect, meaning in ASPECTS.items():
        assert f"| {aspect} | {meaning} |" in PAGE


def test_every_link_of_the_guide_page_resolves() -> None:
    titles = [title.lower() for title in re.findall(r"^## (.+)$", PAGE, re.MULTILINE)]
    anchors = {re.sub(r"[^\w\- ]", "", title).replace(" ", "-") for title in titles}
    assert {link[1:] for link in re.findall(r"\]\((#[^)]+)\)", PAGE)} <= anchors
    assert all((ROOT / "docs" / link).is_file() for link in re.findall(r"\]\(([\w./]+\.md)", PAGE))
