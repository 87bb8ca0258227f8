"""`course grade` where the sandbox is less than full: what is refused, with which exit code, what is said."""

import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from course_lib import cli
from course_lib.grading.jail.isolation import LAYERS
from course_lib.grading.jail.launch import TemplateProcess
from course_lib.grading.records import Course

Grade = Callable[..., int]
WITHOUT_NAMESPACES = ("bubblewrap", "namespaces")


@pytest.fixture(scope="module")
def templates() -> Iterator[dict[tuple[str, ...], TemplateProcess]]:
    """Templates by the layers that they do without: each is started once."""
    opened: dict[tuple[str, ...], TemplateProcess] = {}
    yield opened
    for template in opened.values():
        template.close()


@pytest.fixture
def with_layers(
    templates: dict[tuple[str, ...], TemplateProcess],
    course: Course,
    right: str,
    write_notebook: Callable[..., Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> Callable[..., Grade]:
    """Return a `course grade OPTIONS` without some layers; it returns the exit code."""
    write_notebook(tmp_path / "in" / "ada" / "week01_exercise.ipynb", right, student="ada")

    def without(*off: str) -> Grade:
        template = templates.get(off) or templates.setdefault(off, TemplateProcess(off))
        monkeypatch.setattr("course_lib.grading.run.run.shared_template", lambda _: template)
        monkeypatch.setattr("course_lib.grading.records.exercises_dir", lambda: course.exercises)
        monkeypatch.setattr("course_lib.grading.records.solutions_dir", lambda: course.solutions)
        return run

    def run(*options: str) -> int:
        words = ("grade", str(tmp_path / "in"), "--out", str(tmp_path / "out"), "--jobs", "1", *options)
        monkeypatch.setattr(sys, "argv", ["course", *words])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        code = ended.value.code
        assert isinstance(code, int)
        return code

    return without


@pytest.mark.parametrize(
    ("off", "options", "code", "says"),
    [
        (LAYERS, (), 2, "your rights, no sandbox (lacks namespaces"),
        (LAYERS, ("--require-sandbox",), 2, "--require-sandbox: what works here is: no sandbox"),
        (LAYERS, ("--i-trust-these-submissions",), 0, "Isolation of 1: no sandbox (lacks"),
        (LAYERS, ("--require-sandbox", "--i-trust-these-submissions"), 2, "--require-sandbox"),
        (WITHOUT_NAMESPACES, ("--require-sandbox",), 2, "--require-sandbox: what works here is: partial"),
        (WITHOUT_NAMESPACES, (), 0, "Isolation of 1: partial sandbox (has Landlock, seccomp, limits"),
    ],
)
def test_too_little_of_a_sandbox_ends_with_2_before_anything_is_run(
    with_layers: Callable[..., Grade],
    off: tuple[str, ...],
    options: tuple[str, ...],
    code: int,
    says: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert with_layers(*off)(*options) == code
    said = capsys.readouterr()
    assert says in said.out + said.err
    assert (tmp_path / "out/results").exists() == (code == 0)
