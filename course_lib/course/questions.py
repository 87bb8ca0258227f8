"""Questions to the student, predictions and quizzes, as widgets or as text."""

import textwrap
import tomllib
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any, NamedTuple

from course_lib.course.material import exercises_dir
from course_lib.course.state import student_state
from course_lib.errors import CourseError, did_you_mean, location_of
from course_lib.host import in_notebook
from course_lib.third_party import read_text

SECTION = "predictions"
# The section of the student's state for answers to quizzes.
ANSWERS = "answers"
# What `compare` shows before a prediction is made.
NO_PREDICTION = "No prediction yet. Choose an answer above: what happened then appears here."
# The line below questions without an answer, on pages without a kernel.
HOW_TO_ANSWER = "To answer, run this cell in JupyterLab."
# The tables of a question file.
KINDS = ("question", "prediction")
# Columns that fit next to the file browser. JupyterLab would break longer lines inside words.
WIDTH = 88


def show(build_widget: Callable[[], Any], text: str) -> None:
    """Display the widget that `build_widget()` returns, with `text` for pages without widgets.

    A script prints the text.
    """
    if not in_notebook():
        print(text)  # noqa: T201  a script's page is its terminal
        return
    from IPython.display import display

    bundle = build_widget()._repr_mimebundle_()
    display({**bundle, "text/plain": text}, raw=True)


@dataclass(frozen=True)
class Form:
    """A widget with questions, and the same questions with the chosen answers as HTML and text.

    Pages without a kernel display the HTML, like nbviewer, GitHub and a notebook reopened on the
    next day.

    Args:
        widget: The widget for pages with a kernel.
        saved_output: Returns HTML and text with the current answers.
        on_answer: Functions to call after each answer.
    """

    widget: Any
    saved_output: Callable[[], tuple[str, str]]
    on_answer: list[Callable[[], None]]


def show_form(build: Callable[[], Form], text: str) -> None:
    """Display a form, and update its saved output after each answer. A script prints `text`."""
    if not in_notebook():
        print(text)  # noqa: T201  a script's page is its terminal
        return
    from IPython.display import display

    form = build()

    def bundle() -> dict[str, Any]:
        html, plain = form.saved_output()
        return {**form.widget._repr_mimebundle_(), "text/html": html, "text/plain": plain}

    handle: Any = display(bundle(), raw=True, display_id=True)
    form.on_answer.append(lambda: handle.update(bundle(), raw=True))


@dataclass(frozen=True)
class Answer:
    """A possible answer, and why it is right or wrong."""

    text: str
    reason: str
    right: bool


@dataclass(frozen=True)
class Question:
    """A question with its answers in the order of display. Exactly one answer is right."""

    text: str
    answers: tuple[Answer, ...]
    # Set for predictions only.
    key: str = ""

    @property
    def right(self) -> Answer:
        """The right answer."""
        return next(answer for answer in self.answers if answer.right)

    def answer(self, text: str | None) -> Answer | None:
        """Return the answer with this text, or None."""
        return next((answer for answer in self.answers if answer.text == text), None)


def read_quiz(name: str, kind: str = "question") -> tuple[Question, ...]:
    """Read the questions in `exercises/quizzes/<name>.toml`, or its predictions.

    Raises:
        CourseError: The quiz does not exist, or a question does not have exactly one right answer.
    """
    folder = exercises_dir() / "quizzes"
    path = folder / f"{name}.toml"
    if not path.is_file():
        known_quizzes = ", ".join(sorted(quiz.stem for quiz in folder.glob("*.toml")))
        raise CourseError(f"there is no quiz {name!r}. Quizzes: {known_quizzes}")
    return read_questions(path, kind)


