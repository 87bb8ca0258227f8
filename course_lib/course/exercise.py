"""Exercise notebooks, which are created from solutions, and the student's ID in them.

A solution marks each answer with a comment. The exercise is the same notebook in which these
answers raise an exception, so that task and solution cannot differ.
"""

import copy
import hashlib
import json
import re
import sys
import unicodedata
from collections.abc import Mapping
from contextlib import suppress
from html import escape
from pathlib import Path
from typing import Any

from course_lib.course.material import exercises_dir, solutions_dir
from course_lib.course.questions import paragraph, show
from course_lib.course.state import memory_span, student_state
from course_lib.errors import CourseError, did_you_mean, format_count
from course_lib.files import write_atomically
from course_lib.host import in_notebook, send_to_page
from course_lib.third_party import read_bytes, read_json, read_text

Notebook = dict[str, Any]
BEGIN = re.compile(r"^(?P<indent>\s*)# solution: (?P<missing>.+)$")
END = "# end of solution"
# Maximum number of notebooks that an error message lists.
MAX_NAMES = 12


def find_notebook(path: Path) -> Path:
    """Return a notebook's path, which may be given without .ipynb.

    Raises:
        CourseError: The file does not exist, but one with a similar name does.
    """
    with_suffix = path.with_name(f"{path.name}.ipynb") if path.name else path
    if with_suffix.is_file() and not path.is_file():
        return with_suffix
    if not path.exists():
        folder = path.parent
        notebooks = (*folder.glob("*.ipynb"), *folder.glob("*/week*_exercise.ipynb"))
        # A broken symbolic link is listed, too.
        candidates = [str(notebook) for notebook in notebooks if notebook.exists()]
        matches = [name for name in candidates if Path(name).name.startswith(f"{path.name}_exercise.")]
        matches += [name for name in candidates if _exercise_of(Path(name)) == path.stem]
        if suggestion := did_you_mean(matches[0] if matches else str(path), candidates):
            raise CourseError(f"there is no {path}{suggestion}")
        if path.name == str(path) and not notebooks:
            raise CourseError(
                f"there is no {path} in {Path.cwd()}. Go to your course folder first, like cd ~/my_course, "
                "then type the command again."
            )
    return path


def _exercise_of(path: Path) -> str | None:
    """Return the exercise in a notebook's metadata, which a renamed notebook keeps."""
    with suppress(CourseError, OSError, AttributeError):
        exercise = read_notebook(path)["metadata"].get("course", {}).get("exercise")
        return exercise if isinstance(exercise, str) else None
    return None


def read_notebook(path: Path) -> Notebook:
    """Read a notebook as plain data.

    Raises:
        CourseError: The file is missing, not JSON, or not a notebook of format 4.
    """
    try:
        notebook = read_json(read_bytes(path))
    except FileNotFoundError as error:
        names = sorted(file.name for file in path.parent.glob("*.ipynb"))
        shown = ", ".join([*names[:MAX_NAMES], *["…"] * (len(names) > MAX_NAMES)])
        others = f" Its folder has {shown}." if names else ""
        raise CourseError(f"There is no notebook {path}.{others}") from error
    except (OSError, ValueError) as error:
        raise CourseError(
            f"{path} can't be read as a notebook: {error}. Save it again in JupyterLab, or replace it."
        ) from error
    cells = notebook.get("cells") if isinstance(notebook, dict) and notebook.get("nbformat") == 4 else None
    if not isinstance(cells, list) or not all(isinstance(cell, dict) for cell in cells):
        raise CourseError(f"{path} is not a notebook of format 4. Save it again in JupyterLab.")
    return dict(notebook)


def notebook_text(notebook: Notebook) -> str:
    """Return the file's text in Jupyter's format: indented by 1, with sorted keys and unescaped Unicode."""
    return json.dumps(notebook, indent=1, ensure_ascii=False, sort_keys=True) + "\n"


def code_cells(notebook: Notebook) -> list[tuple[int, dict[str, Any]]]:
    """Return the code cells with their numbers. As in JupyterLab, all cells are counted."""
    numbered = enumerate(notebook["cells"], 1)
    return [(number, cell) for number, cell in numbered if cell.get("cell_type") == "code"]


def source(cell: Mapping[str, Any]) -> str:
    """Return a cell's source as one string.

    The file format allows a string or a list of lines. Anything else in a damaged file is ignored.
    """
    text = cell.get("source", "")
    lines = text if isinstance(text, list) else [text]
    return "".join(line for line in lines if isinstance(line, str)).encode("utf-8", "replace").decode()


