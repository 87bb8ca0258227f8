import sys
from importlib import import_module
from pathlib import Path

from course_lib.ros.messages.definitions import type_names
from course_lib.ros.messages.stubs import stubs, write_stubs
from course_lib.ros.programs.import_path import STANDIN, provided_packages


def test_installed_stubs_agree_with_the_rosbags_types() -> None:
    stale = [path for path, text in stubs().items() if (STANDIN / path).read_text("utf-8") != text]
    assert not stale, "install the kit again: pip install -e ."


def test_stubs_are_written_only_once(tmp_path: Path) -> None:
    first = write_stubs(tmp_path)
    assert tmp_path / "std_msgs" / "msg" / "__init__.pyi" in first
    assert write_stubs(tmp_path) == []


def test_every_package_with_stubs_is_provided_and_can_be_imported() -> None:
    packages = {path.parts[0] for path in stubs()}
    assert packages <= set(provided_packages())
    assert all(import_module(name).__path__ == [str(STANDIN / name)] for name in packages)


def test_every_type_can_be_imported_under_its_real_name() -> None:
    for type_name in type_names():
        package, folder, name = type_name.split("/")
        whole = name.split("_")[0]
        public = getattr(__import__(f"{package}.{folder}", fromlist=[whole]), whole)
        cls = getattr(sys.modules[public.__module__], name)
        assert cls.__name__ == name
