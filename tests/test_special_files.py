"""Named pipes and sockets in place of files: each reader reports them and does not wait for a writer."""

import os
import socket
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from course_lib.third_party import read_bytes, read_text
from tests.patience import PATIENCE
from tests.warm import run_course

READERS = (
    ("run", "pipe.py"),
    ("run", "pipe.ipynb"),
    ("run", "pipe.launch.py"),
    ("run", "pipe.launch.xml"),
    ("run", "node.py", "--ros-args", "--params-file", "pipe.yaml"),
    ("export", "pipe.ipynb", "--package", "arm", "--out", "out"),
    ("export", "pipe.py", "--package", "arm", "--out", "out"),
    ("view", "--no-browser", "--rviz", "pipe.rviz"),
    ("submit", "pipe.ipynb"),
)


@pytest.mark.parametrize("arguments", READERS, ids=" ".join)
def test_command_reports_a_named_pipe(arguments: Sequence[str], tmp_path: Path) -> None:
    (tmp_path / "node.py").write_text("import rclpy\nrclpy.init()\nrclpy.create_node('a')\n")
    for name in arguments:
        if name.startswith("pipe"):
            os.mkfifo(tmp_path / name)
    process = run_course(*arguments, cwd=tmp_path)
    assert process.returncode
    assert "named pipe" in process.stdout + process.stderr


@pytest.mark.parametrize("name", ["huge.py", "huge.ipynb", "huge.launch.py", "huge.launch.xml"])
def test_program_that_is_larger_than_the_memory_is_not_read(name: str, tmp_path: Path) -> None:
    with (tmp_path / name).open("wb") as file:
        file.truncate(2**40)
    process = run_course("run", name, cwd=tmp_path)
    assert process.returncode in (1, 2)
    assert "File too large" in process.stdout + process.stderr


def test_package_with_a_named_pipe_as_manifest_is_reported(tmp_path: Path) -> None:
    (tmp_path / "src" / "arm").mkdir(parents=True)
    os.mkfifo(tmp_path / "src" / "arm" / "package.xml")
    code = "import course_lib\nfrom ament_index_python import get_package_prefix\nget_package_prefix('arm')"
    command = [sys.executable, "-c", code]
    process = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=PATIENCE)
    assert "named pipe, not a regular file" in process.stderr


def test_robot_description_in_a_named_pipe_is_rejected(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "part.xacro")
    (tmp_path / "arm.urdf.xacro").write_text(
        '<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        '<xacro:include filename="part.xacro"/></robot>'
    )
    code = (
        "import sys\nfrom course_lib import load_robot\nfrom course_lib.errors import CourseError\n"
        "for name in sys.argv[1:]:\n    try:\n        load_robot(name)\n"
        "    except CourseError as error:\n        print(error)\n"
    )
    process = subprocess.run(
        [sys.executable, "-c", code, "arm.urdf.xacro", "part.xacro"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
    )
    assert "cannot expand arm.urdf.xacro: error: It is a named pipe, not a regular file" in process.stdout
    assert "Cannot read part.xacro: [Errno 22] It is a named pipe, not a regular file" in process.stdout


def test_socket_and_device_are_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # The path of a socket has at most about 100 characters.
    monkeypatch.chdir(tmp_path)
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind("socket")
        with pytest.raises(OSError, match="It is a socket, not a regular file"):
            read_text(tmp_path / "socket")
    with pytest.raises(OSError, match="It is a device, not a regular file"):
        read_bytes(Path("/dev/zero"))
    with pytest.raises(IsADirectoryError):
        read_bytes(tmp_path)
