from importlib import metadata

import pytest

from course_lib.course.material import VersionCheck, check_versions, find_versions


def test_setup_check_passes_in_this_environment(capsys: pytest.CaptureFixture[str]) -> None:
    check_versions()
    printed = capsys.readouterr().out
    assert printed.startswith("✔ Python 3.")
    assert printed.endswith("Everything is fine.\n")


def test_setup_check_does_not_require_optional_dependencies() -> None:
    assert not {"pytest", "mypy", "playwright"} & {finding.name for finding in find_versions()}


def test_missing_package_is_reported_with_the_install_command(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(metadata, "requires", lambda _: ["no-such-package>=2", "numpy>=999"])
    lines = [finding.line for finding in find_versions()]
    assert lines[0] == "✘ no-such-package: not installed, required: >=2. In a terminal: pip install -e ."
    assert "required: >=999" in lines[1]


def test_finding_is_readable_without_color() -> None:
    assert VersionCheck("numpy", ">=2", "2.4", True).line == "✔ numpy 2.4"
