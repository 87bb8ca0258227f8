import os
import tempfile
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from textwrap import dedent

import pytest

from course_lib.course.course_file import Limits
from course_lib.errors import CourseError
from course_lib.grading.evidence import Evidence
from course_lib.grading.jail.launch import JailEnvironment, TemplateProcess, WorkerError, is_usable
from course_lib.grading.jail.template import enter_jail
from course_lib.grading.run import worker
from course_lib.grading.run.scenario import ALL
from course_lib.grading.run.submission_run import SubmissionRun
from course_lib.grading.task import Call, Message, Scenario, Task, my
from course_lib.ros.time.interrupts import Watch

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


def test_cells_run_in_order_and_continue_after_an_error() -> None:
    evidence, session = run("x = 1", "1 / 0", "answer = x + 1")
    assert evidence.returns == (2,)
    (error,) = session.log.errors
    assert error.startswith("ZeroDivisionError: division by zero (cell In[2], line 1: 1 / 0)")


def test_code_of_common_messages_is_compiled_before_a_submission_starts() -> None:
    code = """
from course_lib.ros.messages.cdr import unpacker
from course_lib.ros.messages.cdr import packer
compiled = [packer.cache_info().misses, unpacker.cache_info().misses]
for name in NAMES:
    packer(name), unpacker(name, "<")
answer = [packer.cache_info().misses, unpacker.cache_info().misses] == compiled
"""
    evidence, _ = run(code.replace("NAMES", repr(worker.SENT)))
    assert evidence.returns == (True,)


def test_node_code_is_specialized_before_a_submission_starts() -> None:
    code = """
import dis
from rclpy.publisher import Publisher
names = {step.opname for step in dis.get_instructions(Publisher.publish, adaptive=True)}
answer = sorted(name for name in names - dis.opmap.keys() if not name.endswith("_ADAPTIVE"))
"""
    evidence, _ = run(code)
    assert evidence.returns[0]


@pytest.mark.parametrize(
    ("scenario", "message"),
    [
        (Scenario("later", inputs=(Message("/x", "std_msgs/msg/Int33", {}),)), "No message type 'std_msgs"),
        (Scenario("later", calls=(Call(my("height")),)), r"my\('height'\) is not in the task's personal"),
    ],
)
def test_invalid_input_or_call_is_reported_with_its_task_and_scenario(
    scenario: Scenario, message: str
) -> None:
    place = "week01.called, scenario 'later' of its check file: "
    with pytest.raises(CourseError, match=place + message):
        run(task=replace(CALLED, scenarios=(scenario,)))


def test_missing_object_is_reported() -> None:
    evidence, _ = run("x = 1")
    assert evidence.errors == ("answer is not defined: no code cell that ran without an error defines it",)


def test_nodes_of_one_scenario_do_not_affect_the_next() -> None:
    cells = ["seen = []", "def talker():\n    seen.append(1)\n    print(len(seen))"]
    with closing(SubmissionRun(cells, {TALKER.id: {}}, Limits())) as session:
        assert [session.run(TALKER, TALKER.scenarios[0]).output for _ in range(2)] == ["1\n", "1\n"]


FLOODS = {  # of a callback that never ends, and the limit's words
    "self.get_logger().info('again')": "the limit on recorded messages was reached",
    "self.create_timer(1.0, print)": "More than 10000 nodes, topics and timers",
}


@pytest.mark.parametrize("call", FLOODS)
def test_loop_that_floods_the_graph_is_stopped_and_reported_before_the_time_limit(call: str) -> None:
    cells = [
        "from rclpy.node import Node",
        f"class talker(Node):\n  def __init__(self):\n    super().__init__('t')\n    while True: {call}",
    ]
    with closing(SubmissionRun(cells, {TALKER.id: {}}, Limits())) as session:
        evidence = session.run(TALKER, TALKER.scenarios[0])
    assert [FLOODS[call] in error for error in evidence.errors] == [True]
    assert evidence.stopped == "size"


def test_thread_started_by_a_function_does_not_reach_the_next_scenario() -> None:
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


@pytest.mark.slow
def test_common_notebook_code_runs() -> None:
    evidence, session = run(
        "%matplotlib inline",
        "%load_ext course_lib",
        "import asyncio\nawait asyncio.sleep(1)",
        "import time\ntime.sleep(3600)",
        "import matplotlib.pyplot as plt\nplt.plot([1, 2])",
        "answer = 5",
    )
    assert session.log.errors == []
    assert evidence.returns == (5,)


