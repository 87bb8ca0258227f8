"""A submission's scenarios in workers: the grader's end."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from course_lib.course.course_file import Limits
from course_lib.grading.evidence import Evidence
from course_lib.grading.jail.launch import TemplateProcess, WorkerError, shared_template
from course_lib.grading.run.outcome import MAX_ERRORS, MAX_LENGTH, Outcome, Usage, is_plain, still_running
from course_lib.grading.run.scenario_graph import ScenarioGraph
from course_lib.grading.run.worker_process import WorkerProcess
from course_lib.grading.task import Scenario, Task
from course_lib.ros import wall
from course_lib.ros.channel import (
    Channel,
    ChannelClosedError,
    ChannelError,
    ChannelTimeoutError,
    FrameSizeError,
)
from course_lib.ros.graph_server import GraphServer, RecordingLimitError, Room

MOST_CPU = 1e6  # [s] that a scenario can have used
ENDED_EARLY = "the process ended before the program did (os._exit, a crash, or it was killed)"


class CrowdedError(ChannelError):
    """A cell that used up all processes of a submission; the scenarios need one."""


LIMITS_MET = {  # how the kernel's refusals begin as Python tells them
    "MemoryError": "memory",
    "RuntimeError: can't start new thread": "processes",
    "BlockingIOError: [Errno 11]": "processes",
    "OSError: [Errno 27]": "size",
    "OSError: [Errno 28]": "size",
}


@dataclass
class CellLog:
    """Output and errors of the cells, which are run before all scenarios."""

    output: str = ""
    errors: list[str] = field(default_factory=list)
    stopped: dict[int, str] = field(default_factory=dict)  # cells that are not run again, and why
    limit: str = ""  # which one was met, if one was
    complete: bool = False  # nothing is added then: cells that run again may know hidden inputs


class SubmissionRun:
    """One submission and its workers, until `close`.

    A worker that had to be killed is followed by a fresh one, in which the cell that hung is left out.

    Args:
        cells: The code cells.
        personal: The student's own values, by task.
        limits: What it may use.
        template: What its workers are forks of; default: that of this process.
        files: Texts in the folder that the cells run in, by their paths from there.
    """

    def __init__(
        self,
        cells: Sequence[str],
        personal: Mapping[str, Mapping[str, Any]],
        limits: Limits,
        template: TemplateProcess | None = None,
        files: Mapping[str, str] | None = None,
    ) -> None:
        self.log = CellLog()
        self.usage = Usage()  # of the workers that have ended, and of each scenario
        self._template = template or shared_template()
        self.isolation = self._template.isolation
        self._cells, self._personal, self._limits = list(cells), personal, limits
        self._files = dict(files or {})
        self._shares = TimeShares(limits.total_seconds, personal)  # of the scenarios
        self._deadline, self._cells_left = 0.0, limits.total_seconds  # of the cells
        self._worker: WorkerProcess | None = None
        self._hung: set[str] = set()  # tasks

    def run(self, task: Task, scenario: Scenario) -> Evidence:
        """Run one scenario; whatever happens, what was done by then is evidence.

        Raises:
            WorkerError: No worker can be started.
        """
        stage = ScenarioGraph(task, scenario, self._personal[task.id])
        if task.id in self._hung:
            why = f"not run: {task.name} did not come to an end before, and was stopped"
            return stage.evidence(Outcome(errors=[why]), stopped="time")
        worker = self._ready_worker()
        if worker is None:
            why = f"not run: all cells together took {self._limits.total_seconds:g} s"
            return stage.evidence(Outcome(errors=[why]), stopped="time")
        if self._shares.left(task.id) <= 0:
            why = f"not run: the scenarios of {task.name} took too long before"
            return stage.evidence(Outcome(errors=[why]), stopped="time")
        begin = wall.monotonic()
        outcome, stopped = self._serve(worker, stage, task)
        self._shares.take(task.id, wall.monotonic() - begin - worker.waiting.given)
        self.usage += Usage(scenarios={f"{task.id}/{scenario.name}": outcome.cpu_seconds})
        if stopped == "time":
            self._hung.add(task.id)
        output = worker.take_output()
        if self._worker is None:
            self._end(worker)
        return stage.evidence(outcome, output=output, stopped=stopped)

    def close(self) -> None:
        """Kill the worker that is there."""
        if self._worker is not None:
            self._end(self._worker)
        self._worker = None

    def _end(self, worker: WorkerProcess) -> None:
        worker.close()
        self.usage += worker.usage
        if worker.usage.fills(self._limits.scratch_megabytes):
            self.log.limit = self.log.limit or "size"

    def _left(self) -> float:
        return self._deadline - wall.monotonic()

    def _ready_worker(self) -> WorkerProcess | None:
        """Return the worker, in which all cells have been run, or None when the time is over."""
        self._deadline = wall.monotonic() + self._cells_left
        while self._worker is None and self._left() > 0:
            worker = self._worker = WorkerProcess(self._template, self._limits, self._cells)
            is_ready = self._run_cells(worker)
            self._deadline += worker.waiting.given
            if not is_ready:
                self.close()
        self._cells_left = self._left()
        return self._worker

    def _run_cells(self, worker: WorkerProcess) -> bool:
        """Run all cells; return False after noting the cell that prevents it."""
        values = {task: dict(values) for task, values in self._personal.items()}
        current, limit, log = -1, self._limits.cell_seconds, self.log
        try:
            worker.channel.send(["files", self._files])
            worker.channel.send(["cells", self._cells, values, sorted(log.stopped)])
            while True:
                worker.allow(min(limit, self._left() + worker.waiting.given))
                match worker.channel.receive():
                    case ["cell", int(index)] if current < index < len(self._cells):
                        current = index
                    case ["ran", list(errors)]:
                        output = worker.take_output()
                        if not log.complete:
                            log.output, log.errors, log.complete = output, _sentences(errors), True
                            log.limit = log.limit or limit_met(log.errors)
                        return True
                    case ["crowded"]:
                        raise CrowdedError("no further process could be started")
                    case _:
                        raise ChannelError("what came is not the next cell")
        except ChannelError as error:
            if current < 0 and self._left() <= 0:
                return False  # the time ran out while it started
            if current < 0:
                raise WorkerError(f"a worker does not begin: {worker.take_output() or error}") from error
            match error:
                case ChannelTimeoutError():
                    met, why = "time", f"was stopped after {limit:g} s"
                case CrowdedError():
                    met, why = "processes", f"was stopped: it left so many processes that {error}"
                case _:
                    met, why = "", f"ended the process ({error})"
            log.limit = log.limit or met
            log.stopped[current] = f"cell {current + 1} {why}"
            return False

    def _serve(self, worker: WorkerProcess, stage: ScenarioGraph, task: Task) -> tuple[Outcome, str]:
        """Run a scenario in the worker; return its outcome and the limit that ended it, or ""."""
        seconds, part = min(self._limits.scenario_seconds, self._shares.left(task.id)), stage.part
        order = [task.id, task.name, part.kind, part.seed, part.calls]
        worker.waiting.begin(seconds)
        worker.allow(seconds)
        try:
            worker.channel.send(["scenario", *order, stage.graph.end_ns, stage.graph.last_id])
            outcome = _drive(worker.channel, stage, Room.lasting(stage.seconds))
            return outcome, limit_met(outcome.errors)
        except ChannelError as error:
            self._worker = None  # what it says can't be followed any more
            match error:
                case ChannelTimeoutError():
                    return Outcome(errors=[still_running(seconds)]), "time"
                case ChannelClosedError():
                    return Outcome(errors=[ENDED_EARLY]), ""
            return Outcome(errors=[str(error)]), "size" if isinstance(
                error, RecordingLimitError | FrameSizeError
            ) else ""


def limit_met(errors: Sequence[str]) -> str:
    """Return the limit behind the errors of student code, or ""."""
    return next((LIMITS_MET[start] for e in errors for start in LIMITS_MET if e.startswith(start)), "")


def _drive(channel: Channel, stage: ScenarioGraph, room: Room) -> Outcome:
    """Run the stage's clock in lock-step with the worker's child, to the child's end.

    Raises:
        ChannelError: What came is not what it has to be.
    """
    server = GraphServer(stage.graph, channel, room)
    server.serve()
    while server.last_frame is None and stage.graph.advance():
        pass
    server.end()
    match server.last_frame:
        case ["result", list(returns), list(errors)] if is_plain(returns):
            match channel.receive():
                case ["exit", int(), float(seconds)] if 0 <= seconds <= MOST_CPU:
                    return Outcome(returns, _sentences(errors), seconds)
            raise ChannelError("something came after the result")
        case ["exit", int(), float()]:
            return Outcome(errors=[ENDED_EARLY])
    raise ChannelError("what came is not a result")


def _sentences(texts: list[Any]) -> list[str]:
    """Cut the number and the length of the worker's texts."""
    if not all(isinstance(text, str) for text in texts):
        raise ChannelError("what came are not sentences")
    return [text[: 2 * MAX_LENGTH] for text in texts[:MAX_ERRORS]]


class TimeShares:
    """Time of a submission: half of it in equal parts for its tasks, the other half for any of them.

    Args:
        seconds: Of the wall clock, for the scenarios of all tasks.
        tasks: Their ids.
    """

    def __init__(self, seconds: float, tasks: Collection[str]) -> None:
        self._common = seconds / 2
        self._reserved = dict.fromkeys(tasks, seconds / 2 / max(len(tasks), 1))

    def left(self, task: str) -> float:
        """Return the time that the task may still take, [s]."""
        return self._reserved[task] + self._common

    def take(self, task: str, seconds: float) -> None:
        """Charge a task: its own part first."""
        own = min(seconds, self._reserved[task])
        self._reserved[task] -= own
        self._common = max(self._common - (seconds - own), 0.0)
