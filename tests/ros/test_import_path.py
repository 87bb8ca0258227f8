import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

from course_lib.errors import CourseError
from course_lib.ros.programs.import_path import STANDIN, install, provided_packages
from tests.patience import PATIENCE

LOAD = (
    "from course_lib.ros.programs.import_path import install; install(); import std_msgs.msg as m;"
    "print(m.__spec__.origin)"
)


def test_install_inserts_the_standin_at_the_front_of_the_path_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "path", ["/foreign", str(STANDIN), "/other"])
    install()
    install()
    assert sys.path == [str(STANDIN), "/foreign", "/other"]


def test_message_packages_are_provided() -> None:
    assert {"std_msgs", "visualization_msgs", "builtin_interfaces"} <= set(provided_packages())


@pytest.mark.parametrize("text", ["raise ImportError('made for Python 3.12')", "class Fake: ..."])
def test_ros_on_pythonpath_is_ignored(tmp_path: Path, text: str) -> None:
    for name in ("rclpy", "std_msgs"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text(text)
    environment = {**os.environ, "PYTHONPATH": str(tmp_path)}
    process = subprocess.run(
        [sys.executable, "-c", LOAD], env=environment, capture_output=True, text=True, timeout=PATIENCE
    )
    assert process.returncode == 0, process.stderr
    assert STANDIN in Path(process.stdout.strip()).parents


def test_previously_imported_ros_is_reported_with_the_next_step(monkeypatch: pytest.MonkeyPatch) -> None:
    foreign = ModuleType("std_msgs")
    foreign.__file__ = "/opt/ros/jazzy/std_msgs/__init__.py"
    monkeypatch.setitem(sys.modules, "std_msgs", foreign)
    with pytest.raises(
        CourseError, match=r"std_msgs .* from /opt/ros/jazzy/.* Restart the kernel .*load_ext"
    ):
        install()


def test_importing_actions_provides_the_module_of_nodes() -> None:
    code = "import course_lib, rclpy\nfrom rclpy.action import ActionClient\nprint(rclpy.node.Node.__name__)"
    process = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=PATIENCE)
    assert (process.stdout, process.stderr) == ("Node\n", "")
