"""Weeks of a class on this machine by the commands: handed in, collected, graded, marked and returned.

    python -m tests.benchmarks.bench_weeks --students 12 --weeks 1 3
    python -m tests.benchmarks.bench_weeks --folder weeks  # 180 students, 8 weeks; resumes after a
    kill python -m tests.benchmarks.bench_weeks --records 180          # records alone: no code runs

Students hand in right answers, the wrong ones of the course's own tables, mutants, copies, broken
and hostile files, or nothing; some are late, some have more time. The script recompute.py in
tests/grading/simulated compares each mark, without using the kit, with what was declared of the
answer.
"""

import argparse
import csv
import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import psutil

from course_lib.course.course_file import read_course_file
from course_lib.grading.reports.tables import write_tables
from tests.grading.simulated import recompute
from tests.grading.simulated.hand_ins import HandIn
from tests.grading.simulated.results import write_results
from tests.grading.simulated.simulated_class import SimulatedClass

MARKS = 5  # manual marks in each week with a manually marked task
SAMPLE = 1.0  # [s] between two looks at the memory


@dataclass(frozen=True)
class Cost:
    """One command: [s] of the wall clock and of CPU, [MB] of all its processes at most."""

    step: str
    count: int
    wall: float
    cpu: float
    memory: float
    said: str = ""

    def __str__(self) -> str:
        cpu = f"{self.cpu:8.1f} s CPU {self.cpu / max(self.count, 1):6.2f} s each"
        return f"{self.step:16} {self.count:5} {self.wall:8.1f} s {cpu} {self.memory:6.0f} MB"


def memory_of(root: psutil.Process) -> float:
    """[MB] of a process and all below it; shared pages are counted once."""
    total = 0
    for process in (root, *root.children(recursive=True)):
        try:
            total += process.memory_full_info().pss
        except psutil.Error:
            continue
    return total / 2**20


class Commands:
    """The commands for a class, each of which is run once, also over several starts of this program."""

    def __init__(self, simulated: SimulatedClass) -> None:
        self._term, self._log = simulated, simulated.top / "costs.jsonl"
        lines = self._log.read_text().splitlines() if self._log.is_file() else []
        self._done = {made.step: made for made in (Cost(**json.loads(line)) for line in lines)}

    def run(self, step: str, count: int, *arguments: str, codes: Sequence[int] = (0,)) -> Cost:
        """Run `course WORDS` and print its cost."""
        if step not in self._done:
            cost = self._measure(step, count, arguments, codes)
            with self._log.open("a") as file:
                file.write(json.dumps(asdict(cost)) + "\n")
            self._done[step] = cost
            sys.stdout.write(f"{cost}\n")
            sys.stdout.flush()
        return self._done[step]

    def _measure(self, step: str, count: int, arguments: Sequence[str], codes: Sequence[int]) -> Cost:
        environment = {**os.environ, **self._term.environment}
        begin, peak_memory = time.perf_counter(), [0.0]
        with tempfile.TemporaryFile("w+") as output:
            command = [sys.executable, "-m", "course_lib", *arguments]
            process = subprocess.Popen(
                command, cwd=self._term.top, env=environment, stdout=output, stderr=output
            )
            process_ended = threading.Event()
            watch = threading.Thread(target=_watch, args=(process.pid, process_ended, peak_memory))
            watch.start()
            _, status, used = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            process_ended.set()
            watch.join()
            output.seek(0)
            text = output.read()
        if process.returncode not in codes:
            raise SystemExit(f"course {' '.join(arguments)}: code {process.returncode}\n{text[-3000:]}")
        cpu = used.ru_utime + used.ru_stime
        return Cost(step, count, time.perf_counter() - begin, cpu, peak_memory[0], text)


def _watch(pid: int, process_ended: threading.Event, peak_memory: list[float]) -> None:
    root = psutil.Process(pid)
    while not process_ended.wait(SAMPLE):
        try:
            peak_memory[0] = max(peak_memory[0], memory_of(root))
        except psutil.NoSuchProcess:
            return


