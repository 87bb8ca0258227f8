"""Holes that a review found, each as the claim that it is closed."""

import os
import sys
import time
import zipfile
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from course_lib.course.course_file import Limits
from course_lib.errors import CourseError
from course_lib.grading import expect_marker, expect_parameters, judge, passed
from course_lib.grading.evidence import Check, Evidence
from course_lib.grading.judge import judge_task
from course_lib.grading.records import Run
from course_lib.grading.reports.scenes import figures, recording_with_inputs
from course_lib.grading.run.outcome import MAX_TEXT, is_plain
from course_lib.grading.run.submission_run import SubmissionRun
from course_lib.grading.submissions.archives import MAX_WORKING_BYTES, working_files
from course_lib.grading.submissions.submission import find_submissions
from course_lib.grading.task import Message, Scenario, Task
from course_lib.grading.vocabulary.check_function import LONGEST
from course_lib.robots.robot import packages_only, resolve
from course_lib.ros.graph.graph import START_NS, Sample
from course_lib.ros.graph.remote import ChannelError, RecordingBudget, RecordingLimitError, _qos
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import definitions, serialize
from tests.hostile.files import RECEIPT, book

TOPIC = "/visualization_marker"


def task_with(*checks: Check) -> Task:
    scenario = Scenario("public", checks=checks)
    return Task("week01.demo", "A demo", "node", "Demo", ("a", "b", "c"), (scenario,))


