"""The grader's side of a submission's scenarios: graph, clock, inputs, recorder and workers.

The grader owns the graph and its clock. The worker runs the student's code and, in lock-step with
the grader, sends each call that concerns the graph: publish, subscribe, wait. So the student's
process can neither change robot time nor see hidden checks, and equal code gives equal evidence.
The worker's answers are validated as untrusted data.

On a busy machine, a worker waits for a processor. This waiting time does not count against a
submission's limits.
"""

import os
import threading
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from select import select
from typing import Any

from course_lib.course.course_file import Limits
from course_lib.errors import CourseError
from course_lib.grading.evidence import Evidence
from course_lib.grading.jail.filters import Excess, Usage, descendants
from course_lib.grading.jail.launch import (
    PIPE_HOLDS,
    START_SECONDS,
    TemplateProcess,
    WorkerError,
    shared_template,
)
from course_lib.grading.run.outcome import MAX_ERRORS, MAX_LENGTH, Outcome, is_plain, still_running_message
from course_lib.grading.run.scenario import MOST_EVIDENCE, ScenarioGraph
from course_lib.grading.task import Scenario, Task
from course_lib.ros.graph import remote
from course_lib.ros.time import wall

MAX_EXTENSION = 9.0  # maximum extension of a limit, as a multiple of it
MIN_EXTENSION = 0.1  # [s] minimum extension of a limit
# Placeholders for the ids of the calling thread, and of all ended threads.
OWN_THREAD, ENDED = 0, -1
# Times of ended children in /proc/PID/stat [ticks], counted after the name.
CHILDREN_TIMES = slice(13, 15)
# Times of the process, its ended threads and its ended children [ticks].
PROCESS_TIMES = slice(11, 15)


@dataclass(frozen=True)
class ThreadTimes:
    """Times of a thread [s]: running, and ready to run but waiting for a processor."""

    running: float = 0.0
    waiting: float = 0.0

    def after(self, earlier: "ThreadTimes") -> "ThreadTimes":
        """Return the difference from earlier times."""
        return ThreadTimes(self.running - earlier.running, self.waiting - earlier.waiting)


class WaitingTime:
    """The waiting time of a process's descendants, and of the thread serving them, since `begin`.

    It is 0 on systems that do not measure it. `granted` is the total extension of limits [s].

    Args:
        process: The process id.
        limit: The limit of each step [s] of the wall clock.
    """

    def __init__(self, process: int, limit: float) -> None:
        self._process = process
        self.begin(limit)

    def begin(self, limit: float) -> None:
        """Restart the measurement, with a limit per step [s]."""
        self.granted, self._max_extension = 0.0, MAX_EXTENSION * limit
        self._since, self._times_at_start = wall.monotonic(), dict(_threads(self._process))

    def extend(self) -> float:
        """Return the extension [s] of a limit that was just reached, or 0 if no thread waited."""
        # The extension is the longest waiting time of a thread, without times in which another one
        # ran.
        spent = {n: t.after(self._times_at_start.get(n, ThreadTimes())) for n, t in _threads(self._process)}
        own_wait = spent.pop(OWN_THREAD, ThreadTimes()).waiting
        ran = sum(times.running for times in spent.values())
        longest = max((times.waiting for times in spent.values()), default=0.0)
        more = (
            min(min(own_wait + longest, wall.monotonic() - self._since - ran), self._max_extension)
            - self.granted
        )
        if more < MIN_EXTENSION:
            return 0.0
        self.granted += more
        return more


