import re
import signal
import threading
from collections.abc import Callable
from typing import Any

import pytest
import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from std_msgs.msg import Float64

from course_lib.course.course_file import Limits
from course_lib.errors import CourseError
from course_lib.grading.advice import incompatible_policy_hint
from course_lib.grading.evidence import Evidence
from course_lib.grading.inputs import set_parameters
from course_lib.grading.run.outcome import RAISED
from course_lib.grading.run.run import Job, Step, _job_fields
from course_lib.grading.run.scenario import rejection_reasons, run_in_this_process
from course_lib.grading.task import Call, Kind, Message, Scenario, Task, my

# The exception that ends a runaway thread; no others are raised in threads here.
pytestmark = pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")

NUMBER = "std_msgs/msg/Float64"


def run(subject: Any, kind: Kind = "node", personal: dict[str, Any] | None = None, **more: Any) -> Evidence:
    task = Task("week01.demo", "A demo", kind, "demo", ("one", "two", "three"))
    limit = more.pop("wall_limit", 20.0)
    return run_in_this_process(task, Scenario("public", **more), subject, personal or {}, wall_limit=limit)


class Doubler(Node):
    def __init__(self) -> None:
        super().__init__("doubler")
        self.out = self.create_publisher(Float64, "/out", 10)
        self.create_subscription(Float64, "/in", self.on_message, 10)

    def on_message(self, message: Float64) -> None:
        self.out.publish(Float64(data=2 * message.data))


def numbers(evidence: Evidence) -> list[tuple[float, float]]:
    return [(round(seconds, 3), message.data) for seconds, message in evidence.messages("/out")]


def test_inputs_are_received_and_only_student_messages_are_evidence() -> None:
    inputs = tuple(Message("/in", NUMBER, {"data": data}, at=at) for at, data in ((0.5, 1), (1.5, 2)))
    evidence = run(Doubler, inputs=inputs, seconds=2.0)
    assert numbers(evidence) == [(0.501, 2.0), (1.501, 4.0)]
    assert evidence.topics.keys() == {"/out"}


def test_best_effort_input_does_not_reach_a_reliable_subscription_and_causes_a_hint() -> None:
    inputs = (Message("/in", NUMBER, {"data": 1.0}, at=0.5, best_effort=True),)
    evidence = run(Doubler, inputs=inputs, seconds=1.0)
    assert numbers(evidence) == []
    (hint,) = incompatible_policy_hint([evidence])
    assert hint.startswith("Hint: Nothing arrives from /in: it is published with Best Effort")
    reliable = run(Doubler, inputs=(Message("/in", NUMBER, {"data": 1.0}, at=0.5),), seconds=1.0)
    assert incompatible_policy_hint([reliable]) == []


def test_best_effort_changes_the_key_of_a_run_and_its_default_does_not() -> None:
    def job(*, best_effort: bool) -> Job:
        message = Message("/in", NUMBER, {"data": 1.0}, best_effort=best_effort)
        scenario = Scenario("public", seconds=1.0, inputs=(message,))
        task = Task("week01.demo", "A demo", "node", "Demo", ("one", "two", "three"))
        return Job(("x = 1",), None, (Step(task, scenario),), Limits())

    assert job(best_effort=True).key != job(best_effort=False).key
    # Evidence of earlier versions stays valid, whose messages have no such field.
    assert "best_effort" not in _job_fields(Message("/in", NUMBER, {}))


def test_personal_values_are_inserted_into_inputs_and_calls() -> None:
    inputs = (Message("/in", NUMBER, {"data": my("n")}, at=0.5),)
    assert numbers(run(Doubler, inputs=inputs, personal={"n": 5.0})) == [(0.501, 10.0)]
    calls = (Call(my("n"), [my("n", times=2)]),)
    assert run(lambda a, b: (a, b), "function", {"n": 5.0}, calls=calls).returns == ([5.0, [10.0]],)


def test_input_may_call_a_service() -> None:
    def tuned() -> Node:
        node = Node("tuned")
        node.declare_parameter("gain", 1.0)
        out = node.create_publisher(Float64, "/out", 10)
        node.create_timer(1.0, lambda: out.publish(Float64(data=node.get_parameter("gain").value)))
        return node

    gain = {"parameters": [{"name": "gain", "value": {"type": 3, "double_value": my("gain")}}]}
    asked = Message("/tuned/set_parameters", "rcl_interfaces/srv/SetParameters", gain, at=1.5)
    assert numbers(run(tuned, inputs=(asked,), seconds=2.0, personal={"gain": 4.0})) == [
        (1.0, 1.0),
        (2.0, 4.0),
    ]


def test_reasons_for_rejected_parameters_are_in_the_output() -> None:
    def strict() -> Node:
        node = Node("strict")
        node.declare_parameter("gain", 1.0)
        refused = SetParametersResult(successful=False, reason="1.0 and nothing else")
        node.add_on_set_parameters_callback(lambda _: refused)
        return node

    asked = (set_parameters("/strict", 1.0, gain=2.0), set_parameters("/strict", 2.0, gain=3.0))
    assert run(strict, inputs=asked, seconds=3.0).output == (
        "At 1.00 s: Setting parameter failed: 1.0 and nothing else\n"
        "At 2.00 s: Setting parameter failed: 1.0 and nothing else\n"
    )


