"""Rules for a week: layout, headings, sentences and pictures of notebooks, and ROS names of checks.

Additional rules for lessons, reviews and extras concern their sections, minutes, predictions and
quizzes.
"""

import ast
import importlib
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from difflib import get_close_matches
from functools import cached_property
from itertools import pairwise
from pathlib import Path

from course_lib.authoring.rehearsal import cells_of, count_options, with_option
from course_lib.course.exercise import BEGIN, END, Notebook, code_cells, notebook_text, read_notebook, source
from course_lib.course.questions import Question, read_questions
from course_lib.errors import CourseError, did_you_mean, format_count, location_of
from course_lib.grading.evidence import Origin
from course_lib.grading.inputs import build, personal_values
from course_lib.grading.store import Course, catalog_of
from course_lib.grading.submissions.notebook import CodeCell
from course_lib.grading.task import Scenario, Task
from course_lib.ros.messages.definitions import definition

# Keys of every cell and their types.
PARTS = {"id": str, "cell_type": str, "metadata": dict}
QUESTIONS = ("quiz", "predict", "compare")


def parse_cell(cell: str) -> ast.Module:
    """Parse a cell. Magics and shell commands, with their continued lines, are treated as comments.

    Raises:
        SyntaxError: The cell is not valid Python.
    """
    commands = re.compile(r"^[%!](?:.*\\\n)*.*", re.MULTILINE)
    return ast.parse(commands.sub(lambda match: re.sub(r"(?m)^", "# ", match[0]), cell))


@dataclass(frozen=True)
class NotebookPage:
    """A notebook of the course.

    Args:
        path: The file.
        exercises: The folder of the exercises, with `quizzes/`.
    """

    path: Path
    exercises: Path

    @cached_property
    def notebook(self) -> Notebook:
        """The notebook as plain data, in which each cell has the keys that Jupyter writes."""
        notebook = read_notebook(self.path)
        for number, cell in enumerate(notebook["cells"], 1):
            if wrong := [name for name, kind in PARTS.items() if not isinstance(cell.get(name), kind)]:
                raise CourseError(f"cell {number} has no {wrong[0]!r}: write it again in JupyterLab")
        return notebook

    @property
    def cells(self) -> Sequence[dict[str, object]]:
        """All cells."""
        cells: list[dict[str, object]] = self.notebook["cells"]
        return cells

    @cached_property
    def markdown(self) -> str:
        """The text of all Markdown cells."""
        return "\n\n".join(source(c) for c in self.cells if c["cell_type"] == "markdown")

    @cached_property
    def code_cells(self) -> list[str]:
        """The source of each code cell."""
        return [source(c) for c in self.cells if c["cell_type"] == "code"]

    @cached_property
    def code(self) -> str:
        """The source of all code cells."""
        return "\n".join(self.code_cells)

    @cached_property
    def questions(self) -> list[tuple[str, str]]:
        """The questions in the code, in order, like ("predict", "week01.top") or ("quiz", "week01")."""
        questions = []
        for cell in self.code_cells:
            # Another rule reports syntax errors.
            with suppress(SyntaxError):
                calls = [node for node in ast.walk(parse_cell(cell)) if isinstance(node, ast.Call)]
                for call in sorted(calls, key=lambda node: (node.lineno, node.col_offset)):
                    match call:
                        case ast.Call(ast.Name(name), [ast.Constant(str(asked)), *_]) if name in QUESTIONS:
                            questions.append((name, asked))
        return questions

    @cached_property
    def headings(self) -> list[tuple[int, str]]:
        """The headings as (level, title)."""
        return [(len(m[1]), m[2]) for m in re.finditer(r"^(#+) (.+)$", self.markdown, re.MULTILINE)]

    @property
    def week(self) -> str:
        """The week in the file's name, like "week01"."""
        return self.path.stem.split("_")[0]


Rule = Callable[[NotebookPage], Iterator[str]]
# Maximum number of lines in a code cell.
MAX_CELL = 25
# Maximum average length and maximum length of a sentence, in words.
AVERAGE_SENTENCE, LONGEST_SENTENCE = 12, 30
IMPORT = "from course_lib import "
VAGUE = {"here", "this", "link", "click here"}


