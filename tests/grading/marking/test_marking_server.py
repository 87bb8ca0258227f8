"""The page's server against strangers, bad requests and hostile submissions."""

import json
import os
import signal
from pathlib import Path
from typing import Any

import pytest

from course_lib.errors import CourseError
from course_lib.grading.marking.by_hand import find_stale, mark_by_hand
from course_lib.grading.marking.server import ADDRESS, serve
from course_lib.grading.marks import read_marks
from course_lib.grading.store import Course, marks_path, report_path
from tests.browser.waiting import wait_until
from tests.grading.marking.bench import ESSAY, MOTTO, Served, save, served, write_results

SCRIPT = "<script>document.title = 'run'</script><img src=x onerror=\"document.title = 'run'\">"


def of(server: Served, student: str, task: str) -> Any:
    (item,) = [one for one in server.items() if (one["student"], one["task"]) == (student, task)]
    return item


def test_marking_server_is_rejected_on_jupyterhub(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("JUPYTERHUB_SERVICE_PREFIX", "/user/ada/")
    with pytest.raises(CourseError, match="not served on a JupyterHub"):
        serve(tmp_path)


def test_mark_is_stored_on_disk_before_it_is_acknowledged(server: Served, tmp_path: Path) -> None:
    item = of(server, "ada", ESSAY)
    answer = server.ask(f"api/item/{item['key']}", save(item, 5, "Ann", "clear", row="1"))
    server.kill()
    assert answer.code == 200
    (mark,) = read_marks(marks_path(tmp_path / "out", "ada", "week05_exercise"))
    assert (mark.by, mark.points, mark.row, mark.comment) == ("Ann", 5, "names the parts", "clear")


@pytest.mark.slow
def test_marks_on_the_page_update_reports_and_gradebook(server: Served, tmp_path: Path) -> None:
    item = of(server, "bob", MOTTO)
    server.ask(f"api/item/{item['key']}", save(item, 60, "Ann", "now it is kind"))
    report = tmp_path / "out/reports/bob/week05_exercise.html"
    wait_until(lambda: "now it is kind" in report.read_text())
    assert "bob,week05_exercise,60.0" in (tmp_path / "out/gradebook.csv").read_text()
    wait_until(lambda: "up to date" in server.ask("api/queue?since=0").content["state"])


@pytest.mark.slow
def test_ctrl_c_stops_the_server_after_reports_are_updated(server: Served, tmp_path: Path) -> None:
    assert (tmp_path / "out" / ADDRESS).stat().st_mode & 0o777 == 0o600
    item = of(server, "bob", MOTTO)
    server.ask(f"api/item/{item['key']}", save(item, 60, "Ann", "now it is kind"))
    server.process.send_signal(signal.SIGINT)
    assert server.process.wait() == 0
    assert "now it is kind" in (tmp_path / "out/reports/bob/week05_exercise.html").read_text()
    assert not (tmp_path / "out" / ADDRESS).exists()


@pytest.mark.sample(1)
@pytest.mark.parametrize("path", ["", "marking.js", "api/queue?since=0", "api/item/{key}"])
def test_request_without_the_token_is_rejected(unmarked: Served, path: str) -> None:
    path = path.format(key=unmarked.items()[0]["key"])
    token = unmarked.address.split("/")[3]
    for other in ("", "x" * len(token), token[:-1], token.upper(), "%ff", "..", "%2e%2e"):
        answer = unmarked.ask_plainly(unmarked.address.replace(token, other) + path)
        assert answer.code in (400, 403, 404)
        assert "ada" not in answer.text


def test_request_with_a_foreign_host_name_is_rejected(unmarked: Served) -> None:
    assert unmarked.ask("api/queue?since=0", Host=f"evil.example:{unmarked.port}").code == 403
    assert unmarked.ask("api/queue?since=0", Host=f"localhost:{unmarked.port}").code == 200


@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": "http://evil.example"},
        {"Origin": "null"},  # a frame without rights
        {"Origin": "http://127.0.0.1:1"},
        {"Content_Type": "text/plain"},
        {"Content_Type": "application/x-www-form-urlencoded"},
    ],
)
def test_save_request_from_another_origin_is_rejected(unmarked: Served, headers: dict[str, str]) -> None:
    item = of(unmarked, "ada", ESSAY)
    answer = unmarked.ask(f"api/item/{item['key']}", save(item, 5, "Ann", row="1"), **headers)
    assert answer.code in (403, 415)
    assert not (unmarked.out / "marks").exists()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (b"{", "the page sent invalid JSON"),
        (b"[" * 100_000, "the page sent invalid JSON"),
        (b'{"by": "a", "revision": "r", "marks": []}', "the page sent no marks"),
        ({"by": 1}, "the page sent no marks"),
        ({"points": "5"}, "expected row, points and comment"),
        ({"points": True}, "expected row, points and comment"),
        ({"points": float("nan")}, "expected 0 to 5"),
        ({"points": 1e999}, "expected 0 to 5"),
        ({"points": -1}, "expected 0 to 5"),
        ({"points": 6}, "6 points for names the parts: expected 0 to 5"),
        ({"row": "9"}, "the rubric has 1 names the parts"),
        ({"comment": "x" * 10_001}, "10001 characters"),
    ],
)
def test_invalid_save_request_is_rejected_with_a_message(
    unmarked: Served, changes: Any, message: str
) -> None:
    item = of(unmarked, "ada", ESSAY)
    body = changes
    if isinstance(changes, dict):
        whole = save(item, 5, "Ann", row="1")
        inner = {name: changes[name] for name in changes if name != "by"}
        body = (
            whole
            | {"marks": [whole["marks"][0] | inner]}
            | {name: changes[name] for name in changes if name == "by"}
        )
    answer = unmarked.ask(f"api/item/{item['key']}", body)
    assert answer.code == 400
    assert message in answer.content["error"]
    assert not (unmarked.out / "marks").exists()


