"""Results that several files need, made once in a session of pytest by the worker that needs them first."""

import fcntl
import hashlib
import pickle
from collections.abc import Callable
from dataclasses import astuple
from pathlib import Path
from typing import Any

from course_lib.authoring.rehearsal import Rehearsal, RehearsalResult, rehearse
from course_lib.authoring.verify import run_lesson
from course_lib.files import write_atomically
from course_lib.grading.run.run import ExerciseRun, Job, pack, run_scenarios, unpack
from course_lib.grading.store import Course


class Once:
    """Results in a folder that all workers of a session share.

    Args:
        folder: The folder.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def get(self, key: str, make: Callable[[], Any]) -> Any:
        """Return the result for a key, which is made if no worker has made it before."""
        path = self._folder / hashlib.sha256(key.encode()).hexdigest()
        # The system releases the lock of a worker that ends, so that other workers do not wait for
        # it.
        with path.with_suffix(".lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if path.exists():
                return pickle.loads(path.read_bytes())
            made = make()
            write_atomically(path, pickle.dumps(made))
            return made

    def run_scenarios(self, job: Job) -> ExerciseRun:
        """Run all scenarios of a job, as `run_scenarios` does. The usage of the run is unknown."""
        return unpack(self.get(f"job {job.key}", lambda: pack(run_scenarios(job))), job.steps)

    def rehearse(self, rehearsal: Rehearsal, course: Course) -> RehearsalResult:
        """Run a rehearsal of the course, as `rehearse` does."""
        made: RehearsalResult = self.get(repr(astuple(rehearsal)), lambda: rehearse(rehearsal, course))
        return made

    def run_lesson(self, path: Path) -> list[Any]:
        """Return the flaws of a lesson, as `run_lesson` does."""
        found: list[Any] = self.get(f"lesson {path}", lambda: run_lesson(path))
        return found