def unclean_cells(page: NotebookPage) -> Iterator[str]:
    """Yield a flaw for outputs, duplicate cell ids, a wrong kernel, and JSON in another format."""
    full = [cell["id"] for cell in page.cells if cell.get("outputs") or cell.get("execution_count")]
    if full:
        yield f"the cells {full} have outputs: clear all outputs"
    if len({cell["id"] for cell in page.cells}) < len(page.cells):
        yield "two cells have the same id"
    if page.notebook["metadata"].get("kernelspec", {}).get("name") != "python3":
        yield "its kernel is not python3"
    if page.path.read_text(encoding="utf-8") != notebook_text(page.notebook):
        yield "its JSON is formatted differently: open it in JupyterLab and save it"


def overlong_cells(page: NotebookPage) -> Iterator[str]:
    """Yield a flaw for each code cell with too many lines."""
    for cell in page.code_cells:
        count = len(cell.splitlines())
        if count > MAX_CELL:
            yield f"the cell {_first_line(cell)!r} has {count} lines, expected at most {MAX_CELL}"


def first_cell_flaws(page: NotebookPage) -> Iterator[str]:
    """Yield a flaw for a first cell without the extension, and for each unused import of the kit."""
    first, *later_cells = page.code_cells or [""]
    if first.splitlines()[:1] != ["%load_ext course_lib"]:
        yield "the first code cell must begin with: %load_ext course_lib"
    lines = [line for line in first.splitlines()[1:] if line.startswith(IMPORT)]
    if len(lines) != 1:
        yield f"the first code cell has {len(lines)} lines {IMPORT!r}, expected 1"
    names = [name for line in lines for name in line.removeprefix(IMPORT).split(", ")]
    for name in names:
        if not re.search(rf"\b{re.escape(name)}\b", "\n".join(later_cells)):
            yield f"{name} is imported from course_lib, but not used"


def syntax_errors(page: NotebookPage) -> Iterator[str]:
    """Yield code cells with syntax errors."""
    for cell in page.code_cells:
        try:
            parse_cell(cell)
        except SyntaxError as error:
            yield f"the cell {_first_line(cell)!r}, line {error.lineno}: SyntaxError: {error.msg}"


def misplaced_headings(page: NotebookPage) -> Iterator[str]:
    """Yield a flaw for a missing or second title, and for each heading that skips a level."""
    levels = [level for level, _ in page.headings]
    if levels[:1] != [1] or levels.count(1) != 1:
        yield "expected one title (# …) above all other headings"
    for (above, _), (level, title) in pairwise(page.headings):
        if level > above + 1:
            yield f"the heading {title!r} has level {level}, but follows one of level {above}"


def link_flaws(page: NotebookPage) -> Iterator[str]:
    """Yield links and pictures without a description of their target, and pictures that are missing."""
    for bang, text, _ in re.findall(r"(!?)\[([^\]]*)\]\(([^)]+)\)", page.markdown):
        if len(text) <= (30 if bang else 3) or text.lower() in VAGUE:
            kind = "picture" if bang else "link"
            yield f"the {kind} {text!r} needs a description for readers who use a screen reader"
    if "<img" in page.markdown:
        yield "<img is HTML: write ![a description](attachment:picture.png)"
    cells = page.notebook["cells"]
    attached = {f"attachment:{name}" for cell in cells for name in cell.get("attachments", {})}
    for target in re.findall(r"!\[[^\]]*\]\(([^)\s]+)", page.markdown):
        is_file = "://" in target or (page.path.parent / target).is_file()
        if target not in attached and not is_file:
            yield f"the picture {target!r} is missing: drag it into the cell again"


def sentences(text: str) -> list[list[str]]:
    """Return the words of each sentence in Markdown, without tables, code and pictures."""
    prose = re.sub(r"^\|[^\n]*$|^```.*?^```|!\[.*?\]\(.*?\)", "", text, flags=re.MULTILINE | re.DOTALL)
    prose = re.sub(r"^(#+|[-*>]|\d+\.) ", "\n", re.sub(r"`[^`]*`", "x", prose), flags=re.MULTILINE)
    parts = re.split(r"[.:?!;](?=\s)|\n\n", prose)
    return [words for part in parts if len(words := re.findall(r"\w+", part)) > 1]