def read_prediction(key: str) -> Question:
    """Read the prediction "week01.top", which has the key "top" in `exercises/quizzes/week01.toml`.

    Raises:
        CourseError: The prediction does not exist or does not have exactly one right answer.
    """
    name, _, question_key = key.partition(".")
    predictions = {question.key: question for question in read_quiz(name, "prediction")}
    if question_key not in predictions:
        known_keys = ", ".join(f"{name}.{other}" for other in predictions) or "none"
        raise CourseError(f"there is no prediction {key!r}. Predictions of {name}: {known_keys}")
    return predictions[question_key]


def read_questions(path: Path, kind: str) -> tuple[Question, ...]:
    """Read the questions of a file. `kind` is "question" or "prediction".

    Raises:
        CourseError: The file is malformed, or a question does not have exactly one right answer.
    """
    try:
        content = tomllib.loads(read_text(path))
    except ValueError as error:
        raise CourseError(f"{path} is not TOML: {error}") from error
    for name, tables in content.items():
        place = location_of(path, f"[{name}")
        if name not in KINDS:
            suggestion = did_you_mean(name, KINDS) or f", known: {', '.join(KINDS)}"
            raise CourseError(f"{place}: there is no table {name!r}{suggestion}")
        if not isinstance(tables, list) or not all(isinstance(table, dict) for table in tables):
            raise CourseError(f"{place}: expected [[{name}]] before each {name}")
    return tuple(_parse_question(path, kind, table) for table in content.get(kind, []))


def _parse_question(path: Path, kind: str, table: dict[str, Any]) -> Question:
    place = location_of(path, str(table.get("text", ""))[:40])
    try:
        answers = tuple(Answer(a["text"], a["reason"], a.get("right", False)) for a in table["answer"])
        question = Question(table["text"], answers, table.get("key", ""))
    except (KeyError, TypeError) as error:
        raise CourseError(f"{place}: a {kind} or one of its answers has no {error}") from error
    for text in (question.text, question.key, *(t for a in question.answers for t in (a.text, a.reason))):
        if not isinstance(text, str):
            raise CourseError(f"{place}: {text!r}, expected a string in quotes")
    if wrong := [answer.right for answer in question.answers if not isinstance(answer.right, bool)]:
        raise CourseError(f"{place}: right = {wrong[0]!r}, expected true or false")
    count = sum(answer.right for answer in question.answers)
    if count != 1:
        raise CourseError(
            f"{place}: {question.text!r} needs exactly one answer with right = true, but has {count}"
        )
    return question


def predict(key: str) -> None:
    """Show a question to answer before running a cell. Afterwards, `compare` shows the result.

    Args:
        key: The prediction's key, like "week01.top".
    """
    question = read_prediction(key)
    saved_answer = student_state().get(SECTION, key)
    lines = [f"Predict: {question.text}", *(f"   ( ) {answer.text}" for answer in question.answers)]
    show_form(lambda: _prediction_form(key, question, saved_answer), "\n".join(lines))


def compare(key: str, measured: str = "") -> None:
    """Show the prediction with its explanation, the right answer, and the measured value.

    In a notebook without a prediction, the answer is held back until one is chosen.

    Args:
        key: The key passed to `predict`.
        measured: A sentence with the values of this run.
    """
    question = read_prediction(key)
    guess = question.answer(student_state().get(SECTION, key))
    if guess is None and in_notebook():
        show_form(lambda: _comparison_after_choice(key, question, measured), "")
    else:
        comparison = _comparison(question, guess, measured)
        show(lambda: comparison, str(comparison))


@dataclass(frozen=True)
class Comparison:
    """The lines that `compare` shows: as paragraphs in a notebook, wrapped in a terminal."""

    lines: tuple[str, ...]

    def __str__(self) -> str:
        return "\n".join(textwrap.fill(line, WIDTH) for line in self.lines)

    @property
    def html(self) -> str:
        """The lines as HTML without styles, which Jupyter removes from untrusted notebooks."""
        return f"<p>{'<br>'.join(map(escape, self.lines))}</p>"

    def _repr_mimebundle_(self, **_: object) -> dict[str, str]:
        return {"text/html": self.html, "text/plain": str(self)}


