# ruff: noqa: E501  attacks are lines of their own kind
"""Attacks and mistakes as tiny submissions: an extra cell, or a change of the right answer.

A cell that reaches what it must not reach prints BROKEN. Names TOP, PORT, GRADER, LIB are given to it.
"""

from collections.abc import Callable
from dataclasses import dataclass

FULL = 110.0
PUBLISH = "        self.publisher.publish(marker)\n"
SECOND_TICK = "        if self.get_clock().now().nanoseconds > 1_700_000_001 * 10**9: "


def _same(cell: str) -> str:
    return cell


def in_callback(code: str) -> Callable[[str], str]:
    """Code that is run in every call of the node's timer, instead of publishing."""
    lines = "".join(f"        {line}\n" for line in code.splitlines())
    return lambda cell: cell.replace(PUBLISH, lines)


def replaced(before: str, after: str) -> Callable[[str], str]:
    """Another text in the right answer."""
    return lambda cell: cell.replace(before, after)


@dataclass(frozen=True)
class Entry:
    """One submission.

    Args:
        name: Of the student.
        cell: Run between the right answer's first and second cell.
        change: Of each cell of the right answer.
        final: The mark it must get.
        status: In the gradebook.
        reason: In the gradebook.
        says: What the result must hold somewhere.
    """

    name: str
    cell: str = ""
    change: Callable[[str], str] = _same
    final: float = FULL
    status: str = "graded"
    reason: str = ""
    says: str = ""


def tries(name: str, *lines: str, **more: object) -> Entry:
    """Each line is tried for itself; one that raises nothing has broken something."""
    cell = "import ctypes, os, signal, socket, subprocess, sys\nlibc = ctypes.CDLL(None, use_errno=True)\n"
    cell += "def call(*a):\n    if libc.syscall(*a) < 0: raise OSError(ctypes.get_errno(), 'no')\n"
    for line in lines:
        cell += f"try:\n    {line}\n    print('BROKEN', {line!r})\nexcept Exception as e:\n    pass\n"
    return Entry(name, cell, **more)  # type: ignore[arg-type]  # the fields above