def _threads(process: int) -> Iterator[tuple[int, ThreadTimes]]:
    """Yield (thread id, CPU times) for this thread and for all threads of a process's descendants.

    Those that have ended are one entry. Otherwise code could start short processes and wait for
    them: they would use the processor, and extend the limit.
    """
    files = [Path("/proc/thread-self/schedstat")]
    ended = _stat_seconds(process, CHILDREN_TIMES)
    for pid in descendants(process):
        files += Path(f"/proc/{pid}/task").glob("*/schedstat")
        ended += _stat_seconds(pid, PROCESS_TIMES)
    for file in files:
        number = int(file.parent.name) if file is not files[0] else OWN_THREAD
        # The system is not Linux, or the thread has just ended.
        with suppress(OSError, ValueError):
            ran, waited, _ = map(int, file.read_text().split())
            yield number, ThreadTimes(ran / 1e9, waited / 1e9)
            ended -= ran / 1e9 if number != OWN_THREAD else 0.0
    yield ENDED, ThreadTimes(ended, 0.0)


def _stat_seconds(pid: int, times: slice) -> float:
    """Return the sum of some of a process's times [s], or 0 if it has just ended."""
    with suppress(OSError, ValueError):
        fields = Path(f"/proc/{pid}/stat").read_bytes().rpartition(b")")[2].split()
        return sum(map(int, fields[times])) / os.sysconf("SC_CLK_TCK")
    return 0.0


# Modules that take long to import, by a string that occurs in cells that need them.
HEAVY = {
    "matplotlib": "matplotlib.pyplot",
    "%matplotlib": "matplotlib_inline.backend_inline",
    "pinocchio": "pinocchio",
}


class WorkerProcess:
    """A worker in the jail, from its start until `close`.

    Args:
        template: The process that it is forked from.
        limits: The resource limits.
        cells: The cells that it will run.

    Raises:
        WorkerError: The worker can't enter the jail.
    """

    def __init__(self, template: TemplateProcess, limits: Limits, cells: Sequence[str]) -> None:
        self._template = template
        # These are set by `close`.
        self.usage = Usage()
        self.excess: Excess | None = None
        imports = [module for word, module in HEAVY.items() if any(word in cell for cell in cells)]
        connection, output = template.start(limits, imports)
        self.channel = remote.Channel(connection)
        self.output = Output(output, round(limits.output_kilobytes * 1000))
        self.waiting = WaitingTime(template.pid, limits.cell_seconds)  # from the start of the worker
        self.channel.overtime = self.waiting.extend
        self.allow(START_SECONDS)
        try:
            problem = self.channel.receive()[1:]
        except remote.ChannelError as error:
            problem = [str(error)]
        if problem != [""]:
            worker_output = self.output.take()
            self.close()
            raise WorkerError(f"a worker can't be put into the jail: {problem} {worker_output}")

    def allow(self, seconds: float) -> None:
        """Set the time [s] in which the worker must answer, excluding waiting for a processor."""
        self.channel.deadline = wall.monotonic() + seconds

    def close(self) -> None:
        """Kill the worker and all processes it has started; its scratch folder is deleted."""
        self.usage, self.excess = self._template.stop()
        self.channel.close()
        self.output.close()


class Output:
    """The text in a pipe, read continuously so that a full pipe cannot block.

    The start of each step is kept.
    """

    def __init__(self, pipe: int, limit: int) -> None:
        self._pipe, self._max_bytes = pipe, limit
        self._kept, self._is_truncated, self._is_closed = bytearray(), False, False
        self._lock = threading.Lock()
        os.set_blocking(pipe, False)
        self._reader = threading.Thread(target=self._read_all, daemon=True)
        self._reader.start()

    def take(self) -> str:
        """Return the output of the step that has just ended, including text still in the pipe."""
        with self._lock:
            self._read()
            text = bytes(self._kept).decode("utf-8", "replace")
            text += f"\n… cut after {self._max_bytes} bytes" if self._is_truncated else ""
            self._kept, self._is_truncated = bytearray(), False
        return text

    def close(self) -> None:
        """Stop reading; the process must have ended."""
        self._is_closed = True
        self._reader.join()
        os.close(self._pipe)

    def _read_all(self) -> None:
        while not self._is_closed:
            if select([self._pipe], [], [], 0.1)[0]:
                with self._lock:
                    self._is_closed = self._read() == 0 or self._is_closed

    def _read(self) -> int | None:
        """Return the number of bytes read; 0 at the end of the pipe, None if none are available."""
        try:
            chunk = os.read(self._pipe, PIPE_HOLDS)
        except BlockingIOError:
            return None
        room = max(self._max_bytes - len(self._kept), 0)
        self._kept += chunk[:room]
        self._is_truncated = self._is_truncated or len(chunk) > room
        return len(chunk)


