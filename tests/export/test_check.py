import shutil
from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.export.export import check_package


@pytest.fixture
def copy(package: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(package, tmp_path / package.name))


@pytest.mark.parametrize(
    ("file", "old", "new", "told"),
    [
        ("package.xml", 'format="3"', 'format="2"', "format"),
        ("package.xml", "<depend>sensor_msgs</depend>", "", "sensor_msgs"),
        ("package.xml", "<build_type>ament_python<", "<build_type>ament_cmake<", "ament_python"),
        ("package.xml", "</package>", "", "XML"),
        ("setup.py", "tf_publisher:main", "tf_publisher:start", "the function start"),
        ("setup.py", "perception_dashboard.tf_publisher", "perception_dashboard.nothing", "nothing"),
        ("setup.py", "launch", "lunch", "launch/ in data_files"),
        ("setup.cfg", "script_dir=$base/lib/perception_dashboard", "", "script_dir"),
    ],
)
def test_errors_in_package_files_are_reported(copy: Path, file: str, old: str, new: str, told: str) -> None:
    text = (copy / file).read_text()
    assert old in text
    (copy / file).write_text(
        text.replace(old, new).replace("launch/*.py", "lunch/*.py" if "lunch" in new else "launch/*.py")
    )
    assert any(told in line for line in check_package(copy).missing)


@pytest.mark.parametrize("path", ["package.xml", "setup.py", "setup.cfg", "resource/perception_dashboard"])
def test_missing_file_is_reported(copy: Path, path: str) -> None:
    (copy / path).unlink()
    assert f"lacks: the file {path}" in check_package(copy).lines()


def test_optional_entries_do_not_count_as_missing(copy: Path) -> None:
    shutil.rmtree(copy / "rviz")
    report = check_package(copy)
    assert report.is_complete
    assert "advised: a file rviz/*.rviz" in report.lines()
    assert any("maintainer" in line for line in report.lines())


@pytest.mark.parametrize("path", ["setup.py", "perception_dashboard/tf_publisher.py"])
def test_python_syntax_error_is_reported_with_its_line(copy: Path, path: str) -> None:
    (copy / path).write_text("x = 1\ny = (\n")
    with pytest.raises(CourseError, match=f"{path}, line 2"):
        check_package(copy)


def test_missing_folder_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(CourseError, match="no folder"):
        check_package(tmp_path / "nowhere")