@pytest.mark.slow
def test_outdated_save_of_a_second_grader_is_a_conflict(server: Served) -> None:
    item = of(server, "ada", ESSAY)
    path = f"api/item/{item['key']}"
    assert server.ask(path, save(item, 5, "Ann", row="1")).code == 200
    answer = server.ask(path, save(item, 3, "Ben", row="1"))
    assert answer.code == 409
    assert "Ann has marked week05.essay in the meantime" in answer.content["error"]


@pytest.mark.parametrize(
    "path",
    [
        "../../etc/passwd",
        "..%2f..%2fetc%2fpasswd",
        "conftest.py",
        "types.d.ts",
        "api/item/..%2fada",
        "api/item/ada",
    ],
)
def test_request_path_cannot_reach_other_files(unmarked: Served, path: str) -> None:
    assert unmarked.ask(path).code == 404


def test_scene_page_is_sandboxed_anonymous_and_has_its_own_token(unmarked: Served) -> None:
    item, other = of(unmarked, "ada", ESSAY), of(unmarked, "bob", ESSAY)
    scene = unmarked.ask(f"api/item/{item['key']}").content["scene"]
    base = f"http://127.0.0.1:{unmarked.port}"
    answer = unmarked.ask_plainly(base + scene)
    policy = answer.headers["Content-Security-Policy"]
    assert answer.code == 200
    assert "sandbox allow-scripts; default-src 'none'" in policy
    assert "'unsafe-inline'" not in policy.split("style-src")[0]
    assert "A person reads and marks this task." in answer.text
    assert "ada" not in answer.text
    assert unmarked.address.split("/")[3] not in scene
    assert unmarked.ask_plainly(base + scene.replace(item["key"], other["key"])).code == 403


def test_content_security_policy_allows_only_the_files_of_the_page(unmarked: Served) -> None:
    for path in ("", "marking.js", "api/queue?since=0"):
        headers = unmarked.ask(path).headers
        assert "script-src 'self'; style-src 'self'" in headers["Content-Security-Policy"]
        assert "default-src 'none'" in headers["Content-Security-Policy"]
        assert headers["X-Content-Type-Options"] == "nosniff"
        assert headers["Cache-Control"] == "no-store"
        assert headers["Referrer-Policy"] == "no-referrer"


@pytest.mark.slow
def test_hostile_student_data_and_code_are_served_as_plain_data(kinds: Course, tmp_path: Path) -> None:
    name = f"cleo {SCRIPT}".replace("/", "")
    undecodable = os.fsdecode(b"d\xffn")
    code = f"essay = '''{SCRIPT}\u202e'''\n" + "(" * 5000
    write_results(kinds, tmp_path / "out", (name, undecodable), code)
    with served(kinds, tmp_path / "out") as server:
        item = of(server, name, ESSAY)
        details = server.ask(f"api/item/{item['key']}").content
        shown = "".join(text for cell in details["code"]["cells"] for _, text in cell["pieces"])
        assert SCRIPT in shown
        assert "\u202e" not in shown
        other = of(server, undecodable, ESSAY)
        assert (
            server.ask(f"api/item/{other['key']}", save(other, 5, "\ud800Ann", "\ud800", row="1")).code == 200
        )
    (mark,) = read_marks(marks_path(tmp_path / "out", undecodable, "week05_exercise"))
    assert (mark.by, mark.comment) == ("?Ann", "?")


def test_marks_of_a_student_with_an_undecodable_name_reach_report_and_index(
    kinds: Course, tmp_path: Path
) -> None:
    out, student = tmp_path / "out", os.fsdecode(b"d\xffn")
    write_results(kinds, out, (student,))
    mark_by_hand(out, student, "week05_exercise", ESSAY, "5", row="1", comment="Well read.", course=kinds)
    assert "Well read." in report_path(out, student, "week05_exercise").read_text("utf-8")
    assert 'href="d%FFn/week05_exercise.html"' in (out / "reports/index.html").read_text("utf-8")
    assert find_stale(out) == []


@pytest.mark.slow
def test_changed_or_missing_submission_code_is_reported(server: Served, tmp_path: Path) -> None:
    path = tmp_path / "in/ada/week05_exercise.ipynb"
    item = of(server, "ada", ESSAY)
    notebook = json.loads(path.read_text())
    notebook["cells"].pop()
    path.write_text(json.dumps(notebook))
    code = server.ask(f"api/item/{item['key']}").content["code"]
    assert code["problem"] == "This file has changed since it was graded."
    assert [(cell["title"], cell["own"]) for cell in code["cells"]] == [("Cell 1", True)]
    path.unlink()
    assert "The code can't be shown" in server.ask(f"api/item/{item['key']}").content["code"]["problem"]


@pytest.mark.slow
def test_folder_without_results_and_occupied_port_are_rejected(
    server: Served, kinds: Course, tmp_path: Path
) -> None:
    with pytest.raises(CourseError, match="has no results"):
        serve(tmp_path / "in", course=kinds)
    with pytest.raises(CourseError, match=f"Port {server.port} is not available"):
        serve(tmp_path / "out", port=server.port, browser=False, course=kinds)
