"""Questions to the student: predictions and quizzes, as a widget or as text."""

import sys
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from course_lib.course.installation import exercises_dir
from course_lib.course.state import student_state
from course_lib.errors import CourseError

SECTION = "predictions"


def in_notebook() -> bool:
    """Return whether this code runs in a notebook's kernel."""
    ipython = sys.modules.get("IPython")
    return ipython is not None and hasattr(ipython.get_ipython(), "kernel")


def show(build_widget: Callable[[], Any], text: str) -> None:
    """Display the widget that `build_widget()` makes; without widgets its `text`; in a script print that."""
    if not in_notebook():
        print(text)  # noqa: T201  a script's page is its terminal
        return
    from IPython.display import display

    bundle = build_widget()._repr_mimebundle_()
    display({**bundle, "text/plain": text}, raw=True)  # type: ignore[no-untyped-call]  # IPython has no types here


def predict(key: str, question: str, options: Sequence[str]) -> None:
    """Ask for a guess before the run; `key` (e.g. "week01.alpha") is what `compare` asks for later."""
    if len(options) < 2:
        raise CourseError(f"a prediction needs two options or more; {key!r} has {list(options)}")
    kept = student_state().get(SECTION, key)
    lines = [f"Predict: {question}", *(f"   ( ) {option}" for option in options)]
    show(lambda: _prediction_form(key, question, list(options), kept), "\n".join(lines))


def keep_prediction(key: str, guess: str) -> None:
    """Keep a guess in the student's folder."""
    student_state().put(SECTION, key, guess)


def compare(key: str, result: str) -> None:
    """Print the guess kept under `key` beside the result."""
    guess = student_state().get(SECTION, key)
    if guess is None:
        said = "none yet (choose one above, then run this cell again)"
    else:
        said = f"{guess}   {'✔ as it happened' if guess == result else '→ look again at why'}"
    print(f"You predicted: {said}\nWhat happened: {result}")  # noqa: T201  the cell's output


def _prediction_form(key: str, question: str, options: list[str], kept: str | None) -> Any:
    import ipywidgets as widgets

    choice = widgets.RadioButtons(
        options=options, value=kept if kept in options else None, layout={"width": "max-content"}
    )
    said = widgets.Label("Kept. Now run the next cell." if kept else "Choose one; it is kept, not marked.")

    def keep(change: dict[str, Any]) -> None:
        if change["new"] is not None:
            keep_prediction(key, change["new"])
            said.value = "Kept. Now run the next cell."

    choice.observe(keep, names="value")
    return widgets.VBox([widgets.HTML(f"<b>Predict:</b> {question}"), choice, said])


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


def load_quiz(week: str) -> tuple[Question, ...]:
    """Read the questions in `exercises/quizzes/<week>.toml`.

    Raises:
        CourseError: no such quiz, or a question without exactly one right answer.
    """
    folder = exercises_dir() / "quizzes"
    path = folder / f"{week}.toml"
    if not path.is_file():
        known = ", ".join(sorted(quiz.stem for quiz in folder.glob("*.toml")))
        raise CourseError(f"there is no quiz {week!r}. Quizzes: {known}")
    tables = tomllib.loads(path.read_text(encoding="utf-8"))["question"]
    questions = tuple(
        Question(t["text"], tuple(Answer(a["text"], a["reason"], a.get("right", False)) for a in t["answer"]))
        for t in tables
    )
    for question in questions:
        if sum(answer.right for answer in question.answers) != 1:
            raise CourseError(f"{path}: {question.text!r} needs exactly one answer with right = true")
    return questions


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
