"""Lint of lessons: headings, lengths, times, words, pictures."""

import ast
import re
import tomllib
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from course_lib.course.exercise import notebook_text, read_notebook, source
from course_lib.course.installation import exercises_dir, extras, lessons, lessons_dir, reviews, solutions_dir
from course_lib.course.questions import load_predictions, load_quiz

LESSONS = lessons()
REVIEWS = reviews()
EXTRAS = extras()
ALL = [
    *LESSONS,
    *REVIEWS,
    *EXTRAS,
    *sorted(exercises_dir().glob("*.ipynb")),
    *sorted(solutions_dir().glob("*.ipynb")),
]
MAX_CELL = 25  # lines
AVERAGE_SENTENCE, LONGEST_SENTENCE = 12, 30  # words
MINUTES = re.compile(r"^## .*\((\d+) min\)$", re.MULTILINE)


def markdown(path: Path) -> str:
    return "\n\n".join(source(c) for c in read_notebook(path)["cells"] if c["cell_type"] == "markdown")


def code_cells(path: Path) -> list[str]:
    return [source(c) for c in read_notebook(path)["cells"] if c["cell_type"] == "code"]


def headings(path: Path) -> list[tuple[int, str]]:
    return [(len(m[1]), m[2]) for m in re.finditer(r"^(#+) (.+)$", markdown(path), re.MULTILINE)]


def each(paths: list[Path]) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("path", paths, ids=lambda path: path.stem)


@each(ALL)
def test_it_is_stripped_of_outputs_and_written_in_jupyters_layout(path: Path) -> None:
    notebook = read_notebook(path)
    cells = notebook["cells"]
    assert not [cell["id"] for cell in cells if cell.get("outputs") or cell.get("execution_count")]
    assert len({cell["id"] for cell in cells}) == len(cells)
    assert notebook["metadata"]["kernelspec"]["name"] == "python3"
    assert path.read_text(encoding="utf-8") == notebook_text(notebook)


@each(ALL)
def test_no_cell_is_over_25_lines(path: Path) -> None:
    assert not [cell for cell in code_cells(path) if len(cell.splitlines()) > MAX_CELL]


@each(ALL)
def test_it_starts_with_the_extension_and_imports_only_what_it_uses(path: Path) -> None:
    first, *rest = code_cells(path)
    lines = first.splitlines()
    assert lines[0] == "%load_ext course_lib"
    (imported,) = [line for line in lines[1:] if line.startswith("from course_lib import ")]
    code = "\n".join(rest)
    unused = [
        name for name in imported.split("import ")[1].split(", ") if not re.search(rf"\b{name}\b", code)
    ]
    assert unused == []
    for cell in rest:
        ast.parse(re.sub(r"^%", "# %", cell, flags=re.MULTILINE))


