from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.robots.robot import import_pinocchio, load_robot
from tests.robots.urdfs import ARM_2R


def test_robot_has_links_and_joints() -> None:
    tree = load_robot(ARM_2R).tree
    assert tree.root == "base"
    assert [joint.child for joint in tree.joints.values()] == ["upper", "fore", "tip"]


def test_missing_system_library_error_states_the_library_and_its_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = "libgomp.so.1: cannot open shared object file: No such file or directory"
    tmp_path.joinpath("needs_library.py").write_text(f"raise ImportError({text!r})\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    with pytest.raises(CourseError, match=r"library of the system: libgomp.so.1: .* apt install libgomp1"):
        import_pinocchio("needs_library")


def test_missing_package_error_has_the_reason_and_the_install_options() -> None:
    with pytest.raises(
        CourseError, match=r"Pinocchio's models.* no_such_package is missing .* WSL2 or from conda"
    ):
        import_pinocchio("no_such_package")