def long_sentences(page: NotebookPage) -> Iterator[str]:
    """Yield a flaw for each sentence that is too long, and for too high an average length."""
    sentences_of_page = sentences(page.markdown)
    average = sum(map(len, sentences_of_page)) / max(len(sentences_of_page), 1)
    if average > AVERAGE_SENTENCE:
        yield f"a sentence has {average:.1f} words on average, expected at most {AVERAGE_SENTENCE}"
    for words in sentences_of_page:
        if len(words) > LONGEST_SENTENCE:
            begin = " ".join(words[:8])
            yield f"a sentence has {len(words)} words, expected at most {LONGEST_SENTENCE}: {begin} …"


def _first_line(cell: str) -> str:
    return (cell.splitlines() or [""])[0][:50]


FOR_ALL: tuple[Rule, ...] = (
    unclean_cells,
    overlong_cells,
    first_cell_flaws,
    syntax_errors,
    misplaced_headings,
    link_flaws,
    long_sentences,
)


MINUTES = re.compile(r"^## .*\((\d+) min\)$", re.MULTILINE)
LESSON_PARTS = ("When it goes wrong", "Recap", "Quiz", "Your turn")
# Number of lines that the true story may have.
STORY = range(3, 11)
# Minimum number of links for further reading.
LINKS = 3
WRITES = re.compile(r'(?:save_\w+\("|record -o |^%ros2 .* > )([\w./]+)', re.MULTILINE)
ANSWER = re.compile(
    r":\*\*[^\n]+\n\n<details><summary>Answer</summary>\n\n.{20,}?\n\n</details>(\n|$)", re.DOTALL
)


def missing_sections(page: NotebookPage) -> Iterator[str]:
    """Yield the required parts of a lesson that are missing."""
    if not re.search(r"!\[.+\]\(attachment:.+\)", source(page.cells[0])):
        yield "the first cell has no picture: ![a description](attachment:picture.png)"
    titles = " | ".join(title for _, title in page.headings)
    missing = [
        p for p in ("**After this lesson you can**", "**Before you start:**") if p not in page.markdown
    ]
    missing += [f"a heading with {part!r}" for part in LESSON_PARTS if part not in titles]
    missing += [f"a cell with {call}" for call in ("quiz(", "predict(", "compare(") if call not in page.code]
    for part in missing:
        yield f"missing: {part}"


def missing_story(page: NotebookPage) -> Iterator[str]:
    """Yield a flaw if the true story at the beginning is missing, or its source."""
    opening, _, story_text = page.markdown.partition("## Do you remember?")
    story = opening.partition("> **A true story.**")[2]
    lines = sum(line.startswith("> ") for line in story.splitlines())
    if not story_text or lines not in STORY:
        yield f"above '## Do you remember?': expected 3 to 10 lines of '> **A true story.** …', found {lines}"
    if not re.search(r"^> Source: \S+", story, re.MULTILINE):
        yield "the true story has no line '> Source: …'"


def missing_quizzes(page: NotebookPage) -> Iterator[str]:
    """Yield missing quizzes. The quiz about earlier weeks must be in the first section."""
    titles = [title for level, title in page.headings if level == 2]
    if not titles or not titles[0].startswith("Do you remember?"):
        yield "the first section must be '## Do you remember?'"
    quizzes = [cell.strip() for cell in page.code_cells if cell.startswith("quiz(")]
    expected = [f'quiz("{page.week}_recall")', f'quiz("{page.week}")']
    if quizzes != expected:
        yield f"the cells with quizzes are {quizzes}, expected {expected}"