def stamp(notebook: Notebook, student: str) -> bool:
    """Store the student's ID in the notebook's metadata. Return whether the metadata changed."""
    course = notebook.setdefault("metadata", {}).setdefault("course", {})
    is_changed = course.get("student") != student
    course["student"] = student
    return bool(is_changed)


def stamp_exercises(folder: Path, student: str) -> list[Path]:
    """Store the ID in all exercises of the student's folder; skip files that are not notebooks.

    An open notebook in JupyterLab gets it, too. JupyterLab compares the hash of a file with the one
    that it has read or written, and would ask at the next save which of both versions to discard.
    """
    exercises = []
    # Hashes of the new files by the hashes of the files that they replace.
    replaced: dict[str, str] = {}
    try:
        for path in sorted(folder.glob("week*_exercise*.ipynb")):
            try:
                before = hashlib.sha256(read_bytes(path)).hexdigest()
                notebook = read_notebook(path)
            except (CourseError, OSError):
                # `course check` reports these errors. They must not prevent a student from setting
                # the ID.
                continue
            exercises.append(path)
            if stamp(notebook, student):
                text = notebook_text(notebook).encode()
                write_atomically(path, text)
                replaced[before] = hashlib.sha256(text).hexdigest()
    finally:
        if replaced:
            send_to_page("course-lib:identity", {"student": student, "replaced": replaced})
    return exercises


def stub(code: str) -> str:
    """Replace the answers in a code cell by an exception whose message describes the missing part.

    Raises:
        CourseError: An answer begins inside another one or does not end.
    """
    lines: list[str] = []
    opened = ""
    for line in code.splitlines():
        begin = BEGIN.match(line)
        if (begin and opened) or (line.strip() == END and not opened):
            raise CourseError(
                f"{line.strip()!r} is in the wrong place: expected '# solution: …', the answer, then {END!r}."
            )
        if begin:
            opened = line.strip()
            lines.append(f'{begin["indent"]}raise NotImplementedError("{begin["missing"]}")')
        elif line.strip() == END:
            opened = ""
        elif not opened:
            lines.append(line)
    if opened:
        raise CourseError(f"an answer is not closed: write {END!r} after the line {opened!r}")
    return "\n".join(lines)


def exercise_from(solution: Notebook) -> Notebook:
    """Return the exercise of a solution: without answers, outputs and cells for instructors.

    Raises:
        CourseError: The markers of an answer are wrong. The message names the cell.
    """
    exercise = copy.deepcopy(solution)
    exercise["cells"] = [
        c for c in exercise["cells"] if "solution" not in c.get("metadata", {}).get("tags", [])
    ]
    for cell in exercise["cells"]:
        if cell.get("cell_type") == "code":
            try:
                cell["source"] = stub(source(cell)).splitlines(keepends=True)
            except CourseError as error:
                begin = source(cell).strip().partition("\n")[0]
                raise CourseError(f"in the cell that begins with {begin!r}, {error}") from error
            cell["outputs"], cell["execution_count"] = [], None
    return exercise


def exercise_path(solution: Path) -> Path:
    """Return the path of a solution's exercise, like exercises/week01_exercise.ipynb."""
    return exercises_dir() / solution.name.replace("_solution", "_exercise")


def write_exercises() -> list[Path]:
    """Write all exercises from their solutions. Return the files that changed."""
    written_paths = []
    for solution in sorted(solutions_dir().glob("week*_solution.ipynb")):
        path = exercise_path(solution)
        try:
            text = notebook_text(exercise_from(read_notebook(solution)))
        except CourseError as error:
            raise CourseError(f"{solution}: {error}") from error
        if not path.exists() or read_text(path) != text:
            write_atomically(path, text.encode())
            written_paths.append(path)
    return written_paths


def main() -> None:
    """Write the exercises and print the files that changed. An error is printed as one line."""
    try:
        written_paths = write_exercises()
    except CourseError as error:
        sys.exit(f"error: {error}")
    for path in written_paths:
        print(f"wrote {path}")  # noqa: T201  this is the command's answer


if __name__ == "__main__":
    main()


MAX_LENGTH = 64
EXTRA_CHARACTERS = "-_.@"
# Marks that are invisible, unlike the accents and the vowels of Indic and other scripts.
INVISIBLE_MARKS = re.compile("[\u034f\u17b4\u17b5\u180b-\u180f\ufe00-\ufe0f\U000e0100-\U000e01ef]")


# The code that sets an ID, for messages.
SET_IDENTITY = "from course_lib import set_identity; set_identity('{}')"


