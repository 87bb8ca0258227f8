"""Questions to the student: predictions and quizzes, as a widget or as text."""

import textwrap
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from course_lib.course.installation import exercises_dir
from course_lib.course.state import student_state
from course_lib.errors import CourseError, did_you_mean, place_of
from course_lib.surroundings import in_notebook

SECTION = "predictions"
KINDS = ("question", "prediction")  # the tables of a file
WIDTH = 88  # characters that fit beside the file browser; JupyterLab breaks longer lines inside words


def show(build_widget: Callable[[], Any], text: str) -> None:
    """Display the widget that `build_widget()` makes; without widgets its `text`; in a script print that."""
    if not in_notebook():
        print(text)  # noqa: T201  a script's page is its terminal
        return
    from IPython.display import display

    bundle = build_widget()._repr_mimebundle_()
    display({**bundle, "text/plain": text}, raw=True)  # type: ignore[no-untyped-call]  # IPython has no types here


@dataclass(frozen=True)
class Answer:
    """One answer to choose, and why it is right or wrong."""

    text: str
    reason: str
    right: bool


@dataclass(frozen=True)
class Question:
    """A question and its answers in the order shown; exactly one is right."""

    text: str
    answers: tuple[Answer, ...]
    key: str = ""  # of a prediction

    @property
    def right(self) -> Answer:
        """The right answer."""
        return next(answer for answer in self.answers if answer.right)

    def answer(self, text: str | None) -> Answer | None:
        """Return the answer with this text, or None."""
        return next((answer for answer in self.answers if answer.text == text), None)


def load_quiz(name: str) -> tuple[Question, ...]:
    """Read the questions in `exercises/quizzes/<name>.toml`.

    Raises:
        CourseError: no such quiz, or a question without exactly one right answer.
    """
    return _load(name, "question")


def load_predictions(name: str) -> tuple[Question, ...]:
    """Read the predictions of a lesson, e.g. "week01"."""
    return _load(name, "prediction")


def load_prediction(key: str) -> Question:
    """Read the prediction "week01.top": the one with key "top" in `exercises/quizzes/week01.toml`.

    Raises:
        CourseError: no such prediction, or one without exactly one right answer.
    """
    name, _, wanted = key.partition(".")
    predictions = {question.key: question for question in load_predictions(name)}
    if wanted not in predictions:
        known = ", ".join(f"{name}.{other}" for other in predictions) or "none"
        raise CourseError(f"there is no prediction {key!r}. Predictions of {name}: {known}")
    return predictions[wanted]


def _load(name: str, kind: str) -> tuple[Question, ...]:
    folder = exercises_dir() / "quizzes"
    path = folder / f"{name}.toml"
    if not path.is_file():
        known = ", ".join(sorted(quiz.stem for quiz in folder.glob("*.toml")))
        raise CourseError(f"there is no quiz {name!r}. Quizzes: {known}")
    return read_questions(path, kind)


def read_questions(path: Path, kind: str) -> tuple[Question, ...]:
    """Read the questions of a file, of the kind "question" or "prediction".

    Raises:
        CourseError: The file is malformed, or a question has not exactly one right answer.
    """
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise CourseError(f"{path} is not TOML: {error}") from error
    for name, tables in content.items():
        place = place_of(path, f"[{name}")
        if name not in KINDS:
            meant = did_you_mean(name, KINDS) or f", known: {', '.join(KINDS)}"
            raise CourseError(f"{place}: there is no table {name!r}{meant}")
        if not isinstance(tables, list) or not all(isinstance(table, dict) for table in tables):
            raise CourseError(f"{place}: expected [[{name}]] before each {name}")
    return tuple(_checked(path, kind, table) for table in content.get(kind, []))


def _checked(path: Path, kind: str, table: dict[str, Any]) -> Question:
    place = place_of(path, str(table.get("text", ""))[:40])
    try:
        question = _question_of(table)
    except (KeyError, TypeError) as error:
        raise CourseError(f"{place}: a {kind} or one of its answers has no {error}") from error
    for text in (question.text, question.key, *(t for a in question.answers for t in (a.text, a.reason))):
        if not isinstance(text, str):
            raise CourseError(f"{place}: {text!r}, expected a text in quotes")
    if wrong := [answer.right for answer in question.answers if not isinstance(answer.right, bool)]:
        raise CourseError(f"{place}: right = {wrong[0]!r}, expected true or false")
    count = sum(answer.right for answer in question.answers)
    if count != 1:
        raise CourseError(
            f"{place}: {question.text!r} needs exactly one answer with right = true, it has {count}"
        )
    return question