def missing_page(page: NotebookPage) -> Iterator[str]:
    """Yield a flaw for each missing final section, a missing page to show, and too few links."""
    titles = [re.sub(r"^\d+\. | \(\d+ min\)$", "", title) for _, title in page.headings]
    ends = [title for title in titles if title in ("Show it", "Recap", "Further reading")]
    if ends != ["Show it", "Recap", "Further reading"]:
        yield f"expected the headings 'Show it', 'Recap', 'Further reading' in this order, found {ends}"
    file = f"my_files/my_week{int(page.week[4:6])}.html"
    if f'save_html("{file}"' not in page.code:
        yield f'no cell saves the page to show: viewer.save_html("{file}")'
    if len(re.findall(r"\]\(https://", page.markdown.partition("## Further reading")[2])) < LINKS:
        yield f"'Further reading' needs at least {LINKS} links with https://"


def missing_answers(page: NotebookPage) -> Iterator[str]:
    """Yield a flaw for each "Try it" without a collapsed answer below it."""
    for tried in re.split(r"^\*\*Try it", page.markdown, flags=re.MULTILINE)[1:]:
        if not ANSWER.match(tried):
            yield f"'**Try it{tried[:40]}…' has no <details><summary>Answer</summary> … </details> below it"


def misplaced_files(page: NotebookPage) -> Iterator[str]:
    """Yield files that a lesson writes outside of my_files/."""
    for name in WRITES.findall(page.code):
        if not name.startswith("my_files/"):
            yield f"it writes {name}, expected a file in my_files/"


def missing_references(page: NotebookPage) -> Iterator[str]:
    """Yield a flaw for each missing reference to RViz2, to the real robot and to the exercise."""
    for phrase in ("> **In RViz2**", "> **On the robot**", "Try it", "_exercise.ipynb`"):
        if phrase not in page.markdown:
            yield f"missing: {phrase!r}"


def wrong_minutes(page: NotebookPage) -> Iterator[str]:
    """Yield a flaw if the stated total time differs from the sum of the sections' minutes."""
    total = sum(map(int, MINUTES.findall(page.markdown)))
    if f"**Time: {total} minutes in total.**" not in page.markdown:
        yield f"the sections sum to {total} min, expected a line **Time: {total} minutes in total.**"


def wrong_minutes_in_metadata(page: NotebookPage) -> Iterator[str]:
    """Yield a flaw if the metadata's total time, for the contents page, differs from that sum."""
    total = sum(map(int, MINUTES.findall(page.markdown)))
    minutes = page.notebook["metadata"].get("course", {}).get("minutes")
    if minutes != total:
        yield f"metadata: course.minutes is {minutes}, the sections sum to {total}"


def wrong_predictions(page: NotebookPage) -> Iterator[str]:
    """Yield a flaw for each prediction that is not requested, not compared or shown too early."""
    name = page.week if "your_review" not in page.path.stem else page.path.stem.replace("_your", "")
    predicted, compared = ([key for call, key in page.questions if call == c] for c in ("predict", "compare"))
    quizzes = page.exercises / "quizzes"
    predictions = {f"{name}.{q.key}": q for q in _predictions(quizzes / f"{name}.toml")}
    if predicted != compared:
        yield f"it asks to predict {predicted}, but compares {compared}"
    if set(predicted) != set(predictions):
        yield f"it asks to predict {sorted(predicted)}, but {name}.toml has {sorted(predictions)}"
    for key in (key for key in predicted if key in predictions and "your_review" not in page.path.stem):
        quoted = f"[\"']{re.escape(key)}[\"']"
        between = re.search(rf"predict\(\s*{quoted}.*?compare\(\s*{quoted}[^\n]*", page.code, re.DOTALL)
        if between and predictions[key].right.text in between[0]:
            yield f"a cell before the comparison shows the answer to {key}: {predictions[key].right.text!r}"


def unknown_questions(page: NotebookPage) -> Iterator[str]:
    """Yield quizzes and predictions that the code uses and no file defines."""
    for call, name in page.questions:
        file, _, key = name.partition(".")
        path = page.exercises / "quizzes" / f"{file}.toml"
        if not path.is_file():
            yield f"it asks {call}({name!r}): there is no {file}.toml"
        elif call != "quiz":
            known_keys = [question.key for question in _predictions(path)]
            if key not in known_keys:
                suggestion = did_you_mean(key, known_keys)
                problem = f"{file}.toml has no prediction with key = {key!r}{suggestion}"
                yield f"it asks {call}({name!r}): {problem}"


