import pytest

from course_lib.errors import CourseError
from course_lib.ros import pace, wall
from course_lib.ros.clock import START_NS
from course_lib.ros.graph import Graph


@pytest.mark.parametrize(
    ("environment", "expected"),
    [
        ({}, "fast"),
        ({"JPY_SESSION_NAME": "/a.ipynb"}, "real"),
        ({"JPY_SESSION_NAME": "/a.ipynb", "COURSE_PACE": "fast"}, "fast"),
        ({"COURSE_PACE": "real"}, "real"),
    ],
)
def test_kernels_of_a_jupyter_server_keep_the_walls_pace_unless_told_otherwise(
    monkeypatch: pytest.MonkeyPatch, environment: dict[str, str], expected: str
) -> None:
    for name in ("JPY_SESSION_NAME", "COURSE_PACE"):
        monkeypatch.delenv(name, raising=False)
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    assert pace.wanted() == expected


def test_another_pace_is_refused_with_what_would_be_right(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COURSE_PACE", "slow")
    with pytest.raises(CourseError, match="COURSE_PACE=real or COURSE_PACE=fast"):
        pace.wanted()


def test_the_walls_pace_holds_events_back(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COURSE_PACE", "real")
    graph = Graph(notebook=True)
    graph.call_at(START_NS + 50_000_000, lambda: None, node=0, entity=0)
    start = wall.monotonic()
    with pace.kept(graph):
        while graph.now_ns == START_NS:
            graph.advance()
    assert wall.monotonic() - start >= 0.05


@pytest.fixture
def slept(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The time [s] of a wall clock that moves by sleeping only."""
    now = [0.0]
    monkeypatch.setattr(wall, "monotonic", lambda: now[0])
    monkeypatch.setattr(wall, "sleep", lambda seconds: now.__setitem__(0, now[0] + seconds))
    return now


@pytest.mark.usefixtures("slept")
def test_a_call_that_waits_gives_a_page_two_seconds_to_come_but_only_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("COURSE_PACE", "real")
    pace.pages.add(lambda: False)
    for expected in (pace.WAIT_FOR_PAGE, 0.0):
        start = wall.monotonic()
        with pace.kept(Graph(notebook=True)):
            assert wall.monotonic() - start == pytest.approx(expected, abs=pace.SLICE)


def test_robot_time_may_go_slower_stand_and_step(slept: list[float]) -> None:
    graph = Graph()
    speed, at_pace = pace.speed_of(graph), pace.WallPace(graph)
    speed.rate = 0.5
    due_ns = START_NS + 10**9
    while not at_pace(due_ns):
        pass
    assert slept[0] == pytest.approx(2.0, abs=pace.SLICE)
    speed.paused = True
    assert not any(at_pace(due_ns + 10**8) for _ in range(100))
    speed.step_ns = 10**8
    assert at_pace(due_ns + 10**8)
    assert not at_pace(due_ns + 2 * 10**8)


def test_a_call_that_waits_while_robot_time_is_paused_says_so(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COURSE_PACE", "real")
    graph = Graph(notebook=True)
    pace.speed_of(graph).paused = True
    with pace.kept(graph):
        pass
    assert "Robot time is paused" in capsys.readouterr().out
