import ast
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
import rclpy
from IPython.core.interactiveshell import InteractiveShell

from course_lib import extension
from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.ros.programs.process import make_shell
from course_lib.ros.programs.program import run_files
from course_lib.ros.time.time_lock import time_lock
from course_lib.ros.time.virtual_time import BusyWaitTransformer
from tests.processes import Program
from tests.warm import run_course

NODE = """
import threading
import time
import rclpy
from rclpy.node import Node
from std_msgs.msg import String

class Waits(Node):
    def __init__(self):
        super().__init__("waits")
        self.got_it = False
        publisher = self.create_publisher(String, "word", 10)
        self.create_subscription(String, "word", self.hear, 10)
        self.create_timer(0.5, lambda: publisher.publish(String(data="now")))

    def hear(self, message):
        self.got_it = True

rclpy.init()
node = Waits()
"""
SPIN = "threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()\n"
SECONDS = "print(round(node.get_clock().now().nanoseconds * 1e-9 - 1.7e9, 2))\n"
WAITS = {
    "a variable": "while not node.got_it:\n    pass\n",
    "a branch": "while True:\n    'waiting'\n    if node.got_it:\n        break\n    continue\n",
    "a call": "while not all([node.got_it]): ...\n",
}
IN_A_THREAD = """
def work():
    while not node.got_it:
        pass
    print("worker")

worker = threading.Thread(target=work)
worker.start()
while worker.is_alive():
    rclpy.spin_once(node, timeout_sec=0.1)
"""
IN_A_CALLBACK = """
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor

def wait():
    timer.cancel()
    while not node.got_it:
        pass
    print("callback")
    rclpy.shutdown()

timer = node.create_timer(0.1, wait, callback_group=ReentrantCallbackGroup())
executor = MultiThreadedExecutor(num_threads=2)
executor.add_node(node)
executor.spin()
"""
STUCK = NODE + "print('begins', flush=True)\nrounds = 0\nwhile not node.got_it:\n    rounds += 1\n"


@pytest.mark.parametrize("loop", WAITS.values(), ids=WAITS)
def test_program_polls_a_variable_that_another_thread_sets(
    loop: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "waits.py").write_text(NODE + SPIN + loop + SECONDS)
    with use_graph(Graph()):
        assert run_files([tmp_path / "waits.py"], seed=0) == 0
    assert capsys.readouterr().out == "0.5\n"


@pytest.mark.parametrize(("code", "message"), [(IN_A_THREAD, "worker\n"), (IN_A_CALLBACK, "callback\n")])
def test_other_threads_and_callbacks_can_poll_a_variable(
    code: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "waits.py").write_text(NODE + code)
    with use_graph(Graph()) as graph:
        graph.end_ns = graph.now_ns + 2 * 10**9
        assert run_files([tmp_path / "waits.py"], seed=0) == 0
    assert capsys.readouterr().out == message


def test_imported_module_can_poll_a_variable_and_leaves_no_cache(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "waiting_module.py").write_text("def wait_for(node):\n    while not node.got_it: pass\n")
    (tmp_path / "waits.py").write_text(
        NODE + SPIN + "from waiting_module import wait_for\nwait_for(node)\n" + SECONDS
    )
    with use_graph(Graph()):
        assert run_files([tmp_path / "waits.py"], seed=0) == 0
    assert capsys.readouterr().out == "0.5\n"
    assert not (tmp_path / "__pycache__").exists()


def test_polling_program_without_other_threads_ends_with_the_run(tmp_path: Path) -> None:
    (tmp_path / "waits.py").write_text(NODE + WAITS["a variable"])
    with use_graph(Graph()) as graph:
        graph.end_ns = graph.now_ns + 2 * 10**9
        assert run_files([tmp_path / "waits.py"], seed=0) == 0
        assert graph.now_ns == graph.end_ns


@pytest.fixture
def shell() -> Iterator[InteractiveShell]:
    """An interpreter whose cells are not known to the time lock, as a kernel's are not."""
    shell = make_shell()
    shell.ast_transformers.clear()
    extension.load(shell)
    yield shell
    InteractiveShell.clear_instance()


