"""`course submit`: one file to hand in, with a receipt and with warnings."""

import json
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from course_lib.course.checked import Packed, keep_packed
from course_lib.course.exercise_file import find_notebook
from course_lib.course.folder import content_hash as digest_of_cells
from course_lib.course.identity import current_identity
from course_lib.course.state import State, find_student_folder
from course_lib.errors import CourseError
from course_lib.grading.before_hand_in import HandIn, report
from course_lib.grading.catalog import shipped_catalog
from course_lib.grading.notebook import Notebook, parse_notebook
from course_lib.grading.submission import NO_EXERCISE, RECEIPT, content_hash, unpack
from course_lib.grading.working_files import FOLDER, working_files

NO_ID = "It names no student: give your ID in week 0 (open week00_welcome.ipynb), submit again."


@dataclass(frozen=True)
class Receipt:
    """What was packed, where it is, and what to look at before it is handed in."""

    file: Path
    content: Mapping[str, Any]
    warnings: tuple[str, ...] = ()

    def text(self) -> str:
        """Return the lines for the student."""
        rows = "".join(f"\n  {key:11} {value or 'none'}" for key, value in self.content.items())
        no_id = "" if self.content["student"] else f"\n{NO_ID}"
        warned = report(self.warnings, self.content["file"])
        return f"Wrote {self.file}: this is the file to hand in. Its receipt:{rows}{no_id}{warned}"


def submit(path: Path, out: Path | None = None) -> Receipt:
    """Pack an exercise with a receipt into `out`; default: beside it, named after it and the ID.

    Raises:
        CourseError: The notebook can't be read, is no exercise, or the file can't be written.
    """
    path = find_notebook(path)
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
    _write(out, receipt, data, files)
    try:
        warnings = _remember(path, notebook, out, str(receipt["time"]))
    except CourseError as error:  # it is packed: what the folder remembers must not say otherwise
        warnings = [str(error)]
    return Receipt(out, receipt, tuple(warnings))


def _write(out: Path, receipt: Mapping[str, Any], data: bytes, files: Mapping[str, str]) -> None:
    try:
        with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr(f"{receipt['exercise']}.ipynb", data)
            archive.writestr(RECEIPT, json.dumps(receipt, indent=1))
            for name, text in files.items():
                archive.writestr(FOLDER + name, text)
    except OSError as error:
        raise CourseError(f"{out} can't be written: {error.strerror}. Name another: --out FILE") from error


def _remember(path: Path, notebook: Notebook, out: Path, time: str) -> list[str]:
    """Keep what was packed in the student's folder, for `course status`; return the warnings."""
    folder, exercise = find_student_folder(path.parent), notebook.exercise or ""
    state = State(folder)
    if folder is not None:
        state.put("packed", exercise, time)
    of_week = shipped_catalog().of_week(exercise.split("_")[0])
    hand_in = HandIn(path, notebook, of_week, state, state.get("identity", "student") or current_identity())
    if folder is not None and path.suffix == ".ipynb":
        tasks = tuple((name, one.outcome) for name, one in hand_in.tasks.items())
        files = str(out.resolve()), str(path.resolve())
        keep_packed(state, exercise, Packed(time, *files, digest_of_cells(path), tasks))
    return hand_in.warnings()
