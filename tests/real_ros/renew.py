"""Renews the frozen outcomes of the real rclpy: `REAL_ROS_PYTHON=/path/to/venv/bin/python python renew.py`.

The environment is made with `requirements.txt`. Words after the command choose files by their
names. All traffic stays on this machine.
"""

import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import psutil

from course_lib.real.process import free_domain

HERE = Path(__file__).parent
ASLEEP = 2.0  # [s] a program that sleeps for so long, even on a busy machine, has started and waits
POLL = 0.1  # [s]
TIME_LIMIT = 180.0  # [s] of one file
AT_ONCE = 4
ENVIRONMENT = {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", "PYTHONUNBUFFERED": "1"}
_domains_in_use: set[int] = set()
_lock = threading.Lock()


def frozen_outcomes(name: str) -> dict[str, Any]:
    """Return the outcomes that are stored in a file."""
    frozen: dict[str, Any] = json.loads((HERE / "frozen" / f"{name}.json").read_text("utf-8"))
    outcomes: dict[str, Any] = frozen["outcomes"]
    return outcomes


@contextmanager
def own_domain() -> Iterator[int]:
    """Reserve a domain during a `with` block: its ports are free between two probes."""
    with _lock:
        domain = next(found for found in iter(free_domain, None) if found not in _domains_in_use)
        _domains_in_use.add(domain)
    try:
        yield domain
    finally:
        _domains_in_use.discard(domain)


def run(command: list[str], *, interrupt: bool = False) -> tuple[str, str, int]:
    """Run a program, with Ctrl+C when it waits; return its stdout, its stderr and its exit code.

    A program that does not end within `TIME_LIMIT` is killed.
    """
    with (
        own_domain() as domain,
        subprocess.Popen(
            command,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=os.environ | ENVIRONMENT | {"ROS_DOMAIN_ID": str(domain)},
            cwd=HERE,
        ) as process,
    ):
        if interrupt:
            _wait_until_asleep(process)
            process.send_signal(signal.SIGINT)
        try:
            out, err = process.communicate(timeout=TIME_LIMIT)
        except subprocess.TimeoutExpired:
            process.kill()
            out, err = process.communicate()
    return out, err, process.returncode


def _wait_until_asleep(process: subprocess.Popen[str]) -> None:
    """Wait until a process has slept for `ASLEEP`, or until it has ended.

    One that starts is running, or waits for a processor or the disk, which is no sleep.
    """
    program, polls, end = psutil.Process(process.pid), 0, time.monotonic() + TIME_LIMIT
    while process.poll() is None and polls < ASLEEP / POLL:
        if time.monotonic() > end:
            process.kill()
            sys.exit(f"{process.args!r} did not wait for anything within {TIME_LIMIT:g} s.")
        polls = polls + 1 if program.status() == psutil.STATUS_SLEEPING else 0
        time.sleep(POLL)


def outcome_of_program(out: str, err: str, code: int) -> dict[str, object]:
    """Return what a program printed and the last line of its traceback, as a shell reports it."""
    lines = [line for line in err.splitlines() if "Error: " in line and not line.startswith(" ")]
    error = re.sub(r"^[\w.]*\.|, at [^ ]*\.c:\d+$", "", lines[-1]) if lines and code else ""
    return {"stdout": out.splitlines(), "error": error, "exit": code % 256}


def outcomes_of_probes(python: str, file: Path) -> dict[str, str]:
    """Return the outcomes of the probes of a file under the real rclpy."""
    out, err, code = run([python, str(file)])
    if code:
        sys.exit(f"{file.name} ended with {code}:\n{err}")
    # Fast DDS writes to stdout if a killed program has left its shared memory locked.
    outcomes: dict[str, str] = json.loads(out.splitlines()[-1])
    return outcomes


def outcome_after_interrupt(python: str, file: Path) -> dict[str, object]:
    """Return the outcome of a program under the real rclpy that receives Ctrl+C."""
    out, err, code = run([python, str(file)], interrupt=True)
    # A shell reports a process that SIGINT has killed as 130.
    return outcome_of_program(out, err, 130 if code == -signal.SIGINT else code)


def outcomes_after_interrupt(python: str, files: Iterable[Path]) -> dict[str, dict[str, object]]:
    """Return what programs do under the real rclpy when they get Ctrl+C; several wait for it at a time."""
    files = sorted(files)
    with ThreadPoolExecutor(AT_ONCE) as threads:
        outcomes = threads.map(lambda file: outcome_after_interrupt(python, file), files)
        return {file.stem: outcome for file, outcome in zip(files, outcomes, strict=True)}


def main() -> None:
    """Run all files under the real rclpy and store the outcomes."""
    python = os.environ.get("REAL_ROS_PYTHON")
    if not python:
        sys.exit("Set REAL_ROS_PYTHON to the Python of an environment with requirements.txt.")
    version = "from importlib.metadata import version; print(version('ros-rclpy'))"
    release = run([python, "-c", version])[0].strip()
    for file in sorted((HERE / "probes").glob("*.py")):
        if file.stem == "probing" or not all(word in file.stem for word in sys.argv[1:]):
            continue
        _write(file.stem, {"rclpy": release, "outcomes": outcomes_of_probes(python, file)})
    if not sys.argv[1:] or "programs" in sys.argv[1:]:
        programs = outcomes_after_interrupt(python, (HERE / "programs").glob("*.py"))
        _write("programs", {"rclpy": release, "outcomes": programs})
    sys.path.insert(0, str(HERE.parents[1]))
    import course_lib  # noqa: F401  # makes ROS's names importable

    if not sys.argv[1:] or "mistakes" in sys.argv[1:]:
        from tests.real_ros.mistakes import outcomes_of_mistakes

        _write("mistakes", {"rclpy": release, "outcomes": outcomes_of_mistakes()})
    if not sys.argv[1:] or "nodes" in sys.argv[1:]:
        from tests.real_ros.nodes import outcomes_in_kit, outcomes_on_ros

        _write("nodes", {"rclpy": release, "outcomes": outcomes_on_ros(outcomes_in_kit())})


def _write(name: str, content: object) -> None:
    text = json.dumps(content, indent=1, ensure_ascii=False)
    (HERE / "frozen" / f"{name}.json").write_text(f"{text}\n", encoding="utf-8")
    sys.stdout.write(f"frozen/{name}.json\n")


if __name__ == "__main__":
    main()
