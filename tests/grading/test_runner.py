import os
import tempfile
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from textwrap import dedent

import pytest

from course_lib.course.course_file import Limits
from course_lib.grading.evidence import Evidence
from course_lib.grading.jail.launch import TemplateProcess, WorkerError
from course_lib.grading.run import worker
from course_lib.grading.run.submission_run import SubmissionRun
from course_lib.grading.task import Call, Scenario, Task
from course_lib.ros.interrupts import Watch

HINTS = ("one", "two", "three")
ANSWER = Task("week01.answer", "An answer", "value", "answer", HINTS, (Scenario("public"),))
CALLED = Task("week01.called", "A call", "function", "called", HINTS, (Scenario("public", calls=(Call(),)),))
TALKER = Task("week01.talker", "A talker", "node", "talker", HINTS, (Scenario("public"),))
FIND_PIPE = """
import os, stat
pipe = []
for fd in range(3, 100):
    try:
        pipe += [fd] if stat.S_ISSOCK(os.fstat(fd).st_mode) else []
    except OSError:
        pass
"""


def run(
    *cells: str, task: Task = ANSWER, limits: Limits | None = None, template: TemplateProcess | None = None
) -> tuple[Evidence, SubmissionRun]:
    limits = limits or Limits(cell_seconds=2, scenario_seconds=2)
    with closing(SubmissionRun(cells, {task.id: {}}, limits, template)) as session:
        return session.run(task, task.scenarios[0]), session


def test_cells_run_in_order_and_an_error_does_not_stop_the_rest() -> None:
    came, session = run("x = 1", "1 / 0", "answer = x + 1")
    assert came.returns == (2,)
    assert session.log.errors == ["ZeroDivisionError: division by zero (cell In[2], line 1: 1 / 0)"]


def test_the_code_of_usual_messages_is_compiled_before_a_submission_begins() -> None:
    code = """
from course_lib.ros.messages.cdr_reader import unpacker
from course_lib.ros.messages.cdr_writer import packer
compiled = [packer.cache_info().misses, unpacker.cache_info().misses]
for name in NAMES:
    packer(name), unpacker(name, "<")
answer = [packer.cache_info().misses, unpacker.cache_info().misses] == compiled
"""
    came, _ = run(code.replace("NAMES", repr(worker.SENT)))
    assert came.returns == (True,)


def test_the_code_that_nodes_run_is_specialized_before_a_submission_begins() -> None:
    code = """
import dis
from rclpy.publisher import Publisher
names = {step.opname for step in dis.get_instructions(Publisher.publish, adaptive=True)}
answer = sorted(name for name in names - dis.opmap.keys() if not name.endswith("_ADAPTIVE"))
"""
    came, _ = run(code)
    assert came.returns[0]


def test_a_missing_object_is_named() -> None:
    came, _ = run("x = 1")
    assert came.errors == ("answer is not in the notebook: no cell that ran to its end makes it",)


def test_nodes_of_one_scenario_do_not_touch_those_of_the_next() -> None:
    cells = ["seen = []", "def talker():\n    seen.append(1)\n    print(len(seen))"]
    with closing(SubmissionRun(cells, {TALKER.id: {}}, Limits())) as session:
        assert [session.run(TALKER, TALKER.scenarios[0]).output for _ in range(2)] == ["1\n", "1\n"]


FLOODS = {  # of a callback that never ends, and the limit's words
    "self.get_logger().info('again')": "more messages were published than are recorded",
    "self.create_timer(1.0, print)": "More than 10000 nodes, topics and timers",
}


@pytest.mark.parametrize("call", FLOODS)
def test_a_loop_that_only_adds_to_the_graph_is_named_and_does_not_wait_for_the_time_limit(call: str) -> None:
    cells = [
        "from rclpy.node import Node",
        f"class talker(Node):\n  def __init__(self):\n    super().__init__('t')\n    while True: {call}",
    ]
    with closing(SubmissionRun(cells, {TALKER.id: {}}, Limits())) as session:
        came = session.run(TALKER, TALKER.scenarios[0])
    assert [FLOODS[call] in error for error in came.errors] == [True]
    assert came.stopped == "size"