def _comparison(question: Question, guess: Answer | None, measured: str) -> Comparison:
    lines = [f"You predicted: {guess.text}. {verdict(guess)}" if guess else "You predicted: nothing"]
    if guess is None or not guess.right:
        lines.append(f"What happened: {question.right.text}. {question.right.reason}")
    if measured:
        lines.append(f"Measured: {measured}")
    return Comparison(tuple(lines))


# Functions that show the answers withheld by `compare`, by the prediction's key.
_waiting: dict[str, Callable[[], None]] = {}


def _comparison_after_choice(key: str, question: Question, measured: str) -> Form:
    """Return a form that shows a comparison as soon as a prediction is chosen."""
    import ipywidgets as widgets

    output = widgets.HTML(f"<b>{NO_PREDICTION}</b>")
    on_answer: list[Callable[[], None]] = []

    def reveal() -> None:
        output.value = paragraph(comparison().html)
        for call in on_answer:
            call()

    def comparison() -> Comparison:
        return _comparison(question, question.answer(student_state().get(SECTION, key)), measured)

    def saved_output() -> tuple[str, str]:
        if student_state().get(SECTION, key) is None:
            return f"<p>{NO_PREDICTION}</p>", NO_PREDICTION
        return comparison().html, str(comparison())

    # A cell that runs again replaces its output.
    _waiting[key] = reveal
    return Form(output, saved_output, on_answer)


# ipywidgets gives each option one line, of which a narrow window shows the beginning.
# The buttons of a question follow the text, and float to the left.
_CHOICE_STYLE = """<style>.course-choice .widget-radio-box label { display: flex; flex-direction: row-reverse;
justify-content: flex-end; align-items: flex-start; height: auto; white-space: normal; }
.course-choice .widget-radio-box input { flex: none; }</style>"""


def _radio_buttons(**options: Any) -> Any:
    """Return radio buttons that break long options; the title above them brings their style."""
    import ipywidgets as widgets

    choice = widgets.RadioButtons(layout={"width": "max-content", "max_width": "100%"}, **options)
    choice.add_class("course-choice")
    return choice


def _prediction_form(key: str, question: Question, saved_answer: str | None) -> Form:
    import ipywidgets as widgets

    options = [answer.text for answer in question.answers]
    choice = _radio_buttons(options=options, value=saved_answer if saved_answer in options else None)
    status = widgets.Label(
        "Kept. Now run the next cell." if saved_answer else "Choose one; it is kept, not marked."
    )
    on_answer: list[Callable[[], None]] = []

    def keep(change: dict[str, Any]) -> None:
        if change["new"] is not None:
            student_state().put(SECTION, key, change["new"])
            reveal = _waiting.get(key)
            status.value = "Kept. See the result below." if reveal else "Kept. Now run the next cell."
            for call in on_answer:
                call()
            if reveal:
                reveal()

    def saved_output() -> tuple[str, str]:
        chosen = question.answer(choice.value)
        return _saved_output([AnsweredQuestion(f"Predict: {question.text}", question, chosen)])

    choice.observe(keep, names="value")
    title = widgets.HTML(_CHOICE_STYLE + paragraph(f"<b>Predict:</b> {question.text}"))
    form = widgets.VBox([title, choice, status])
    return Form(form, saved_output, on_answer)


def paragraph(html: str) -> str:
    """Return HTML with a small line height: ipywidgets' lines are as high as a button."""
    return f'<div style="line-height: 1.4; padding: 4px 0">{html}</div>'


def verdict(answer: Answer) -> str:
    """Return the feedback below a chosen answer.

    It contains a sign and words, because not everybody sees colors.
    """
    return f"{'✔ Right.' if answer.right else '✘ Not this one.'} {answer.reason}"


