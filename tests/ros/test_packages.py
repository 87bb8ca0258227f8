from pathlib import Path

import pytest
from ament_index_python import PackageNotFoundError, get_package_prefix, get_package_share_directory

from course_lib.ros.programs.packages import find_package, packages, python_path, source


def make(folder: Path, name: str) -> Path:
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text(f"<package>\n  <name>{name}</name></package>")
    return folder


@pytest.fixture(autouse=True)
def nowhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("AMENT_PREFIX_PATH", "")
    monkeypatch.setenv("ROS_PACKAGE_PATH", "")
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")


def test_installed_package_takes_precedence_over_its_sources(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    built = make(tmp_path / "install" / "robot" / "share" / "robot", "robot")
    make(tmp_path / "src" / "robot", "robot")
    sources = make(tmp_path / "src" / "folder", "arm")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "install" / "robot"))
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "src"))
    assert packages() == {"arm": sources, "robot": built}
    assert get_package_prefix("robot") == str(tmp_path / "install" / "robot")
    assert get_package_share_directory("arm") == str(sources)


def test_sources_in_the_working_folder_and_its_src_are_found(tmp_path: Path) -> None:
    make(tmp_path / "here" / "robot", "robot")
    make(tmp_path / "here" / "src" / "arm", "arm")
    assert set(packages()) == {"robot", "arm"}


def test_packages_next_to_the_package_of_a_file_are_found(tmp_path: Path) -> None:
    for name in ("robot", "arm"):
        make(tmp_path / "install" / name / "share" / name, name)
    source(tmp_path / "install" / "robot" / "share" / "robot" / "launch" / "x.launch.py")
    assert set(packages()) == {"robot", "arm"}


@pytest.mark.parametrize("place", ["level1/robot/robot/talker.py", "loose/talker.py"])
def test_repository_without_src_is_a_workspace(tmp_path: Path, place: str) -> None:
    checkout = tmp_path / "checkout"
    (checkout / ".git").mkdir(parents=True)
    for folder in ("level1/robot", "top_msgs", "level2/arm_msgs", "level3/deep/far_msgs"):
        make(checkout / folder, folder.rpartition("/")[2])
    found = python_path(checkout / place)
    expected = {checkout, *(checkout / name for name in ("top_msgs", "level1", "level2", "level3/deep"))}
    assert {str(path) for path in expected} <= set(found)


def test_file_in_an_unrelated_repository_finds_no_packages(tmp_path: Path) -> None:
    (tmp_path / "checkout" / ".git").mkdir(parents=True)
    make(tmp_path / "checkout" / "examples" / "robot", "robot")
    assert python_path(tmp_path / "checkout" / "talker.py") == []


def test_executables_are_read_from_setup_py_without_executing_it(tmp_path: Path) -> None:
    folder = make(tmp_path / "here" / "robot", "robot")
    scripts = '["talker = robot.talker:main", f"x"]'
    (folder / "setup.py").write_text(
        f'raise SystemExit\nsetup(entry_points={{"console_scripts": {scripts}}})'
    )
    package = find_package("robot")
    assert package is not None
    assert package.executables == {"talker": ("robot.talker", "main")}


def test_missing_package_error_lists_the_available_packages(tmp_path: Path) -> None:
    make(tmp_path / "here" / "robot", "robot")
    with pytest.raises(PackageNotFoundError) as error:
        get_package_share_directory("robt")
    assert str(error.value).startswith("package 'robt' not found, searching: [")
    assert "There is: robot." in str(error.value)


@pytest.mark.parametrize("name", ["rclpy", "std_msgs"])
def test_package_of_the_kit_has_the_share_folder_that_it_has_on_a_robot(name: str) -> None:
    assert get_package_share_directory(name) == f"/opt/ros/jazzy/share/{name}"
    assert get_package_prefix(name) == "/opt/ros/jazzy"