def test_a_thread_that_a_function_leaves_behind_is_not_there_in_the_next_scenario() -> None:
    cells = [
        "import threading, time",
        "def wait():\n    while True: time.sleep(1)",
        """def called():
            count = threading.active_count()
            threading.Thread(target=wait, daemon=True).start()
            return count""",
    ]
    with closing(SubmissionRun(cells, {CALLED.id: {}}, Limits())) as session:
        assert len({session.run(CALLED, CALLED.scenarios[0]).returns for _ in range(3)}) == 1


def test_what_a_notebook_usually_does_works() -> None:
    came, session = run(
        "%matplotlib inline",
        "%load_ext course_lib",
        "import asyncio\nawait asyncio.sleep(1)",
        "import time\ntime.sleep(3600)",
        "import matplotlib.pyplot as plt\nplt.plot([1, 2])",
        "answer = 5",
    )
    assert session.log.errors == []
    assert came.returns == (5,)


def test_there_is_no_keyboard() -> None:
    _, session = run("input()")
    assert "EOFError" in session.log.errors[0] or "StdinNotImplementedError" in session.log.errors[0]


def test_a_process_that_ends_itself_costs_only_what_it_did() -> None:
    came, session = run("answer = 1", "import os\nos._exit(0)", "answer += 1")
    assert came.returns == (2,)
    assert "cell 2 ended the process" in session.log.stopped[1]
    came, _ = run("import os\ndef called():\n    os._exit(0)", task=CALLED)
    assert "the process ended before the program did" in came.errors[0]


@pytest.mark.parametrize("garbage", ["b'\\xff' * 100", "b'\\0\\0\\0\\1\\xc1'", "b'\\0\\0\\0\\2\\x91\\x01'"])
def test_garbage_in_the_pipe_is_no_evidence(garbage: str) -> None:
    write = f"os.write(pipe[0], {garbage})\n"
    came, session = run(FIND_PIPE, "answer = 1", write)
    assert came.returns == (1,)
    assert list(session.log.stopped) == [2]
    came, _ = run(FIND_PIPE, f"def called():\n    {write}", task=CALLED)
    assert came.returns == ()
    assert came.errors


def test_a_result_that_is_no_plain_data_is_not_taken() -> None:
    forge = "import msgpack, struct\nbody = msgpack.packb(['result', [b'bytes'], []])\n"
    forge += "frame = struct.pack('!I', len(body)) + body"
    came, _ = run(FIND_PIPE + forge, "def called():\n    os.write(pipe[0], frame)", task=CALLED)
    assert came.returns == ()
    assert came.errors == ("what came is not a result",)


def test_the_total_time_bounds_everything() -> None:
    limits = Limits(cell_seconds=60, scenario_seconds=60, total_seconds=3)
    came, _ = run("while True: pass", limits=limits)
    assert came.stopped == "time"
    assert came.errors == ("not run: all cells together took 3 s",)


def test_nothing_is_left_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    template = TemplateProcess(off={"bubblewrap", "namespaces"})  # processes have the same numbers then
    daemon = """
        import os
        if os.fork() == 0:
            os.setsid()
            if os.fork() == 0:
                open("pid", "w").write(str(os.getpid()))
                while True: pass
            os._exit(0)
        while not os.path.exists("pid") or not open("pid").read(): pass
    """
    cells = dedent(daemon), "answer = [os.getpid(), int(open('pid').read())]"
    came, _ = run(*cells, template=template)
    for pid in came.returns[0]:
        with pytest.raises(ProcessLookupError):
            os.kill(pid, 0)
    template.close()
    assert list(tmp_path.iterdir()) == []


def test_the_worker_gets_nothing_of_the_graders_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GRADER_TOKEN", "secret")
    came, _ = run("import os, sys\nanswer = [dict(os.environ), sys.argv[1:], os.getcwd()]")
    environment, arguments, folder = came.returns[0]
    assert "GRADER_TOKEN" not in environment
    assert arguments == []
    assert folder == environment["HOME"] != os.path.expanduser("~")


