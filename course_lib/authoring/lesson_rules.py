"""Rules for lessons, reviews and extras: their parts, minutes, predictions and quizzes."""

import ast
import importlib
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path

from course_lib.authoring.page import NotebookPage
from course_lib.authoring.rules import Rule
from course_lib.course.exercise import BEGIN, END, code_cells, read_notebook, source
from course_lib.course.questions import Question, read_questions
from course_lib.errors import did_you_mean

MINUTES = re.compile(r"^## .*\((\d+) min\)$", re.MULTILINE)
PARTS = ("When it goes wrong", "Recap", "Quiz", "Your turn")
STORY = range(3, 11)  # lines
LINKS = 3  # at least, for further reading
WRITES = re.compile(r'(?:save_\w+\("|rqt save |record -o |^%ros2 .* > )([\w./]+)', re.MULTILINE)
ANSWER = re.compile(
    r":\*\*[^\n]+\n\n<details><summary>Answer</summary>\n\n.{20,}?\n\n</details>(\n|$)", re.DOTALL
)


def every_part(page: NotebookPage) -> Iterator[str]:
    """Yield the parts that a lesson needs and this one lacks."""
    if not re.search(r"!\[.+\]\(attachment:.+\)", source(page.cells[0])):
        yield "the first cell has no picture: ![a description](attachment:picture.png)"
    titles = " | ".join(title for _, title in page.headings)
    missing = [
        p for p in ("**After this lesson you can**", "**Before you start:**") if p not in page.markdown
    ]
    missing += [f"a heading with {part!r}" for part in PARTS if part not in titles]
    missing += [f"a cell with {call}" for call in ("quiz(", "predict(", "compare(") if call not in page.code]
    for part in missing:
        yield f"missing: {part}"


def true_story(page: NotebookPage) -> Iterator[str]:
    """Yield an opening without a true story and its source."""
    opening, _, rest = page.markdown.partition("## Do you remember?")
    story = opening.partition("> **A true story.**")[2]
    lines = sum(line.startswith("> ") for line in story.splitlines())
    if not rest or lines not in STORY:
        yield f"above '## Do you remember?': expected 3 to 10 lines of '> **A true story.** …', found {lines}"
    if not re.search(r"^> Source: \S+", story, re.MULTILINE):
        yield "the true story has no line '> Source: …'"


def recall_first(page: NotebookPage) -> Iterator[str]:
    """Yield quizzes that are missing: the one on earlier weeks comes first."""
    titles = [title for level, title in page.headings if level == 2]
    if not titles or not titles[0].startswith("Do you remember?"):
        yield "the first section must be '## Do you remember?'"
    quizzes = [cell.strip() for cell in page.code_cells if cell.startswith("quiz(")]
    expected = [f'quiz("{page.week}_recall")', f'quiz("{page.week}")']
    if quizzes != expected:
        yield f"the cells with quizzes are {quizzes}, expected {expected}"


def page_to_show(page: NotebookPage) -> Iterator[str]:
    """Yield a lesson without a page to show, or without further reading."""
    titles = [re.sub(r"^\d+\. | \(\d+ min\)$", "", title) for _, title in page.headings]
    ends = [title for title in titles if title in ("Show it", "Recap", "Further reading")]
    if ends != ["Show it", "Recap", "Further reading"]:
        yield f"expected the headings 'Show it', 'Recap', 'Further reading' in this order, found {ends}"
    file = f"my_files/my_week{int(page.week[4:6])}.html"
    if f'save_html("{file}"' not in page.code:
        yield f'no cell saves the page to show: viewer.save_html("{file}")'
    if len(re.findall(r"\]\(https://", page.markdown.partition("## Further reading")[2])) < LINKS:
        yield f"'Further reading' needs at least {LINKS} links with https://"


def answers_to_open(page: NotebookPage) -> Iterator[str]:
    """Yield each "Try it" without an answer to open below it."""
    for tried in re.split(r"^\*\*Try it", page.markdown, flags=re.MULTILINE)[1:]:
        if not ANSWER.match(tried):
            yield f"'**Try it{tried[:40]}…' has no <details><summary>Answer</summary> … </details> below it"


def one_folder(page: NotebookPage) -> Iterator[str]:
    """Yield files that a lesson writes elsewhere than into my_files/."""
    for name in WRITES.findall(page.code):
        if not name.startswith("my_files/"):
            yield f"it writes {name}, expected a file in my_files/"


def to_the_robot(page: NotebookPage) -> Iterator[str]:
    """Yield phrases that lead from the lesson to RViz2, to the robot and to the exercise."""
    for phrase in ("> **In RViz2**", "> **On the robot**", "Try it", "_exercise.ipynb`"):
        if phrase not in page.markdown:
            yield f"missing: {phrase!r}"


def minutes(page: NotebookPage) -> Iterator[str]:
    """Yield minutes of sections that do not sum to the total."""
    total = sum(map(int, MINUTES.findall(page.markdown)))
    if f"**Time: {total} minutes in total.**" not in page.markdown:
        yield f"the sections sum to {total} min, expected a line **Time: {total} minutes in total.**"