def _predictions(path: Path) -> tuple[Question, ...]:
    return read_questions(path, "prediction") if path.is_file() else ()


def missing_review_quiz(page: NotebookPage) -> Iterator[str]:
    """Yield a flaw if a review lacks a quiz."""
    name = page.path.stem.replace("_your", "")
    if f'quiz("{name}")' not in page.code:
        yield f'no cell with quiz("{name}")'


FOR_LESSONS: tuple[Rule, ...] = (
    missing_sections,
    missing_answers,
    misplaced_files,
    wrong_minutes,
    wrong_minutes_in_metadata,
    wrong_predictions,
)
WITH_EXERCISE: tuple[Rule, ...] = (missing_story, missing_quizzes, missing_page, missing_references)
FOR_REVIEWS: tuple[Rule, ...] = (missing_review_quiz, missing_answers, wrong_minutes, wrong_predictions)
FOR_EXTRAS: tuple[Rule, ...] = (missing_answers, wrong_minutes, wrong_minutes_in_metadata)


OURS = re.compile(r"(rclpy|tf2_\w+|\w+_msgs|launch\w*|course_lib|ament_index_python|rcl_interfaces)(\.|$)")


def code_of(path: Path) -> str:
    """Return the code of a solution without cells tagged `solution`, which replace manual work."""
    cells = (cell for _, cell in code_cells(read_notebook(path)))
    sources = (source(cell) for cell in cells if "solution" not in cell.get("metadata", {}).get("tags", []))
    return "\n".join(re.sub(r"^([%!])", r"# \1", cell, flags=re.MULTILINE) for cell in sources)


def names_in_answers(code: str) -> Iterator[str]:
    """Yield the names imported from ROS and the kit, and their members, that an answer uses."""
    tree, lines = ast.parse(code), lines_of_answers(code)
    imports = dict[str, object]()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module and OURS.match(node.module):
            # An import that fails is reported when the solution is run.
            with suppress(ImportError):
                module = importlib.import_module(node.module)
                imports |= {a.name: getattr(module, a.name) for a in node.names if hasattr(module, a.name)}
    members = {name for imported in imports.values() for name in dir(imported) if not name.startswith("_")}
    for node in ast.walk(tree):
        match node:
            case ast.Attribute(attr=name) if node.lineno in lines and name in members:
                yield name
            case ast.Name(id=name) if node.lineno in lines and name in imports:
                yield name


def lines_of_answers(code: str) -> set[int]:
    """Return the line numbers between `# solution:` and its end mark."""
    line_numbers, inside = set[int](), False
    for number, line in enumerate(code.splitlines(), 1):
        inside = (inside or bool(BEGIN.match(line))) and END not in line
        line_numbers |= {number} if inside else set()
    return line_numbers


# The columns of the table: the heading and the requirement.
ASPECTS = {
    "files": "course.toml, check files and answers can be read",
    "fields": "message types and fields in checks and inputs exist; no topic of an input is misspelt",
    "solution": "the solution has full marks under every personal option",
    "stub": "the empty exercise has no points, and its errors state what is missing",
    "empty": "a publisher without content has at most a tenth of the points",
    "second": "an alternative correct answer has full marks",
    "wrong": (
        "wrong answers and mutants fail with a message about the mistake, and crashing answers fail; "
        "no check raises or crashes on an answer"
    ),
    "can fail": "every check fails for at least one answer",
    "quiz": "each question has one right answer, and all questions of the lessons exist",
    "lesson": "lessons run without errors; lesson, exercise and solution follow the rules",
    "fresh": "the exercise is generated from the current solution",
}


@dataclass(frozen=True)
class Flaw:
    """A flaw in the files of a week.

    Args:
        aspect: A key of ASPECTS.
        text: What was found and what was expected.
        location: The file, with the line if it is known.
    """

    aspect: str
    text: str
    location: str = ""

    def __str__(self) -> str:
        return f"{self.location}: {self.text}" if self.location else self.text


