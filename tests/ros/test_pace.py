import threading

import pytest

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import START_NS, Graph
from course_lib.ros.time import pace, wall


@pytest.mark.parametrize(
    ("environment", "expected"),
    [
        ({}, "fast"),
        ({"JPY_SESSION_NAME": "/a.ipynb"}, "real"),
        ({"JPY_SESSION_NAME": "/a.ipynb", "COURSE_PACE": "fast"}, "fast"),
        ({"COURSE_PACE": "real"}, "real"),
    ],
)
def test_jupyter_kernel_runs_in_real_time_unless_the_environment_overrides_it(
    monkeypatch: pytest.MonkeyPatch, environment: dict[str, str], expected: str
) -> None:
    for name in ("JPY_SESSION_NAME", "COURSE_PACE"):
        monkeypatch.delenv(name, raising=False)
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    assert pace.mode() == expected


def test_unknown_pace_is_rejected_with_the_valid_values(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COURSE_PACE", "slow")
    with pytest.raises(CourseError, match="COURSE_PACE=real or COURSE_PACE=fast"):
        pace.mode()


def test_real_time_pace_delays_events(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COURSE_PACE", "real")
    graph = Graph(notebook=True)
    graph.call_at(START_NS + 50_000_000, lambda: None, node=0, entity=0)
    start = wall.monotonic()
    with pace.keep_pace(graph):
        while graph.now_ns == START_NS:
            graph.advance()
    assert wall.monotonic() - start >= 0.05


@pytest.fixture
def fake_wall_time(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The time [s] of a wall clock that moves only while the test sleeps."""
    now, real_sleep, test_thread = [0.0], wall.sleep, threading.get_ident()

    def sleep(seconds: float) -> None:
        # An earlier test may have started the thread that watches callbacks, which also sleeps.
        if threading.get_ident() != test_thread:
            real_sleep(seconds)
        else:
            now[0] += seconds

    monkeypatch.setattr(wall, "monotonic", lambda: now[0])
    monkeypatch.setattr(wall, "sleep", sleep)
    return now


@pytest.mark.usefixtures("fake_wall_time")
def test_blocking_call_waits_two_seconds_for_a_page_only_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("COURSE_PACE", "real")
    pace.pages.add(lambda: False)
    for expected in (pace.WAIT_FOR_PAGE, 0.0):
        start = wall.monotonic()
        with pace.keep_pace(Graph(notebook=True)):
            assert wall.monotonic() - start == pytest.approx(expected, abs=pace.SLICE)


def test_robot_time_can_be_slowed_paused_and_stepped(fake_wall_time: list[float]) -> None:
    graph = Graph()
    speed, at_pace = pace.speed_of(graph), pace.WallPace(graph)
    speed.rate = 0.5
    due_ns = START_NS + 10**9
    while not at_pace(due_ns):
        pass
    assert fake_wall_time[0] == pytest.approx(2.0, abs=pace.SLICE)
    speed.is_paused = True
    assert not any(at_pace(due_ns + 10**8) for _ in range(100))
    speed.step_ns = 10**8
    assert at_pace(due_ns + 10**8)
    assert not at_pace(due_ns + 2 * 10**8)


def test_live_nodes_that_are_too_slow_for_real_time_never_catch_up_at_length(
    fake_wall_time: list[float],
) -> None:
    limit, period_ns = 0.25, 10**8  # [s], [ns]
    graph = Graph()
    graph.pace = at_pace = pace.WallPace(graph)

    def compute() -> None:
        fake_wall_time[0] += 1.0  # ten times the period

    for tick in range(1, 200):
        graph.call_at(START_NS + tick * period_ns, compute, node=0, entity=0)
    for _ in range(20):
        fake_wall_time[0] += 0.02
        start, end_ns = fake_wall_time[0], at_pace.reached_ns(limit)
        while (graph.next_due_ns() or end_ns) <= end_ns:
            assert graph.advance()
        assert fake_wall_time[0] - start <= 3.1
    assert graph.now_ns > START_NS + 20 * period_ns


def test_blocking_call_while_robot_time_is_paused_prints_a_notice(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COURSE_PACE", "real")
    graph = Graph(notebook=True)
    pace.speed_of(graph).is_paused = True
    with pace.keep_pace(graph):
        pass
    assert "Robot time is paused" in capsys.readouterr().out