def test_a_worker_that_cannot_start_is_our_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("course_lib.grading.jail.launch.sys.executable", "/bin/false")
    with pytest.raises(WorkerError, match="can't be started"):
        TemplateProcess()


@pytest.mark.parametrize("loop", ["while not done: pass", "while True: time.sleep(1)"])
def test_a_function_that_waits_for_ever_is_named_at_the_end_of_robot_time(loop: str) -> None:
    cell = f"import time\ndone = False\ndef called():\n    {loop}"
    with closing(SubmissionRun([cell], {CALLED.id: {}}, Limits())) as session:
        came = session.run(CALLED, CALLED.scenarios[0])
    assert came.errors == ("still running after 5 s: an endless loop? It was stopped.",)


def test_a_task_that_hangs_costs_its_time_once() -> None:
    tasks = [replace(CALLED, id=f"week01.{name}", name=name) for name in ("hangs", "called")]
    cells = ["def called():\n    return 1", "def hangs():\n    while True: pass"]
    limits = Limits(scenario_seconds=1)
    with closing(SubmissionRun(cells, {task.id: {} for task in tasks}, limits)) as session:
        hung, again, other = (session.run(task, task.scenarios[0]) for task in (tasks[0], *tasks))
    assert hung.errors == ("still running after 1 s: an endless loop? It was stopped.",)
    assert again.errors == ("not run: hangs did not come to an end before, and was stopped",)
    assert (hung.stopped, again.stopped, other.returns) == ("time", "time", (1,))


@pytest.mark.parametrize("end", ["while True: pass", "os._exit(0)"])
def test_what_a_callback_publishes_before_it_hangs_or_kills_its_process_is_evidence(end: str) -> None:
    cell = f"""
import os
from rclpy.node import Node
from std_msgs.msg import String
class talker(Node):
    def __init__(self):
        super().__init__("talker")
        self.publisher = self.create_publisher(String, "/said", 1)
        self.create_timer(1.0, self.tick)
    def tick(self):
        self.publisher.publish(String(data="before"))
        {end}
"""
    came, _ = run(cell, task=TALKER)
    assert [sample.topic for sample in came.samples if sample.topic == "/said"] == ["/said"]


def test_cells_that_run_again_add_nothing_to_the_log_and_find_nothing() -> None:
    """Values that a scenario leaves behind, hidden inputs included, must not come out through the cells."""
    cells = [
        "import os\nprint(open('note').read() if os.path.exists('note') else 'nothing')",
        "def called():\n    open('note', 'w').write('secret')\n    os._exit(0)",
        "found = os.path.exists('note')",
    ]
    with closing(SubmissionRun(cells, {CALLED.id: {}}, Limits())) as session:
        for _ in range(2):
            session.run(CALLED, CALLED.scenarios[0])
    assert session.log.output == "nothing\n"


def test_an_error_that_is_no_valid_text_costs_no_other_cell() -> None:
    came, session = run("raise ValueError('\\ud800')", "answer = 1", "other = 2")
    assert came.returns == (1,)
    assert session.log.stopped == {}
    assert "ValueError: ?" in session.log.errors[0]


def test_a_class_that_lies_about_its_errors_costs_no_other_cell() -> None:
    lie = "class Lie(Exception):\n    def __str__(self):\n        raise SystemExit\nraise Lie()"
    came, session = run(lie, "answer = 1")
    assert came.returns == (1,)
    assert session.log.stopped == {}


def test_a_lost_output_stream_is_an_error_of_the_cells_and_not_the_end_of_the_process() -> None:
    _, session = run("import sys\nsys.stdout = sys.stderr = None", "answer = 1")
    assert session.log.stopped == {}
    assert "'NoneType' object has no attribute" in session.log.errors[0]


def test_the_watch_of_callbacks_is_not_counted_as_a_thread_that_a_cell_left(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    watch = Watch()
    monkeypatch.setattr(worker, "watch", watch)
    before = worker.threads_left()
    watch.begin("/talker")
    watch.under_way = None
    assert worker.threads_left() == before
