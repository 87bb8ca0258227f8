import errno
import os
import platform
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.real import environment
from course_lib.real.environment import find_environment, install, pins
from tests.patience import PATIENCE
from tests.processes import Program


def make_environment(folder: Path, versions: dict[str, str]) -> Path:
    packages = folder / "lib" / "python3.12" / "site-packages"
    for name, version in versions.items():
        info = packages / f"{name.replace('-', '_')}-{version}.dist-info"
        info.mkdir(parents=True)
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n")
        (packages / name.removeprefix("ros-").replace("-", "_")).mkdir()
    (folder / "bin").mkdir()
    (folder / "bin" / "python").touch()
    return folder / "bin" / "python"


def test_environment_with_the_pinned_versions_is_accepted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    python = make_environment(tmp_path, pins())
    monkeypatch.setenv(environment.PYTHON, str(python))
    assert str(find_environment()) == "rclpy 7.1.6 of ROS 2 Jazzy with Fast DDS 2.14.5"


@pytest.mark.parametrize(
    ("name", "version", "problem"),
    [
        ("ros-fastcdr", "2.2.6", "ros-fastcdr 2.2.6, expected 2.2.5"),
        ("ros-rosidl-runtime-c", "", "ros-rosidl-runtime-c is missing, expected 4.6.6"),
    ],
)
def test_environment_with_another_version_is_rejected(
    name: str, version: str, problem: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    versions = pins() | {name: version}
    python = make_environment(tmp_path, {one: number for one, number in versions.items() if number})
    monkeypatch.setenv(environment.PYTHON, str(python))
    with pytest.raises(CourseError, match=problem):
        find_environment()


def test_environment_with_a_missing_folder_is_rejected(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    python = make_environment(tmp_path, pins())
    monkeypatch.setenv(environment.PYTHON, str(python))
    (tmp_path / "lib" / "python3.12" / "site-packages" / "rclpy").rmdir()
    with pytest.raises(CourseError, match="the folder rclpy of ros-rclpy is missing"):
        find_environment()


def test_installation_on_a_full_disk_is_an_error_with_the_needed_space(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.setattr(environment, "unsupported_reason", lambda: "")
    usage = shutil.disk_usage(tmp_path)._replace(free=25_000_000)
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: usage)
    with pytest.raises(CourseError, match="has 25 MB free, and the real ROS 2 needs 300 MB"):
        install(print)
    assert not list(environment.default_folder().parent.iterdir())


def test_second_installation_at_the_same_time_is_rejected_and_does_not_disturb_the_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def create(folder: Path, lock: int) -> None:
        (folder / "bin").mkdir(parents=True)
        with pytest.raises(CourseError, match="Another `course ros --install` is installing into"):
            install(print)
        assert (folder / "bin").exists()
        raise CourseError("the first ended")

    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    monkeypatch.setattr(environment, "unsupported_reason", lambda: "")
    monkeypatch.setattr(environment, "_create", create)
    for _ in range(2):
        with pytest.raises(CourseError, match="the first ended"):
            install(lambda line: None)


def test_folder_that_cannot_be_created_is_an_error_with_the_variable_to_set(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "file"))
    monkeypatch.setattr(environment, "unsupported_reason", lambda: "")
    with pytest.raises(CourseError, match=r"file/course_lib: Not a directory\. Set XDG_DATA_HOME"):
        install(print)


def test_folder_that_cannot_be_written_is_an_error_with_the_variable_to_set(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(path: Path) -> None:
        raise OSError(errno.EROFS, os.strerror(errno.EROFS), str(path))

    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    monkeypatch.setattr(environment, "unsupported_reason", lambda: "")
    monkeypatch.setattr(Path, "touch", fail)
    with pytest.raises(CourseError, match=r"course_lib: Read-only file system\. Set XDG_DATA_HOME"):
        install(print)


def test_missing_environment_error_shows_the_install_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv(environment.PYTHON, raising=False)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    monkeypatch.setattr(environment, "unsupported_reason", lambda: "")
    with pytest.raises(CourseError, match=r"not installed .*: course ros --install"):
        find_environment()


def test_unsupported_platform_is_reported_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    monkeypatch.setattr(sys, "platform", "darwin")
    monkeypatch.setattr(platform, "machine", lambda: "arm64")
    with pytest.raises(CourseError, match=r"wheels for Linux on x86-64 only, and this is .* on arm64"):
        install(print)
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize("ending", [KeyboardInterrupt, CourseError("no network")])
def test_interrupted_installation_leaves_nothing_behind(
    ending: type[BaseException], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(folder: Path, lock: int) -> None:
        (folder / "bin").mkdir(parents=True)
        (folder / "bin" / "python").touch()
        raise ending

    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    monkeypatch.setattr(environment, "unsupported_reason", lambda: "")
    monkeypatch.setattr(environment, "_create", fail)
    lines: list[str] = []
    with pytest.raises((KeyboardInterrupt, CourseError)):
        install(lines.append)
    assert lines[-1] == f"Nothing is installed: {environment.default_folder()} is removed."
    assert not list(environment.default_folder().parent.iterdir())


def test_killed_installation_is_not_used_and_its_pip_is_awaited(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv(environment.PYTHON, raising=False)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    monkeypatch.setattr(environment, "unsupported_reason", lambda: "")
    killed = tmp_path / "killed.py"
    killed.write_text(
        "import os, signal, subprocess, sys\n"
        "from course_lib.real import environment\n"
        "from tests.real.test_environment import make_environment\n"
        "def create(folder, lock):\n"
        "    make_environment(folder, environment.pins())\n"
        "    pip = subprocess.Popen([sys.executable, '-c', 'input()'], pass_fds=(lock,))\n"
        "    os.kill(os.getpid(), signal.SIGKILL)\n"
        "environment.unsupported_reason, environment._create = str, create\n"
        "environment.install(print)\n"
    )
    root = str(Path(environment.__file__).parents[2])
    monkeypatch.setenv("PYTHONPATH", root)
    with Program([sys.executable, killed], stdin=subprocess.PIPE, cwd=root) as process:
        assert process.wait(60) == -signal.SIGKILL
        with pytest.raises(CourseError, match="its installation has not ended"):
            find_environment()
        with pytest.raises(CourseError, match="Another `course ros --install` is installing"):
            install(print)
        # The end of its input ends the process that stands for pip.
        assert process.stdin is not None
        process.stdin.close()
    monkeypatch.setattr(environment, "_create", lambda folder, lock: make_environment(folder, pins()))
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        try:
            install(lambda line: None)
        except CourseError:
            continue
        break
    assert find_environment().problem() == ""


_RETRY = "WARNING: Retrying (Retry(total=0, connect=None)) after connection broken by "
_NOT_FOUND = "\nERROR: No matching distribution found for numpy>=2"


# Lines as pip 23.2 prints them.
@pytest.mark.parametrize(
    ("lines", "error"),
    [
        (
            f"{_RETRY}'NewConnectionError('… Temporary failure in name resolution')': /simple{_NOT_FOUND}",
            r"this computer is online, then .* cause: 'NewConnectionError\('… Temporary failure",
        ),
        (
            f"{_RETRY}'ProxyError('Cannot connect to proxy.', OSError('Tunnel failed: 403'))'{_NOT_FOUND}",
            r"Check HTTPS_PROXY and `pip config list`, then .*cause: 'ProxyError\(",
        ),
        (
            f"{_RETRY}'SSLError(1, '[SSL] certificate verify failed: self-signed')'{_NOT_FOUND}",
            "run `pip config set global.cert FILE`",
        ),
        (_NOT_FOUND, "has a login page, log in with a browser.* cause: ERROR: No matching"),
        (
            "ERROR: THESE PACKAGES DO NOT MATCH THE HASHES FROM THE REQUIREMENTS FILE.\n  Got        0eaf30",
            "Run `pip cache purge`, then repeat the command. The cause: ERROR: THESE PACKAGES",
        ),
        (
            "ERROR: Could not install packages due to an OSError: [Errno 122] Disk quota exceeded",
            "a disk or your quota is full",
        ),
        ("ERROR: [Errno 30] Read-only file system: '/data'", "Set XDG_DATA_HOME to a folder that you may"),
        ("ERROR: Something else.", "cannot .*, then repeat the command. The cause: ERROR: Something else."),
        ("", "cannot .* The cause: exit code 1"),
    ],
)
def test_pip_failure_is_reported_with_the_cause_and_the_next_step(
    lines: str, error: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(command: list[str], **settings: object) -> subprocess.CompletedProcess[str]:
        return subprocess.CompletedProcess(command, int("pip" in command), "", lines)

    monkeypatch.setattr(subprocess, "run", fail)
    with pytest.raises(CourseError, match=error):
        environment._create(tmp_path / "folder", 0)


def test_venv_failure_is_reported_with_the_missing_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(command: list[str], **settings: object) -> subprocess.CompletedProcess[str]:
        return subprocess.CompletedProcess(command, 1, "ensurepip is not available.\n\nFailing command:", "")

    monkeypatch.setattr(subprocess, "run", fail)
    python = f"python{sys.version_info.major}.{sys.version_info.minor}"
    with pytest.raises(CourseError, match=f"{python} cannot create .*: apt install {python}-venv, then"):
        environment._create(tmp_path / "folder", 0)


def test_folder_as_the_python_of_another_environment_is_rejected(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    make_environment(tmp_path, pins())
    monkeypatch.setenv(environment.PYTHON, str(tmp_path))
    with pytest.raises(CourseError, match=r"which is not a Python\. Set it to the file bin/python of an"):
        find_environment()


def test_relative_data_folder_is_ignored(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", "data")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert environment.default_folder().parent == tmp_path / ".local" / "share" / "course_lib"


def test_missing_home_folder_is_an_error_with_the_variables_to_set(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail() -> Path:
        raise RuntimeError("Could not determine home directory.")

    for variable in ("XDG_DATA_HOME", environment.PYTHON):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setattr(Path, "home", fail)
    with pytest.raises(CourseError, match="Set HOME, or XDG_DATA_HOME"):
        find_environment()


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("words", "error"),
    [
        (["run", "missing.py", "--ros"], "missing.py is not a file"),
        (["run", "a.launch.py", "--ros"], "launch has no wheel"),
        (["run", "a.ipynb", "--ros"], "course check --ros"),
        (["run", "a.py", "--ros", "--real-time"], "leave out --robot"),
        (["run", "a.py", "--view"], "--view and --no-view need --ros"),
    ],
)
def test_command_that_cannot_be_executed_is_an_error_with_the_reason(
    words: list[str], error: str, tmp_path: Path
) -> None:
    for name in ("a.launch.py", "a.ipynb", "a.py"):
        (tmp_path / name).write_text("")
    command = [sys.executable, "-m", "course_lib", *words]
    process = subprocess.run(command, capture_output=True, text=True, timeout=60, cwd=tmp_path)
    assert (process.returncode, process.stderr.startswith("error: ")) == (2, True)
    assert error in process.stderr
