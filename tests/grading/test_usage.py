import os
from contextlib import closing
from pathlib import Path

import pytest

from course_lib.course.course_file import Limits
from course_lib.grading.run.outcome import Usage
from course_lib.grading.run.run import Job, Step, read_usage, run_scenarios
from course_lib.grading.run.submission_run import SubmissionRun
from course_lib.grading.store import usage_path
from course_lib.grading.task import Call, Scenario, Task

ANSWER = Task("week01.answer", "An answer", "value", "answer", ("a", "b", "c"), (Scenario("public"),))


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
    steps = (Step(ANSWER, ANSWER.scenarios[0], hidden=False),)
    cells = ("import os\nanswer = len(os.sched_getaffinity(0))",)
    made = run_scenarios(Job(cells, None, steps, Limits()))
    assert made.runs[0].evidence.returns == (1,)
    assert os.sched_getaffinity(0) == allowed


def test_usage_is_read_from_its_file_and_invalid_usage_is_none(tmp_path: Path) -> None:
    path = usage_path(tmp_path, "key")
    assert read_usage(tmp_path, "key") is None
    path.parent.mkdir()
    path.write_text(Usage(1.5, 90.0).as_json())
    assert read_usage(tmp_path, "key") == Usage(1.5, 90.0)
    path.write_text('{"cpu": 1')
    assert read_usage(tmp_path, "key") is None