# The row of notebooks that do not belong to a week.
EXTRAS = "extras"


def page_flaws(week: str, course: Course) -> Iterator[Flaw]:
    """Yield the violations of the rules in a week's notebooks, or in the extras."""
    if week == EXTRAS:
        for path in sorted(course.lessons.glob("extra_*.ipynb")):
            yield from _apply_rules(path, course, [*FOR_ALL, *FOR_EXTRAS])
        return
    reviews = sorted(course.lessons.glob(f"{week}_your_review.ipynb"))
    pages = sorted(set(course.lessons.glob(f"{week}_*.ipynb")) - set(reviews))
    solution = course.solutions / f"{week}_solution.ipynb"
    if len(pages) != 1:
        text = f"{format_count(len(pages), 'lesson')}, expected one"
        yield Flaw("lesson", text, str(course.lessons / f"{week}_*.ipynb"))
    for path in pages:
        rules = [*FOR_ALL, *FOR_LESSONS, *(WITH_EXERCISE if solution.is_file() else ())]
        yield from _apply_rules(path, course, rules)
    for path in reviews:
        yield from _apply_rules(path, course, [*FOR_ALL, *FOR_REVIEWS])
    for path in (solution, course.exercises / f"{week}_exercise.ipynb"):
        if path.is_file():
            yield from _apply_rules(path, course, FOR_ALL)
    if solution.is_file():
        lessons = [path for path in sorted(course.lessons.glob("week*.ipynb")) if path.name[:6] <= week]
        # The rules report unreadable notebooks and syntax errors.
        with suppress(CourseError, SyntaxError):
            taught = "\n".join(source(cell) for path in lessons for cell in read_notebook(path)["cells"])
            for name in dict.fromkeys(names_in_answers(code_of(solution))):
                if not re.search(rf"\b{re.escape(name)}\b", taught):
                    text = f"an answer uses {name}, which no lesson up to this week shows"
                    yield Flaw("lesson", text, str(solution))


def _apply_rules(path: Path, course: Course, rules: Iterable[Rule]) -> Iterator[Flaw]:
    page = NotebookPage(path, course.exercises)
    # Unreadable quizzes and notebooks are reported elsewhere.
    with suppress(CourseError):
        yield from (Flaw("quiz", text, str(path)) for text in unknown_questions(page))
    try:
        for rule in rules:
            yield from (Flaw("lesson", text, str(path)) for text in rule(page))
    # The file is not a notebook, or a cell lacks a key.
    except (CourseError, KeyError) as error:
        yield Flaw("lesson", f"it can't be read as a notebook: {error}", str(path))


NAME = re.compile(r"/?[A-Za-z]\w*(/\w+)*")
# Minimum similarity of two names for one to count as a misspelling of the other.
SIMILAR = 0.75
# Topics that nodes subscribe to although their code does not contain the names.
IMPLICIT_TOPICS = ("/tf", "/tf_static", "/clock")
MARKER = "visualization_msgs/msg/Marker"


def input_flaws(week: str, course: Course) -> Iterator[Flaw]:
    """Yield the flaws in the inputs of a week's tasks: invalid messages and misspelled topics."""
    catalog = catalog_of(course)
    solution = course.solutions / f"{week}_solution.ipynb"
    # Strings in the solution that may be names of topics or nodes, without the leading slash.
    names = set[str]()
    for cell in cells_of(solution) if solution.is_file() else ():
        for node in ast.walk(CodeCell(1, cell, True).tree):
            match node:
                case ast.Constant(str(text)) if NAME.fullmatch(text):
                    names.add(text.strip("/"))
    for task in catalog.tasks_of_week(week):
        yield from invalid_messages(task, task.scenarios, course.exercises / "checks" / f"{week}.py")
        hidden_scenarios = catalog.hidden.get(task.id, ())
        yield from invalid_messages(
            replace(task, ghost=()), hidden_scenarios, course.solutions / "checks" / f"{week}.py"
        )
        if task.kind == "node":
            for scenarios, top in ((task.scenarios, course.exercises), (hidden_scenarios, course.solutions)):
                yield from misspelled_topics(task, scenarios, names, top / "checks" / f"{week}.py")


