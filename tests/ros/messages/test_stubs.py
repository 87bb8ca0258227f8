import sys

import pytest

from course_lib.ros.messages.definitions import type_names
from tests.ros.messages import stubs


def test_the_stubs_on_disk_are_what_the_types_say() -> None:
    assert stubs.main(["--check"]) == 0


def test_a_stale_stub_is_named(
    tmp_path: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(stubs, "STANDIN", tmp_path)
    assert stubs.main(["--check"]) == 1
    assert "std_msgs/msg/__init__.pyi is not what" in capsys.readouterr().out
    assert stubs.main([]) == 0
    assert stubs.main(["--check"]) == 0


def test_every_type_can_be_imported_under_its_real_name() -> None:
    for type_name in type_names():
        package, folder, name = type_name.split("/")
        whole = name.split("_")[0]
        public = getattr(__import__(f"{package}.{folder}", fromlist=[whole]), whole)
        cls = getattr(sys.modules[public.__module__], name)
        assert cls.__name__ == name
