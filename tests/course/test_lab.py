import hashlib
import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import psutil
import pytest
import websocket
from jupyter_client.blocking.client import BlockingKernelClient
from nbconvert import HTMLExporter, SlidesExporter
from nbformat.v4 import new_code_cell, new_notebook, new_output
from traitlets.config.loader import JSONFileConfigLoader

from course_lib.course import lab as lab_module
from course_lib.course.lab import can_open_browser, command, free_port, lab, provide_home
from course_lib.errors import CourseError
from tests.patience import PATIENCE
from tests.processes import Program

HOME_DIRS = ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR")


@pytest.fixture
def taken() -> Iterator[int]:
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        listener.listen()
        yield listener.getsockname()[1]


def test_next_free_port_is_used_if_the_port_is_occupied(taken: int) -> None:
    assert taken < free_port(taken) <= taken + 100


@pytest.mark.parametrize("port", [-1, 0, 65536])
def test_invalid_port_is_rejected(port: int) -> None:
    with pytest.raises(CourseError, match="from 1 to 65535"):
        free_port(port)


def test_allow_root_is_passed_only_for_the_root_user(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(os, "geteuid", lambda: 0, raising=False)
    assert "--allow-root" in command(tmp_path, 8888)
    monkeypatch.setattr(os, "geteuid", lambda: 1000, raising=False)
    assert "--allow-root" not in command(tmp_path, 8888)


def test_server_starts_without_compiling_grammars_of_addresses(tmp_path: Path) -> None:
    words = [sys.executable, "-X", "importtime", *command(tmp_path, 8888)[1:4], "--version"]
    done = subprocess.run(words, capture_output=True, text=True, check=True, timeout=PATIENCE)
    modules = {line.rpartition("|")[2].strip() for line in done.stderr.splitlines()}
    assert "jsonschema" in modules
    assert "lark" not in modules


def test_address_of_the_extension_changes_with_its_content() -> None:
    """Jupyter tells browsers to keep each address of an extension for a year, without asking again."""
    folder = lab_module.LAB_EXTENSIONS / "course-lib"
    digest = hashlib.sha256((folder / "static/remoteEntry.js").read_bytes()).hexdigest()[:12]
    build = json.loads((folder / "package.json").read_text())["jupyterlab"]["_build"]
    assert build["load"] == f"static/remoteEntry.js?v={digest}"


def test_no_browser_is_opened_without_a_display(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "linux")
    for variable in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(variable, raising=False)
    assert not can_open_browser()


@pytest.mark.skipif(os.name == "nt", reason="HOME is not used")
def test_missing_home_folder_is_replaced_by_one_in_the_course_folder(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    assert provide_home(tmp_path / "mine") == []
    monkeypatch.setenv("HOME", str(tmp_path / "missing"))
    (line,) = provide_home(tmp_path / "mine")
    assert "missing cannot be written" in line
    assert Path.home() == tmp_path / "mine/.course/home"
    assert Path.home().is_dir()


def test_failing_server_start_is_reported_in_one_line(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(lab_module, "command", lambda *_: [sys.executable, "-c", "raise SystemExit(1)"])
    with pytest.raises(CourseError, match="JupyterLab did not start"):
        lab(tmp_path / "mine", browser=False)


@pytest.mark.parametrize("serves", [True, False])
def test_course_lab_on_a_hub_or_with_no_server_only_creates_the_folder(
    serves: bool, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if serves:
        monkeypatch.setenv("JUPYTERHUB_SERVICE_PREFIX", "/user/ada/")
    monkeypatch.setattr(lab_module, "command", lambda *_: pytest.fail("a server was started"))
    lab(tmp_path / "mine", serves=serves)
    assert "Open contents.md of it in JupyterLab." in capsys.readouterr().out
    assert (tmp_path / "mine" / "contents.md").is_file()


OVERTAKEN = """
import json, pathlib, os, jupyter_core.paths
folder = pathlib.Path(jupyter_core.paths.jupyter_runtime_dir())
folder.mkdir(parents=True, exist_ok=True)
(folder / f"jpserver-{os.getpid()}.json").write_text(json.dumps({"url": "http://localhost:8888/"}))
raise SystemExit("ERROR: no available port could be found")
"""


@pytest.mark.slow
def test_port_taken_during_startup_is_replaced_by_the_next_port(
    taken: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Jupyter names its address in a file before it listens there."""
    for name in HOME_DIRS:
        monkeypatch.setenv(name, str(tmp_path / "home" / name.lower()))
    real = lab_module.command

    def first_time_overtaken(folder: Path, port: int) -> list[str]:
        return [sys.executable, "-c", OVERTAKEN] if port == taken else real(folder, port)

    monkeypatch.setattr(lab_module, "command", first_time_overtaken)
    (tmp_path / "mine").mkdir()
    with lab_module.server(tmp_path / "mine", taken) as (process, address):
        assert process.poll() is None
        assert get(address, "api/status")["kernels"] == 0
    assert f"Another program has taken port {taken} in the meantime" in capsys.readouterr().out


def get(address: str, path: str) -> Any:
    base, _, token = address.partition("lab/tree")
    with urllib.request.urlopen(f"{base}{path}?{token.partition('?')[2]}", timeout=60) as answer:
        return json.loads(answer.read())


def recording_node(folder: Path) -> Path:
    """Write a program `node` that records its arguments in `calls`. Return the folder of both."""
    program = folder / "bin" / "node"
    program.parent.mkdir()
    program.with_name("calls").write_text("")
    program.write_text(f'#!/bin/sh\necho "$@" >> {program.with_name("calls")}\n')
    program.chmod(0o755)
    return program.parent


@pytest.mark.slow
@pytest.mark.parametrize("end", ["SIGTERM", "SIGHUP"])
def test_server_serves_only_the_student_folder_and_leaves_no_files_or_processes(
    tmp_path: Path,
    taken: int,
    end: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    for name in HOME_DIRS:
        monkeypatch.setenv(name, str(tmp_path / "home" / name.lower()))
    path = os.pathsep.join((str(recording_node(tmp_path)), os.environ["PATH"]))
    arguments = ["lab", str(tmp_path / "mine"), "--port", str(taken), "--no-browser"]
    # Below `nohup`, this process ignores the signal, and a child would, too.
    inherited = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    process = Program(
        [sys.executable, "-m", "course_lib", *arguments],
        env=os.environ | {"PATH": path},
        stdout=subprocess.PIPE,
    )
    signal.signal(signal.SIGHUP, inherited)
    process.find(f"Port {taken} is taken")
    address = process.find(r"http://\S+")
    server = psutil.Process(process.pid).children(recursive=True)
    served = {item["name"] for item in get(address, "api/contents")["content"]}
    assert {"contents.md", "week00_welcome.ipynb", "week01_exercise.ipynb"} <= served
    assert ".course" not in served
    news = get(address, "lab/api/settings/@jupyterlab/apputils-extension:notification")
    assert news["schema"]["properties"]["fetchNews"]["default"] == "false"
    # JupyterLab would ask yarn before it listens.
    assert "yarn" not in (tmp_path / "bin" / "calls").read_text()
    lab(tmp_path / "mine", browser=False)  # in a second terminal
    assert f"already runs in this folder.\nOpen this address in a browser:\n\n    {address}" in (
        capsys.readouterr().out
    )
    assert lab_module.running_address(tmp_path) is None
    process.send_signal(getattr(signal, end))
    process.find("Your files are kept.")
    assert process.wait(60) == 0
    assert not [p for p in server if p.is_running() and p.status() != psutil.STATUS_ZOMBIE]


@pytest.mark.slow
def test_kernels_of_the_server_are_encrypted_and_find_the_commands_of_the_kit(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    for name in HOME_DIRS:
        monkeypatch.setenv(name, str(tmp_path / "home" / name.lower()))
    monkeypatch.setenv("PATH", os.defpath)
    # Debian's /etc/profile does the same.
    (tmp_path / ".profile").write_text(f"PATH={os.defpath}\n")
    for name, value in {"HOME": str(tmp_path), "SHELL": "/bin/sh"}.items():
        monkeypatch.setenv(name, value)
    (tmp_path / "mine").mkdir()
    with lab_module.server(tmp_path / "mine", free_port(8888)) as (process, address):
        base, _, token = address.partition("lab/tree")
        body, headers = b"{}", {"Authorization": f"token {token.partition('token=')[2]}"}
        request = urllib.request.Request(f"{base}api/kernels", body, headers)
        with urllib.request.urlopen(request, timeout=PATIENCE) as answer:
            kernel = json.loads(answer.read())["id"]
        file = tmp_path / "home/jupyter_runtime_dir" / f"kernel-{kernel}.json"
        assert json.loads(file.read_text())["curve_publickey"]
        path = psutil.Process(process.pid).environ()["PATH"]
        assert (command_file := shutil.which("course", path=path))
        request = urllib.request.Request(f"{base}api/terminals", body, headers)
        with urllib.request.urlopen(request, timeout=PATIENCE) as answer:
            terminal = json.loads(answer.read())["name"]
        socket_url = f"ws{base.removeprefix('http')}terminals/websocket/{terminal}"
        connection = websocket.create_connection(socket_url, PATIENCE, header=headers)
        connection.send(json.dumps(["stdin", "command -v course; echo end\r"]))
        shown = ""
        while "\nend" not in shown:
            shown += str(json.loads(connection.recv())[-1])
        connection.close()
        assert command_file in shown
        client = BlockingKernelClient(connection_file=str(file))
        client.load_connection_file()
        client.start_channels(hb=False)
        client.wait_for_ready(PATIENCE)
        client.stop_channels()
    output = capfd.readouterr()
    # ipykernel would warn of missing encryption, and the server of an unknown option.
    assert "WARNING" not in output.out + output.err


@pytest.mark.parametrize("template", ["lab", "classic", "basic", "reveal"])
def test_pictures_have_their_alternative_texts_in_pages_of_nbconvert(template: str) -> None:
    data = {"image/png": "iVBO\nRw==", "text/plain": "A view"}
    view = new_output("display_data", data, metadata={"image/png": {"alt": "<red> cube"}})
    figure = new_output("display_data", data)
    cell = new_code_cell("viewer", outputs=[view, figure], metadata={"alt": "a curve"})
    notebook = new_notebook(cells=[cell])
    config = JSONFileConfigLoader("jupyter_config.json", str(lab_module.JUPYTER_SETTINGS)).load_config()
    exporters: dict[str, Any] = {"reveal": SlidesExporter}
    exporter = exporters.get(template, HTMLExporter)(config=config, template_name=template)
    html, _ = exporter.from_notebook_node(notebook)
    assert re.findall('<img alt="([^"]*)" src="data:image/png;base64,iVBORw=="', html) == [
        "&lt;red&gt; cube",
        "a curve",
    ]