def invalid_messages(task: Task, scenarios: Sequence[Scenario], path: Path) -> Iterator[Flaw]:
    """Yield a flaw for each input or expected message that does not match its type."""
    messages = [message for scenario in scenarios for message in scenario.inputs]
    problems = dict[str, None]()
    for row in range(count_options([task])):
        values = personal_values(with_option(task, row), None)
        for message in (*messages, *task.ghost):
            # For a service, these are the fields of the request.
            suffix = "_Request" if "/srv/" in message.type_name else ""
            try:
                build(replace(message, type_name=f"{message.type_name}{suffix}"), values)
            except CourseError as error:
                problems[str(error)] = None
    for text in problems:
        # In errors of Python and ROS, the last quoted name is the misspelled one.
        name = f'"{text.rsplit(chr(39), 2)[-2]}"' if text.count("'") > 1 else ""
        yield Flaw("fields", f"{task.id}: {text}", location_of(path, name))


def misspelled_topics(
    task: Task, scenarios: Iterable[Scenario], names: Collection[str], path: Path
) -> Iterator[Flaw]:
    """Yield a flaw for each input topic that the solution lacks, if it has one with a similar name.

    Other names are not flaws, because a TransformListener subscribes to topics that its code does
    not mention, and a name may be composed at run time.
    """
    for topic in dict.fromkeys(message.topic for scenario in scenarios for message in scenario.inputs):
        name = topic.strip("/").removesuffix("/set_parameters")
        parts = {name, *name.split("/")}
        similar_names = get_close_matches(name, names, n=1, cutoff=SIMILAR)
        if parts.isdisjoint(names) and f"/{name}" not in IMPLICIT_TOPICS and similar_names:
            text = f"the solution does not use the input topic {topic!r}. Did you mean {similar_names[0]}?"
            yield Flaw("fields", f"{task.id}: {text}", location_of(path, f'"{topic}"'))


def misspelled_names(
    task: Task, scenarios: Iterable[Scenario], types: Mapping[tuple[str, str], str]
) -> Iterator[Flaw]:
    """Yield a flaw for each message type, field or marker type in a check that does not exist.

    Args:
        task: The task.
        scenarios: The task's scenarios.
        types: The message type that the solution publishes, by task and topic.
    """
    checks = [check for scenario in scenarios for check in scenario.checks]
    for check in (part for whole in checks for part in (whole, *whole.requires)):
        if check.origin is not None and (text := _misspelling(task, check.origin, types)):
            yield Flaw("fields", f"{task.id}: {text}", check.origin.location)


def _misspelling(task: Task, origin: Origin, types: Mapping[tuple[str, str], str]) -> str:
    arguments = origin.arguments
    type_name = arguments.get("type")
    try:
        if origin.check_function == "expect_topic" and isinstance(type_name, str):
            definition(type_name)
        elif origin.check_function in ("expect_marker", "expect_marker_count") and isinstance(type_name, str):
            marker_types = definition(MARKER).constants
            if type_name not in marker_types:
                raise CourseError(
                    f"a marker has no type {type_name!r}{did_you_mean(type_name, marker_types)}"
                )
        elif origin.check_function == "expect_message" and (
            sent_type := types.get((task.id, arguments["topic"]))
        ):
            for dotted in arguments["fields"]:
                _check_field(sent_type, dotted)
    except CourseError as error:
        return f"{origin.check_function}: {error}"
    return ""


def _check_field(type_name: str, dotted: str) -> None:
    """Resolve a dotted field name through the message types.

    Raises:
        CourseError: A message type does not have the field.
    """
    at = type_name
    for part in dotted.split("."):
        if part.isdecimal():
            continue
        fields = {field.name: field for field in definition(at).fields} if "/" in at else {}
        if part not in fields:
            alternatives = did_you_mean(part, fields) or f"; it has {', '.join(fields) or 'no fields'}"
            raise CourseError(f"{at} has no field {part!r} ({dotted!r}){alternatives}")
        at = fields[part].base