RESOURCES = (
    Entry(
        "busy_loop",
        """
import signal
for s in (signal.SIGINT, signal.SIGXCPU, signal.SIGTERM): signal.signal(s, signal.SIG_IGN)
while True:
    try:
        while True: pass
    except BaseException: pass
""",
        status="limit",
        reason="time",
        says="cell 2 was stopped after 2 s",
    ),
    Entry("long_sleep", "import time\ntime.sleep(1e9)"),
    Entry(
        "real_time_spin", "import os\nwhile os.times().elapsed < 1e12: pass", status="limit", reason="time"
    ),
    Entry("huge_array", "x = bytearray(10**11)", status="limit", reason="memory", says="MemoryError"),
    Entry("leak", "x = []\nwhile True: x.append(bytearray(10**8))", status="limit", reason="memory|time"),
    Entry("fork_bomb", "import os\nwhile True: os.fork()", status="limit", reason="processes|time"),
    Entry(
        "many_forks",
        "import os, signal\nwhile os.fork(): pass\nsignal.pause()",
        status="limit",
        reason="processes|time",
    ),
    Entry(
        "threads",
        "import _thread\nfor _ in range(10000): _thread.start_new_thread(input, ())",
        status="limit",
        reason="processes",
    ),
    Entry(
        "fills_disk", "f = open('f', 'wb')\nwhile True: f.write(b'x' * 10**6)", status="limit", reason="size"
    ),
    Entry(
        "fills_disk_by_files",
        "for i in range(10**6): open(f'{i % 999}_{i}', 'wb').write(b'x' * 10**5)",
        status="limit",
        reason="size",
    ),
    Entry("million_files", "for i in range(10**6): open(str(i), 'w').close()", status="limit", reason="size"),
    Entry("many_open_files", "files = [open('f', 'w') for _ in range(10000)]", says="Too many open files"),
    Entry(
        "huge_message",
        change=in_callback("marker.text = 'x' * 50_000_000\n" + PUBLISH.strip()),
        final=50,
        status="limit",
        reason="size",
    ),
    Entry(
        "endless_publishing",
        change=in_callback("while True: " + PUBLISH.strip()),
        final=80,
        status="limit",
        reason="time",
    ),
    Entry("print_flood", "for _ in range(100): print('x' * 10**6)", says="cut after"),
    Entry("real_flood", "import os\nfor _ in range(100): os.write(1, b'x' * 10**6)", says="cut after"),
    Entry("huge_return", change=replaced("return length / 2", "return [0.0] * 10**7"), final=70),
    Entry(
        "recursive_return", change=replaced("return length / 2", "a = []; a.append(a); return a"), final=70
    ),
    Entry(
        "deep_return",
        change=replaced(
            "return length / 2", "\n    a = []\n    for _ in range(10**5): a = [a]\n    return a"
        ),
        final=70,
    ),
    Entry("stack", "def f(): f()\nf()", says="RecursionError"),
    Entry("segfault", "import ctypes\nctypes.string_at(0)", says="cell 2 ended the process"),
)
ESCAPES = (
    tries("reads_files",
          "open(TOP + '/secret.txt').read()", "open(TOP + '/in/aaa_honest/week01_exercise.ipynb').read()",
          "open(TOP + '/course/solutions/checks/week01.py').read()", "os.listdir(TOP)", "os.listdir('/root')",
          "open('/etc/passwd').read()", "open('/proc/self/environ').read()", "open('/proc/1/environ').read()",
          "open(f'/proc/{GRADER}/environ').read()", "open('/proc/self/mem', 'rb')", "os.environ['GRADER_TOKEN']",
          "os.symlink(TOP + '/secret.txt', 'link'); open('link').read()",
          "os.link(TOP + '/secret.txt', 'hard'); open('hard').read()", "os.listdir(os.path.expanduser('~root'))",
          "os.chdir(TOP)", "open('../../secret.txt').read()"),
    tries("writes_files",
          "open(TOP + '/out/gradebook.csv', 'a')", "open(TOP + '/new', 'w')", "open(LIB, 'a')", "os.remove(LIB)",
          "os.rename(LIB, LIB + 'x')", "open('/tmp/x', 'w')", "open('/dev/shm/x', 'w')", "os.mkdir('/tmp/d')",
          "open(os.__file__, 'a')", "os.chmod(LIB, 0o777)", "os.truncate(LIB, 0)", "os.mkfifo(TOP + '/fifo')"),
    tries("network",
          "socket.create_connection(('127.0.0.1', int(PORT)), 1)", "socket.socket(socket.AF_INET, socket.SOCK_DGRAM)",
          "socket.socket(socket.AF_UNIX)", "socket.socket(socket.AF_NETLINK, socket.SOCK_RAW)",
          "socket.getaddrinfo('example.org', 80)", "call(41, 2, 1, 0)"),
    tries("signals",
          "os.kill(int(GRADER), 9)", "os.kill(os.getppid(), 9)", "os.kill(-1, 9)", "os.killpg(0, 9)",
          "call(62, -1, 9)", "call(234, int(GRADER), int(GRADER), 9)", "signal.pidfd_send_signal(3, 9)"),
    tries("other_processes",
          "call(101, 16, int(GRADER), 0, 0)", "call(310, int(GRADER), 0, 0, 0, 0, 0)", "os.pidfd_open(int(GRADER))",
          "call(302, int(GRADER), 7, 0, 0)", "os.sched_setaffinity(int(GRADER), [0])"),
    tries("other_programs",
          "os.execv('/bin/sh', ['sh', '-c', 'echo BROKEN'])", "subprocess.run(['/bin/true'])",
          "assert os.system('exit 0') == 0", "os.posix_spawn('/bin/true', ['true'], {})"),
    tries("system_calls",
          "call(272, 0x10000000)", "call(165, b'tmpfs', b'/', b'tmpfs', 0, 0)", "call(56, 0x10000011, 0, 0, 0, 0)",
          "call(435, 0, 88)", "call(308, 0, 0)", "call(161, b'.')", "call(425, 8, 0)", "call(321, 0, 0, 0)",
          "call(440, 0)", "call(500)", "call(166, b'/proc', 2)"),
    Entry("daemon", """
import os
if os.fork() == 0:
    os.setsid()
    if os.fork() == 0:
        for fd in range(20):
            try: os.close(fd)
            except OSError: pass
        while True: pass
    os._exit(0)
"""),
)  # fmt: skip
TAMPERING = (
    Entry(
        "patches_everything",
        """
import builtins, json, math, struct, sys, unittest
import numpy as np
np.allclose = np.isclose = lambda *a, **k: True
json.dumps = lambda *a, **k: '{"score": 100}'
math.isclose = lambda *a, **k: True
sys.excepthook = sys.settrace = lambda *a: None
""",
        change=replaced("length / 2", "length"),
        final=70,
    ),
    Entry(
        "breaks_python",
        "import builtins\nbuiltins.isinstance = builtins.abs = builtins.len = lambda *a: True",
        says="ended the process",
    ),
    Entry(
        "patches_judge",
        """
import course_lib.grading.judge as judge, course_lib.grading.evidence as evidence
judge.judge_task = None
evidence.failed = evidence.passed
import course_lib.grading.vocabulary.values as values
for name in list(vars(values)):
    if name.startswith("expect"): setattr(values, name, None)
""",
        change=replaced("length / 2", "length"),
        final=70,
    ),
    Entry(
        "always_equal",
        change=replaced(
            "return length / 2",
            """
    class Any(float):
        __eq__ = __ge__ = __le__ = lambda *a: True
        __sub__ = __rsub__ = __abs__ = lambda *a: 0.0
        __reduce__ = lambda self: (print, ("BROKEN",))
    return Any(7)""",
        ),
        final=70,
    ),
    Entry("no_number", change=replaced("return length / 2", "return float('nan')"), final=70),
    Entry("infinity", change=replaced("return length / 2", "return float('inf')"), final=70),
    Entry("big_integer", change=replaced("return length / 2", "return 10**5000"), final=70),
    Entry(
        "array_lies",
        change=replaced(
            "return length / 2",
            """
    class A:
        __array__ = lambda *a, **k: 1 / 0
        __class__ = property(lambda self: float)
    return A()""",
        ),
        final=70,
    ),
    Entry(
        "exits_well",
        change=replaced(PUBLISH, PUBLISH + SECOND_TICK + "import os; os._exit(0)\n"),
        final=80,
        says="the process ended before the program did",
    ),
    Entry("system_exit", "raise SystemExit(0)"),
    Entry(
        "transformer",
        """
ip = get_ipython()
ip.input_transformers_post.append(lambda lines: [l for l in lines if "length" not in l or "def" in l] + ["    pass"])
""",
        final=60,
    ),
    Entry(
        "forged_output",
        "print('All tests passed', '\\x1b]0;title\\x07\\x1b[2J', '<script>alert(1)</script>')",
    ),
    Entry("forged_error", "raise ValueError('<script>alert(2)</script>\\x1b[2J')"),
    Entry("surrogates", "print('x\\ud800')\nraise ValueError('\\udfff')"),
    Entry(
        "searches_memory",
        """
import gc
names = {type(o).__name__ for o in gc.get_objects()}
if names & {"Catalog", "CourseFile", "Scenario", "Check", "Submission"}: print("BROKEN", names)
""",
    ),
    Entry(
        "frames",
        """
import sys
frame, seen = sys._getframe(), []
while frame:
    seen += [repr(v)[:2000] for v in list(frame.f_locals.values())]
    frame = frame.f_back
if "canary-4711" in "".join(seen): print("BROKEN")
""",
    ),
    Entry(
        "truth_topics",
        change=replaced(
            PUBLISH,
            PUBLISH.replace("publish(marker)", "publish(marker)") + "        marker.header.stamp.sec = 1\n",
        ),
    ),
    Entry(
        "clock",
        "import time\ntime.time = time.monotonic = lambda: 0.0\n"
        "import course_lib.ros.clock as clock\nclock.START_NS = 0",
    ),
    Entry("garbage_in_pipe", "import os\nos.write(3, b'\\xff' * 1000)"),
    Entry(
        "all_descriptors",
        """
import os
for fd in range(3, 1024):
    try: os.write(fd, b"\\0\\0\\0\\1\\xc1")
    except OSError: pass
""",
        says="cell 2",
    ),
    Entry("closes_pipe", "import os\nos.closerange(0, 1024)", says="cell 2 ended the process"),
)
MISTAKES = (
    Entry("typo", "fro x in y", says="SyntaxError"),
    Entry("no_keyboard", "name = input('Your name? ')", says="input"),
    Entry("debugger", "breakpoint()"),
    Entry("magics", "%matplotlib inline\n%timeit -n1 -r1 1 + 1"),
    Entry("cell_magic", "%%time\nx = 1"),
    Entry("shell", "!ls\n!pip install x", says="There is no shell when graded"),
    Entry("pip", "%pip install x", says="There is no shell when graded"),
    Entry("bash", "%%bash\necho BRO''KEN"),
    Entry(
        "figures",
        "import matplotlib.pyplot as plt\nfor _ in range(30): plt.figure(); plt.plot([1, 2])\nplt.show()",
    ),
    Entry("absolute_path", "open('/home/me/data.csv')", says="data.csv"),
    Entry("windows_path", "open('C:\\\\data\\\\x.csv')", says="FileNotFoundError"),
    Entry("own_files", "open('notes.txt', 'w').write('x')\nassert open('notes.txt').read() == 'x'"),
    Entry("warns", "import warnings, sys\nwarnings.warn('old')\nprint('x', file=sys.stderr)"),
    Entry("missing_package", "import not_there_at_all", says="No module named 'not_there_at_all'"),
    Entry("spins_in_a_cell", "rclpy.init()\nrclpy.spin(RedCubeNode())"),
    Entry("spins_for_ever", "import threading\nthreading.Event().wait()", says="wait"),
    Entry("asyncio", "import asyncio\nawait asyncio.sleep(3)"),
    Entry("thread_left", "import threading, time\nthreading.Thread(target=time.sleep, args=(1e6,)).start()"),
    Entry("renamed", change=replaced("def half", "def halve"), final=70, says="half is not in the notebook"),
    Entry("duplicated", "def half(length):\n    return 0.0\n"),
    Entry(
        "endless_function",
        change=replaced("return length / 2", "\n    while True: pass"),
        final=70,
        status="limit",
        reason="time",
    ),
)
ALL = (*RESOURCES, *ESCAPES, *TAMPERING, *MISTAKES)
