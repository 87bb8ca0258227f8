"""The exercise students get, made from the instructors' solution: `python -m course_lib.course.exercise`.

In a code cell everything from a line `# solution: <what is missing>` to a line `# end of solution`
becomes one `raise NotImplementedError("<what is missing>")`. Cells tagged `solution` are left out.
"""

import copy
import re
from pathlib import Path

from course_lib.course.exercise_file import Notebook, notebook_text, read_notebook, source
from course_lib.course.files import exercises_dir, solutions_dir
from course_lib.course.whole_file import write_whole
from course_lib.errors import CourseError

BEGIN = re.compile(r"^(?P<indent>\s*)# solution: (?P<missing>.+)$")
END = "# end of solution"


def stub(code: str) -> str:
    """One code cell with its answers replaced by the sentence that says what is missing.

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
    """The exercise notebook: stubs for answers, no instructors' cells, no outputs."""
    exercise = copy.deepcopy(solution)
    exercise["cells"] = [
        c for c in exercise["cells"] if "solution" not in c.get("metadata", {}).get("tags", [])
    ]
    for cell in exercise["cells"]:
        if cell["cell_type"] == "code":
            cell["source"] = stub(source(cell)).splitlines(keepends=True)
            cell["outputs"], cell["execution_count"] = [], None
    return exercise


def exercise_path(solution: Path) -> Path:
    """Where the exercise of a solution stands: week01_solution.ipynb -> exercises/week01_exercise.ipynb."""
    return exercises_dir() / solution.name.replace("_solution", "_exercise")


def write_exercises() -> list[Path]:
    """Make every exercise anew; returns the files that changed."""
    changed = []
    for solution in sorted(solutions_dir().glob("week*_solution.ipynb")):
        text, path = notebook_text(exercise_from(read_notebook(solution))), exercise_path(solution)
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            write_whole(path, text.encode())
            changed.append(path)
    return changed


if __name__ == "__main__":
    for made in write_exercises():
        print(f"wrote {made}")  # noqa: T201  this is the command's answer
