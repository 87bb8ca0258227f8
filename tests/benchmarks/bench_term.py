"""A term on this machine by the commands: weeks handed in, collected, graded, marked, returned, added up.

    python -m tests.benchmarks.bench_term --students 12 --weeks 1 3
    python -m tests.benchmarks.bench_term --folder term          # 180 students, 8 weeks; goes on after a kill
    python -m tests.benchmarks.bench_term --records 180          # records alone: no code runs

Students hand in right answers, the wrong ones of the course's own tables, mutants, copies, broken and hostile
files, or nothing; some are late, some have more time, in one week groups hand in. The script recompute.py in
tests/grading/term, which knows nothing of the kit, computes the totals again and compares each mark with what
was declared of the answer.
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
from course_lib.grading.term.term import Files, write_term
from tests.grading.term import recompute
from tests.grading.term.handed_in import HandIn
from tests.grading.term.simulated import write_results
from tests.grading.term.simulated_term import SimulatedTerm

MARKS = 5  # of persons, in each week with a task that a person reads
REQUESTS = 3  # to look again, in each week
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
    """The commands of a term, each of which is run once, also over several starts of this program."""

    def __init__(self, term: SimulatedTerm) -> None:
        self._term, self._log = term, term.top / "costs.jsonl"
        lines = self._log.read_text().splitlines() if self._log.is_file() else []
        self._done = {made.step: made for made in (Cost(**json.loads(line)) for line in lines)}

    def run(self, step: str, count: int, *words: str, codes: Sequence[int] = (0,)) -> Cost:
        """Run `course WORDS` and print its cost."""
        if step not in self._done:
            made = self._measure(step, count, words, codes)
            with self._log.open("a") as file:
                file.write(json.dumps(asdict(made)) + "\n")
            self._done[step] = made
            sys.stdout.write(f"{made}\n")
            sys.stdout.flush()
        return self._done[step]

    def _measure(self, step: str, count: int, words: Sequence[str], codes: Sequence[int]) -> Cost:
        environment = {**os.environ, **self._term.environment}
        begin, most = time.perf_counter(), [0.0]
        with tempfile.TemporaryFile("w+") as said:
            command = [sys.executable, "-m", "course_lib", *words]
            process = subprocess.Popen(command, cwd=self._term.top, env=environment, stdout=said, stderr=said)
            ended = threading.Event()
            watch = threading.Thread(target=_watch, args=(process.pid, ended, most))
            watch.start()
            _, status, used = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            ended.set()
            watch.join()
            said.seek(0)
            text = said.read()
        if process.returncode not in codes:
            raise SystemExit(f"course {' '.join(words)}: code {process.returncode}\n{text[-3000:]}")
        cpu = used.ru_utime + used.ru_stime
        return Cost(step, count, time.perf_counter() - begin, cpu, most[0], text)


def _watch(pid: int, ended: threading.Event, most: list[float]) -> None:
    root = psutil.Process(pid)
    while not ended.wait(SAMPLE):
        try:
            most[0] = max(most[0], memory_of(root))
        except psutil.NoSuchProcess:
            return


def week_of(term: SimulatedTerm, week: str, commands: Commands, jobs: int) -> list[HandIn]:
    """Collect, grade and mark a week."""
    made = term.hand_in(week)
    exercise, count = f"{week}_exercise", len(made)
    lists = ("--roster", f"{week}.csv", "--id-column", "ID number")
    commands.run(f"{week} collect", count, "collect", f"{week}.zip", "--out", "in", *lists, codes=(0, 1))
    only = ("--only", f"*/{exercise}", "--jobs", str(jobs), "--resume")
    commands.run(f"{week} grade", count, "grade", "in", "--out", "graded", *only, codes=(0, 1))
    for number, (student, task, points) in enumerate(term.by_hand(made, week, MARKS)):
        words = ("mark", "graded", student, exercise, task, points, "--comment", "Read.")
        commands.run(f"{week} mark {number}", 1, *words)
    return made


def look_again(term: SimulatedTerm, handed: dict[str, list[HandIn]], commands: Commands) -> None:
    """Enter requests, answer some of them, and change a mark."""
    first = [(week, one) for week, made in handed.items() for one in made[:REQUESTS] if one.expected]
    asked = [(one.student, f"{week}_exercise", next(iter(one.expected))) for week, one in first]
    for student, exercise, _ in asked:
        (term.top / "requests" / student).mkdir(parents=True, exist_ok=True)
        (term.top / "requests" / student / f"{exercise}.txt").write_text("Please look at it <b>again</b>.")
    commands.run("requests", len(asked), "regrade", "graded", "--requests", "requests")
    for number, (student, exercise, task) in enumerate(asked[::2]):
        answer = ("regrade", "graded", student, exercise, "--answer", "You are right: it is changed.")
        commands.run(f"answer {number}", 1, *answer)
        commands.run(f"changed mark {number}", 1, "mark", "graded", student, exercise, task, "7.5")


def compared(term: SimulatedTerm) -> list[str]:
    """Return where totals and marks differ from those of the script."""
    out, top = term.top / "graded", term.top
    with (out / "term.csv").open(newline="") as file:
        totals = {row["student"]: row["total"] for row in csv.DictReader(file)}
    lists = (top / "roster.csv", term.course_toml, top / "exemptions.csv", top / "quizzes.csv")
    again = recompute.totals(out, *lists)
    wrong = [
        f"{one}: {totals[one]}, expected {total}"
        for one, total in again.items()
        if (total is None) != (totals[one] == "") or abs(float(totals[one] or 0) - (total or 0)) > 0.03
    ]
    declared = [one for week in term.weeks for one in json.loads((top / f"{week}.declared.json").read_text())]
    return wrong + recompute.disagreements(out, declared, 10)


def summary(term: SimulatedTerm, handed: dict[str, list[HandIn]]) -> str:
    """Return the numbers of hand-ins, runs and states."""
    kinds = Counter(one.kind for made in handed.values() for one in made)
    with (term.top / "graded" / "gradebook.csv").open(newline="") as file:
        states = Counter(row["status"] for row in csv.DictReader(file))
    runs = len(list((term.top / "graded" / "evidence").glob("*.gz")))
    return f"{sum(kinds.values())} hand-ins {dict(kinds)}\n{runs} of them run; states {dict(states)}\n"


def graded_term(term: SimulatedTerm, jobs: int) -> list[str]:
    """Run the whole term; returns where the marks differ from those of the script."""
    term.write()
    commands = Commands(term)
    handed = {week: week_of(term, week, commands, jobs) for week in term.weeks}
    look_again(term, handed, commands)
    count = sum(map(len, handed.values()))
    commands.run("feedback", count, "feedback", "graded", "--lms", "moodle")
    lists = ("--roster", "roster.csv", "--exemptions", "exemptions.csv", "--quizzes", "quizzes.csv")
    commands.run("term", count, "term", "graded", *lists)
    names = ("--exercise", "term", "--column", "Grade", "--id-column", "ID number", "--to", "totals.csv")
    commands.run("totals", count, "mark", "graded", "--lms", f"{term.weeks[-1]}.csv", *names)
    sys.stdout.write(summary(term, handed))
    return compared(term)


def records_alone(term: SimulatedTerm) -> None:
    """Print the seconds of tables and totals over made-up records."""
    term.write()
    course, out = read_course_file(term.course_toml), term.top / "graded"
    write_results(out, list(term.students), course)
    top = term.top
    for what, action in (
        ("tables", lambda: write_tables(out, course.zone)),
        ("term", lambda: write_term(out, Files(top / "roster.csv", None, top / "quizzes.csv"), course)),
    ):
        begin = time.perf_counter()
        action()
        sys.stdout.write(f"{what:12} {time.perf_counter() - begin:8.2f} s\n")


def main() -> None:
    """Run a term, or only its records."""
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
        term = SimulatedTerm(top, students, [f"week{week:02}" for week in options.weeks])
        if options.records:
            records_alone(term)
            return
        wrong = graded_term(term, options.jobs)
        sys.stdout.write("\n".join([*wrong, f"{len(wrong)} differ from the script's"]) + "\n")


if __name__ == "__main__":
    main()
