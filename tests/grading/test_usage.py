import json
import os
import re
import sys
from contextlib import closing
from dataclasses import asdict
from pathlib import Path

import pytest

from course_lib.course.course_file import Limits
from course_lib.grading.jail.filters import Usage
from course_lib.grading.run.run import Job, Step, read_usage, run_scenarios
from course_lib.grading.run.submission_run import SubmissionRun
from course_lib.grading.store import usage_path
from course_lib.grading.task import Call, Scenario, Task

ANSWER = Task("week01.answer", "An answer", "value", "answer", ("a", "b", "c"), (Scenario("public"),))

linux = pytest.mark.skipif(sys.platform != "linux", reason="only Linux lists the memory of processes")

FORK = """
import os, signal
for _ in range({count}):
    if os.fork() == 0:
        {statement}
        signal.pause()
signal.pause()
"""


def used(*cells: str) -> Usage:
    with closing(SubmissionRun(cells, {ANSWER.id: {}}, Limits())) as session:
        session.run(ANSWER, ANSWER.scenarios[0])
    return session.usage


@pytest.mark.slow
def test_resource_usage_includes_child_processes() -> None:
    idle = used("answer = 1")
    busy = used("answer = sum(range(30_000_000))")
    large = used("answer = len(bytearray(200_000_000))")
    child = used(
        "import os\nif os.fork() == 0:\n    sum(range(30_000_000)); os._exit(0)\nanswer = os.wait()[1]"
    )
    assert busy.cpu_seconds > 2 * idle.cpu_seconds
    assert child.cpu_seconds > 2 * idle.cpu_seconds
    assert large.memory_megabytes > idle.memory_megabytes + 190


def run_with_limit(*cells: str, megabytes: float = 400) -> SubmissionRun:
    """Run cells, then a task that needs another one, and return the closed run."""
    limits = Limits(memory_megabytes=megabytes)
    with closing(SubmissionRun([*cells, "answer = 1"], {ANSWER.id: {}}, limits)) as session:
        assert session.run(ANSWER, ANSWER.scenarios[0]).returns == (1,)
    return session


@linux
def test_memory_of_a_process_does_not_include_the_modules_of_the_kit() -> None:
    cells = ("import rclpy, numpy", "x = bytearray(300_000_000)", "y = bytearray(300_000_000)")
    log = run_with_limit(*cells).log
    assert log.errors == ["MemoryError (cell In[3], line 1: y = bytearray(300_000_000))"]


@linux
@pytest.mark.parametrize(
    "cell",
    [
        FORK.format(count=20, statement="x = bytearray(b'x') * 100_000_000"),
        "x = bytearray(b'x') * 150_000_000"
        + FORK.format(count=20, statement="x[::4096] = bytes(len(x[::4096]))"),
        FORK.format(count=20, statement="os.setsid(); x = bytearray(b'x') * 100_000_000"),
        FORK.format(count=20, statement="os.fork() and os._exit(0); x = bytearray(b'x') * 100_000_000"),
        "for _ in range(20):\n    x = bytearray(b'x') * 100_000_000; import os, signal\n"
        "    if os.fork() == 0: signal.pause()\nsignal.pause()",
    ],
    ids=["forks", "written pages of forks", "sessions", "grandchildren", "pages of a former parent"],
)
def test_all_processes_together_exceeding_memory_are_killed_and_the_cell_skipped(cell: str) -> None:
    session = run_with_limit(cell)
    assert list(session.log.stopped) == [0], session.log
    assert re.fullmatch(
        r"cell 1 was stopped: its \d+ processes together used [\d,]+ MB of memory, more than 800 MB",
        session.log.stopped[0],
    )
    assert session.log.limit == "memory"


@linux
def test_many_idle_processes_do_not_exceed_the_memory_of_all_processes() -> None:
    cell = (
        "import os\nreader, writer = os.pipe()\nchildren = []\nfor _ in range(50):\n"
        "    child = os.fork()\n    if child == 0: os.close(writer); os.read(reader, 1); os._exit(0)\n"
        "    children.append(child)\nx = sum(range(10_000_000))\nos.close(writer)\n"
        "for child in children: os.waitpid(child, 0)"
    )
    assert run_with_limit(cell).log.stopped == {}


@linux
def test_scenario_exceeding_the_memory_of_all_processes_is_stopped_and_the_next_one_runs() -> None:
    cell = "def crowd():\n" + FORK.format(count=20, statement="x = bytearray(b'x') * 100_000_000").replace(
        "\n", "\n    "
    )
    crowd = Task(
        "week01.crowd", "Crowd", "function", "crowd", ("a", "b", "c"), (Scenario("p", calls=(Call(),)),)
    )
    limits = Limits(memory_megabytes=400)
    with closing(SubmissionRun([cell, "answer = 1"], {ANSWER.id: {}, crowd.id: {}}, limits)) as session:
        evidence = session.run(crowd, crowd.scenarios[0])
        assert evidence.stopped == "memory"
        assert "processes together used" in evidence.errors[0]
        assert session.run(ANSWER, ANSWER.scenarios[0]).returns == (1,)


@pytest.mark.parametrize("show", ["print", "display", "sys.stderr.write"])
def test_printed_output_does_not_count_as_memory(show: str) -> None:
    first = "import sys\nfrom IPython.display import display\n"
    loop = f"for n in range(60): {show}(str(n) * 500_000)"
    quiet, loud = used(f"{first}answer = 1"), used(f"{first}{loop}\nanswer = 1")
    assert loud.memory_megabytes < quiet.memory_megabytes + 20  # 60 MB were printed


def test_cpu_time_is_measured_per_scenario() -> None:
    busy = Task(
        "week01.busy", "Busy", "function", "busy", ("a", "b", "c"), (Scenario("public", calls=(Call(1),)),)
    )
    cells = ("answer = 1\ndef busy(x):\n    return sum(range(20_000_000))",)
    with closing(SubmissionRun(cells, {ANSWER.id: {}, busy.id: {}}, Limits())) as session:
        for task in (ANSWER, busy):
            session.run(task, task.scenarios[0])
    times = session.usage.scenarios
    assert times["week01.busy/public"] > 10 * times["week01.answer/public"] > 0
    assert sum(times.values()) < session.usage.cpu_seconds


@pytest.mark.skipif(not hasattr(os, "sched_getaffinity"), reason="the system keeps no process on a processor")
def test_submission_runs_on_one_cpu_and_grader_affinity_is_restored() -> None:
    allowed = os.sched_getaffinity(0)
    steps = (Step(ANSWER, ANSWER.scenarios[0], is_hidden=False),)
    cells = ("import os\nanswer = len(os.sched_getaffinity(0))",)
    made = run_scenarios(Job(cells, None, steps, Limits()))
    assert made.runs[0].evidence.returns == (1,)
    assert os.sched_getaffinity(0) == allowed


def test_usage_is_read_from_its_file_and_invalid_usage_is_none(tmp_path: Path) -> None:
    path = usage_path(tmp_path, "key")
    assert read_usage(tmp_path, "key") is None
    path.parent.mkdir()
    path.write_text(json.dumps(asdict(Usage(1.5, 90.0))))
    assert read_usage(tmp_path, "key") == Usage(1.5, 90.0)
    path.write_text('{"cpu": 1')
    assert read_usage(tmp_path, "key") is None
