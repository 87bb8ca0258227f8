import queue
import threading
import time

import pytest

from course_lib.ros import virtual_time, wall
from course_lib.ros.baton import baton
from course_lib.ros.graph import Graph, use_graph


def run_threads(*bodies: "object") -> None:
    """Run functions as threads of a program to their ends."""
    with use_graph(Graph()), baton.known():
        threads = [threading.Thread(target=body, daemon=True) for body in bodies]  # type: ignore[arg-type]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()


@pytest.mark.parametrize("make", ["Lock", "RLock"])
def test_a_lock_made_in_a_cell_hands_the_baton_on(make: str) -> None:
    virtual_time.install()
    lock, order = getattr(threading, make)(), []

    def work(name: str) -> None:
        with lock:
            time.sleep(1.0)
            order.append(name)

    run_threads(lambda: work("a"), lambda: work("b"))
    assert order == ["a", "b"]


def test_a_pools_queue_made_in_a_cell_hands_the_baton_on() -> None:
    virtual_time.install()
    jobs: queue.SimpleQueue[int] = queue.SimpleQueue()
    got: list[int] = []

    def put_later() -> None:
        time.sleep(1.0)
        jobs.put(7)

    run_threads(lambda: got.append(jobs.get()), put_later)
    assert got == [7]


def test_a_lock_that_an_ordinary_thread_holds_is_waited_for_by_the_wall_clock() -> None:
    virtual_time.install()
    lock = threading.Lock()
    held = threading.Event()

    def hold() -> None:
        with lock:
            held.set()
            wall.sleep(0.05)

    threading.Thread(target=hold).start()
    held.wait()
    with use_graph(Graph()) as graph, baton.known():
        start_ns = graph.now_ns
        with lock:
            assert graph.now_ns == start_ns


def test_a_lock_behaves_as_python_s_own() -> None:
    virtual_time.install()
    lock = threading.Lock()
    assert lock.acquire(timeout=0.01)
    assert lock.locked()
    assert not lock.acquire(blocking=False)
    assert not lock.acquire(timeout=0.01)
    lock.release()
    with pytest.raises(RuntimeError, match="release unlocked lock"):
        lock.release()
