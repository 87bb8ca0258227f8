import asyncio
import re
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from contextvars import ContextVar

import pytest
import rclpy
from rclpy.node import Node
from std_msgs.msg import String

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import START_NS, Graph, use_graph
from course_lib.ros.time import driving, interrupts, pace, virtual_time, wall
from course_lib.ros.time.driving import LiveRun, run_live, running_nodes, stop_all

Captured = pytest.CaptureFixture[str]
A_MINUTE = 60.0  # [s]

SHOW = LiveRun.show  # the fixture replaces it


@pytest.fixture
def notebook(monkeypatch: pytest.MonkeyPatch) -> Iterator[Graph]:
    monkeypatch.setattr(LiveRun, "show", lambda self: None)
    virtual_time.install()
    with use_graph(Graph(notebook=True)) as graph:
        rclpy.init(args=[])
        yield graph
        rclpy.try_shutdown()


def in_a_kernel(
    cell: Callable[[], object], monkeypatch: pytest.MonkeyPatch, *, until: Callable[[], object]
) -> None:
    """Run a cell in a loop on the wall's clock, as a kernel does, and leave it free until something is so."""
    monkeypatch.setenv("COURSE_PACE", "real")

    async def kernel() -> None:
        asyncio.get_running_loop().time = wall.monotonic  # type: ignore[method-assign]
        cell()
        end = wall.monotonic() + A_MINUTE
        while not until():
            assert wall.monotonic() < end
            await asyncio.sleep(0.02)

    asyncio.run(kernel())


