"""Commands of `course` where processes cannot fork, as on native Windows."""

import os
import sys

import pytest

from course_lib import cli


@pytest.fixture
def windows(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(os, "fork", raising=False)
    monkeypatch.setattr(sys, "platform", "win32")


@pytest.mark.parametrize("command", ["check", "classroom", "collect", "grade", "mark", "verify"])
@pytest.mark.usefixtures("windows")
def test_submission_command_without_fork_is_rejected_in_one_line(
    command: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["course", command, "some", "words"])
    with pytest.raises(SystemExit):
        cli.main()
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1
    assert lines[0].startswith(f"error: course {command} needs Linux, macOS or WSL2: on this system (win32)")
    assert ("check() works" in lines[0]) == (command == "check")
