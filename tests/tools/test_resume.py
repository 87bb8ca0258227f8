"""`resume()` in real kernels, as JupyterLab would start them."""

import json
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from jupyter_client.manager import KernelManager

from course_lib.course.material import lessons
from course_lib.course.state import STATE_FOLDER, cell_digest, last_check, state_of
from course_lib.tools.resume import resume
from tests.patience import PATIENCE

LESSONS = [path for path in lessons() if path.stem >= "week01"]
PLACE = "go-on-here"  # the beginning of the ids of the cells
CELLS = (
    "%load_ext course_lib\nfrom course_lib import resume, run_live, predict\nimport rclpy\nrclpy.init()",
    "print('seen'); size = 1",
    "class Half(",
    "raise ValueError('no')",
    'predict("week01.ground")',
    "size += 1",
    "resume()",
    "size += 10",
)


def code_cells(path: Path) -> list[dict[str, Any]]:
    """Return the code cells of a notebook."""
    return [cell for cell in json.loads(path.read_text("utf-8"))["cells"] if cell["cell_type"] == "code"]


def places_of(cells: list[dict[str, Any]]) -> list[int]:
    """Return the indices of the cells at which a lesson is resumed."""
    return [index for index, cell in enumerate(cells) if cell["id"].startswith(PLACE)]


def may_raise(cell: dict[str, Any]) -> bool:
    """Return whether a cell of a lesson shows an error."""
    return "raises-exception" in cell["metadata"].get("tags", [])


def unexpected_failures(printed: str, cells: list[dict[str, Any]]) -> list[str]:
    """Return the lines of the output of `resume()` on cells that should not fail."""
    failures = re.finditer(r"^  In \[(\d+)\]: .*", printed, re.MULTILINE)
    return [line.group() for line in failures if not may_raise(cells[int(line.group(1)) - 1])]


class Kernel:
    """A kernel that runs the cells of one notebook, by their ids."""

    def __init__(self, path: Path, client: Any) -> None:
        self.cells = code_cells(path)
        self._client = client

    def run(self, index: int, source: str | None = None, *, tells_id: bool = True) -> tuple[str, str]:
        """Run a cell. Return its output and the name of its exception."""
        cell = self.cells[index]
        code = "".join(cell["source"]) if source is None else source
        content = {"code": code, "silent": False, "store_history": True, "stop_on_error": False}
        content |= {"user_expressions": {}, "allow_stdin": False}
        metadata = {"cellId": cell["id"]} if tells_id else {}
        message = self._client.session.msg("execute_request", content, metadata=metadata)
        self._client.shell_channel.send(message)
        printed, error = "", ""
        while True:
            news = self._client.get_iopub_msg(timeout=PATIENCE)
            if news["parent_header"].get("msg_id") != message["header"]["msg_id"]:
                continue
            if news["msg_type"] == "stream":
                printed += news["content"]["text"]
            elif news["msg_type"] == "error":
                error = news["content"]["ename"]
            elif news["content"].get("execution_state") == "idle":
                return printed, error


@contextmanager
def kernel_of(path: Path) -> Iterator[Kernel]:
    manager = KernelManager()
    manager.start_kernel(cwd=str(path.parent), env=os.environ | {"JPY_SESSION_NAME": str(path)})
    client = manager.client()
    client.start_channels()
    try:
        client.wait_for_ready(timeout=PATIENCE)
        yield Kernel(path, client)
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)


@pytest.fixture
def notebook(tmp_path: Path) -> Path:
    empty: dict[str, object] = {"cell_type": "code", "metadata": {}, "outputs": [], "execution_count": None}
    cells = [{**empty, "id": f"c{i}", "source": source} for i, source in enumerate(CELLS)]
    path = tmp_path / "lesson.ipynb"
    path.write_text(json.dumps({"cells": cells, "metadata": {}, "nbformat": 4, "nbformat_minor": 5}))
    return path


@pytest.mark.slow
def test_new_kernel_runs_the_cells_above_without_their_outputs_and_reports_errors(notebook: Path) -> None:
    with kernel_of(notebook) as kernel:
        printed, error = kernel.run(6, "from course_lib import resume\nresume()")
        assert error == ""
        assert "seen" not in printed
        assert printed.splitlines() == [
            "Ran 4 cells above. Continue below.",
            "Errors, as when you run these cells yourself:",
            "  In [4]: ValueError: no",
        ]
        assert kernel.run(7, "print(size)") == ("2\n", "")
        assert kernel.run(6) == ("All cells above have been run. Continue below.\n", "")
        assert kernel.run(7, "print(size)") == ("2\n", "")


def test_message_from_another_thread_arrives_while_resume_runs_cells(notebook: Path) -> None:
    message = """\
from threading import Thread
errors = []
def receive():
    try:
        get_ipython().set_parent(get_ipython().get_parent())
    except Exception as error:
        errors.append(error)
thread = Thread(target=receive)
thread.start()
thread.join()"""
    content = json.loads(notebook.read_text())
    content["cells"][1]["source"] = message
    notebook.write_text(json.dumps(content))
    with kernel_of(notebook) as kernel:
        kernel.run(6, "from course_lib import resume\nresume()")
        assert kernel.run(7, "print(thread.is_alive(), errors)") == ("False []\n", "")