@pytest.fixture
def graph() -> Iterator[Graph]:
    """A kernel's graph, whose threads end with the test."""
    with use_graph(Graph(notebook=True)) as graph:
        yield graph
        rclpy.try_shutdown()
        with time_lock.hold():
            time_lock.sleep_until(graph.now_ns + 10**7, "the ends of threads")
        assert not time_lock.has_waiting_threads(graph)


@pytest.mark.parametrize("loop", ["pass", "time.sleep(0.1)"])
@pytest.mark.parametrize("driven", [SPIN, "from course_lib import run_live\nrun_live(node)\n"])
def test_cell_polls_a_variable_of_a_thread_or_live_node(
    shell: InteractiveShell,
    graph: Graph,
    loop: str,
    driven: str,
    capsys: pytest.CaptureFixture[str],
) -> None:
    begun_ns = graph.now_ns
    cell = NODE + driven + f"node.got_it = False\nwhile not node.got_it:\n    {loop}\nprint('got it')"
    assert shell.run_cell(cell).success
    assert graph.now_ns > begun_ns
    assert capsys.readouterr().out.endswith("got it\n")


@pytest.mark.parametrize("rests", ["time.sleep(0.1)", "!sleep 0.1; echo rested"])
def test_cell_can_sleep_after_shutdown_despite_a_remaining_thread(
    shell: InteractiveShell, graph: Graph, rests: str
) -> None:
    for cell in (NODE + SPIN + "time.sleep(0.2)\nrclpy.shutdown()", rests):
        assert shell.run_cell(cell).success, cell


def test_loops_other_than_busy_waits_are_unchanged() -> None:
    for loop in (
        "while i < 5: i += 1",
        "while True:\n        if step(): return",
        "while True: step()",
        "while not done(): await step()",
        "while not await done(): pass",
        "while True: pass",
        "while 1:\n        if node.got_it: continue",
    ):
        tree = ast.parse(f"async def f():\n    {loop}")
        before = ast.dump(tree)
        assert ast.dump(BusyWaitTransformer().visit(tree)) == before, loop


@pytest.mark.slow
def test_ctrl_c_reports_the_line_of_a_busy_loop(tmp_path: Path) -> None:
    (tmp_path / "stuck.py").write_text(STUCK)
    command = [sys.executable, "-m", "course_lib", "run", str(tmp_path / "stuck.py")]
    with Program(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.read_line() == "begins\n"
        process.send_signal(signal.SIGINT)
        _, output = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "interrupted in stuck.py, line 2" in output
    assert "time.sleep(0.01)" in output


POLLING = """
import threading

import rclpy
from rclpy.action import ActionClient
from example_interfaces.action import Fibonacci
from std_msgs.msg import String
from std_srvs.srv import Trigger

rclpy.init()
node = rclpy.create_node("poller")
client = node.create_client(Trigger, "empty")
action = ActionClient(node, Fibonacci, "fibonacci")
subscription = node.create_subscription(String, "chatter", print, 10)
publisher = node.create_publisher(String, "other", 10)


def poll():
    count = 0
    while True:
        count += 1
        {call}


{start}
"""
IN_THREAD = "threading.Thread(target=poll, daemon=True).start()\nrclpy.spin(node)"


@pytest.mark.sample(1)
@pytest.mark.parametrize("start", ["poll()", IN_THREAD], ids=["main", "thread"])
@pytest.mark.parametrize(
    "call",
    [
        "client.service_is_ready()",
        "client.call_async(Trigger.Request())",
        "action.server_is_ready()",
        "publisher.get_subscription_count()",
        "subscription.get_publisher_count()",
        "node.count_subscribers('nothing')",
        "node.count_publishers('nothing')",
    ],
)
def test_loop_that_polls_the_graph_and_counts_iterations_ends_with_the_run(
    tmp_path: Path, call: str, start: str
) -> None:
    file = tmp_path / "poller.py"
    file.write_text(POLLING.format(call=call, start=start), encoding="utf-8")
    run = run_course("run", "--seconds", "0.5", file)
    assert run.returncode == 0, run.stderr
