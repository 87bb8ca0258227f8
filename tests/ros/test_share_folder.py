"""The share folder of sources whose setup.py installs files in other folders."""

from collections.abc import Callable
from pathlib import Path

import pytest
from ament_index_python.packages import get_package_prefix, get_package_share_directory

SETUP = """
import os
from glob import glob
from setuptools import setup

package_name = "arm"
setup(name=package_name, data_files=[
    ("share/ament_index/resource_index/packages", ["resource/" + package_name]),
    {}
])
"""
Share = Callable[..., Path]


@pytest.fixture
def share(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Share:
    """Write a package's sources with a file for its build; return its share folder."""
    root = tmp_path / "arm"

    def make(**files: str) -> Path:
        for name, text in {"package.xml": "<package><name>arm</name></package>", **files}.items():
            (root / name).write_text(text)
        return Path(get_package_share_directory("arm"))

    for file in ("urdf/arm.urdf", "urdf/deep/tool.urdf", "meshes/a.stl", "more/b.stl", "launch/a.launch.py"):
        (root / file).parent.mkdir(parents=True, exist_ok=True)
        (root / file).write_text(file)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path))
    return make


def in_setup(entry: str) -> dict[str, str]:
    return {"setup.py": SETUP.replace("{}", entry)}


def in_cmake(line: str) -> dict[str, str]:
    return {"CMakeLists.txt": f"project(arm)\n{line}\nament_package()\n"}


@pytest.mark.parametrize(
    ("build", "places"),
    [
        (in_setup("(os.path.join('share', package_name), glob('urdf/*.urdf')),"),
         {"arm.urdf": "urdf/arm.urdf"}),
        (in_setup("('share/' + package_name, ['package.xml'] + glob('urdf/*.urdf')),"),
         {"arm.urdf": "urdf/arm.urdf"}),
        (in_setup("(f'share/{package_name}/meshes', glob(os.path.join('more', '*'))),"),
         {"meshes/b.stl": "more/b.stl", "meshes/a.stl": "meshes/a.stl"}),
        (in_setup("('share/arm/new/deep', ['urdf/arm.urdf']),"), {"new/deep/arm.urdf": "urdf/arm.urdf"}),
        (in_cmake("install(DIRECTORY urdf/ DESTINATION share/${PROJECT_NAME}/data)"),
         {"data/arm.urdf": "urdf/arm.urdf", "data/deep/tool.urdf": "urdf/deep/tool.urdf"}),
        (in_cmake("install(DIRECTORY urdf/deep more DESTINATION ${CMAKE_INSTALL_DATADIR}/${PROJECT_NAME})"),
         {"deep/tool.urdf": "urdf/deep/tool.urdf"}),
        (in_cmake("install(DIRECTORY more/ launch/ DESTINATION share/arm)"),
         {"b.stl": "more/b.stl", "a.launch.py": "launch/a.launch.py"}),
        (in_cmake("install(DIRECTORY more/ DESTINATION share/arm/meshes)"),
         {"meshes/b.stl": "more/b.stl", "meshes/a.stl": "meshes/a.stl"}),
        (in_cmake("install(FILES urdf/arm.urdf DESTINATION share/arm RENAME robot.urdf)"),
         {"robot.urdf": "urdf/arm.urdf"}),
        (in_cmake("ament_auto_package(INSTALL_TO_SHARE launch urdf/deep)"),
         {"deep/tool.urdf": "urdf/deep/tool.urdf"}),
    ],
)  # fmt: skip
def test_share_file_is_found_by_its_install_path_and_its_source_path(
    share: Share, build: dict[str, str], places: dict[str, str]
) -> None:
    folder = share(**build)
    for place, file in {**places, "launch/a.launch.py": "launch/a.launch.py"}.items():
        assert (folder / place).read_text() == file
        assert (folder / file).read_text() == file
    assert (Path(get_package_prefix("arm")) / "arm" / "package.xml").is_file()


@pytest.mark.parametrize(
    "build",
    [
        {},
        in_setup("(os.path.join('share', package_name, 'urdf'), glob('urdf/*')),"),
        in_setup("('share/' + package_name, made_by_a_function()),"),
        in_setup("('share/' + package_name, glob('/etc/host*')),"),
        in_setup("('share/' + package_name, glob('../*')), ('share/arm', ['../../x', '/etc/hosts']),"),
        in_setup("('share/arm/../other', ['urdf/arm.urdf']), ('lib/arm', ['urdf/arm.urdf']),"),
        {"setup.py": "package_name = package_name\nsetup(data_files=[(package_name, [])])"},
        in_setup("('share/arm', glob() + [os.path.join()] + glob('')),"),
        in_cmake("install(DIRECTORY launch urdf DESTINATION share/${PROJECT_NAME})"),
        in_cmake("install(DIRECTORY urdf/ DESTINATION ${CMAKE_INSTALL_PREFIX}/share/arm/urdf)"),
        in_cmake(
            "install(DIRECTORY more DESTINATION include) install(FILES ../x /etc/hosts DESTINATION share/arm)"
        ),
    ],
)
def test_sources_installed_in_place_are_the_share_folder(
    share: Share, build: dict[str, str], tmp_path: Path
) -> None:
    assert share(**build) == tmp_path / "arm"


def test_later_changes_of_a_share_file_are_visible(share: Share, tmp_path: Path) -> None:
    folder = share(**in_setup("(os.path.join('share', package_name), glob('urdf/*.urdf')),"))
    (tmp_path / "arm" / "urdf" / "arm.urdf").write_text("changed")
    assert (folder / "arm.urdf").read_text() == "changed"
    assert Path(get_package_share_directory("arm")) == folder
