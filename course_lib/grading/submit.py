"""`course submit`: one file to hand in, with a receipt."""

import json
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from course_lib.course.identity import current_identity
from course_lib.course.state import State, find_student_folder
from course_lib.errors import CourseError
from course_lib.grading.notebook import parse_notebook
from course_lib.grading.submission import NO_EXERCISE, RECEIPT, content_hash, unpack
from course_lib.grading.working_files import FOLDER, working_files


@dataclass(frozen=True)
class Receipt:
    """What was packed, and where it is."""

    file: Path
    content: Mapping[str, Any]

    def text(self) -> str:
        """What to tell the student."""
        rows = "".join(f"\n  {key:11} {value or 'none'}" for key, value in self.content.items())
        no_id = (
            "" if self.content["student"] else "\nIt names no student: give your ID in week 0, submit again."
        )
        return f"Wrote {self.file}: this is the file to hand in. Its receipt:{rows}{no_id}"


def submit(path: Path, out: Path | None = None) -> Receipt:
    """Pack an exercise with a receipt into `out`; default: beside it, named after it and the ID.

    Raises:
        CourseError: The notebook can't be read, is no exercise, or the file can't be written.
    """
    data, _ = unpack(path)
    notebook = parse_notebook(data, path.name)
    if notebook.exercise is None:
        raise CourseError(f"{path} {NO_EXERCISE}")
    student = notebook.student or current_identity()
    files = working_files(path, notebook.cells)
    receipt = {
        "exercise": notebook.exercise,
        "student": student,
        "file": path.name,
        "code cells": len(notebook.cells),
        "files": ", ".join(files),
        "sha256": content_hash(data, files),
        "time": datetime.now(UTC).isoformat(timespec="seconds"),
    }
    out = out or path.with_name(f"{notebook.exercise}_{student or 'no_id'}.zip")
    try:
        with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr(f"{notebook.exercise}.ipynb", data)
            archive.writestr(RECEIPT, json.dumps(receipt, indent=1))
            for name, text in files.items():
                archive.writestr(FOLDER + name, text)
    except OSError as error:
        raise CourseError(f"{out} can't be written: {error.strerror}. Name another: --out FILE") from error
    folder = find_student_folder(path.parent)
    if folder is not None:
        State(folder).put("packed", notebook.exercise, receipt["time"])
    return Receipt(out, receipt)