def test_check_after_resume_counts_as_a_check_of_the_cells_that_resume_ran(notebook: Path) -> None:
    (notebook.parent / STATE_FOLDER).mkdir()  # as in a student's folder
    content = json.loads(notebook.read_text())
    answer = "def battery_bar(charge, height):\n    return 0"
    asking = 'check("week05.battery_bar", battery_bar)'
    for cell, source in zip(content["cells"][3:], [answer, "size = 0", asking], strict=False):
        cell["source"] = source
    notebook.write_text(json.dumps(content))
    with kernel_of(notebook) as kernel:
        kernel.run(6, "from course_lib import resume\nresume()")
        printed, _ = kernel.run(6, f"from course_lib import check\n{asking}")
        assert "ended with an error" not in printed
    last = last_check(state_of(notebook.parent), "week05.battery_bar")
    assert last is not None
    assert cell_digest(answer) in last.cells


@pytest.mark.slow
def test_cells_already_run_in_this_kernel_are_not_run_again(notebook: Path) -> None:
    with kernel_of(notebook) as kernel:
        for index in (0, 1):
            kernel.run(index)
        kernel.run(1, "size = 5")
        printed, _ = kernel.run(6, tells_id=False)
        assert printed.startswith("Ran 2 cells above.")
        assert kernel.run(7, "print(size)") == ("6\n", "")


PLACE_TO_STOP = "from course_lib import resume\n\nresume()  # to part 2"


@pytest.mark.sample(1)
@pytest.mark.parametrize(("stop", "count"), [(PLACE_TO_STOP, 5), ("resume(); size += 0", 6)])
def test_cells_below_a_stopping_point_are_run_once_by_a_later_resume(
    notebook: Path, stop: str, count: int
) -> None:
    content = json.loads(notebook.read_text())
    content["cells"][6]["source"] = stop
    content["cells"].append({**content["cells"][7], "id": "c8", "source": "resume()"})
    notebook.write_text(json.dumps(content))
    with kernel_of(notebook) as kernel:
        printed, _ = kernel.run(8, "from course_lib import resume\nresume()")
        assert printed.startswith(f"Ran {count} cells above.")
        assert kernel.run(8, "print(size)") == ("12\n", "")


@pytest.mark.slow
def test_passed_stopping_point_does_not_rerun_cells(notebook: Path) -> None:
    content = json.loads(notebook.read_text())
    content["cells"][6]["source"] = PLACE_TO_STOP
    content["cells"].append({**content["cells"][7], "id": "c8", "source": "resume()"})
    notebook.write_text(json.dumps(content))
    with kernel_of(notebook) as kernel:
        for index in (0, 1, 3, 4, 5, 7):
            kernel.run(index)
        assert kernel.run(8) == ("All cells above have been run. Continue below.\n", "")


@pytest.mark.slow
def test_cell_missing_in_the_saved_notebook_is_reported(notebook: Path) -> None:
    with kernel_of(notebook) as kernel:
        kernel.cells.append({"id": "new", "source": ""})
        _, error = kernel.run(8, "from course_lib import resume\nresume()  # new")
        assert error == "CourseError"


def test_resume_without_a_server_has_no_effect(capsys: pytest.CaptureFixture[str]) -> None:
    resume()
    assert capsys.readouterr().out == ""


# tests/browser/test_lessons.py resumes all other lessons at their last place.
@pytest.mark.slow
@pytest.mark.parametrize("number", [0, -1], ids=["first", "last"])
def test_lesson_one_resumes_from_its_stopping_points_in_a_new_kernel(
    number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COURSE_PACE", "fast")
    (tmp_path / ".course").mkdir()
    path = tmp_path / LESSONS[0].name
    path.write_text(LESSONS[0].read_text("utf-8"), "utf-8")
    with kernel_of(path) as kernel:
        places = places_of(kernel.cells)
        place = places[number]
        printed, error = kernel.run(place)
        assert (printed.splitlines()[0].startswith("Ran "), error) == (True, "")
        assert unexpected_failures(printed, kernel.cells) == []
        # Cells below the last place are run after it was resumed there; nbmake runs them after the
        # cells above.
        end = len(kernel.cells) if number == -1 else places[-1] + 1
        faults = {
            cell["id"]: fault
            for index, cell in enumerate(kernel.cells[place + 1 : end], place + 1)
            if not may_raise(cell) and (fault := kernel.run(index)[1])
        }
        assert faults == {}


def minutes_of(cell: dict[str, Any]) -> int:
    """Return the minutes that the headings of a cell state, [min]."""
    return sum(int(found) for found in re.findall(r"^## .*\((\d+) min\)", "".join(cell["source"]), re.M))


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda p: p.stem)
def test_stopping_points_divide_each_lesson_into_parts_shorter_than_an_hour(lesson: Path) -> None:
    cells = json.loads(lesson.read_text("utf-8"))["cells"]
    places = [index for index, cell in enumerate(cells) if cell["id"].startswith("stop-here")]
    assert places
    edges = [0, *places, len(cells)]
    parts = [sum(map(minutes_of, cells[i:j])) for i, j in pairwise(edges)]
    assert max(parts) < 60
    for number, place in enumerate(places, 1):
        done, ahead = sum(parts[:number]), parts[number]
        which = "last" if place == places[-1] else "next"
        stated = f"{done} of {sum(parts)} minutes are behind you, and the {which} part takes {ahead}."
        assert stated in "".join(cells[place]["source"])
        # The number identifies the position for pages that send no cell ids.
        go_on = "".join(cells[place + 1]["source"])
        assert go_on.endswith(f"resume()  # to part {number + 1} of {len(parts)}")