MOST_CPU = 1e6  # [s] plausible maximum of a scenario's CPU time
ENDED_EARLY = "the process ended before the program did (os._exit, a crash, or killed)"


class ProcessLimitError(remote.ChannelError):
    """Raised if a cell used up all processes of a submission, because each scenario needs one."""


# Beginnings of the messages with which Python reports that a kernel limit was reached.
LIMITS_MET = {
    "MemoryError": "memory",
    "RuntimeError: can't start new thread": "processes",
    "BlockingIOError: [Errno 11]": "processes",
    "OSError: [Errno 27]": "size",
    "OSError: [Errno 28]": "size",
}


@dataclass
class CellLog:
    """Output and errors of the cells, which run before all scenarios."""

    output: str = ""
    errors: list[str] = field(default_factory=list)
    # reasons for cells that are not run again, by index
    stopped: dict[int, str] = field(default_factory=dict)
    limit: str = ""  # the limit that was reached, or ""
    # Once complete, the log is frozen: cells that run again may know hidden inputs.
    is_complete: bool = False


class SubmissionRun:
    """One submission and its workers, until `close`.

    If a worker had to be killed, a new one replaces it, in which the cell that hung is skipped.

    Args:
        cells: The code cells.
        personal: The student's personal values, by task.
        limits: The resource limits.
        template: The process that workers are forked from; default: the one of this process.
        files: Contents of the files in the working folder of the cells, by relative path.
    """

    def __init__(
        self,
        cells: Sequence[str],
        personal: Mapping[str, Mapping[str, Any]],
        limits: Limits,
        template: TemplateProcess | None = None,
        files: Mapping[str, str | bytes] | None = None,
    ) -> None:
        self.log = CellLog()
        self.usage = Usage()  # sum over ended workers and scenarios
        self._template = template or shared_template()
        self.isolation = self._template.isolation
        self._cells, self._personal, self._limits = list(cells), personal, limits
        self._files = dict(files or {})
        self._time_budget = Budget(limits.total_seconds, personal)  # scenario time [s]
        self._size_budget = Budget(MOST_EVIDENCE, personal)  # size of evidence [B]
        self._deadline, self._cell_seconds = 0.0, limits.total_seconds  # deadline and remaining cell time [s]
        self._worker: WorkerProcess | None = None
        self._hung_tasks: set[str] = set()  # task ids

    def run(self, task: Task, scenario: Scenario) -> Evidence:
        """Run one scenario and return its evidence, which is partial if a limit ended it.

        Raises:
            WorkerError: No worker can be started.
            CourseError: An input or a call of the scenario is invalid.
        """
        room = self._size_budget.remaining(task.id)
        try:
            stage = ScenarioGraph(task, scenario, self._personal[task.id], room)
        except CourseError as error:
            place = f"{task.id}, scenario {scenario.name!r} of its check file"
            raise CourseError(f"{place}: {error}") from error
        if task.id in self._hung_tasks:
            why = f"not run: {task.name} did not end in an earlier scenario, and was stopped"
            return stage.evidence(Outcome(errors=[why]), stopped="time")
        worker = self._ready_worker()
        if worker is None:
            why = f"not run: all cells together took {self._limits.total_seconds:g} s"
            return stage.evidence(Outcome(errors=[why]), stopped="time")
        if self._time_budget.remaining(task.id) <= 0:
            why = f"not run: the previous scenarios of {task.name} took too long"
            return stage.evidence(Outcome(errors=[why]), stopped="time")
        begin = wall.monotonic()
        outcome, stopped = self._serve(worker, stage, task)
        self._time_budget.charge(task.id, wall.monotonic() - begin - worker.waiting.granted)
        self._size_budget.charge(task.id, stage.recorded_bytes)
        self.usage += Usage(scenarios={f"{task.id}/{scenario.name}": outcome.cpu_seconds})
        if stopped == "time":
            self._hung_tasks.add(task.id)
        output = worker.output.take()
        if self._worker is None:
            self._end(worker)
            if worker.excess:
                outcome = Outcome(errors=[f"it was stopped: {worker.excess.message}"])
                stopped = worker.excess.limit
        return stage.evidence(outcome, output=output, stopped=stopped)

    def close(self) -> None:
        """Kill the current worker, if any."""
        if self._worker is not None:
            self._end(self._worker)
        self._worker = None

    def _end(self, worker: WorkerProcess) -> None:
        worker.close()
        self.usage += worker.usage
        if worker.usage.exceeds_by_far(self._limits.scratch_megabytes):
            self.log.limit = self.log.limit or "size"

    def _remaining_cell_time(self) -> float:
        return self._deadline - wall.monotonic()

    def _ready_worker(self) -> WorkerProcess | None:
        """Return the worker after it has run all cells, or None if their time has expired."""
        self._deadline = wall.monotonic() + self._cell_seconds
        while self._worker is None and self._remaining_cell_time() > 0:
            worker = self._worker = WorkerProcess(self._template, self._limits, self._cells)
            is_ready = self._run_cells(worker)
            self._deadline += worker.waiting.granted
            if not is_ready:
                self.close()
        self._cell_seconds = self._remaining_cell_time()
        return self._worker

    def _run_cells(self, worker: WorkerProcess) -> bool:
        """Run all cells and return True, or record the cell that prevents it and return False."""
        values = {task: dict(values) for task, values in self._personal.items()}
        current, limit, log = -1, self._limits.cell_seconds, self.log
        try:
            worker.channel.send(["files", self._files])
            worker.channel.send(["cells", self._cells, values, sorted(log.stopped)])
            while True:
                worker.allow(min(limit, self._remaining_cell_time() + worker.waiting.granted))
                match worker.channel.receive():
                    case ["cell", int(index)] if current < index < len(self._cells):
                        current = index
                    case ["ran", list(errors)]:
                        output = worker.output.take()
                        if not log.is_complete:
                            log.output, log.errors, log.is_complete = output, _limit_texts(errors), True
                            log.limit = log.limit or find_exceeded_limit(log.errors)
                        return True
                    case ["crowded"]:
                        raise ProcessLimitError("no further process could be started")
                    case _:
                        raise remote.ChannelError("the worker did not report the next cell")
        except remote.ChannelError as error:
            if current < 0 and self._remaining_cell_time() <= 0:
                # The time expired during the start of the worker.
                return False
            if current < 0:
                raise WorkerError(f"a worker does not start: {worker.output.take() or error}") from error
            # Closing reveals whether the template has killed the worker.
            self.close()
            match error:
                case _ if worker.excess:
                    met, why = worker.excess.limit, f"was stopped: {worker.excess.message}"
                case remote.ChannelTimeoutError():
                    met, why = "time", f"was stopped after {limit:g} s"
                case ProcessLimitError():
                    met, why = "processes", f"was stopped: it left so many processes running that {error}"
                case _:
                    met, why = "", f"ended the process ({error})"
            log.limit = log.limit or met
            log.stopped[current] = f"cell {current + 1} {why}"
            return False

    def _serve(
        self,
        worker: WorkerProcess,
        stage: ScenarioGraph,
        task: Task,
    ) -> tuple[Outcome, str]:
        """Run a scenario in the worker; return its outcome and the limit that ended it, or ""."""
        seconds, part = (
            min(self._limits.scenario_seconds, self._time_budget.remaining(task.id)),
            stage.instructions,
        )
        order = [task.id, task.name, part.kind, part.seed, part.calls]
        worker.waiting.begin(seconds)
        worker.allow(seconds)
        try:
            worker.channel.send(["scenario", *order, stage.graph.end_ns, stage.graph.last_id])
            outcome = _drive(worker.channel, stage, remote.RecordingBudget.for_duration(stage.seconds))
            return outcome, find_exceeded_limit(outcome.errors)
        except remote.ChannelError as error:
            # After an error, further messages from this worker cannot be interpreted.
            self._worker = None
            match error:
                case remote.ChannelTimeoutError():
                    return Outcome(errors=[still_running_message(seconds)]), "time"
                case remote.ChannelClosedError():
                    return Outcome(errors=[ENDED_EARLY]), ""
                case remote.MemoryLimitError():
                    return Outcome(errors=[str(error)]), "memory"
                case remote.RecordingLimitError() | remote.FrameSizeError():
                    return Outcome(errors=[str(error)]), "size"
            return Outcome(errors=[str(error)]), ""