def test_judge_does_not_search_packages_for_types_invented_by_students(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(definitions, "find_package", lambda _: pytest.fail("looked for"))
    samples = (Sample(0, TOPIC, "made/msg/Up", b"x", Qos(), 2),)
    assert Evidence("a", "b", 1.0, samples).messages(TOPIC) == []


def test_check_exceeding_its_time_limit_fails_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    def loop(_: Evidence) -> Any:
        while True:
            pass

    monkeypatch.setattr(judge, "CHECK_SECONDS", 0.1)
    task = task_with(Check("endless", loop))
    run = Run(task.scenarios[0], Evidence(task.id, "public", 1.0))
    result = judge_task(task, 10.0, False, [run])
    assert result.checks[0].broken.endswith("TimeoutError: it takes more than 0.1 s")


@pytest.mark.parametrize(
    ("call", "reason"),
    [
        (lambda _: time.sleep(1000), "TimeoutError: it waits for something, without computing for 0.2 s"),
        (lambda _: sys.exit(0), "SystemExit: 0"),
        (lambda _: os._exit(0), "RuntimeError: os._exit would end or duplicate the grader: remove this call"),
        (lambda _: os.fork(), "RuntimeError: os.fork would end or duplicate the grader: remove this call"),
        (
            lambda _: os.kill(0, 9),
            "RuntimeError: os.kill(0, 9) would end or duplicate the grader: remove this call",
        ),
        (lambda _: input(), "EOFError: EOF when reading a line"),
        (lambda _: bytes(10**13), "MemoryError: "),
    ],
)
def test_check_that_waits_or_ends_the_program_fails_alone(
    call: Any, reason: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("course_lib.grading.task.WAIT_SECONDS", 0.2)
    task = task_with(Check("own", call), Check("right", lambda _: passed("as expected")))
    result = judge_task(task, 10.0, False, [Run(task.scenarios[0], Evidence(task.id, "public", 1.0))])
    assert [check.broken.partition(": ")[2] for check in result.checks] == [reason, ""]
    assert [check.score for check in result.checks] == [0.0, 1.0]


def test_slow_check_of_huge_messages_reports_the_messages(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def loop(_: Evidence) -> Any:
        while True:
            pass

    monkeypatch.setattr(judge, "CHECK_SECONDS", 0.1)
    task = task_with(Check("endless", loop))
    samples = (Sample(0, TOPIC, "visualization_msgs/msg/Marker", bytes(24_000_000), Qos(), 2),)
    run = Run(task.scenarios[0], Evidence(task.id, "public", 1.0, samples))
    (check,) = judge_task(task, 10.0, False, [run]).checks
    assert f"a message on {TOPIC} holds 24 MB" in check.message
    assert check.broken.endswith("TimeoutError: it takes more than 0.1 s")


@pytest.mark.parametrize("word", ["x" * 10**6, 7])
def test_qos_policy_that_is_not_a_string_is_rejected(word: object) -> None:
    with pytest.raises(ChannelError, match="Not a QoS"):
        _qos([word, 10, "reliable", "volatile", None, None, "automatic", None])


def test_images_do_not_use_the_recording_limit_of_other_messages() -> None:
    budget = RecordingBudget()
    budget.charge("sensor_msgs/msg/Image", 10**8)
    budget.charge("visualization_msgs/msg/Marker", budget.other_bytes)
    with pytest.raises(RecordingLimitError, match="the limit on recorded bytes was reached"):
        budget.charge("visualization_msgs/msg/Marker", 1)
    with pytest.raises(RecordingLimitError, match="the limit on recorded messages was reached"):
        RecordingBudget(messages=0).charge("visualization_msgs/msg/Marker", 0)


def test_too_many_messages_in_one_task_do_not_affect_another() -> None:
    cell = """
from rclpy.node import Node
from std_msgs.msg import String
def talker(size):
    def make():
        node = Node("talker")
        node.create_publisher(String, "/said", 1).publish(String(data="x" * size))
        return [node]
    return make
Flood, Right = talker(9_000_000), talker(10)
"""
    tasks = [replace(task_with(), id=f"week01.{name.lower()}", name=name) for name in ("Flood", "Right")]
    with closing(SubmissionRun([cell], {task.id: {} for task in tasks}, Limits())) as session:
        flood, right = (session.run(task, task.scenarios[0]) for task in tasks)
    assert (flood.stopped, len(flood.samples)) == ("size", 0)
    assert (right.errors, len(right.samples)) == ((), 1)


CAMERA = """
from rclpy.node import Node
from sensor_msgs.msg import Image
class Camera(Node):
    def __init__(self, pictures=1):
        super().__init__("camera")
        publisher = self.create_publisher(Image, "/image", 1)
        for _ in range(pictures):
            publisher.publish(Image(height=480, width=640, step=1920, encoding="rgb8", data=bytes(921_600)))
Left = lambda: Camera(290)
"""


@pytest.mark.slow
def test_camera_left_running_in_one_task_does_not_affect_another() -> None:
    tasks = [replace(task_with(), id=f"week01.{name.lower()}", name=name) for name in ("Left", "Camera")]
    with closing(SubmissionRun([CAMERA], {task.id: {} for task in tasks}, Limits())) as session:
        left, camera = (session.run(task, task.scenarios[0]) for task in tasks)
    assert (left.stopped, len(left.samples)) == ("", 290)
    assert (camera.stopped, camera.errors, len(camera.samples)) == ("", (), 1)


def test_slow_task_does_not_reduce_the_time_of_other_tasks() -> None:
    tasks = [replace(task_with(), id=f"week01.{n}", kind="value", name=n) for n in ("slow", "quick")]
    with closing(SubmissionRun(["slow = quick = 1"], {task.id: {} for task in tasks}, Limits())) as session:
        session._time_budget.charge("week01.slow", 1e9)
        slow, quick = (session.run(task, task.scenarios[0]) for task in tasks)
    assert (slow.stopped, slow.errors) == ("time", ("not run: the previous scenarios of slow took too long",))
    assert (quick.stopped, quick.returns) == ("", (1,))


@pytest.mark.slow
def test_flood_of_messages_is_stopped_early_with_the_likely_cause() -> None:
    cell = """
from rclpy.node import Node
from std_msgs.msg import Empty
class Flood(Node):
    def __init__(self):
        super().__init__("flood")
        publisher = self.create_publisher(Empty, "/said", 1)
        self.create_timer(1 / 6000, lambda: publisher.publish(Empty()))
"""
    task = replace(task_with(), name="Flood")
    with closing(SubmissionRun([cell], {task.id: {}}, Limits())) as session:
        evidence = session.run(task, task.scenarios[0])
    assert evidence.stopped == "size"
    assert "is the period of a timer too short" in evidence.errors[0]
    assert 2000 < len(evidence.samples) <= RecordingBudget.for_duration(task.scenarios[0].seconds).messages


def test_verdict_length_is_limited_regardless_of_the_published_messages() -> None:
    samples = tuple(Sample(0, f"/{n}", "std_msgs/msg/String", b"", Qos(), 2) for n in range(5000))
    verdict = expect_marker(TOPIC).judge(Evidence("a", "b", 1.0, samples))
    assert len(verdict.message) < LONGEST + 10


def test_raw_string_has_the_same_length_limit_as_a_converted_one() -> None:
    assert is_plain("x" * MAX_TEXT)
    assert not is_plain(["x" * (MAX_TEXT + 1)])


@pytest.mark.parametrize("text", ["[" * 9000, "{a: " * 1600 + "1" + "}" * 1600, "? [a]\n: 1"])
def test_invalid_parameters_file_is_reported_as_a_student_mistake(text: str) -> None:
    verdict = expect_parameters("/node", {"a": 1}).judge(Evidence("a", "b", 1.0, returns=(text,)))
    assert (verdict.score, verdict.mistake) == (0.0, "the parameters file cannot be read")


@pytest.mark.parametrize(
    "uri", ["file://{}", "package:///../../../../../../../../{}", "package://a/..%2f..%2f..%2f..%2f..%2f..{}"]
)
def test_report_does_not_reveal_files_of_the_grader(
    uri: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from visualization_msgs.msg import Marker

    from course_lib.displays import markers

    secret = tmp_path / "secret.stl"
    secret.write_text("solid")
    named = uri.format(secret)
    monkeypatch.setattr(markers, "load_mesh", lambda path: pytest.fail(f"read {path}"))
    task = task_with()
    cdr = serialize(Marker(type=Marker.MESH_RESOURCE, mesh_resource=named))
    sample = Sample(START_NS, TOPIC, "visualization_msgs/msg/Marker", cdr, Qos(), 2)
    run = Run(task.scenarios[0], Evidence(task.id, "public", 1.0, (sample,)))
    assert figures(task, [run], 100_000)[0].view
    with packages_only(), pytest.raises(CourseError, match="not the address of a file"):
        resolve(named)


def test_service_calls_of_a_scenario_are_not_drawn() -> None:
    called = Message("/camera/set_parameters", "rcl_interfaces/srv/SetParameters", {}, at=1.0)
    assert recording_with_inputs(Evidence("a", "b", 1.0), [called]).samples == []


@pytest.mark.parametrize("student", ["index.html", "viewer-0123456789ab.js"])
def test_student_id_equal_to_a_report_file_name_is_changed(student: str, tmp_path: Path) -> None:
    hand_in(tmp_path / student / "week01_exercise.ipynb")
    hand_in(tmp_path / "flat.ipynb", metadata={"course": {"student": student}})
    assert {found.student for found in find_submissions(tmp_path)} == {f"{student}_"}


@pytest.mark.parametrize("time", ["9999-12-31T23:59:59+00:00", "0001-01-01T00:00:00+00:00"])
def test_receipt_with_a_maximum_timestamp_is_ignored(time: str, tmp_path: Path) -> None:
    receipt = RECEIPT.replace(b"{", f'{{"time": "{time}", '.encode(), 1)
    (tmp_path / "ada").mkdir()
    with zipfile.ZipFile(tmp_path / "ada/week01.zip", "w") as archive:
        archive.writestr("receipt.json", receipt)
        archive.writestr("week01_exercise.ipynb", book())
    (submission,) = find_submissions(tmp_path)
    assert (submission.problem, submission.received.source) == ("", "unknown")


def test_uppercase_file_name_is_collected(tmp_path: Path) -> None:
    hand_in(tmp_path / "ada/WEEK01.IPYNB")
    assert find_submissions(tmp_path)[0].student == "ada"


def test_submission_with_the_id_of_another_student_is_reported(tmp_path: Path) -> None:
    for name in ("a.ipynb", "b.ipynb"):
        hand_in(tmp_path / name, metadata={"course": {"student": "ada", "exercise": "week01_exercise"}})
    (submission,) = find_submissions(tmp_path)
    assert "several files have the ID ada, in a.ipynb, b.ipynb: this one counts" in submission.notes


def test_working_files_exceeding_the_worker_limit_are_omitted(tmp_path: Path) -> None:
    names = [f"{n}.py" for n in range(20)]
    for name in names:
        (tmp_path / name).write_bytes(b"\xff" * (MAX_WORKING_BYTES - 1))
    assert working_files(tmp_path / "x.ipynb", [repr(names)]) == {}


def hand_in(path: Path, **more: Any) -> None:
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(book(**more))
    os.utime(path, (1.7e9, 1.7e9))