@each(ALL)
def test_headings_are_in_order_below_one_title(path: Path) -> None:
    levels = [level for level, _ in headings(path)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(b <= a + 1 for a, b in pairwise(levels))


@each(ALL)
def test_pictures_have_a_text_and_links_say_where_they_lead(path: Path) -> None:
    for bang, text, _ in re.findall(r"(!?)\[([^\]]*)\]\(([^)]+)\)", markdown(path)):
        assert len(text) > (30 if bang else 3), text
        assert text.lower() not in {"here", "this", "link", "click here"}
    assert "<img" not in markdown(path)


def sentences(text: str) -> list[list[str]]:
    """The words of each sentence of the prose: no tables, no code, no pictures."""
    prose = re.sub(r"^\|[^\n]*$|^```.*?^```|!\[.*?\]\(.*?\)", "", text, flags=re.MULTILINE | re.DOTALL)
    prose = re.sub(r"^(#+|[-*>]|\d+\.) ", "\n", re.sub(r"`[^`]*`", "x", prose), flags=re.MULTILINE)
    parts = re.split(r"[.:?!;](?=\s)|\n\n", prose)
    return [words for part in parts if len(words := re.findall(r"\w+", part)) > 1]


@each(ALL)
def test_sentences_are_short_on_average(path: Path) -> None:
    found = sentences(markdown(path))
    assert sum(map(len, found)) / len(found) <= AVERAGE_SENTENCE
    assert [" ".join(words) for words in found if len(words) > LONGEST_SENTENCE] == []


@each(LESSONS)
def test_a_lesson_has_every_part_that_a_lesson_needs(path: Path) -> None:
    text, titles = markdown(path), " | ".join(title for _, title in headings(path))
    assert re.search(r"!\[.+\]\(attachment:.+\)", source(read_notebook(path)["cells"][0])), "a picture on top"
    for phrase in ("**After this lesson you can**", "**Before you start:**"):
        assert phrase in text
    for part in ("When it goes wrong", "Recap", "Quiz", "Your turn"):
        assert part in titles
    assert any(cell.startswith("quiz(") for cell in code_cells(path))
    assert any("predict(" in cell for cell in code_cells(path))
    assert any("compare(" in cell for cell in code_cells(path))


WITH_EXERCISE = [path for path in LESSONS if path.stem != "week00_welcome"]


@each(WITH_EXERCISE)
def test_a_lesson_opens_with_a_true_story_and_its_source(path: Path) -> None:
    opening, _, rest = markdown(path).partition("## Do you remember?")
    assert rest, "the story comes first"
    story = opening.split("> **A true story.**")[1]
    assert 3 <= len([line for line in story.splitlines() if line.startswith("> ")]) <= 10
    assert re.search(r"^> Source: \S+", story, re.MULTILINE)


@each(WITH_EXERCISE)
def test_a_lesson_asks_of_earlier_weeks_before_anything_new(path: Path) -> None:
    titles = [title for level, title in headings(path) if level == 2]
    assert titles[0].startswith("Do you remember?")
    quizzes = [cell for cell in code_cells(path) if cell.startswith("quiz(")]
    assert quizzes == [f'quiz("{path.stem[:6]}_recall")', f'quiz("{path.stem[:6]}")']


@each(WITH_EXERCISE)
def test_a_lesson_ends_with_a_page_to_show_and_further_reading(path: Path) -> None:
    titles = [re.sub(r"^\d+\. | \(\d+ min\)$", "", title) for _, title in headings(path)]
    assert titles.index("Show it") < titles.index("Recap") < titles.index("Further reading")
    assert any(f'save_html("my_files/my_week{int(path.stem[4:6])}.html"' in cell for cell in code_cells(path))
    reading = markdown(path).split("## Further reading")[1]
    assert len(re.findall(r"\]\(https://", reading)) >= 3


@each([*LESSONS, *REVIEWS, *EXTRAS])
def test_each_try_it_is_followed_by_an_answer_to_open(path: Path) -> None:
    answer = r"<details><summary>Answer</summary>\n\n.{20,}?\n\n</details>"
    for tried in re.split(r"^\*\*Try it", markdown(path), flags=re.MULTILINE)[1:]:
        assert re.match(rf":\*\*[^\n]+\n\n{answer}(\n|$)", tried, re.DOTALL), tried[:80]


@each(LESSONS)
def test_what_a_lesson_writes_goes_into_one_folder(path: Path) -> None:
    writing = r'(?:save_\w+\("|rqt save |record -o |^%ros2 .* > )([\w./]+)'
    named = {name for cell in code_cells(path) for name in re.findall(writing, cell, re.MULTILINE)}
    assert [name for name in named if not name.startswith("my_files/")] == []


@each(WITH_EXERCISE)
def test_a_lesson_leads_to_rviz2_and_to_the_robot(path: Path) -> None:
    for phrase in ("> **In RViz2**", "> **On the robot**", "Try it", "_exercise.ipynb`"):
        assert phrase in markdown(path)


@each([*LESSONS, *EXTRAS])
def test_the_minutes_of_the_sections_sum_to_the_total(path: Path) -> None:
    total = sum(map(int, MINUTES.findall(markdown(path))))
    assert f"**Time: {total} minutes in total.**" in markdown(path)
    assert read_notebook(path)["metadata"]["course"]["minutes"] == total


@each(LESSONS)
def test_every_prediction_is_asked_and_compared_with_a_result(path: Path) -> None:
    code = "\n".join(code_cells(path))
    asked = re.findall(r'predict\(\s*"([^"]+)"', code)
    assert asked == re.findall(r'compare\(\s*"([^"]+)"', code)
    assert set(asked) == {f"{path.stem[:6]}.{q.key}" for q in load_predictions(path.stem[:6])}


@each(LESSONS)
def test_no_cell_up_to_the_comparison_shows_the_answer_of_a_prediction(path: Path) -> None:
    code = "\n".join(code_cells(path))
    for question in load_predictions(path.stem[:6]):
        key = re.escape(f'"{path.stem[:6]}.{question.key}"')
        between = re.search(rf"predict\({key}.*?compare\({key}[^\n]*", code, re.DOTALL)
        assert between is not None
        assert question.right.text not in between[0]


@each(REVIEWS)
def test_a_review_has_questions_and_compares_its_predictions(path: Path) -> None:
    code, name = "\n".join(code_cells(path)), path.stem.replace("_your", "")
    assert f'quiz("{name}")' in code
    asked = re.findall(r'predict\("([^"]+)"', code)
    assert (
        asked
        == re.findall(r'compare\("([^"]+)"', code)
        == [f"{name}.{q.key}" for q in load_predictions(name)]
    )
    total = sum(map(int, MINUTES.findall(markdown(path))))
    assert f"**Time: {total} minutes in total.**" in markdown(path)


COVERAGE = tomllib.loads((lessons_dir() / "coverage.toml").read_text(encoding="utf-8"))["part"]


@pytest.mark.parametrize("part", COVERAGE, ids=lambda part: part["topic"])
def test_every_part_of_the_original_tutorials_is_there_by_its_words(part: dict[str, Any]) -> None:
    assert sum(map(len, part["words"].values())) >= 2
    for name, words in part["words"].items():
        folder = exercises_dir() if name.endswith("exercise") else lessons_dir()
        cells = read_notebook(folder / f"{name}.ipynb")["cells"]
        text = "\n".join(source(cell) for cell in cells).casefold()
        assert [word for word in words if word.casefold() not in text] == []


def test_week_6_asks_the_ten_questions_of_its_tutorial() -> None:
    assert len(load_quiz("week06")) == 10
