"""`course lab`: update the student's folder, and start and stop JupyterLab in it."""

import os
import secrets
import shlex
import signal
import socket
import subprocess
import sys
import sysconfig
import time
import webbrowser
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import psutil

from course_lib.course.progress import CONTENTS_FILE, write_contents
from course_lib.course.state import STATE_FOLDER
from course_lib.course.student_folder import DEFAULT_FOLDER, prepare
from course_lib.errors import CourseError
from course_lib.host import hub_prefix
from course_lib.third_party import read_json

FIRST_PORT = 8888
PORTS_TO_TRY = 100
# Time limit [s]. A first start compiles Python files, perhaps on a slow disk.
START_SECONDS = 180.0
# These settings disable pop-ups about news, and open Markdown files as rendered pages.
JUPYTER_SETTINGS = Path(__file__).parent / "jupyter"
# JupyterLab finds the extension of an installed wheel automatically, but not in a checkout.
LAB_EXTENSIONS = JUPYTER_SETTINGS / "labextensions"
KERNEL_STARTUP = JUPYTER_SETTINGS / "kernel_startup.py"


def free_port(first: int = FIRST_PORT) -> int:
    """Return the first free port at or above `first`.

    Raises:
        CourseError: No port is free, or the number is not a port.
    """
    if not 1 <= first <= 65535:
        raise CourseError(f"--port {first}: a port is a number from 1 to 65535. Try: course lab --port 8888")
    for port in range(first, min(first + PORTS_TO_TRY, 65536)):
        with socket.socket() as probe, suppress(OSError):
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(("127.0.0.1", port))
            return port
    raise CourseError(f"no free port from {first} on. Choose another one: course lab --port 9500")


def command(folder: Path, port: int) -> list[str]:
    """Return the command that starts the server for this folder only, without pop-ups."""
    allow_root = ["--allow-root"] if hasattr(os, "geteuid") and os.geteuid() == 0 else []
    # Without a terminal of its own, Jupyter runs login shells in its terminals, and Debian's
    # /etc/profile replaces the PATH in which `course` is found.
    shell = shlex.quote(os.environ.get("SHELL") or "sh")
    terminals = [] if os.name == "nt" else [f"--ServerApp.terminado_settings=shell_command={shell}"]
    return [
        *(sys.executable, "-P", "-m", "course_lib.course.jupyterlab", "--no-browser"),
        *(allow_root + terminals),
        f"--ServerApp.root_dir={folder}",
        f"--ServerApp.port={port}",
        # Stop at the first Ctrl+C, without asking.
        "--ServerApp.answer_yes=True",
        "--ServerApp.log_level=ERROR",
        "--LabApp.log_level=ERROR",
        f"--LabApp.extra_labextensions_path={LAB_EXTENSIONS}",
        f"--LabApp.default_url=/lab/tree/{CONTENTS_FILE}",
        "--LabApp.check_for_updates_class=jupyterlab.NeverCheckForUpdate",
    ]


@contextmanager
def server(folder: Path, port: int) -> Iterator[tuple["subprocess.Popen[bytes]", str]]:
    """Start JupyterLab, yield its process and address, and stop it at the end of the block."""
    process, address = _start_jupyterlab(folder, port)
    try:
        yield process, address
    finally:
        _stop(process)


def _start_jupyterlab(folder: Path, port: int) -> tuple["subprocess.Popen[bytes]", str]:
    """Start JupyterLab on a port, or on another one if the port has been taken in the meantime."""
    token = secrets.token_hex(24)
    settings = [str(JUPYTER_SETTINGS), *filter(None, [os.environ.get("JUPYTER_CONFIG_PATH")])]
    paths = [sysconfig.get_path("scripts"), *filter(None, [os.environ.get("PATH")])]
    environment = {
        # JupyterLab's terminals find `course` even if no virtual environment was activated.
        "PATH": os.pathsep.join(paths),
        "JUPYTER_TOKEN": token,
        "JUPYTER_CONFIG_PATH": os.pathsep.join(settings),
        # For the kernels: the order of sets is the same in every run, as in grading.
        "PYTHONHASHSEED": "0",
        "PYTHONSTARTUP": os.environ.get("PYTHONSTARTUP") or str(KERNEL_STARTUP),
    }
    process = subprocess.Popen(
        command(folder, port), env=os.environ | environment, cwd=folder, stdin=subprocess.DEVNULL
    )
    try:
        url = _wait_for_server_url(process)
    # Includes Ctrl+C.
    except BaseException:
        _stop(process)
        raise
    if url is not None:
        return process, f"{url}lab/tree/{CONTENTS_FILE}?token={token}"
    other = free_port(port)
    if process.poll() is None or other == port:
        _stop(process)
        raise CourseError("JupyterLab did not start; see its message above. Try: python -m jupyterlab")
    print_now(f"Another program has taken port {port} in the meantime. Using port {other}.")
    return _start_jupyterlab(folder, other)