def test_live_run_without_a_page_simulates_two_seconds_and_prints_a_notice(
    notebook: Graph, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COURSE_PACE", "fast")
    node, calls = Node("talker"), []
    node.create_timer(1.0, lambda: calls.append(1))
    run = run_live(node)
    assert (len(calls), notebook.now_ns) == (2, START_NS + 2 * 10**9)
    assert "ran 2 s of robot time at full speed" in capsys.readouterr().out
    assert run.state() == "▶ running: talker (0 s of robot time)"


def test_live_nodes_run_while_the_event_loop_is_idle_and_pause_when_stopped(
    notebook: Graph, monkeypatch: pytest.MonkeyPatch
) -> None:
    node, calls = Node("talker"), []
    node.create_timer(0.05, lambda: calls.append(1))
    runs: list[LiveRun] = []
    start = wall.monotonic()
    in_a_kernel(lambda: runs.append(run_live(node)), monkeypatch, until=lambda: len(calls) > 4)
    assert len(calls) <= (wall.monotonic() - start) / 0.05
    runs[0].stop()
    runs[0].stop()
    assert running_nodes() == []
    assert runs[0].state().startswith("■ stopped: talker")


def test_stopped_nodes_are_not_listed_until_they_run_or_publish_again(
    notebook: Graph, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COURSE_PACE", "fast")
    talker, listener = Node("talker"), Node("listener")
    publisher = talker.create_publisher(String, "/chatter", 10)
    listener.create_subscription(String, "/chatter", print, 10)

    def listed() -> tuple[list[str], int, int]:
        sides = listener.count_publishers("/chatter"), listener.count_subscribers("/chatter")
        return sorted(listener.get_node_names()), *sides

    both = (["listener", "talker"], 1, 1)
    run = run_live(talker)
    assert listed() == both
    run.stop()
    assert listed() == (["listener"], 0, 1)
    run = run_live(talker)
    assert listed() == both
    run.stop()
    publisher.publish(String())
    assert listed() == both


def test_node_run_again_has_only_one_live_run(notebook: Graph, monkeypatch: pytest.MonkeyPatch) -> None:
    node = Node("talker")
    monkeypatch.setenv("COURSE_PACE", "fast")
    first, second = run_live(node), run_live(node)
    assert (first.is_running, second.is_running) == (False, True)
    second.stop()
    assert running_nodes() == []


def test_stop_without_arguments_stops_all_live_nodes(
    notebook: Graph, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COURSE_PACE", "fast")
    runs = [run_live(Node("talker")), run_live(Node("listener"))]
    stop_all()
    assert [run.is_running for run in runs] == [False, False]
    assert running_nodes() == []


def test_shutdown_ends_a_live_run_silently(notebook: Graph, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(driving, "show_error", lambda: pytest.fail("an error was shown"))
    node = Node("talker")
    runs: list[LiveRun] = []

    def cell() -> None:
        runs.append(run_live(node))
        rclpy.shutdown()

    in_a_kernel(cell, monkeypatch, until=lambda: not runs[0].is_running)


def test_shutdown_in_a_callback_ends_a_live_run_and_it_can_be_started_again(
    notebook: Graph, monkeypatch: pytest.MonkeyPatch
) -> None:
    node, calls = Node("talker"), []
    node.create_timer(0.02, rclpy.shutdown)
    in_a_kernel(lambda: run_live(node), monkeypatch, until=lambda: running_nodes() == [])
    rclpy.init(args=[])
    again = Node("talker")
    again.create_timer(0.02, lambda: calls.append(1))
    in_a_kernel(lambda: run_live(again), monkeypatch, until=lambda: calls)


def test_live_run_requires_a_node(notebook: Graph) -> None:
    with pytest.raises(CourseError, match=r"at least one node, like run_live\(MyNode\(\)\)"):
        run_live()


def test_paused_nodes_do_not_run_and_a_step_advances_them_by_its_duration(
    notebook: Graph, monkeypatch: pytest.MonkeyPatch
) -> None:
    node, calls = Node("talker"), []
    node.create_timer(0.05, lambda: calls.append(1))
    speed = pace.speed_of(notebook)
    speed.is_paused, speed.step_ns = True, 110_000_000  # [ns]
    rested = wall.monotonic() + 0.4  # [s]
    in_a_kernel(
        lambda: run_live(node), monkeypatch, until=lambda: len(calls) > 1 and wall.monotonic() > rested
    )
    assert (len(calls), notebook.now_ns) == (2, START_NS + 110_000_000)


def test_robot_time_keeps_up_with_the_wall_clock_if_a_callback_sleeps_its_full_period(
    notebook: Graph, monkeypatch: pytest.MonkeyPatch
) -> None:
    node, calls = Node("sleeper"), []

    def tick() -> None:
        calls.append(1)
        time.sleep(0.1)

    node.create_timer(0.1, tick)
    start = wall.monotonic()
    in_a_kernel(lambda: run_live(node), monkeypatch, until=lambda: len(calls) > 3)
    assert (notebook.now_ns - START_NS) * 1e-9 <= wall.monotonic() - start
    stop_all()


def loop_for_ever() -> None:
    while True:
        pass


def swallow_all() -> None:
    while True:
        try:  # noqa: SIM105  the mistake under test
            wall.sleep(0.01)
        except:  # noqa: E722
            pass


def sleep_and_swallow_all() -> None:
    while True:
        with suppress(BaseException):
            time.sleep(0.01)


@pytest.mark.sample(1)
@pytest.mark.parametrize("tick", [loop_for_ever, swallow_all, sleep_and_swallow_all])
@pytest.mark.parametrize("by_click", [True, False])
def test_stop_button_and_interrupt_end_an_endless_callback_and_report_its_line(
    tick: Callable[[], None], by_click: bool, notebook: Graph, monkeypatch: pytest.MonkeyPatch
) -> None:
    stuck, other = Node("stuck"), Node("other")
    stuck.create_timer(0.05, tick)
    runs: list[LiveRun] = []

    def press() -> None:
        while interrupts.watch.running_callback is None:
            wall.sleep(0.01)
        if by_click:
            runs[0]._on_stop_click()
        else:
            interrupts.interrupt_main_thread()

    def cell() -> None:
        runs.extend((run_live(stuck), run_live(other)))
        threading.Thread(target=press, daemon=True).start()

    in_a_kernel(cell, monkeypatch, until=lambda: runs[0].note)
    assert re.search(r"■ stopped: stuck .*, interrupted in test_live.py, line \d+: ", runs[0].state())
    assert [run.is_running for run in runs] == [False, by_click]
    stop_all()


@pytest.mark.slow
def test_run_state_is_not_sent_repeatedly_without_an_open_page(
    notebook: Graph, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Messages of a kernel whose page is closed would keep a hub from ending it."""
    received: list[str] = []
    monkeypatch.setattr(LiveRun, "show_state", lambda run, note="": received.append(run.state(note)))
    monkeypatch.setattr(driving, "RECENTLY", 0.1)
    calls: list[int] = []
    node = Node("talker")
    node.create_timer(0.05, lambda: calls.append(1))

    def silent_for_ten_calls() -> bool:
        return received[-1:] != [] and "goes on" in received[-1] and len(calls) > len(received) + 10

    in_a_kernel(lambda: run_live(node), monkeypatch, until=silent_for_ten_calls)
    shown = len(received)
    monkeypatch.setattr(pace, "views", {lambda: True})
    monkeypatch.setattr(driving, "RECENTLY", 0.0)
    in_a_kernel(lambda: run_live(node), monkeypatch, until=lambda: len(received) > shown + 10)
    assert "goes on" not in received[-1]


def test_output_of_live_nodes_is_shown_in_the_newest_live_cell(
    notebook: Graph, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Jupyter finds the cell of an output in a context variable, as here."""
    cell_number: ContextVar[int] = ContextVar("cell_number")
    printed: list[tuple[str, int]] = []

    def run_cell(number: int, name: str) -> None:
        cell_number.set(number)
        node = Node(name)
        node.create_timer(0.05, lambda: printed.append((name, cell_number.get(-1))))
        run_live(node)

    def run_cells() -> None:
        for number, name in enumerate(("talker", "listener")):
            run_cell(number, name)

    in_a_kernel(run_cells, monkeypatch, until=lambda: len(printed) > 6)
    assert set(printed) == {("talker", 1), ("listener", 1)}


def test_live_node_that_a_newer_one_replaces_gets_no_hint_about_a_spin(
    notebook: Graph, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COURSE_PACE", "fast")
    run_live(Node("talker"), Node("listener"))
    run_live(Node("talker"))
    driving.spin_for(0.1, Node("talker"))
    out = capsys.readouterr().out
    assert out.count("The new node /talker replaces the one of the same name.") == 2
    assert "hint:" not in out


def test_run_state_includes_the_name_of_a_replaced_node(notebook: Graph) -> None:
    run = LiveRun(notebook, (Node("talker"),))
    Node("talker")
    assert run.is_over()
    assert "talker" in run.state()


class Faulty(Node):
    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.create_timer(0.05, self.tick)

    def tick(self) -> None:
        raise ValueError("too <fast>")


def test_long_error_does_not_squeeze_the_stop_button(notebook: Graph) -> None:
    run = LiveRun(notebook, (Node("talker"),))
    SHOW(run)
    assert run._panel is not None
    assert run._panel.children[0].layout.flex == "none"


def test_run_state_shows_the_error_after_an_exception(
    notebook: Graph, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(driving, "show_error", lambda: None)
    runs: list[LiveRun] = []

    def cell() -> None:
        runs.append(run_live(Node("talker")))
        runs.append(run_live(Faulty("faulty")))

    in_a_kernel(cell, monkeypatch, until=lambda: not any(run.is_running for run in runs))
    state = runs[1].state()
    assert state.startswith("✗ stopped by an error: faulty (")
    assert "ValueError: too <fast> in test_live.py, line " in state
    assert runs[0].state().startswith("■ stopped: talker (")
    assert runs[0].state().endswith("as faulty ended with an error")
    assert "color: var(--jp-error-color1, #d32f2f)" in runs[1]._html()
    assert "too &lt;fast&gt;" in runs[1]._html()
