from importlib import metadata

import pytest

from course_lib.course.installation import Finding, check_versions, find_versions


def test_this_environment_is_fine(capsys: pytest.CaptureFixture[str]) -> None:
    check_versions()
    printed = capsys.readouterr().out
    assert printed.startswith("✔ Python 3.")
    assert printed.endswith("All of it is fine.\n")


def test_extras_are_not_wanted_of_students() -> None:
    assert not {"pytest", "mypy", "playwright"} & {finding.name for finding in find_versions()}


def test_a_missing_package_says_what_to_type(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(metadata, "requires", lambda _: ["no-such-package>=2", "numpy>=999"])
    lines = [finding.line for finding in find_versions()]
    assert lines[0] == "✘ no-such-package: not installed, wanted >=2. In a terminal: pip install -e ."
    assert "wanted >=999" in lines[1]


def test_colour_is_not_needed_to_read_a_finding() -> None:
    assert Finding("numpy", ">=2", "2.4", True).line == "✔ numpy 2.4"