def _question_of(table: dict[str, Any]) -> Question:
    answers = tuple(Answer(a["text"], a["reason"], a.get("right", False)) for a in table["answer"])
    return Question(table["text"], answers, table.get("key", ""))


def predict(key: str) -> None:
    """Ask for a guess before the run; `compare` shows the answer.

    Args:
        key: The question, "week01.top".
    """
    question = load_prediction(key)
    kept = student_state().get(SECTION, key)
    lines = [f"Predict: {question.text}", *(f"   ( ) {answer.text}" for answer in question.answers)]
    show(lambda: _prediction_form(key, question, kept), "\n".join(lines))


def keep_prediction(key: str, guess: str) -> None:
    """Keep a guess in the student's folder."""
    student_state().put(SECTION, key, guess)


def compare(key: str, measured: str = "") -> None:
    """Print the guess with its reason, the right answer, and what the cell measured.

    Args:
        key: The question, as `predict` takes it.
        measured: A sentence with the values of this run.
    """
    question = load_prediction(key)
    guess = question.answer(student_state().get(SECTION, key))
    lines = ["You predicted: nothing yet (choose an answer above, then run this cell again)"]
    if guess is not None:
        lines = [f"You predicted: {guess.text}. {verdict(guess)}"]
    if guess is None or not guess.right:
        lines.append(f"What happened: {question.right.text}. {question.right.reason}")
    if measured:
        lines.append(f"Measured: {measured}")
    print("\n".join(textwrap.fill(line, WIDTH) for line in lines))  # noqa: T201  the cell's output


def _prediction_form(key: str, question: Question, kept: str | None) -> Any:
    import ipywidgets as widgets

    options = [answer.text for answer in question.answers]
    choice = widgets.RadioButtons(
        options=options, value=kept if kept in options else None, layout={"width": "max-content"}
    )
    said = widgets.Label("Kept. Now run the next cell." if kept else "Choose one; it is kept, not marked.")

    def keep(change: dict[str, Any]) -> None:
        if change["new"] is not None:
            keep_prediction(key, change["new"])
            said.value = "Kept. Now run the next cell."

    choice.observe(keep, names="value")
    return widgets.VBox([widgets.HTML(f"<b>Predict:</b> {question.text}"), choice, said])


def verdict(answer: Answer) -> str:
    """Return the text below a chosen answer; colour alone does not reach everybody."""
    return f"{'✔ Right.' if answer.right else '✘ Not this one.'} {answer.reason}"


def quiz(week: str) -> None:
    """Show the questions of a week, e.g. "week01"; nothing is kept or marked."""
    questions = load_quiz(week)
    show(lambda: _quiz_form(questions), as_text(questions))


def as_text(questions: tuple[Question, ...]) -> str:
    """Return the questions for a page without widgets."""
    lines = []
    for number, question in enumerate(questions, 1):
        lines += [f"{number}. {question.text}", *(f"   ( ) {answer.text}" for answer in question.answers)]
    return "\n".join(lines)


def _quiz_form(questions: tuple[Question, ...]) -> Any:
    import ipywidgets as widgets

    return widgets.VBox([_question(number, question) for number, question in enumerate(questions, 1)])


def _question(number: int, question: Question) -> Any:
    import ipywidgets as widgets

    texts = [answer.text for answer in question.answers]
    choice = widgets.RadioButtons(options=texts, index=None, layout={"width": "max-content"})
    said = widgets.HTML()
    wide = {"max_width": "52em"}

    def react(change: dict[str, Any]) -> None:
        if change["new"] is not None:
            said.value = verdict(question.answers[change["new"]])

    choice.observe(react, names="index")
    title = widgets.HTML(f"<b>{number}. {question.text}</b>", layout=wide)
    return widgets.VBox([title, choice, said], layout={"margin": "0 0 1em 0"})