@pytest.mark.parametrize("cdr", [b"", b"\0\1\0\0", b"\0\1\0\0\xff\xff\xff\xff"])
def test_invalid_reply_is_not_a_rejection(cdr: bytes) -> None:
    assert rejection_reasons(cdr) == []


def test_malformed_input_is_reported_with_its_topic() -> None:
    with pytest.raises(CourseError, match=r"the message for /in \(std_msgs/msg/Float64\)"):
        run(Doubler, inputs=(Message("/in", NUMBER, {"date": 1.0}),))


def main() -> None:
    rclpy.init()
    node = Doubler()
    node.create_timer(1.0, lambda: node.out.publish(Float64(data=7.0)))
    rclpy.spin(node)
    node.destroy_node()
    rclpy.try_shutdown()


def several() -> list[Node]:
    return [Doubler(), Node("other")]


@pytest.mark.parametrize("subject", [main, several, lambda: Doubler()])
def test_main_function_or_factory_is_accepted_instead_of_a_class(subject: Callable[..., Any]) -> None:
    evidence = run(subject, inputs=(Message("/in", NUMBER, {"data": 1.0}, at=0.25),), seconds=1.0)
    assert evidence.errors == ()
    assert numbers(evidence)[0] == (0.251, 2.0)


def test_call_results_keep_their_order_and_errors_are_readable() -> None:
    evidence = run(lambda x: 1 / x, "function", calls=(Call(2.0), Call(0.0), Call(4.0)))
    assert evidence.returns == (0.5, RAISED, 0.25)
    assert evidence.errors[0].startswith("ZeroDivisionError: ")
    assert "test_scenario.py, line" in evidence.errors[0]


def test_values_texts_and_files_are_recorded(tmp_path: Any) -> None:
    assert run([1, (2,)], "value").returns == ([1, [2]],)
    assert run("because", "text").returns == ("because",)
    (tmp_path / "view.rviz").write_text("Panels: []")
    assert run(tmp_path / "view.rviz", "file").returns == ("Panels: []",)
    assert "FileNotFoundError" in run(tmp_path / "none.rviz", "file").errors[0]


def loop_for_ever() -> None:
    while True:
        pass


def loop_in_a_thread() -> Node:
    threading.Thread(target=loop_for_ever, daemon=True).start()
    return Doubler()


@pytest.mark.parametrize("subject", [loop_for_ever, loop_in_a_thread])
def test_endless_loop_is_interrupted_and_the_next_run_succeeds(subject: Callable[..., Any]) -> None:
    evidence = run(subject, wall_limit=0.2)
    assert evidence.stopped == "time"
    (message,) = evidence.errors
    where = r"test_scenario.py, line \d+: (while True:|pass)"
    assert re.fullmatch(
        rf"still running after 0.2 s \({where}\): is it an endless loop\? It was stopped.", message
    )
    assert run(lambda: 3, "function", calls=(Call(),)).returns == (3,)


def loop_around_a_call() -> None:
    while re.compile("a"):
        for number in range(10):
            increase(number)


def increase(number: int) -> int:
    return number + 1


def test_endless_loop_around_a_call_is_reported_with_its_own_line() -> None:
    (message,) = run(loop_around_a_call, wall_limit=0.2).errors
    assert 'while re.compile("a"):' in message


def test_endless_loop_is_interrupted_under_nohup() -> None:
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        assert run(loop_for_ever, wall_limit=0.2).stopped == "time"
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)


def test_output_is_recorded_and_random_generators_are_seeded() -> None:
    def roll() -> float:
        import random

        print("rolled")  # noqa: T201  what a student's code does
        return random.random()

    first, second = (run(roll, "function", calls=(Call(),), seed=4) for _ in range(2))
    assert first.output == "rolled\n"
    assert first.returns == second.returns != run(roll, "function", calls=(Call(),), seed=5).returns


def test_process_exit_is_an_error_of_the_student() -> None:
    evidence = run(lambda: exit(3), "function", calls=(Call(),))
    assert evidence.errors[0].startswith("SystemExit: 3")


@pytest.mark.parametrize(
    ("subject", "error"),
    [
        ("CubeNode", "got an object of str, expected a node class: pass CubeNode without quotes"),
        (lambda: None, "<lambda>() created no node, expected a class: class <lambda>(Node): …"),
    ],
)
def test_error_explains_a_subject_that_is_not_a_node(subject: Any, error: str) -> None:
    assert run(subject).errors == (error,)


def test_passing_an_instance_instead_of_its_class_is_explained() -> None:
    class Made:
        pass

    assert run(Made()).errors == (
        "got an object of Made, expected a node class: pass Made itself, without ()",
    )


def stops_in_finally() -> None:
    rclpy.init()
    node = Doubler()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.out.publish(Float64(data=0.0))
        rclpy.shutdown()


def test_errors_after_the_end_of_a_scenario_are_ignored() -> None:
    inputs = (Message("/in", NUMBER, {"data": 1.0}, at=0.5),)
    evidence = run(stops_in_finally, inputs=inputs, seconds=1.0)
    assert evidence.errors == ()
    assert numbers(evidence) == [(0.501, 2.0)]


def test_errors_before_the_end_of_a_scenario_are_recorded() -> None:
    evidence = run(lambda: [Doubler(), 3], seconds=1.0)
    assert len(evidence.errors) == 1
