"""`course lab`: JupyterLab on the student's folder, with the address on the terminal."""

import os
import secrets
import signal
import socket
import subprocess
import sys
import time
import webbrowser
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import psutil

from course_lib.course.hand_out import DEFAULT_FOLDER, prepare
from course_lib.course.progress import CONTENTS_FILE, write_contents
from course_lib.errors import CourseError
from course_lib.foreign import read_json
from course_lib.surroundings import hub_prefix

FIRST_PORT = 8888
PORTS_TO_TRY = 100
START_SECONDS = 60.0  # [s] a first start compiles Python files on slow disks
JUPYTER_SETTINGS = Path(__file__).parent / "jupyter"  # no news pop-ups; Markdown opens as a page


def free_port(first: int = FIRST_PORT) -> int:
    """Return the first free port from `first` on.

    Raises:
        CourseError: none is free, or there is no such port.
    """
    if not 1 <= first <= 65535:
        raise CourseError(f"--port {first}: a port is a number from 1 to 65535. Try: course lab --port 8888")
    for port in range(first, min(first + PORTS_TO_TRY, 65536)):
        with socket.socket() as probe, suppress(OSError):
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(("127.0.0.1", port))
            return port
    raise CourseError(f"no free port from {first} on. Name another one: course lab --port 9500")


def command(folder: Path, port: int) -> list[str]:
    """Return the command that starts the server for this folder only, without pop-ups."""
    allow_root = ["--allow-root"] if hasattr(os, "geteuid") and os.geteuid() == 0 else []
    return [
        *(sys.executable, "-m", "jupyterlab", "--no-browser", *allow_root),
        f"--ServerApp.root_dir={folder}",
        f"--ServerApp.port={port}",
        "--ServerApp.answer_yes=True",  # one Ctrl+C ends it
        "--ServerApp.log_level=ERROR",
        "--LabApp.log_level=ERROR",
        f"--LabApp.default_url=/lab/tree/{CONTENTS_FILE}",
        "--LabApp.check_for_updates_class=jupyterlab.NeverCheckForUpdate",
    ]


@contextmanager
def server(folder: Path, port: int) -> Iterator[tuple["subprocess.Popen[bytes]", str]]:
    """Start JupyterLab; yield its process and its address, and stop it at the end of the block."""
    process, address = _started(folder, port)
    try:
        yield process, address
    finally:
        _stop(process)


def _started(folder: Path, port: int) -> tuple["subprocess.Popen[bytes]", str]:
    """Start JupyterLab on a port, or on another one if a program has taken the port meanwhile."""
    token = secrets.token_hex(24)
    settings = [str(JUPYTER_SETTINGS), *filter(None, [os.environ.get("JUPYTER_CONFIG_PATH")])]
    environment = {
        "JUPYTER_TOKEN": token,
        "JUPYTER_CONFIG_PATH": os.pathsep.join(settings),
        "PYTHONHASHSEED": "0",  # for the kernels: sets keep their order from run to run, as when grading
    }
    process = subprocess.Popen(
        command(folder, port), env=os.environ | environment, cwd=folder, stdin=subprocess.DEVNULL
    )
    try:
        url = _url_when_it_listens(process)
    except BaseException:  # Ctrl+C, too
        _stop(process)
        raise
    if url is not None:
        return process, f"{url}lab/tree/{CONTENTS_FILE}?token={token}"
    other = free_port(port)
    if process.poll() is None or other == port:
        _stop(process)
        raise CourseError("JupyterLab did not start; its own message stands above. Try: python -m jupyterlab")
    say(f"Another program has taken port {port} meanwhile, using {other}.")
    return _started(folder, other)


def _stop(process: "subprocess.Popen[bytes]") -> None:
    process.terminate()  # the server shuts its kernels down, then leaves
    try:
        process.wait(timeout=10)  # [s]
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def _url_when_it_listens(process: "subprocess.Popen[bytes]") -> str | None:
    """Return the URL of the server; None if it has ended or does not listen in time.

    Jupyter writes the URL into a file before it listens, so another program can take the port in between.
    """
    from jupyter_core.paths import jupyter_runtime_dir

    facts = Path(jupyter_runtime_dir()) / f"jpserver-{process.pid}.json"
    deadline = time.monotonic() + START_SECONDS
    while process.poll() is None and time.monotonic() < deadline:
        with suppress(OSError, ValueError, psutil.Error):  # not there yet, half written, or it ends just now
            url = str(read_json(facts.read_text())["url"])
            sockets = psutil.Process(process.pid).net_connections("tcp")
            if any(found.status == psutil.CONN_LISTEN for found in sockets):
                return url
        time.sleep(0.1)  # [s]
    return None


def can_open_browser() -> bool:
    """Return whether a graphical browser can be opened; text browsers would occupy the terminal."""
    if sys.platform.startswith("linux") and not (
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    ):
        return False
    with suppress(webbrowser.Error):
        webbrowser.get()
        return True
    return False


def lab(
    folder: Path = DEFAULT_FOLDER, *, port: int | None = None, browser: bool = True, serves: bool = True
) -> None:
    """Refresh the student's folder and serve it until Ctrl+C (or SIGTERM, as containers stop).

    On a JupyterHub, or without `serves`, the folder is all: there a JupyterLab runs already.

    Raises:
        CourseError: the folder or the port can't be used, or JupyterLab did not start.
    """
    folder = folder.expanduser().resolve()
    report = prepare(folder).lines()
    write_contents(folder)
    if hub_prefix() or not serves:
        next_step = f"Open {CONTENTS_FILE} of it in JupyterLab."
        say("\n".join([f"Your course folder: {folder}", *report, next_step]))
    else:
        _serve(folder, report, port, browser)


def _serve(folder: Path, report: list[str], port: int | None, browser: bool) -> None:
    chosen = free_port(FIRST_PORT if port is None else port)
    if port not in (None, chosen):
        report.append(f"Port {port} is taken, using {chosen}.")
    say("\n".join([f"Your course folder: {folder}", *report, "Starting JupyterLab …"]))
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        with server(folder, chosen) as (process, address):
            say(f"Open this address in a browser:\n\n    {address}\n\nStop with Ctrl+C.")
            if browser and can_open_browser():
                webbrowser.open(address)
            process.wait()
    except KeyboardInterrupt:
        say("\nJupyterLab is stopped. Your files are kept.")


def say(text: str) -> None:
    """Print a message at once, also into a pipe."""
    print(text, flush=True)  # noqa: T201  the command's own voice