def test_keyboard_input_is_an_error() -> None:
    _, session = run("input()")
    assert "EOFError" in session.log.errors[0] or "StdinNotImplementedError" in session.log.errors[0]


def test_process_exit_loses_only_the_effects_of_its_cell() -> None:
    evidence, session = run("answer = 1", "import os\nos._exit(0)", "answer += 1")
    assert evidence.returns == (2,)
    assert "cell 2 ended the process" in session.log.stopped[1]
    evidence, _ = run("import os\ndef called():\n    os._exit(0)", task=CALLED)
    assert "the process ended before the program did" in evidence.errors[0]


@pytest.mark.parametrize("garbage", ["b'\\xff' * 100", "b'\\0\\0\\0\\1\\xc1'", "b'\\0\\0\\0\\2\\x91\\x01'"])
def test_malformed_data_in_the_pipe_is_not_evidence(garbage: str) -> None:
    write = f"os.write(pipe[0], {garbage})\n"
    evidence, session = run(FIND_PIPE, "answer = 1", write)
    assert evidence.returns == (1,)
    assert list(session.log.stopped) == [2]
    evidence, _ = run(FIND_PIPE, f"def called():\n    {write}", task=CALLED)
    assert evidence.returns == ()
    assert evidence.errors


def test_result_without_plain_data_is_rejected() -> None:
    forge = "import msgpack, struct\nbody = msgpack.packb(['result', [b'bytes'], []])\n"
    forge += "frame = struct.pack('!I', len(body)) + body"
    evidence, _ = run(FIND_PIPE + forge, "def called():\n    os.write(pipe[0], frame)", task=CALLED)
    assert evidence.returns == ()
    assert evidence.errors == ("the worker did not send a valid result",)


@pytest.mark.slow
def test_total_time_limit_ends_the_submission() -> None:
    limits = Limits(cell_seconds=60, scenario_seconds=60, total_seconds=3)
    evidence, _ = run("while True: pass", limits=limits)
    assert evidence.stopped == "time"
    assert evidence.errors == ("not run: all cells together took 3 s",)


def test_processes_and_files_of_a_submission_are_removed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
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
    evidence, _ = run(*cells, template=template)
    for pid in evidence.returns[0]:
        with pytest.raises(ProcessLookupError):
            os.kill(pid, 0)
    template.close()
    assert list(tmp_path.iterdir()) == []


def test_temporary_files_are_in_the_jail_even_if_their_folder_was_used_before(tmp_path: Path) -> None:
    place = JailEnvironment("host", "same", os.getuid(), str(tmp_path), ())

    def write() -> None:
        tempfile.tempdir = "/"
        enter_jail(place, (), Limits())
        assert Path(tempfile.mkdtemp()).is_relative_to(tmp_path)

    assert is_usable(write)


