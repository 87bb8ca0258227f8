"""`course grade` with an incomplete sandbox: refusals, exit codes and messages."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from course_lib import cli
from course_lib.grading.jail.filters import LAYERS
from course_lib.grading.jail.launch import TemplateProcess
from course_lib.grading.store import Course
from tests.grading.graders import write_class
from tests.patience import PATIENCE
from tests.processes import Program

Grade = Callable[..., int]
WITHOUT_NAMESPACES = ("bubblewrap", "namespaces")


@pytest.fixture(scope="module")
def templates() -> Iterator[dict[tuple[str, ...], TemplateProcess]]:
    """Templates by the layers that they do without: each is started once."""
    opened: dict[tuple[str, ...], TemplateProcess] = {}
    yield opened
    for template in opened.values():
        template.close()


@pytest.fixture
def with_layers(
    templates: dict[tuple[str, ...], TemplateProcess],
    course: Course,
    right: str,
    write_notebook: Callable[..., Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> Callable[..., Grade]:
    """Return a `course grade OPTIONS` without some layers; it returns the exit code."""
    write_notebook(tmp_path / "in" / "ada" / "week01_exercise.ipynb", right, student="ada")

    def without(*off: str) -> Grade:
        template = templates.get(off) or templates.setdefault(off, TemplateProcess(off))
        monkeypatch.setattr("course_lib.grading.run.run.shared_template", lambda _: template)
        monkeypatch.setattr("course_lib.grading.store.exercises_dir", lambda: course.exercises)
        monkeypatch.setattr("course_lib.grading.store.solutions_dir", lambda: course.solutions)
        return run

    def run(*options: str) -> int:
        words = ("grade", str(tmp_path / "in"), "--out", str(tmp_path / "out"), "--jobs", "1", *options)
        monkeypatch.setattr(sys, "argv", ["course", *words])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        code = ended.value.code
        assert isinstance(code, int)
        return code

    return without


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("off", "options", "code", "says"),
    [
        (LAYERS, (), 2, "your rights, no sandbox (lacks namespaces"),
        (LAYERS, ("--require-sandbox",), 2, "--require-sandbox: this machine has only: no sandbox"),
        (LAYERS, ("--i-trust-these-submissions",), 0, "Isolation of 1 submission: no sandbox (lacks"),
        (LAYERS, ("--require-sandbox", "--i-trust-these-submissions"), 2, "--require-sandbox"),
        (WITHOUT_NAMESPACES, ("--require-sandbox",), 2, "--require-sandbox: this machine has only: partial"),
        (
            WITHOUT_NAMESPACES,
            (),
            0,
            "Isolation of 1 submission: partial sandbox (has Landlock, seccomp, limits",
        ),
    ],
)
def test_insufficient_sandbox_exits_with_2_before_running_submissions(
    with_layers: Callable[..., Grade],
    off: tuple[str, ...],
    options: tuple[str, ...],
    code: int,
    says: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert with_layers(*off)(*options) == code
    captured = capsys.readouterr()
    assert says in captured.out + captured.err
    assert (tmp_path / "out/results").exists() == (code == 0)


INTERRUPTED = """
import sys
from pathlib import Path
from course_lib import cli
from course_lib.grading import grade
from course_lib.grading.store import Course

if __name__ == "__main__":
    top = Path(sys.argv[1])
    grade.this_course = lambda: Course(top / "course/exercises", top / "course/solutions")
    sys.argv = ["course", "grade", str(top / "in"), "--out", str(top / "out"), "--jobs", sys.argv[2]]
    cli.main()
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_terminal_interrupts_during_process_start_print_no_traceback(course: Course, tmp_path: Path) -> None:
    write_class(tmp_path, 2)
    script = tmp_path / "interrupted.py"
    script.write_text(INTERRUPTED)
    command = [sys.executable, str(script), str(tmp_path), "2"]
    grader = Program(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True)

    def starts_a_process() -> bool:
        # A thread or process that is listed may have ended.
        with suppress(OSError):
            tasks = Path(f"/proc/{grader.pid}/task").glob("*/children")
            started = [pid for task in tasks for pid in task.read_text().split()]
            return any(b"spawn_main" in Path(f"/proc/{pid}/cmdline").read_bytes() for pid in started)
        return False

    while grader.poll() is None and not starts_a_process():
        time.sleep(0.005)
    for _ in range(2):
        os.killpg(grader.pid, signal.SIGINT)
        time.sleep(0.3)
    output = grader.communicate(timeout=PATIENCE)[0]
    assert grader.returncode in (130, -signal.SIGINT)
    assert "Traceback" not in output
    assert "resource_tracker" not in output


@pytest.mark.slow
@pytest.mark.sample(1)
@pytest.mark.parametrize("jobs", [1, 2])
@pytest.mark.parametrize("gap", [0.0, 0.05, 0.5])
def test_further_interrupts_print_no_traceback_and_leave_no_half_written_result(
    course: Course, tmp_path: Path, jobs: int, gap: float
) -> None:
    write_class(tmp_path, 30)
    script = tmp_path / "interrupted.py"
    script.write_text(INTERRUPTED)
    command = [sys.executable, str(script), str(tmp_path), str(jobs)]
    grader = Program(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    while grader.poll() is None and not any(tmp_path.glob("out/results/*/*.json")):
        time.sleep(0.01)
    for _ in range(3):
        grader.send_signal(signal.SIGINT)
        time.sleep(gap)
    output = grader.communicate(timeout=PATIENCE)[0]
    assert grader.returncode in (130, -signal.SIGINT)
    assert "Traceback" not in output
    assert "Exception ignored" not in output
    for path in tmp_path.glob("out/results/*/[!.]*.json"):
        json.loads(path.read_text())
