"""Exported packages under ROS's own tools."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from course_lib.ros.programs.build_files import build_faults
from tests.ros.launch.run import recorded

STYLE = (
    "D100",
    "D101",
    "D102",
    "D103",
    "D104",
    "D105",
    "D106",
    "D107",
    "D203",
    "D212",
    "D404",
)  # ament_pep257's


def succeed(folder: Path, *words: str) -> str:
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    process = subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=600, env=environment)
    assert process.returncode == 0, process.stdout + process.stderr
    return process.stdout


def module(folder: Path, *words: str) -> str:
    return succeed(folder, sys.executable, "-m", *words)


@pytest.fixture(scope="module")
def workspace(package: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("ws")
    shutil.copytree(package, root / "src" / package.name, ignore=shutil.ignore_patterns("__pycache__"))
    return root


def test_package_xml_is_valid_for_catkin_pkg(package: Path) -> None:
    from catkin_pkg.package import parse_package  # type: ignore[import-untyped]  # it ships no types

    parsed = parse_package(package)
    parsed.validate()
    assert (parsed.name, parsed.get_build_type()) == ("perception_dashboard", "ament_python")
    wanted = {"rclpy", "sensor_msgs", "tf2_ros", "visualization_msgs", "launch_ros", "rviz2"}
    assert wanted <= {depend.name for depend in parsed.exec_depends}


def test_exported_package_passes_flake8_and_pep257(package: Path) -> None:
    assert module(package, "flake8", "--max-line-length", "99", ".") == ""
    assert module(package, "pydocstyle", "--ignore", ",".join(STYLE), ".") == ""


@pytest.mark.slow
def test_colcon_builds_and_tests_the_package_and_its_nodes_start(workspace: Path) -> None:
    succeed(workspace, "colcon", "build")
    succeed(workspace, "colcon", "test", "--return-code-on-test-failure")
    assert "0 errors, 0 failures" in succeed(workspace, "colcon", "test-result", "--all")
    share = workspace / "install" / "perception_dashboard" / "share" / "perception_dashboard"
    recording, code = recorded(share / "launch" / "perception_dashboard.launch.py")
    assert code == 0
    assert sum(sample.topic == "/scan" for sample in recording.samples) == 10
    import perception_dashboard  # type: ignore[import-not-found]  # what the launch has started

    assert workspace / "install" in Path(perception_dashboard.__file__).parents


# What `ros2 run` needs of a build: the executable, and the hook that extends AMENT_PREFIX_PATH.
INSTALLED = ("lib/{0}/tf_publisher", "share/{0}/hook/ament_prefix_path.sh")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "old", "new", "missing"),
    [
        ("setup.cfg", "install_scripts", "other_scripts", INSTALLED[:1]),
        ("package.xml", "<version>", "<!-- -- --><version>", INSTALLED[1:]),
        ("package.xml", "<license>", "<licence>x</licence><license>", INSTALLED[1:]),
        ("package.xml", "ament_python", "ament_pyton", INSTALLED),
        ("setup.py", "'resource/' +", "'resources/' +", INSTALLED[:1]),
    ],
)
def test_colcon_build_lacks_what_a_reported_fault_breaks(
    package: Path, tmp_path: Path, file: str, old: str, new: str, missing: tuple[str, ...]
) -> None:
    folder = Path(shutil.copytree(package, tmp_path / "src" / package.name))
    assert build_faults(package.name, folder) == []
    assert old in (folder / file).read_text()
    (folder / file).write_text((folder / file).read_text().replace(old, new))
    assert len(build_faults(package.name, folder)) == 1
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    subprocess.run(["colcon", "build"], cwd=tmp_path, capture_output=True, timeout=600, env=environment)
    prefix = tmp_path / "install" / package.name
    files = [path for path in INSTALLED if not (prefix / path.format(package.name)).exists()]
    assert files == list(missing)