def _stop(process: "subprocess.Popen[bytes]") -> None:
    # The server shuts down its kernels before it exits.
    process.terminate()
    try:
        process.wait(timeout=10)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def _wait_for_server_url(process: "subprocess.Popen[bytes]") -> str | None:
    """Return the URL of the server, or None if it has ended or does not listen in time.

    Jupyter writes the URL into a file before it listens, so another program can take the port in
    between.
    """
    from jupyter_core.paths import jupyter_runtime_dir

    facts = Path(jupyter_runtime_dir()) / f"jpserver-{process.pid}.json"
    deadline = time.monotonic() + START_SECONDS
    while process.poll() is None and time.monotonic() < deadline:
        # The file may be missing or incomplete, or the process may have just ended.
        with suppress(OSError, ValueError, psutil.Error):
            url = str(read_json(facts.read_text())["url"])
            sockets = psutil.Process(process.pid).net_connections("tcp")
            if any(connection.status == psutil.CONN_LISTEN for connection in sockets):
                return url
        time.sleep(0.1)
    return None


def running_address(folder: Path) -> str | None:
    """Return the address of the JupyterLab that another `course lab` runs in this folder, or None.

    A second one would start a second kernel for a notebook that is open, and the two pages would
    overwrite each other's changes.
    """
    from jupyter_core.paths import jupyter_runtime_dir

    for facts in Path(jupyter_runtime_dir()).glob("jpserver-*.json"):
        # The file may be incomplete, or belong to another computer with the same home folder.
        with suppress(OSError, ValueError, KeyError, psutil.Error):
            server_info = read_json(facts.read_text())
            process = psutil.Process(int(server_info["pid"]))
            # Ctrl+Z in a terminal stops both programs, and then no page can be opened.
            is_stopped = process.status() in (psutil.STATUS_STOPPED, psutil.STATUS_ZOMBIE)
            if f"--ServerApp.root_dir={folder}" in process.cmdline() and not is_stopped:
                return f"{server_info['url']}lab/tree/{CONTENTS_FILE}?token={server_info['token']}"
    return None


def provide_home(folder: Path) -> list[str]:
    """Set HOME to a folder in the student's folder if the user's home is not writable.

    JupyterLab and IPython do not start without one, which some containers and hubs lack.

    Returns:
        A line for the student if HOME was set.
    """
    home = os.path.expanduser("~")  # "~" itself if the user has none
    if os.access(home, os.W_OK):
        return []
    own = folder / STATE_FOLDER / "home"
    own.mkdir(parents=True, exist_ok=True)
    os.environ["HOME"] = str(own)
    return [f"Your home folder {home} cannot be written, so Jupyter's settings are in {own}."]


def can_open_browser() -> bool:
    """Return whether a graphical browser can be opened.

    A text browser would occupy the terminal.
    """
    if sys.platform.startswith("linux") and not (
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    ):
        return False
    with suppress(webbrowser.Error):
        webbrowser.get()
        return True
    return False


def lab(
    folder: Path = DEFAULT_FOLDER,
    *,
    port: int | None = None,
    browser: bool = True,
    serves: bool = True,
) -> None:
    """Update the student's folder and serve it until Ctrl+C, or SIGTERM when a container stops.

    The end of the terminal (SIGHUP) also stops it, unless it was started by `nohup`. On a
    JupyterHub, or without `serves`, only the folder is updated, because JupyterLab already runs. If
    it runs in this folder already, its address is printed, unless another port is requested.

    Raises:
        CourseError: The folder or the port cannot be used, or JupyterLab did not start.
    """
    folder = folder.expanduser().resolve()
    report = prepare(folder).lines()
    write_contents(folder)
    if hub_prefix() or not serves:
        next_step = f"Open {CONTENTS_FILE} of it in JupyterLab."
        print_now("\n".join([f"Your course folder: {folder}", *report, next_step]))
    elif port is None and (address := running_address(folder)):
        running = "JupyterLab already runs in this folder."
        print_now("\n".join([f"Your course folder: {folder}", *report, running]))
        print_now(f"Open this address in a browser:\n\n    {address}\n\nStop it with Ctrl+C in its terminal.")
        if browser and can_open_browser():
            webbrowser.open(address)
    else:
        server_port = free_port(FIRST_PORT if port is None else port)
        if port not in (None, server_port):
            report.append(f"Port {port} is taken, using {server_port}.")
        report += provide_home(folder)
        print_now("\n".join([f"Your course folder: {folder}", *report, "Starting JupyterLab …"]))
        signal.signal(signal.SIGTERM, signal.default_int_handler)
        if hasattr(signal, "SIGHUP") and signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:
            signal.signal(signal.SIGHUP, signal.default_int_handler)
        try:
            with server(folder, server_port) as (process, address):
                print_now(f"Open this address in a browser:\n\n    {address}\n\nStop with Ctrl+C.")
                if browser and can_open_browser():
                    webbrowser.open(address)
                process.wait()
        except KeyboardInterrupt:
            print_now("\nJupyterLab is stopped. Your files are kept.")


def print_now(text: str) -> None:
    """Print a message and flush it, so that it also appears when the output is a pipe."""
    print(text, flush=True)  # noqa: T201  the output of the command
