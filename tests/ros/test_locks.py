import _thread
import queue
import threading
import time
from typing import Any

import pytest

from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.ros.time import virtual_time, wall
from course_lib.ros.time.time_lock import time_lock
from tests.patience import PATIENCE


def run_threads(*bodies: "object") -> None:
    """Run functions as threads of a program to their ends."""
    with use_graph(Graph()), time_lock.hold():
        threads = [threading.Thread(target=body, daemon=True) for body in bodies]  # type: ignore[arg-type]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()


@pytest.mark.parametrize("make", ["Lock", "RLock"])
def test_lock_created_in_a_cell_releases_the_time_lock_while_waiting(make: str) -> None:
    virtual_time.install()
    lock, order = getattr(threading, make)(), []

    def work(name: str) -> None:
        with lock:
            time.sleep(1.0)
            order.append(name)

    run_threads(lambda: work("a"), lambda: work("b"))
    assert order == ["a", "b"]


def test_pool_queue_created_in_a_cell_releases_the_time_lock_while_waiting() -> None:
    virtual_time.install()
    jobs: queue.SimpleQueue[int] = queue.SimpleQueue()
    received: list[int] = []

    def put_later() -> None:
        time.sleep(1.0)
        jobs.put(7)

    run_threads(lambda: received.append(jobs.get()), put_later)
    assert received == [7]


def test_lock_held_by_an_ordinary_thread_is_awaited_in_wall_time() -> None:
    virtual_time.install()
    lock = threading.Lock()
    held = threading.Event()

    def hold() -> None:
        with lock:
            held.set()
            wall.sleep(0.05)

    threading.Thread(target=hold, daemon=True).start()
    assert held.wait(PATIENCE)
    with use_graph(Graph()) as graph, time_lock.hold():
        start_ns = graph.now_ns
        with lock:
            assert graph.now_ns == start_ns


class JustTaken:
    """A real lock whose next taker stops before it has noted that it has it."""

    def __init__(self, real: Any) -> None:
        self._real, self.stops = real, True
        self.taken, self.go_on = _thread.allocate_lock(), _thread.allocate_lock()
        self.taken.acquire()
        self.go_on.acquire()

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        taken: bool = self._real.acquire(blocking, timeout)
        if taken and self.stops:
            self.stops = False
            self.taken.release()
            self.go_on.acquire()
        return taken

    def __getattr__(self, name: str) -> Any:
        return getattr(self._real, name)


@pytest.mark.parametrize("program_had_it_before", [False, True])
def test_lock_just_acquired_by_an_ordinary_thread_is_not_a_deadlock(
    program_had_it_before: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    virtual_time.install()
    lock = virtual_time.ProgramLock()
    real_sleep, ends = wall.sleep, _thread.allocate_lock()

    def take_and_release() -> None:
        with ends, lock:
            pass

    def sleep(seconds: float) -> None:  # the waiting thread has looked at the lock
        if just_taken.go_on.locked():
            just_taken.go_on.release()
        real_sleep(seconds)

    monkeypatch.setattr(wall, "sleep", sleep)
    with use_graph(Graph()), time_lock.hold():
        if program_had_it_before:
            with lock:
                pass
        lock._real = just_taken = JustTaken(lock._real)  # type: ignore[assignment]  # it acts as one
        _thread.start_new_thread(take_and_release, ())
        assert just_taken.taken.acquire(timeout=PATIENCE)
        with lock:
            assert not just_taken.stops
        assert ends.acquire(timeout=PATIENCE)


def test_lock_held_by_a_thread_after_it_releases_the_time_lock_is_not_a_deadlock() -> None:
    virtual_time.install()
    lock = virtual_time.ProgramLock()
    held, visited, ended = (_thread.allocate_lock() for _ in range(3))
    held.acquire(), visited.acquire(), ended.acquire()

    def visit() -> None:
        with lock:
            held.release()
            with time_lock.hold():  # it runs when the main thread waits for the lock
                visited.release()
            wall.sleep(0.05)
        ended.release()

    with use_graph(Graph()), time_lock.hold():
        _thread.start_new_thread(visit, ())
        assert held.acquire(timeout=PATIENCE)
        while not time_lock._waiting:
            wall.sleep(0.001)
        with lock:
            assert not visited.locked()
        assert ended.acquire(timeout=PATIENCE)


def test_lock_behaves_like_a_python_lock() -> None:
    virtual_time.install()
    lock = threading.Lock()
    assert lock.acquire(timeout=0.01)
    assert lock.locked()
    assert not lock.acquire(blocking=False)
    assert not lock.acquire(timeout=0.01)
    lock.release()
    with pytest.raises(RuntimeError, match="release unlocked lock"):
        lock.release()


def test_thread_not_started_by_python_can_create_a_lock() -> None:
    virtual_time.install()
    ended, made = _thread.allocate_lock(), []
    ended.acquire()

    def make() -> None:
        try:
            made.append((threading.Lock(), threading.RLock(), threading.current_thread()))
        finally:
            ended.release()

    _thread.start_new_thread(make, ())
    assert ended.acquire(timeout=PATIENCE)
    assert made
