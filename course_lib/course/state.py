"""What the kit remembers for one student, as small JSON files in `WORK_DIR/.course/`."""

import json
from pathlib import Path
from typing import Any

from course_lib.course.whole_file import write_whole
from course_lib.errors import CourseError

STATE_FOLDER = ".course"


def find_student_folder(start: Path | None = None) -> Path | None:
    """The student's folder that holds `start` (default: the working directory), or None."""
    here = (start or Path.cwd()).resolve()
    return next((folder for folder in (here, *here.parents) if (folder / STATE_FOLDER).is_dir()), None)


class State:
    """Sections of keys and plain values. Without a folder it lives as long as the process."""

    def __init__(self, folder: Path | None) -> None:
        self.folder = folder
        self._memory: dict[str, dict[str, Any]] = {}

    def section(self, name: str) -> dict[str, Any]:
        """All keys of one section, e.g. "predictions"; empty if nothing was kept yet."""
        path = self._path(name)
        if path is None:
            return dict(self._memory.get(name, {}))
        try:
            kept = json.loads(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return {}
        except ValueError as error:
            raise CourseError(f"{path} is broken ({error}). Delete it and run the cell again.") from error
        return kept if isinstance(kept, dict) else {}

    def get(self, name: str, key: str, default: Any = None) -> Any:
        """One value of a section."""
        return self.section(name).get(key, default)

    def put(self, name: str, key: str, value: Any) -> None:
        """Keep one plain value (str, number, bool, list or dict of these)."""
        section = self.section(name) | {key: value}
        path = self._path(name)
        if path is None:
            self._memory[name] = section
        else:
            text = json.dumps(section, indent=1, ensure_ascii=False, sort_keys=True) + "\n"
            write_whole(path, text.encode())

    def _path(self, name: str) -> Path | None:
        return self.folder and self.folder / STATE_FOLDER / f"{name}.json"


_of_this_process = State(None)


def student_state() -> State:
    """The state of the student's folder around the working directory, else of this process."""
    folder = find_student_folder()
    return State(folder) if folder else _of_this_process