def minutes_in_metadata(page: NotebookPage) -> Iterator[str]:
    """Yield a total that is not the one of the notebook's metadata, which the contents show."""
    total = sum(map(int, MINUTES.findall(page.markdown)))
    stored = page.notebook["metadata"].get("course", {}).get("minutes")
    if stored != total:
        yield f"metadata: course.minutes is {stored}, the sections sum to {total}"


def predictions(page: NotebookPage) -> Iterator[str]:
    """Yield predictions that are not asked and compared, or whose answer is shown too early."""
    name = page.week if "your_review" not in page.path.stem else page.path.stem.replace("_your", "")
    asked, compared = ([key for call, key in page.questions if call == c] for c in ("predict", "compare"))
    quizzes = page.exercises / "quizzes"
    known = {f"{name}.{q.key}": q for q in _predictions(quizzes / f"{name}.toml")}
    if asked != compared:
        yield f"it asks to predict {asked}, but compares {compared}"
    if set(asked) != set(known):
        yield f"it asks to predict {sorted(asked)}, but {name}.toml has {sorted(known)}"
    for key in (key for key in asked if key in known and "your_review" not in page.path.stem):
        quoted = f"[\"']{re.escape(key)}[\"']"
        between = re.search(rf"predict\(\s*{quoted}.*?compare\(\s*{quoted}[^\n]*", page.code, re.DOTALL)
        if between and known[key].right.text in between[0]:
            yield f"a cell before the comparison shows the answer to {key}: {known[key].right.text!r}"


def unknown_questions(page: NotebookPage) -> Iterator[str]:
    """Yield quizzes and predictions that the code asks for, and that no file has."""
    for call, name in page.questions:
        file, _, key = name.partition(".")
        path = page.exercises / "quizzes" / f"{file}.toml"
        if not path.is_file():
            yield f"it asks {call}({name!r}): there is no {file}.toml"
        elif call != "quiz":
            known = [question.key for question in _predictions(path)]
            if key not in known:
                meant = did_you_mean(key, known)
                yield f"it asks {call}({name!r}): {file}.toml has no prediction with key = {key!r}{meant}"


def _predictions(path: Path) -> tuple[Question, ...]:
    return read_questions(path, "prediction") if path.is_file() else ()


def review_quiz(page: NotebookPage) -> Iterator[str]:
    """Yield a review without its quiz."""
    name = page.path.stem.replace("_your", "")
    if f'quiz("{name}")' not in page.code:
        yield f'no cell with quiz("{name}")'


FOR_LESSONS: tuple[Rule, ...] = (
    every_part,
    answers_to_open,
    one_folder,
    minutes,
    minutes_in_metadata,
    predictions,
)
WITH_EXERCISE: tuple[Rule, ...] = (true_story, recall_first, page_to_show, to_the_robot)
FOR_REVIEWS: tuple[Rule, ...] = (review_quiz, answers_to_open, minutes, predictions)
FOR_EXTRAS: tuple[Rule, ...] = (answers_to_open, minutes, minutes_in_metadata)


OURS = re.compile(r"(rclpy|tf2_\w+|\w+_msgs|launch\w*|course_lib|ament_index_python|rcl_interfaces)(\.|$)")


def untaught(solution: Path, lessons: Sequence[Path]) -> Iterator[str]:
    """Yield each name of ROS or the kit that an answer uses, and that none of these lessons shows."""
    taught = "\n".join(source(cell) for path in lessons for cell in read_notebook(path)["cells"])
    for name in dict.fromkeys(used_in_answers(code_of(solution))):
        if not re.search(rf"\b{re.escape(name)}\b", taught):
            yield f"an answer uses {name}, which no lesson up to this week shows"


def code_of(path: Path) -> str:
    """Return the code without cells that only the solution has: they do by code what students do by hand."""
    cells = (cell for _, cell in code_cells(read_notebook(path)))
    kept = (source(cell) for cell in cells if "solution" not in cell.get("metadata", {}).get("tags", []))
    return "\n".join(re.sub(r"^([%!])", r"# \1", cell, flags=re.MULTILINE) for cell in kept)


def used_in_answers(code: str) -> Iterator[str]:
    """Yield imported names of ROS and the kit, and members of theirs, that stand in an answer."""
    tree, lines = ast.parse(code), lines_of_answers(code)
    imported = dict[str, object]()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module and OURS.match(node.module):
            with suppress(ImportError):  # the run of the solution names it
                module = importlib.import_module(node.module)
                imported |= {a.name: getattr(module, a.name) for a in node.names if hasattr(module, a.name)}
    members = {name for thing in imported.values() for name in dir(thing) if not name.startswith("_")}
    for node in ast.walk(tree):
        match node:
            case ast.Attribute(attr=name) if node.lineno in lines and name in members:
                yield name
            case ast.Name(id=name) if node.lineno in lines and name in imported:
                yield name


def lines_of_answers(code: str) -> set[int]:
    """Return the numbers of the lines between `# solution:` and its end."""
    found, inside = set[int](), False
    for number, line in enumerate(code.splitlines(), 1):
        inside = (inside or bool(BEGIN.match(line))) and END not in line
        found |= {number} if inside else set()
    return found
