"""JSON that others wrote: what is nested too deeply is refused like any other damaged text."""

import asyncio
from collections.abc import Callable
from pathlib import Path

import pytest
from tornado.websocket import websocket_connect

from course_lib.authoring.memory import MEMORY, _known
from course_lib.course.state import State
from course_lib.errors import CourseError
from course_lib.foreign import read_json
from course_lib.grading.handin.copies import FOLDER, alike_in
from course_lib.grading.records import Course
from course_lib.ros.process import NotebookProgram
from course_lib.viewer.page_server import PageServer
from course_lib.viewer.scene import Scene

DEEP = "[" * 100_000

# what reads a file, the file's place in a folder, what is said
READERS: list[tuple[Callable[[Path], object], str, str]] = [
    (lambda top: State(top).section("hints"), ".course/hints.json", r"hints\.json is broken .* Delete it"),
    (lambda top: NotebookProgram(top / "a.ipynb"), "a.ipynb", r"a\.ipynb is not a notebook of format 4"),
    (alike_in, f"{FOLDER}/week01_exercise.json", r"week01_exercise\.json can't be read: .* Remove it"),
]


def test_a_text_that_is_nested_too_deeply_is_not_json() -> None:
    with pytest.raises(ValueError, match="nested too deeply"):
        read_json(DEEP)


@pytest.mark.parametrize(("read", "name", "said"), READERS, ids=[name for _, name, _ in READERS])
def test_a_file_that_is_nested_too_deeply_is_named(
    read: Callable[[Path], object], name: str, said: str, tmp_path: Path
) -> None:
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).write_text(DEEP)
    with pytest.raises(CourseError, match=said):
        read(tmp_path)


@pytest.mark.parametrize("text", [DEEP, "5", "{", '{"a": 1}'])
def test_a_damaged_memory_of_verified_weeks_is_an_empty_one(tmp_path: Path, text: str) -> None:
    (tmp_path / MEMORY).parent.mkdir(exist_ok=True)
    (tmp_path / MEMORY).write_text(text)
    assert _known(Course(tmp_path / "exercises", tmp_path / "solutions")) == []


@pytest.mark.parametrize("message", [DEEP, "{"])
def test_a_page_that_sends_no_json_is_told_so(message: str) -> None:
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
