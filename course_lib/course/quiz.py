"""A quiz for learning: one question after the other, a reason for every answer, no marks."""

import tomllib
from dataclasses import dataclass
from typing import Any

from course_lib.course.files import exercises_dir
from course_lib.course.page import show
from course_lib.errors import CourseError


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
    """The questions in `exercises/quizzes/<week>.toml`.

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
    """What is said to a chosen answer: in words, since colour alone does not reach everybody."""
    return f"{'✔ Right.' if answer.right else '✘ Not this one.'} {answer.reason}"


def quiz(week: str) -> None:
    """Show the questions of a week, e.g. "week01"; nothing is kept or marked."""
    questions = load_quiz(week)
    show(lambda: _form(questions), as_text(questions))


def as_text(questions: tuple[Question, ...]) -> str:
    """The questions for a page without widgets."""
    lines = []
    for number, question in enumerate(questions, 1):
        lines += [f"{number}. {question.text}", *(f"   ( ) {answer.text}" for answer in question.answers)]
    return "\n".join(lines)


def _form(questions: tuple[Question, ...]) -> Any:
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
