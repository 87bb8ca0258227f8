import asyncio
import concurrent.futures
import queue
import threading
import time
from collections.abc import Callable, Iterator
from multiprocessing.pool import Pool, ThreadPool

import pytest

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import START_NS, Graph, use_graph
from course_lib.ros.time import virtual_time, wall
from course_lib.ros.time.time_lock import DeadlockError, time_lock

SECOND = 10**9  # [ns]


@pytest.fixture
def graph() -> Iterator[Graph]:
    virtual_time.install()
    with use_graph(Graph(end_ns=START_NS + 100 * SECOND)) as graph, time_lock.hold():
        yield graph
        graph.end_ns = graph.now_ns
        time_lock.finish_other_threads()


def seconds(graph: Graph) -> float:
    return (graph.now_ns - START_NS) / SECOND


def test_sleep_advances_robot_time_and_not_wall_time(graph: Graph) -> None:
    start = wall.monotonic()
    time.sleep(50)
    assert seconds(graph) == 50
    assert time.time() == pytest.approx(START_NS / SECOND + 50)
    assert wall.monotonic() - start < 50


def test_threads_started_by_jupyter_use_the_wall_clock() -> None:
    virtual_time.install()
    assert time.time() > START_NS / SECOND + 1_000_000
    start = wall.monotonic()
    time.sleep(0.02)
    assert wall.monotonic() - start >= 0.02


def test_threads_run_in_a_deterministic_order(graph: Graph) -> None:
    observed: list[tuple[float, str]] = []

    def tick(name: str, period: float) -> None:
        for _ in range(3):
            time.sleep(period)
            observed.append((seconds(graph), name))

    threads = [threading.Thread(target=tick, args=args) for args in (("a", 2.0), ("b", 1.0))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert observed == [(1, "b"), (2, "a"), (2, "b"), (3, "b"), (4, "a"), (6, "a")]


def test_event_queue_and_condition_time_out_in_robot_time(graph: Graph) -> None:
    assert threading.Event().wait(3) is False
    assert seconds(graph) == 3
    with pytest.raises(queue.Empty):
        queue.Queue[int]().get(timeout=4)
    assert seconds(graph) == 7
    condition = threading.Condition()
    with condition:
        assert condition.wait(5) is False
    assert seconds(graph) == 12


def test_queue_passes_items_between_threads(graph: Graph) -> None:
    items: queue.Queue[int] = queue.Queue()

    def produce() -> None:
        for item in range(3):
            time.sleep(1)
            items.put(item)

    threading.Thread(target=produce).start()
    assert [items.get() for _ in range(3)] == [0, 1, 2]
    assert seconds(graph) == 3


def test_mutex_passes_the_time_lock_to_its_holder(graph: Graph) -> None:
    lock, order = threading.Lock(), []

    def hold() -> None:
        with lock:
            time.sleep(5)
            order.append("holder")

    thread = threading.Thread(target=hold)
    thread.start()
    time.sleep(1)
    with lock:
        order.append("main")
    thread.join()
    assert order == ["holder", "main"]


def test_thread_pool_runs_in_robot_time(graph: Graph) -> None:
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        list(pool.map(time.sleep, [3, 1, 2]))
    assert seconds(graph) == 3


def test_pool_logs_errors_of_callbacks_except_the_end_of_the_run(
    graph: Graph, caplog: pytest.LogCaptureFixture
) -> None:
    pool = concurrent.futures.ThreadPoolExecutor(2)
    for task in (lambda: time.sleep(1000), lambda: 1 / 0):
        pool.submit(task).add_done_callback(lambda future: future.result())
    time.sleep(1)
    graph.end_ns = graph.now_ns
    time_lock.finish_other_threads()
    pool.shutdown()
    assert [record.exc_info and record.exc_info[0] for record in caplog.records] == [ZeroDivisionError]


@pytest.mark.parametrize("pool", [Pool, ThreadPool, concurrent.futures.ProcessPoolExecutor])
def test_pool_that_would_deadlock_is_rejected_immediately(graph: Graph, pool: Callable[[], object]) -> None:
    with pytest.raises(CourseError, match=r"Use concurrent\.futures\.ThreadPoolExecutor"):
        pool()


def test_asyncio_sleep_advances_robot_time(graph: Graph) -> None:
    async def both() -> tuple[str, str]:
        async def say(word: str, delay: float) -> str:
            await asyncio.sleep(delay)
            return word

        return await asyncio.gather(say("late", 20), say("early", 10))

    start = wall.monotonic()
    assert list(asyncio.run(both())) == ["late", "early"]
    assert seconds(graph) == pytest.approx(20, abs=0.01)
    assert wall.monotonic() - start < 20


def test_loop_that_only_polls_the_clock_ends(graph: Graph) -> None:
    start = time.time()
    while time.time() - start < 1:
        pass
    assert seconds(graph) == pytest.approx(1, abs=0.01)


def test_deadlock_error_is_raised_in_the_main_thread(graph: Graph) -> None:
    mine = threading.Lock()
    mine.acquire()
    thread = threading.Thread(target=mine.acquire, name="other", daemon=True)
    thread.start()
    with pytest.raises(DeadlockError, match='thread "other" waits for a lock'):
        thread.join()
    mine.release()


def test_waits_return_and_endless_loops_end_at_the_end_of_a_run(graph: Graph) -> None:
    graph.end_ns = START_NS + 2 * SECOND
    time.sleep(1000)
    assert graph.ended
    assert seconds(graph) == 2
    threading.Event().wait()

    def forever() -> None:
        while True:
            time.sleep(1)

    thread = threading.Thread(target=forever)
    thread.start()
    time_lock.finish_other_threads()
    thread.join()
    assert not thread.is_alive()
    with pytest.raises(KeyboardInterrupt):
        forever()
