import _thread
import threading
import time

from course_lib.ros import virtual_time, wall
from course_lib.ros.baton import baton
from course_lib.ros.clock import START_NS
from course_lib.ros.graph import Graph, use_graph

SECOND = 10**9  # [ns]


def test_a_wait_goes_on_after_an_event_in_it_has_waited_for_a_lock() -> None:
    virtual_time.install()
    lock, took, before = virtual_time.ProgramLock(), list[int](), list(baton._waiting)

    def hold() -> None:
        with lock:
            time.sleep(2.0)

    with use_graph(Graph()) as graph, baton.known():
        threading.Thread(target=hold, daemon=True).start()

        def look() -> None:
            with lock:
                took.append(graph.now_ns)

        graph.call_at(START_NS + SECOND, look, node=0, entity=0)
        for end_ns in (START_NS + SECOND // 2, START_NS + 5 * SECOND):
            baton.sleep_until(end_ns, "the end")  # events happen in the thread that slept last
        assert (took, graph.now_ns) == ([START_NS + 2 * SECOND], START_NS + 5 * SECOND)
        assert baton._waiting == before


def test_a_visitor_comes_in_when_the_main_thread_leaves() -> None:
    virtual_time.install()
    visited = _thread.allocate_lock()
    visited.acquire()

    def visit() -> None:
        with baton.known():
            visited.release()

    with use_graph(Graph()), baton.known():
        _thread.start_new_thread(visit, ())
        while not baton._waiting:
            wall.sleep(0.001)
    assert visited.acquire(timeout=60.0)  # [s]


def test_a_thread_that_is_left_in_one_run_does_not_count_in_the_next() -> None:
    virtual_time.install()
    over: list[bool] = []

    def rest() -> None:
        with baton.known():
            baton.wait(lambda: bool(over), until_ns=None, what="the end of the test")

    with use_graph(Graph()) as old:
        _thread.start_new_thread(rest, ())
        while not baton.has_visitors(old):
            wall.sleep(0.001)
        with use_graph(Graph()) as new:
            assert (baton.has_visitors(old), baton.has_visitors(new)) == (True, False)
        over.append(True)
        with baton.known():
            baton.sleep_until(old.now_ns + SECOND, "the thread's end")
        assert not baton.has_visitors(old)