def week_of(simulated: SimulatedClass, week: str, commands: Commands, jobs: int) -> list[HandIn]:
    """Collect, grade and mark a week."""
    submissions = simulated.hand_in(week)
    exercise, count = f"{week}_exercise", len(submissions)
    lists = ("--roster", f"{week}.csv", "--id-column", "ID number")
    commands.run(f"{week} collect", count, "collect", f"{week}.zip", "--out", "in", *lists, codes=(0, 1))
    only = ("--only", f"*/{exercise}", "--jobs", str(jobs), "--resume")
    commands.run(f"{week} grade", count, "grade", "in", "--out", "graded", *only, codes=(0, 1))
    for number, (student, task, points) in enumerate(simulated.by_hand(submissions, week, MARKS)):
        arguments = ("mark", "graded", student, exercise, task, points, "--comment", "Read.")
        commands.run(f"{week} mark {number}", 1, *arguments)
    return submissions


def compared(simulated: SimulatedClass) -> list[str]:
    """Return the differences between the marks and the expected results of the submissions."""
    paths = (simulated.top / f"{week}.declared.json" for week in simulated.weeks)
    declared = [one for path in paths for one in json.loads(path.read_text())]
    return recompute.disagreements(simulated.top / "graded", declared, 10)


def summary(simulated: SimulatedClass, submissions: dict[str, list[HandIn]]) -> str:
    """Return the numbers of hand-ins, runs and states."""
    kinds = Counter(submission.kind for tasks_of_week in submissions.values() for submission in tasks_of_week)
    with (simulated.top / "graded" / "gradebook.csv").open(newline="") as file:
        states = Counter(row["status"] for row in csv.DictReader(file))
    runs = len(list((simulated.top / "graded" / "evidence").glob("*.gz")))
    return f"{sum(kinds.values())} hand-ins {dict(kinds)}\n{runs} of them run; states {dict(states)}\n"


def graded_weeks(simulated: SimulatedClass, jobs: int) -> list[str]:
    """Run all commands of all weeks; returns where the marks differ from the declared ones."""
    simulated.write()
    commands = Commands(simulated)
    submissions = {week: week_of(simulated, week, commands, jobs) for week in simulated.weeks}
    count = sum(map(len, submissions.values()))
    commands.run("feedback", count, "feedback", "graded", "--lms", "moodle")
    last = simulated.weeks[-1]
    names = ("--exercise", f"{last}_exercise", "--column", "Grade", "--id-column", "ID number")
    commands.run("marks", count, "mark", "graded", "--lms", f"{last}.csv", *names, "--to", "filled.csv")
    sys.stdout.write(summary(simulated, submissions))
    return compared(simulated)


def records_alone(simulated: SimulatedClass) -> None:
    """Print the time [s] for writing the tables of generated records."""
    simulated.write()
    course, out = read_course_file(simulated.course_toml), simulated.top / "graded"
    write_results(out, list(simulated.students), course)
    begin = time.perf_counter()
    write_tables(out, course.zone)
    sys.stdout.write(f"tables {time.perf_counter() - begin:8.2f} s\n")


def main() -> None:
    """Grade the weeks, or only write their records."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--students", type=int, default=180)
    parser.add_argument("--weeks", type=int, nargs="+", default=list(range(1, 9)))
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--records", type=int, default=0)
    parser.add_argument("--folder", type=Path, help="keep everything there; the same command goes on")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        top = (options.folder or Path(folder)).resolve()
        top.mkdir(exist_ok=True)
        students = [f"s{number:03}" for number in range(options.records or options.students)]
        simulated = SimulatedClass(top, students, [f"week{week:02}" for week in options.weeks])
        if options.records:
            records_alone(simulated)
            return
        differences = graded_weeks(simulated, options.jobs)
        sys.stdout.write(
            "\n".join([*differences, f"{len(differences)} differ from what was declared"]) + "\n"
        )


if __name__ == "__main__":
    main()
