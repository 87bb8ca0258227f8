import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

from course_lib.errors import CourseError
from course_lib.ros.standin_path import STANDIN, install, provided

LOAD = (
    "from course_lib.ros.standin_path import install; install(); import std_msgs.msg as m;"
    "print(m.__spec__.origin)"
)


def test_install_puts_the_standin_first_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "path", ["/foreign", str(STANDIN), "/other"])
    install()
    install()
    assert sys.path == [str(STANDIN), "/foreign", "/other"]


def test_the_message_packages_are_provided() -> None:
    assert {"std_msgs", "visualization_msgs", "builtin_interfaces"} <= set(provided())


@pytest.mark.parametrize("text", ["raise ImportError('made for Python 3.12')", "class Fake: ..."])
def test_a_ros_on_pythonpath_changes_nothing(tmp_path: Path, text: str) -> None:
    for name in ("rclpy", "std_msgs"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text(text)
    environment = {**os.environ, "PYTHONPATH": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", LOAD], env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert STANDIN in Path(done.stdout.strip()).parents


def test_a_ros_imported_before_is_named_with_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    foreign = ModuleType("std_msgs")
    foreign.__file__ = "/opt/ros/jazzy/std_msgs/__init__.py"
    monkeypatch.setitem(sys.modules, "std_msgs", foreign)
    with pytest.raises(
        CourseError, match=r"std_msgs .* from /opt/ros/jazzy/.* Restart the kernel .*load_ext"
    ):
        install()
