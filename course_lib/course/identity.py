"""The student's ID: asked once in week 0, kept in the student's folder, stamped into the exercises."""

import hashlib
import unicodedata
from typing import Any

from course_lib.course.exercise import stamp_exercises
from course_lib.course.questions import show
from course_lib.course.state import student_state
from course_lib.errors import CourseError, counted
from course_lib.surroundings import in_notebook

MAX_LENGTH = 64
EXTRA_CHARACTERS = "-_.@"


def normalise(text: str) -> str:
    """Normalise an ID to one spelling: no spaces, small letters, digits of any script as 0-9.

    Raises:
        CourseError: nothing is left, or something that does not belong into an ID (it also names folders).
    """
    plain = unicodedata.normalize("NFKC", str(text)).casefold()
    student = "".join(str(unicodedata.digit(c, c)) for c in plain if not c.isspace())
    strange = sorted({c for c in student if not (c.isalnum() or c in EXTRA_CHARACTERS)})
    if not student or strange or len(student) > MAX_LENGTH or not student[0].isalnum():
        raise CourseError(
            f"{text!r} is not a student ID: expected up to {MAX_LENGTH} letters, digits and "
            f"{' '.join(EXTRA_CHARACTERS)}, the first a letter or a digit. Example: 20231234"
        )
    return student


def current_identity() -> str | None:
    """Return the ID kept in the student's folder, or None."""
    kept = student_state().get("identity", "student")
    return kept if isinstance(kept, str) else None


def set_identity(text: str) -> str:
    """Keep this ID, stamp it into the exercises of the student's folder, and say what was kept."""
    student, state = normalise(text), student_state()
    state.put("identity", "student", student)
    where = "while this kernel lives"
    if state.folder:
        exercises = counted(len(stamp_exercises(state.folder, student)), "exercise")
        where = f"in {state.folder} and in {exercises}"
    return f"Your ID is {student}, kept {where}. To change it: set_identity('another-id')"


def personal_number(student: str | None, key: str, choices: int) -> int:
    """Return a number from 0 to choices - 1 by a hash of the student and `key`; None is a guest."""
    digest = hashlib.sha256(f"{student or 'guest'}/{key}".encode()).digest()
    return int.from_bytes(digest[:8], "big") % choices


def ask_identity() -> None:
    """Ask for the ID with a small form, once; where nobody can answer, say how to give it."""
    known = current_identity()
    if known:
        text = f"Your ID is {known}. To change it: set_identity('another-id')"
    elif in_notebook():
        text = "Type your student ID and press Enter or Keep."
    else:
        text = "No page to ask in, so your student ID is not set. Type: set_identity('your-id')"
    show(lambda: _form(known, text), text)


def _form(known: str | None, text: str) -> Any:
    import ipywidgets as widgets

    field = widgets.Text(
        value=known or "", description="Student ID", placeholder="20231234", continuous_update=False
    )
    button = widgets.Button(description="Keep", tooltip="Keep this student ID", button_style="primary")
    answer = widgets.Label(value=text)

    def keep(_: object) -> None:
        try:
            answer.value = set_identity(field.value)
        except CourseError as error:
            answer.value = str(error)

    button.on_click(keep)
    field.observe(keep, "value")  # Enter, or leaving the field
    return widgets.VBox([widgets.HBox([field, button]), answer])
