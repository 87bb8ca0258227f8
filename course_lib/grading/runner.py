"""Runs a submission's scenarios in workers and brings back the evidence."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import TracebackType
from typing import Any

from course_lib.errors import CourseError
from course_lib.grading.course_file import Limits
from course_lib.grading.judge import Run
from course_lib.grading.perform import MAX_ERRORS, Outcome
from course_lib.grading.plain import is_plain
from course_lib.grading.scenario import Stage
from course_lib.grading.student_error import MAX_LENGTH
from course_lib.grading.task import Scenario, Task
from course_lib.grading.worker_process import WorkerProcess
from course_lib.ros import wall
from course_lib.ros.channel import ChannelClosedError, ChannelError
from course_lib.ros.graph_server import GraphServer, RecordingLimitError

START_SECONDS = 60.0  # [s] for a worker's imports on a busy machine
ENDED_EARLY = "the process ended before the program did (os._exit, a crash, or it was killed)"


class WorkerError(CourseError):
    """A worker does not even start: the kit's or the machine's fault, never the student's."""


@dataclass(frozen=True)
class Planned:
    """A scenario to be run."""

    task: Task
    scenario: Scenario
    hidden: bool = False


@dataclass
class CellLog:
    """What the cells brought out when they were run, once, before all scenarios."""

    output: str = ""
    errors: list[str] = field(default_factory=list)
    stopped: dict[int, str] = field(default_factory=dict)  # cells that are not run again, and why
    timed_out: bool = False


class Session:
    """One submission and its workers; a context manager that leaves no process behind.

    A worker that had to be killed is followed by a fresh one, in which the cell that hung is left out.

    Args:
        cells: The code cells.
        personal: The student's own values, by task.
        limits: What it may use.
    """

    def __init__(
        self, cells: Sequence[str], personal: Mapping[str, Mapping[str, Any]], limits: Limits
    ) -> None:
        self.log = CellLog()
        self._cells, self._personal, self._limits = list(cells), personal, limits
        self._deadline = wall.monotonic() + limits.total_seconds
        self._worker: WorkerProcess | None = None

    def run(self, planned: Planned) -> Run:
        """Run one scenario; whatever happens, what was done by then is evidence.

        Raises:
            WorkerError: No worker can be started.
        """
        stage = Stage(planned.task, planned.scenario, self._personal[planned.task.id])
        outcome, stopped, output = Outcome(), "time", ""
        worker = self._ready_worker()
        if worker is None:
            outcome.errors = [f"not run: all cells together took {self._limits.total_seconds:g} s"]
        else:
            stopped = self._serve(worker, stage, planned, outcome)
            output = worker.take_output()
        evidence = stage.evidence(outcome, output=output, stopped=stopped)
        return Run(planned.scenario, evidence, planned.hidden)

    def close(self) -> None:
        """Kill the worker that is there."""
        if self._worker is not None:
            self._worker.close()
        self._worker = None

    def _left(self) -> float:
        return self._deadline - wall.monotonic()

    def _ready_worker(self) -> WorkerProcess | None:
        """The worker, with all cells run; None when the time is over."""
        if self._worker is not None and self._worker.broken:
            self.close()
        while self._worker is None and self._left() > 0:
            self._worker = WorkerProcess(round(self._limits.output_kilobytes * 1000))
            if not self._run_cells(self._worker):
                self.close()
        return self._worker

    def _run_cells(self, worker: WorkerProcess) -> bool:
        """Whether all cells were run; if not, the one to blame has been noted."""
        values = {task: dict(values) for task, values in self._personal.items()}
        current, limit = -1, START_SECONDS
        try:
            skip = sorted(self.log.stopped)
            worker.channel.send(["cells", self._cells, values, skip, worker.new_token()])
            while True:
                with worker.limited(min(limit, self._left())):
                    frame = worker.channel.receive()
                limit = self._limits.cell_seconds
                match frame:
                    case ["cell", int(index)] if current < index < len(self._cells):
                        current = index
                    case ["ran", list(errors)]:
                        self.log.output, self.log.errors = worker.take_output(), _sentences(errors)
                        return True
                    case _:
                        raise ChannelError("what came is not the next cell")
        except ChannelError as error:
            if current < 0:
                raise WorkerError(f"a worker can't be started: {worker.take_output() or error}") from error
            why = f"was stopped after {limit:g} s" if worker.timed_out else f"ended the process ({error})"
            self.log.timed_out |= worker.timed_out
            self.log.stopped[current] = f"cell {current + 1} {why}"
            return False

    def _serve(self, worker: WorkerProcess, stage: Stage, planned: Planned, outcome: Outcome) -> str:
        """Let the worker run a scenario on the stage; says which limit ended it, if one did."""
        seconds = min(self._limits.scenario_seconds, self._left())
        task, part = planned.task, stage.part
        order = [task.id, task.name, part.kind, part.seed, part.calls, stage.graph.end_ns]
        try:
            with worker.limited(seconds):
                worker.channel.send(["scenario", *order, worker.new_token()])
                _drive(worker, stage, outcome)
        except RecordingLimitError as error:
            worker.broken, outcome.errors = True, [str(error)]
            return "size"
        except ChannelError as error:
            worker.broken, outcome.errors = True, [str(error)]
            if isinstance(error, ChannelClosedError):
                outcome.errors = [ENDED_EARLY]
            if worker.timed_out:
                outcome.errors = [f"still running after {seconds:.0f} s: an endless loop? It was stopped."]
                return "time"
        return ""

    def __enter__(self) -> "Session":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, where: TracebackType | None
    ) -> None:
        self.close()


def _drive(worker: WorkerProcess, stage: Stage, outcome: Outcome) -> None:
    """Run the stage's clock in lock-step with the worker's child, to the child's end.

    Raises:
        ChannelError: What came is not what it has to be.
    """
    server = GraphServer(stage.graph, worker.channel)
    server.serve()
    while server.last_frame is None and stage.graph.advance():
        pass
    server.end()
    match server.last_frame:
        case ["result", list(returns), list(errors)] if is_plain(returns):
            outcome.returns, outcome.errors = returns, _sentences(errors)
            if worker.channel.receive()[:1] != ["exit"]:
                raise ChannelError("something came after the result")
        case ["exit", int()]:
            outcome.errors = [ENDED_EARLY]
        case _:
            raise ChannelError("what came is not a result")


def _sentences(texts: list[Any]) -> list[str]:
    """Texts from the worker, as many and as long as they may be."""
    if not all(isinstance(text, str) for text in texts):
        raise ChannelError("what came are not sentences")
    return [text[: 2 * MAX_LENGTH] for text in texts[:MAX_ERRORS]]
