"""Exercise notebooks: read, stamped, and made from the solutions."""

import copy
import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from course_lib.course.installation import exercises_dir, solutions_dir
from course_lib.course.state import write_whole
from course_lib.errors import CourseError, did_you_mean
from course_lib.foreign import read_json

Notebook = dict[str, Any]
BEGIN = re.compile(r"^(?P<indent>\s*)# solution: (?P<missing>.+)$")
END = "# end of solution"


def find_notebook(path: Path) -> Path:
    """Return a notebook's path, which may have been typed without .ipynb.

    Raises:
        CourseError: There is no such file, but one of nearly the same name.
    """
    with_suffix = path.with_name(f"{path.name}.ipynb") if path.name else path
    if with_suffix.is_file() and not path.is_file():
        return with_suffix
    if not path.exists():
        folder = path.parent
        near = [str(one) for one in (*folder.glob("*.ipynb"), *folder.glob("*/week*_exercise.ipynb"))]
        begun = [one for one in near if Path(one).name.startswith(f"{path.name}_exercise.")]
        if meant := did_you_mean(begun[0] if begun else str(path), near):
            raise CourseError(f"there is no {path}{meant}")
    return path


def read_notebook(path: Path) -> Notebook:
    """Read a notebook as plain data.

    Raises:
        CourseError: it is missing, no JSON, or no notebook of format 4.
    """
    try:
        notebook = read_json(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise CourseError(f"{path} can't be read as a notebook: {error}") from error
    cells = notebook.get("cells") if isinstance(notebook, dict) and notebook.get("nbformat") == 4 else None
    if not isinstance(cells, list) or not all(isinstance(cell, dict) for cell in cells):
        raise CourseError(f"{path} is not a notebook of format 4. Save it again in JupyterLab.")
    return dict(notebook)


def notebook_text(notebook: Notebook) -> str:
    """Return the file's text in Jupyter's own layout: indent 1, keys sorted, non-ASCII as it is."""
    return json.dumps(notebook, indent=1, ensure_ascii=False, sort_keys=True) + "\n"


def code_cells(notebook: Notebook) -> list[tuple[int, dict[str, Any]]]:
    """Return the code cells with their numbers, as JupyterLab counts all cells."""
    numbered = enumerate(notebook["cells"], 1)
    return [(number, cell) for number, cell in numbered if cell.get("cell_type") == "code"]


def source(cell: Mapping[str, Any]) -> str:
    """Return a cell's text; the file format allows a string or a list of lines, a file may hold anything."""
    text = cell.get("source", "")
    lines = text if isinstance(text, list) else [text]
    return "".join(line for line in lines if isinstance(line, str)).encode("utf-8", "replace").decode()


def stamp(notebook: Notebook, student: str) -> bool:
    """Store the student's ID in the notebook's metadata; True if that changed it."""
    course = notebook.setdefault("metadata", {}).setdefault("course", {})
    changed = course.get("student") != student
    course["student"] = student
    return bool(changed)


def stamp_exercises(folder: Path, student: str) -> list[Path]:
    """Store the ID in every exercise of the student's folder; skip files that are not notebooks."""
    exercises = sorted(folder.glob("week*_exercise*.ipynb"))
    for path in exercises:
        try:
            notebook = read_notebook(path)
        except CourseError:
            continue  # `course check` names what is wrong with it; an ID can still be given
        if stamp(notebook, student):
            write_whole(path, notebook_text(notebook).encode())
    return exercises


def stub(code: str) -> str:
    """Replace the answers in a code cell by an exception that names the missing part.

    Raises:
        CourseError: an answer is opened twice or not closed.
    """
    lines: list[str] = []
    opened = False
    for line in code.splitlines():
        begin = BEGIN.match(line)
        if (begin and opened) or (line.strip() == END and not opened):
            raise CourseError(f"{line.strip()!r} does not fit: '# solution: …', the answer, then {END!r}.")
        if begin:
            opened = True
            lines.append(f'{begin["indent"]}raise NotImplementedError("{begin["missing"]}")')
        elif line.strip() == END:
            opened = False
        elif not opened:
            lines.append(line)
    if opened:
        raise CourseError(f"an answer is not closed: write {END!r} after it. The cell:\n{code}")
    return "\n".join(lines)


def exercise_from(solution: Notebook) -> Notebook:
    """Return the exercise of a solution: stubs for answers, no instructors' cells, no outputs."""
    exercise = copy.deepcopy(solution)
    exercise["cells"] = [
        c for c in exercise["cells"] if "solution" not in c.get("metadata", {}).get("tags", [])
    ]
    for cell in exercise["cells"]:
        if cell.get("cell_type") == "code":
            cell["source"] = stub(source(cell)).splitlines(keepends=True)
            cell["outputs"], cell["execution_count"] = [], None
    return exercise


def exercise_path(solution: Path) -> Path:
    """Return the path of a solution's exercise: week01_solution.ipynb -> exercises/week01_exercise.ipynb."""
    return exercises_dir() / solution.name.replace("_solution", "_exercise")


def write_exercises() -> list[Path]:
    """Write every exercise again from its solution; return the files that changed."""
    changed = []
    for solution in sorted(solutions_dir().glob("week*_solution.ipynb")):
        path = exercise_path(solution)
        try:
            text = notebook_text(exercise_from(read_notebook(solution)))
        except CourseError as error:
            raise CourseError(f"{solution}: {error}") from error
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            write_whole(path, text.encode())
            changed.append(path)
    return changed


if __name__ == "__main__":
    for made in write_exercises():
        print(f"wrote {made}")  # noqa: T201  this is the command's answer
