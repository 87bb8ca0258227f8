"""Third-party JSON and Python: too deeply nested text is rejected like other malformed text."""

import asyncio
from collections.abc import Callable
from pathlib import Path

import pytest
from tornado.websocket import websocket_connect

from course_lib.authoring.verify import DIGESTS_FILE, _read_digests
from course_lib.course.state import State
from course_lib.errors import CourseError
from course_lib.export.module import Cell, statements
from course_lib.grading.store import Course
from course_lib.grading.submissions.copies import FOLDER, read_similar
from course_lib.grading.submissions.notebook import CodeCell
from course_lib.ros.programs.process import NotebookProgram, Program
from course_lib.third_party import MAX_NESTING, compile_python, parse_scopes, read_json
from course_lib.viewer.page_server import PageServer
from course_lib.viewer.scene import Scene

DEEP = "[" * 100_000

# reader, path of the file, reported message
READERS: list[tuple[Callable[[Path], object], str, str]] = [
    (lambda top: State(top).section("hints"), ".course/hints.json", r"hints\.json is broken .* Delete it"),
    (lambda top: NotebookProgram(top / "a.ipynb"), "a.ipynb", r"a\.ipynb is not a notebook of format 4"),
    (read_similar, f"{FOLDER}/week01_exercise.json", r"week01_exercise\.json can't be read: .* Remove it"),
]


def test_too_deeply_nested_json_is_rejected() -> None:
    with pytest.raises(ValueError, match="nested too deeply"):
        read_json(DEEP)


@pytest.mark.parametrize(("read", "name", "message"), READERS, ids=[name for _, name, _ in READERS])
def test_too_deeply_nested_file_is_reported(
    read: Callable[[Path], object], name: str, message: str, tmp_path: Path
) -> None:
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).write_text(DEEP)
    with pytest.raises(CourseError, match=message):
        read(tmp_path)


@pytest.mark.parametrize("text", [DEEP, "5", "{", '{"a": 1}'])
def test_damaged_record_of_verified_weeks_is_treated_as_empty(tmp_path: Path, text: str) -> None:
    (tmp_path / DIGESTS_FILE).parent.mkdir(exist_ok=True)
    (tmp_path / DIGESTS_FILE).write_text(text)
    assert _read_digests(Course(tmp_path / "exercises", tmp_path / "solutions")) == []


@pytest.mark.parametrize("message", [DEEP, "{"])
def test_invalid_json_from_a_page_gives_an_error_response(message: str) -> None:
    async def closed() -> tuple[int | None, str | None]:
        server = PageServer(Scene())
        server.listen()
        serving = asyncio.create_task(server.serve())
        page = await websocket_connect(server.url.replace("http", "ws", 1) + "socket")
        await page.read_message()  # the scene
        await page.write_message(message)
        assert await page.read_message() is None
        serving.cancel()
        return page.close_code, page.close_reason

    assert asyncio.run(closed()) == (1003, "not JSON")


DEEP_PYTHON = {
    "operators": "x = " + "-" * 100_000 + "1",
    "attributes": "x = 1\nx = x" + ".real" * 200_000,
    "sum": "x = " + " + ".join(["1"] * 200_000),
    "conditions": "x = " + "1 if 1 else " * 50_000 + "1",
}
# Python compiles these, but a visitor of the syntax tree that recurses exceeds the limit of calls.
NESTED_PYTHON = {
    "attributes": "x = 1\nx = x" + ".real" * 2_000,
    "sum": "x = " + " + ".join(["1"] * 2_000),
    "branches": "x = 1\nif x == 0: pass\n" + "elif x == 1: pass\n" * 400,
}


@pytest.mark.parametrize("code", DEEP_PYTHON.values(), ids=list(DEEP_PYTHON))
def test_too_deeply_nested_python_is_a_syntax_error_with_its_line(code: str, tmp_path: Path) -> None:
    with pytest.raises(SyntaxError, match="nested too deeply") as raised:
        compile_python(f"first = (\n1)\n{code}\nlast = 2\n")
    assert raised.value.lineno == 2 + len(code.splitlines())
    cell = CodeCell(1, code, was_run=True)
    assert "nested too deeply for Python: split the expression" in cell.syntax_error
    (tmp_path / "deep.py").write_text(code)
    with pytest.raises(CourseError, match=r"deep\.py, line \d: it is nested too deeply"):
        Program(tmp_path / "deep.py", ())


@pytest.mark.parametrize("code", [*DEEP_PYTHON.values(), *NESTED_PYTHON.values()])
def test_too_deeply_nested_python_is_not_analysed(code: str) -> None:
    assert CodeCell(1, code, was_run=True).bindings == frozenset()
    with pytest.raises(CourseError, match=r"Cell 3, line \d+: it is nested too deeply"):
        statements([Cell(3, code, is_marked=False)])


def test_nested_python_at_the_limit_is_analysed() -> None:
    code = "x = " + " + ".join(["y"] * (MAX_NESTING - 10))
    assert CodeCell(1, code, was_run=True).bindings == {"x"}
    assert {symbol.get_name() for symbol in parse_scopes(code).get_symbols()} == {"x", "y"}


def test_sum_of_many_terms_compiles_as_in_python(tmp_path: Path) -> None:
    (tmp_path / "sum.py").write_text("x = 1\ny = " + " + ".join(["x"] * 2_000))
    assert Program(tmp_path / "sum.py", ())