def find_exceeded_limit(errors: Sequence[str]) -> str:
    """Return the kernel limit that caused one of the errors, or ""."""
    return next((LIMITS_MET[start] for e in errors for start in LIMITS_MET if e.startswith(start)), "")


def _drive(channel: remote.Channel, stage: ScenarioGraph, room: remote.RecordingBudget) -> Outcome:
    """Run the scenario's clock in lock-step with the worker's child until the child ends.

    Raises:
        ChannelError: The worker sent an invalid message.
    """
    server = remote.GraphServer(stage.graph, channel, room)
    server.serve()
    while server.last_frame is None and stage.graph.advance():
        pass
    server.end()
    match server.last_frame:
        case ["result", list(returns), list(errors)] if is_plain(returns):
            match channel.receive():
                case ["exit", int(), float(seconds)] if 0 <= seconds <= MOST_CPU:
                    stage.count_bytes(size_of(returns))
                    return Outcome(returns, _limit_texts(errors), seconds)
            raise remote.ChannelError("the worker sent more data after the result")
        case ["exit", int(), float()]:
            return Outcome(errors=[ENDED_EARLY])
    raise remote.ChannelError("the worker did not send a valid result")


BYTES_PER_ITEM = 32  # [B] size of an object and the reference to it


def size_of(value: Any) -> int:
    """Return the approximate memory size [B] of a value of plain data."""
    if type(value) is list:
        return BYTES_PER_ITEM + sum(map(size_of, value))
    if type(value) is dict:
        return BYTES_PER_ITEM + sum(size_of(key) + size_of(item) for key, item in value.items())
    return BYTES_PER_ITEM + (len(value) if type(value) is str else 0)


def _limit_texts(texts: list[Any]) -> list[str]:
    """Limit the number and the length of the worker's strings."""
    if not all(isinstance(text, str) for text in texts):
        raise remote.ChannelError("the worker sent errors that are not strings")
    return [text[: 2 * MAX_LENGTH] for text in texts[:MAX_ERRORS]]


class Budget:
    """A budget of time or memory: half of it in equal shares for the tasks, the other half shared.

    The shares keep one task from using up the budget of the others.

    Args:
        amount: The total for the scenarios of all tasks, in [s] of the wall clock or in bytes.
        tasks: The task ids.
    """

    def __init__(self, amount: float, tasks: Collection[str]) -> None:
        self._shared_amount = amount / 2
        self._reserved_amounts = dict.fromkeys(tasks, amount / 2 / max(len(tasks), 1))

    def remaining(self, task: str) -> float:
        """Return the remaining amount that a task may use."""
        return self._reserved_amounts[task] + self._shared_amount

    def charge(self, task: str, amount: float) -> None:
        """Charge a task: first its own share, then the shared half."""
        from_reserve = min(amount, self._reserved_amounts[task])
        self._reserved_amounts[task] -= from_reserve
        self._shared_amount = max(self._shared_amount - (amount - from_reserve), 0.0)
