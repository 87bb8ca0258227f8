"""Predict, then run: the student's guess is kept, and shown beside what happened."""

from collections.abc import Sequence
from typing import Any

from course_lib.course.page import show
from course_lib.course.state import student_state
from course_lib.errors import CourseError

SECTION = "predictions"


def predict(key: str, question: str, options: Sequence[str]) -> None:
    """Ask for a guess before the run; `key` (e.g. "week01.alpha") is what `compare` asks for later."""
    if len(options) < 2:
        raise CourseError(f"a prediction needs two options or more; {key!r} has {list(options)}")
    kept = student_state().get(SECTION, key)
    lines = [f"Predict: {question}", *(f"   ( ) {option}" for option in options)]
    show(lambda: _form(key, question, list(options), kept), "\n".join(lines))


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


def _form(key: str, question: str, options: list[str], kept: str | None) -> Any:
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
