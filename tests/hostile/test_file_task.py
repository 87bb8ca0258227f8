"""File names in file tasks: the file is read as text in the jail."""

from contextlib import closing

import pytest

from course_lib.course.course_file import Limits
from course_lib.grading.run.outcome import MAX_TEXT
from course_lib.grading.run.submission_run import SubmissionRun
from course_lib.grading.task import Scenario, Task

LAYOUT = Task("week01.layout", "A layout", "file", "layout", ("a", "b", "c"), (Scenario("public"),))
LAUGHS = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{name}: &{name} [{', '.join([f'*{before}'] * 9)}]\n"
    for before, name in zip("abcdefghi", "bcdefghij", strict=True)
)
ENTITIES = (
    '<!DOCTYPE r [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;"><!ENTITY c SYSTEM "/etc/passwd">]><r>&b;&c;</r>'
)


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("cell", "error", "limit"),
    [
        ("layout = '/dev/urandom'", "MemoryError|still running", "memory|time"),
        # The jail has no such device.
        ("layout = '/dev/zero'", "PermissionError|FileNotFoundError", ""),
        ("layout = '/etc/passwd'", "PermissionError|FileNotFoundError", ""),
        ("import os\nos.symlink('/etc/passwd', 'f')\nlayout = 'f'", "PermissionError|FileNotFoundError", ""),
        ("import os\nos.mkdir('f')\nlayout = 'f'", "IsADirectoryError", ""),
        ("open('f', 'wb').write(b'\\xff\\x00')\nlayout = 'f'", "UnicodeDecodeError", ""),
        ("layout = 'x' * 10**6", "OSError", ""),
        ("layout = 'not_there.rviz'", "FileNotFoundError", ""),
        ("layout = ['a']", "TypeError", ""),
        ("class P:\n    __fspath__ = lambda self: 1 / 0\nlayout = P()", "ZeroDivisionError", ""),
        (
            "class P:\n    def __fspath__(self):\n        while True: pass\nlayout = P()",
            "still running",
            "time",
        ),
    ],
)
def test_missing_or_invalid_returned_file_is_an_error_of_that_task(cell: str, error: str, limit: str) -> None:
    with closing(SubmissionRun([cell], {LAYOUT.id: {}}, Limits(scenario_seconds=2))) as session:
        evidence = session.run(LAYOUT, LAYOUT.scenarios[0])
    assert any(evidence.errors[0].startswith(kind) for kind in error.split("|"))
    assert evidence.returns == ()
    assert evidence.stopped in limit.split("|")


@pytest.mark.parametrize(
    "text", [LAUGHS, ENTITIES, "[" * 50_000, "x" * 10**7, "a: !!python/object:os.system x"]
)
def test_yaml_bomb_is_returned_as_plain_text(text: str) -> None:
    files = {"f.yaml": text}
    with closing(SubmissionRun(["layout = 'f.yaml'"], {LAYOUT.id: {}}, Limits(), files=files)) as session:
        evidence = session.run(LAYOUT, LAYOUT.scenarios[0])
    assert evidence.returns == (text[:MAX_TEXT],)
