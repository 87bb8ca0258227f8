import _thread
import threading
import time

from course_lib.ros.graph.graph import START_NS, Graph, use_graph
from course_lib.ros.time import virtual_time, wall
from course_lib.ros.time.time_lock import time_lock

SECOND = 10**9  # [ns]


def test_sleep_continues_after_an_event_callback_has_waited_for_a_lock() -> None:
    virtual_time.install()
    lock, took, before = virtual_time.ProgramLock(), list[int](), list(time_lock._waiting)

    def hold() -> None:
        with lock:
            time.sleep(2.0)

    with use_graph(Graph()) as graph, time_lock.hold():
        threading.Thread(target=hold, daemon=True).start()

        def look() -> None:
            with lock:
                took.append(graph.now_ns)

        graph.call_at(START_NS + SECOND, look, node=0, entity=0)
        for end_ns in (START_NS + SECOND // 2, START_NS + 5 * SECOND):
            time_lock.sleep_until(end_ns, "the end")  # events happen in the thread that slept last
        assert (took, graph.now_ns) == ([START_NS + 2 * SECOND], START_NS + 5 * SECOND)
        assert time_lock._waiting == before


def test_waiting_thread_gets_the_time_lock_when_the_main_thread_releases_it() -> None:
    virtual_time.install()
    visited = _thread.allocate_lock()
    visited.acquire()

    def visit() -> None:
        with time_lock.hold():
            visited.release()

    with use_graph(Graph()), time_lock.hold():
        _thread.start_new_thread(visit, ())
        while not time_lock._waiting:
            wall.sleep(0.001)
    assert visited.acquire(timeout=60.0)  # [s]


def test_thread_remaining_from_one_run_is_not_counted_in_the_next() -> None:
    virtual_time.install()
    over: list[bool] = []

    def rest() -> None:
        with time_lock.hold():
            time_lock.wait(lambda: bool(over), until_ns=None, awaited="the end of the test")

    with use_graph(Graph()) as old:
        _thread.start_new_thread(rest, ())
        while not time_lock.has_waiting_threads(old):
            wall.sleep(0.001)
        with use_graph(Graph()) as new:
            assert (time_lock.has_waiting_threads(old), time_lock.has_waiting_threads(new)) == (True, False)
        over.append(True)
        with time_lock.hold():
            time_lock.sleep_until(old.now_ns + SECOND, "the thread's end")
        assert not time_lock.has_waiting_threads(old)