def is_allowed_in_id(character: str) -> bool:
    """Return whether an ID may contain a character: letter, digit, combining mark, or -_.@."""
    is_mark = unicodedata.category(character) in ("Mn", "Mc")
    return character.isalnum() or is_mark or character in EXTRA_CHARACTERS


def normalise(text: str) -> str:
    """Normalize an ID: remove spaces, convert to lower case and digits of any script to 0-9.

    Invisible characters, such as the direction marks of copied text, are removed like spaces.
    Combining marks belong to their letter: without them, names in Indic scripts would lose vowels.

    Raises:
        CourseError: Nothing remains, or a character is not allowed. IDs are also used as names of
            folders.
    """
    student, before = str(text), ""
    # What is removed may separate a letter and its mark, so one round is not always enough.
    while student != before:
        before = student
        plain = INVISIBLE_MARKS.sub("", unicodedata.normalize("NFKC", before).casefold())
        visible = (c for c in plain if not c.isspace() and unicodedata.category(c) != "Cf")
        student = "".join(str(unicodedata.digit(c, c)) for c in visible)
    strange = [c for c in student if not is_allowed_in_id(c)]
    # A spreadsheet writes 4.1E+06, and pandas 4100001.0 in a column with empty cells.
    is_number = re.fullmatch(r"\d([.,]\d+)?e\+\d+|\d{3,}\.0", student)
    if not student or strange or len(student) > MAX_LENGTH or not student[0].isalnum() or is_number:
        advice = (
            " A spreadsheet has shortened this number: export the file again, and don't save it there."
            if is_number and "e" in student
            else " A program has read the ID as a number: read the column as text there."
        )
        raise CourseError(
            f"{text!r} is not a student ID: expected up to {MAX_LENGTH} letters, digits and "
            f"{' '.join(EXTRA_CHARACTERS)}, the first a letter or a digit. Example: 20231234"
            f"{advice if is_number else ''}"
        )
    return student


def current_identity() -> str | None:
    """Return the ID stored in the student's folder, or None."""
    identity = student_state().get("identity", "student")
    return identity if isinstance(identity, str) else None


def set_identity(text: str) -> str:
    """Store the ID, write it into the exercises of the student's folder, and return a confirmation.

    Args:
        text: The student ID, like "20231234".

    Raises:
        CourseError: It is not an ID, or an exercise cannot be written.
    """
    student, state = normalise(text), student_state()
    state.put("identity", "student", student)
    where, then = memory_span(), ""
    if state.folder and state.is_saved("identity"):
        where = f"in {state.folder}"
        try:
            stamped = stamp_exercises(state.folder, student)
        except OSError as error:
            raise CourseError(
                f"Your ID {student} is stored, but not in your exercises. {error.filename} cannot "
                f"be written: {error.strerror}. Correct that, then set your ID again."
            ) from None
        if stamped:
            where += f" and in {format_count(len(stamped), 'exercise')}"
            then = " If an editor says that an open one has changed on disk, choose Overwrite."
    return f"Your ID is {student}, stored {where}.{then}"


def personal_number(student: str | None, key: str, choices: int) -> int:
    """Return a number from 0 to choices - 1 from a hash of student and `key`. None is a guest."""
    digest = hashlib.sha256(f"{student or 'guest'}/{key}".encode()).digest()
    return int.from_bytes(digest[:8], "big") % choices


def ask_identity() -> None:
    """Show a form for the ID unless one is stored. Without a page, print how to set it."""
    identity = current_identity()
    if identity:
        text = f"Your ID is {identity}. To change it, type another one and press Enter or Keep."
    elif in_notebook():
        text = "Type your student ID and press Enter or Keep."
    else:
        command = SET_IDENTITY.format("your-id")
        text = f"No page shows the form, so your student ID is not set. Run: {command}"
    show(lambda: _form(identity, text), text)


def _form(identity: str | None, text: str) -> Any:
    import ipywidgets as widgets

    field = widgets.Text(
        value=identity or "", description="Student ID", placeholder="20231234", continuous_update=False
    )
    button = widgets.Button(description="Keep", tooltip="Keep this student ID", button_style="primary")
    # A label shows one line only.
    answer = widgets.HTML(paragraph(escape(text)))

    def keep(_: object) -> None:
        try:
            text = set_identity(field.value)
        except CourseError as error:
            text = str(error)
        answer.value = paragraph(escape(text))

    button.on_click(keep)
    # The value changes on Enter and when the field loses the focus.
    field.observe(keep, "value")
    return widgets.VBox([widgets.HBox([field, button]), answer])