def quiz(week: str) -> None:
    """Show the questions of a week.

    The answers are stored in the student's folder and not marked.

    Args:
        week: The name of the quiz, like "week01".

    Raises:
        CourseError: There is no quiz of this name.
    """
    questions = read_quiz(week)
    rows = [AnsweredQuestion(f"{n}. {question.text}", question) for n, question in enumerate(questions, 1)]
    show_form(lambda: _quiz_form(week, questions), _as_text(rows))


class AnsweredQuestion(NamedTuple):
    """A question as a page without a kernel displays it."""

    title: str
    question: Question
    chosen: Answer | None = None
    # The verdict on the chosen answer.
    below: str = ""


def _saved_output(rows: Sequence[AnsweredQuestion]) -> tuple[str, str]:
    """Return questions as HTML and as text for pages without a kernel."""
    if all(row.chosen for row in rows):
        return _as_html(rows), _as_text(rows)
    return f"{_as_html(rows)}\n<p>{HOW_TO_ANSWER}</p>", f"{_as_text(rows)}\n{HOW_TO_ANSWER}"


def _as_text(rows: Iterable[AnsweredQuestion]) -> str:
    lines = []
    for title, question, chosen, below in rows:
        lines.append(title)
        lines += [f"   ({'x' if answer is chosen else ' '}) {answer.text}" for answer in question.answers]
        lines += [f"   {below}"] * bool(below)
    return "\n".join(lines)


def _as_html(rows: Iterable[AnsweredQuestion]) -> str:
    """Return the questions as HTML without styles and scripts.

    Jupyter removes these from a notebook that is not trusted.
    """
    parts = []
    for title, question, chosen, below in rows:
        marks = (
            ("◉", f"<b>{escape(a.text)}</b>") if a is chosen else ("○", escape(a.text))
            for a in question.answers
        )
        answers = "<br>".join(f"{mark} {text}" for mark, text in marks)
        parts.append(f"<p><b>{title}</b><br>{answers}{f'<br>{escape(below)}' if below else ''}</p>")
    return "\n".join(parts)


def _quiz_form(week: str, questions: tuple[Question, ...]) -> Form:
    import ipywidgets as widgets

    saved_answers = student_state().section(ANSWERS)
    on_answer: list[Callable[[], None]] = []
    boxes, choices = [], []
    for number, question in enumerate(questions, 1):
        key = f"{week}.{number}"
        box, choice = _question(number, question, question.answer(saved_answers.get(key)), key, on_answer)
        boxes.append(box)
        choices.append(choice)

    def saved_output() -> tuple[str, str]:
        rows: list[AnsweredQuestion] = []
        for number, (question, choice) in enumerate(zip(questions, choices, strict=True), 1):
            chosen = None if choice.index is None else question.answers[choice.index]
            below = verdict(chosen) if chosen else ""
            rows.append(AnsweredQuestion(f"{number}. {question.text}", question, chosen, below))
        return _saved_output(rows)

    return Form(widgets.VBox(boxes), saved_output, on_answer)


def _question(
    number: int,
    question: Question,
    saved_answer: Answer | None,
    key: str,
    on_answer: list[Callable[[], None]],
) -> tuple[Any, Any]:
    """Return the box of a question, and its radio buttons."""
    import ipywidgets as widgets

    texts = [answer.text for answer in question.answers]
    index = question.answers.index(saved_answer) if saved_answer else None
    choice = _radio_buttons(options=texts, index=index)
    feedback = widgets.HTML(paragraph(verdict(saved_answer)) if saved_answer else "")
    wide = {"max_width": "52em"}

    def react(change: dict[str, Any]) -> None:
        if change["new"] is not None:
            answer = question.answers[change["new"]]
            feedback.value = paragraph(verdict(answer))
            student_state().put(ANSWERS, key, answer.text)
            for call in on_answer:
                call()

    choice.observe(react, names="index")
    title = widgets.HTML(_CHOICE_STYLE + paragraph(f"<b>{number}. {question.text}</b>"), layout=wide)
    return widgets.VBox([title, choice, feedback], layout={"margin": "0 0 1em 0"}), choice
