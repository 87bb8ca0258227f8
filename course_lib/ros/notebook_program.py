"""A notebook run as a program: its code cells in order, up to the first that fails."""

import json
from pathlib import Path

from course_lib.errors import CourseError
from course_lib.ros.process import Process
from course_lib.ros.shell import make_shell


class NotebookProgram(Process):
    """The code cells of one notebook; raises a CourseError if it cannot be read as one of format 4."""

    def __init__(self, file: Path) -> None:
        super().__init__(file)
        try:
            cells = json.loads(file.read_bytes())["cells"]
            self._sources = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
        except OSError as error:
            raise CourseError(f"{file} cannot be run: {error.strerror}.") from error
        except (ValueError, KeyError, TypeError) as error:
            raise CourseError(f"{file} is no notebook of format 4. Save it again in JupyterLab.") from error

    def work(self) -> None:
        """Run the cells; IPython shows what one raises."""
        shell = make_shell()
        for source in self._sources:
            if not shell.run_cell(source).success:  # type: ignore[no-untyped-call]  # IPython annotates little
                self.exit_code = 1
                return