def test_worker_does_not_inherit_the_environment_of_the_grader(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GRADER_TOKEN", "secret")
    evidence, _ = run("import os, sys\nanswer = [dict(os.environ), sys.argv[1:], os.getcwd()]")
    environment, arguments, folder = evidence.returns[0]
    assert "GRADER_TOKEN" not in environment
    assert arguments == []
    assert folder == environment["HOME"] != os.path.expanduser("~")


@pytest.mark.slow
def test_failed_worker_start_is_a_grader_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("course_lib.grading.jail.launch.sys.executable", "/bin/false")
    with pytest.raises(WorkerError, match="no process for submissions can be started"):
        TemplateProcess()


@pytest.mark.sample(1)
@pytest.mark.parametrize("loop", ["while not done: pass", "while True: time.sleep(1)"])
def test_endless_wait_is_reported_at_the_end_of_robot_time(loop: str) -> None:
    cell = f"import time\ndone = False\ndef called():\n    {loop}"
    with closing(SubmissionRun([cell], {CALLED.id: {}}, Limits())) as session:
        evidence = session.run(CALLED, CALLED.scenarios[0])
    assert evidence.errors == ("still running after 5 s: is it an endless loop? It was stopped.",)


@pytest.mark.slow
def test_hanging_task_uses_its_time_limit_only_once() -> None:
    tasks = [replace(CALLED, id=f"week01.{name}", name=name) for name in ("hangs", "called")]
    cells = ["def called():\n    return 1", "def hangs():\n    while True: pass"]
    limits = Limits(scenario_seconds=1)
    with closing(SubmissionRun(cells, {task.id: {} for task in tasks}, limits)) as session:
        hung, again, other = (session.run(task, task.scenarios[0]) for task in (tasks[0], *tasks))
    assert hung.errors == ("still running after 1 s: is it an endless loop? It was stopped.",)
    assert again.errors == ("not run: hangs did not end in an earlier scenario, and was stopped",)
    assert (hung.stopped, again.stopped, other.returns) == ("time", "time", (1,))


@pytest.mark.sample(1)
@pytest.mark.parametrize("end", ["while True: pass", "os._exit(0)"])
def test_messages_published_before_a_hang_or_crash_are_evidence(end: str) -> None:
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
    evidence, _ = run(cell, task=TALKER)
    assert [sample.topic for sample in evidence.samples if sample.topic == "/said"] == ["/said"]


def test_rerun_cells_add_no_output_and_find_no_files_of_a_scenario() -> None:
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


def test_error_with_an_invalid_string_does_not_affect_other_cells() -> None:
    evidence, session = run("raise ValueError('\\ud800')", "answer = 1", "other = 2")
    assert evidence.returns == (1,)
    assert session.log.stopped == {}
    assert "ValueError: ?" in session.log.errors[0]


def test_exception_with_a_raising_str_does_not_affect_other_cells() -> None:
    lie = "class Lie(Exception):\n    def __str__(self):\n        raise SystemExit\nraise Lie()"
    evidence, session = run(lie, "answer = 1")
    assert evidence.returns == (1,)
    assert session.log.stopped == {}


def test_closed_output_stream_is_a_cell_error_and_does_not_end_the_process() -> None:
    _, session = run("import sys\nsys.stdout = sys.stderr = None", "answer = 1")
    assert session.log.stopped == {}
    assert "'NoneType' object has no attribute" in session.log.errors[0]


def test_callback_watchdog_is_not_counted_as_a_leftover_thread(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    watch = Watch()
    monkeypatch.setattr(worker, "watch", watch)
    before = worker.running_threads()
    watch.begin("/talker")
    watch.running_callback = None
    assert worker.running_threads() == before


PICTURES = """
import os
from rclpy.node import Node
from sensor_msgs.msg import Image
from std_msgs.msg import String
class talker(Node):
    def __init__(self):
        super().__init__("talker")
        self.create_publisher(String, "/said", 1).publish(String(data="before"))
        self.pictures = [self.create_publisher(Image, f"/camera_{n}", 100) for n in range(NUMBER)]
        self.create_subscription(Image, "/camera_0", lambda message: None, 100)
        self.create_timer(0.1, self.tick)
        self.image = Image(height=1, width=1, step=3, encoding="rgb8", data=os.urandom(SIZE))
    def tick(self):
        for _ in range(TIMES):
            for publisher in self.pictures:
                publisher.publish(self.image)
"""


@pytest.mark.slow
def test_images_in_flight_beyond_the_limit_end_the_scenario_and_keep_the_evidence() -> None:
    cell = PICTURES.replace("NUMBER", "1").replace("SIZE", "8_000_000").replace("TIMES", "9")
    evidence, _ = run(cell, task=TALKER, limits=Limits(scenario_seconds=30))
    assert evidence.stopped == "memory"
    assert "64 MB were in transit or latched at a time" in evidence.errors[0]
    assert "/said" in evidence.topics
    assert 0 < sum(len(sample.cdr) for sample in evidence.samples) < 9_000_000


@pytest.mark.slow
def test_evidence_size_is_limited_per_submission_and_per_task() -> None:
    calls = tuple(Call() for _ in range(2))
    greedy = tuple(
        Task(f"week01.greedy_{n}", "Large", "function", "called", HINTS, (Scenario("public", calls=calls),))
        for n in range(3)
    )
    cell = "answer = 7\ndef called(): return [str(n) for n in range(190_000)]"
    personal: dict[str, dict[str, int]] = {task.id: {} for task in (*greedy, ANSWER)}
    with closing(SubmissionRun([cell], personal, Limits())) as session:
        came = [session.run(task, task.scenarios[0]) for task in greedy]
        assert [one.stopped for one in came] == ["", "memory", "memory"]
        assert "32 MB for all of its tasks" in came[1].errors[0]
        assert session.run(ANSWER, ANSWER.scenarios[0]).returns == (7,)


@pytest.mark.parametrize("size", [1_000_000, 30_000_000])
def test_images_never_exhaust_the_evidence_limit(size: int) -> None:
    cell = PICTURES.replace("NUMBER", "3").replace("SIZE", str(size)).replace("TIMES", "1")
    cell = cell.replace("self.create_sub", "0 and self.create_sub")
    evidence, _ = run(cell, task=replace(TALKER, scenarios=(Scenario("public", seconds=1.0),)))
    assert sum(len(sample.cdr) for sample in evidence.samples) <= ALL
