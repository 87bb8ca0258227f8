from __future__ import annotations

import re
import threading
import time
from collections.abc import Iterator

import pytest
import rclpy
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import String

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import START_NS, Graph, use_graph
from course_lib.ros.time import driving, interrupts, pace, virtual_time, wall
from course_lib.ros.time.driving import running_nodes, spin_for
from course_lib.ros.time.time_lock import time_lock
from tests.patience import PATIENCE

SECOND = 10**9  # [ns]


@pytest.fixture
def notebook(monkeypatch: pytest.MonkeyPatch) -> Iterator[Graph]:
    monkeypatch.setenv("COURSE_PACE", "fast")
    virtual_time.install()
    with use_graph(Graph(notebook=True)) as graph:
        rclpy.init(args=[])
        yield graph
        rclpy.try_shutdown()


def test_spin_for_advances_robot_time_by_exactly_its_duration(notebook: Graph) -> None:
    node, calls = Node("talker"), []
    node.create_timer(0.5, lambda: calls.append(1))
    spin_for(2.0, node)
    assert (len(calls), notebook.now_ns) == (4, START_NS + 2 * SECOND)


def test_burst_of_callbacks_takes_no_robot_time(notebook: Graph) -> None:
    node, values = Node("talker"), []
    publisher = node.create_publisher(String, "x", 2000)
    node.create_subscription(String, "x", lambda _: values.append(1), 2000)
    for _ in range(1500):
        publisher.publish(String())
    spin_for(0.001, node)
    assert (len(values), notebook.now_ns) == (1500, START_NS + SECOND // 1000)


def test_spin_for_ends_and_warns_once_when_a_callback_takes_its_full_period(
    notebook: Graph, capsys: pytest.CaptureFixture[str]
) -> None:
    node, calls = Node("sleeper"), []

    def tick() -> None:
        calls.append(notebook.now_ns - START_NS)
        time.sleep(1.0)

    node.create_timer(1.0, tick)
    spin_for(2.0, node)
    assert (calls, notebook.now_ns) == ([SECOND, 2 * SECOND], START_NS + 3 * SECOND)
    hint = "hint: tick of /sleeper took 1 s, and its timer's period is 1 s: it is always late"
    assert capsys.readouterr().out.count(hint) == 1


def test_callback_shorter_than_its_period_gets_no_hint(
    notebook: Graph, capsys: pytest.CaptureFixture[str]
) -> None:
    node = Node("sleeper")
    node.create_timer(1.0, lambda: time.sleep(0.5))
    spin_for(3.0, node)
    assert (capsys.readouterr().out, notebook.now_ns) == ("", START_NS + 3 * SECOND + SECOND // 2)


def test_line_of_a_blocking_callback_and_the_interrupted_line_are_reported(
    notebook: Graph, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(interrupts, "PATIENCE", 0.0)
    node = Node("stuck")

    def tick() -> None:
        callback = interrupts.watch.running_callback
        while callback is not None and not callback.is_reported:
            pass
        while True:
            interrupt_main()

    node.create_timer(1.0, tick)
    spin_for(10.0, node)
    lines, stopped = capsys.readouterr().out.splitlines()
    line = r"test_driving.py, line \d+: "
    assert re.fullmatch(rf"/stuck has been busy for \d+ s in {line}.* \(■ stops it\)", lines)
    assert re.fullmatch(rf"Stopped after 1.0 s of robot time, in {line}.*\.", stopped)


@pytest.mark.parametrize("seconds", [-1, "2", float("nan"), 1e7])
def test_invalid_duration_is_rejected(notebook: Graph, seconds: float) -> None:
    with pytest.raises(CourseError, match=r"pass the seconds of robot time first, from 0 to 1e\+06"):
        spin_for(seconds)


def test_invalid_node_is_rejected(notebook: Graph) -> None:
    with pytest.raises(CourseError, match=r"is not a node. Pass an object of your class"):
        spin_for(1.0, Node)  # type: ignore[arg-type]  # the mistake under test


def test_only_the_passed_nodes_and_live_nodes_run(notebook: Graph) -> None:
    calls: list[str] = []
    for name in ("given", "live", "left over"):
        node = Node(name.replace(" ", "_"))
        node.create_timer(1.0, lambda name=name: calls.append(name))  # type: ignore[misc]
        if name == "live":
            running_nodes().append(node)
        if name == "given":
            given = node
    spin_for(1.0, given)
    assert calls == ["given", "live"]


def test_waiting_for_a_future_or_a_callback_spins_the_live_nodes(notebook: Graph) -> None:
    live, waiting = Node("live"), Node("waiting")
    running_nodes().append(live)
    future: Future[int] = Future()
    live.create_timer(1.0, lambda: future.set_result(1))
    rclpy.spin_until_future_complete(waiting, future, timeout_sec=5.0)
    assert future.done()
    assert notebook.now_ns == START_NS + SECOND
    assert live.executor is rclpy.get_global_executor()


def test_cell_looping_over_spin_once_advances_time(notebook: Graph) -> None:
    node, calls = Node("talker"), []
    node.create_timer(0.01, lambda: calls.append(1))
    for _ in range(3000):
        rclpy.spin_once(node, timeout_sec=0)
    assert calls


def test_interrupt_ends_spin_with_one_line_while_another_thread_holds_the_time_lock(
    notebook: Graph, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COURSE_PACE", "real")
    node, calls = Node("talker"), list[int]()
    node.create_timer(0.1, lambda: calls.append(1))

    def interrupt_spin() -> None:
        # An interrupt before `spin_for` would end the tests.
        while not calls:
            wall.sleep(0.01)
        interrupt_main()

    for target in (sleep_in_the_program, interrupt_spin):
        threading.Thread(target=target, daemon=True).start()
    start = wall.monotonic()
    spin_for(1000.0, node)
    assert wall.monotonic() - start < 60  # [s] of the 1000
    output = capsys.readouterr().out
    assert output.startswith("Stopped after ")
    assert float(output.split()[2]) < 60  # [s] of robot time


@pytest.mark.slow
def test_thread_that_lost_the_time_lock_to_a_second_interrupt_reacquires_it(notebook: Graph) -> None:
    node, held = Node("talker"), []

    def stuck() -> None:
        with time_lock.hold():
            time.sleep(0.5)
            for _ in range(2):  # outside of the kit
                interrupt_main()
                wall.sleep(0.2)
            wall.sleep(0.3)
            time.sleep(0.5)
            held.append(time_lock._holder is time_lock._threads[threading.get_ident()])

    thread = threading.Thread(target=stuck, daemon=True)
    thread.start()
    spin_for(10.0, node)
    wall.sleep(0.8)
    spin_for(10.0, node)
    thread.join(PATIENCE)
    assert held == [True]


def test_pacing_yields_to_other_threads_after_a_slice() -> None:
    graph = Graph()
    paced = pace.WallPace(graph)
    start = wall.monotonic()
    assert not paced(graph.now_ns + 1000 * SECOND)
    assert wall.monotonic() - start < 1000
    assert paced(graph.now_ns)


def test_wait_for_returns_whether_the_condition_became_true(notebook: Graph) -> None:
    assert not driving.wait_for(lambda: False, seconds=1.0)
    assert notebook.now_ns == START_NS + SECOND
    assert driving.wait_for(lambda: True, seconds=1.0)


def sleep_in_the_program() -> None:
    with time_lock.hold():
        time.sleep(1000.0)


def interrupt_main() -> None:
    import signal

    signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
