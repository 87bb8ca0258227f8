"""Submissions that use too much: of time, memory, processes, disk, output."""

from tests.hostile.entry import PUBLISH, Entry, in_callback, replaced

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
        says="cell 2 was stopped after",
    ),
    Entry("long_sleep", "import time\ntime.sleep(1e9)"),
    Entry(
        "real_time_spin", "import os\nwhile os.times().elapsed < 1e12: pass", status="limit", reason="time"
    ),
    # They use the processor while the cell waits for it, which must not extend the time limit much.
    Entry(
        "short_processes",
        """
import os, signal
try: signal.signal(signal.SIGCHLD, signal.SIG_IGN)
except OSError: pass
while True:
    for _ in range(20):
        if os.fork() == 0:
            while os.times().user < 0.02: pass
            os._exit(0)
    sum(range(10**6))
    for _ in range(20): os.wait()
""",
        status="limit",
        reason="time",
        says="cell 2 was stopped after",
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
        reason="size|time",
    ),
    Entry(
        "endless_publishing",
        change=in_callback("while True: " + PUBLISH.strip()),
        final=80,
        status="limit",
        reason="size|time",
    ),
    Entry(
        "flush_flood",
        "import ctypes, os, time\nbegin = time.perf_counter()\nf = open('f', 'w')\n"
        "for _ in range(20_000): os.sync(); os.fsync(f.fileno()); os.fdatasync(f.fileno())\n"
        "assert ctypes.CDLL(None).syncfs(f.fileno()) == 0\nprint('flushed')",
        says="flushed",
    ),
    Entry(
        "clogged_pipe",
        "import os\nunread, written = os.pipe()\nfor number in (1, 2): os.dup2(written, number)\n"
        "os.write(1, b'x' * 200_000)",
        status="limit",
        reason="time",
    ),
    Entry("log_flood", "import logging\nfor i in range(50_000): logging.getLogger(f'l{i}').error('x' * 99)"),
    Entry(
        "finalizer_spins",
        "class D:\n    def __del__(self):\n        while True: pass\nd = D()\ndel d",
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
    Entry(
        "robot_time_spin",
        "import time\nend = time.time() + 1e9\nwhile time.time() < end: pass",
        status="limit",
        reason="time",
    ),
    Entry(
        "hidden_forks",
        """
import os, signal
try:
    while os.fork(): pass
    signal.pause()
except OSError: pass
""",
        status="limit",
        reason="processes|time",
        says="cell 2 was stopped",
    ),
    Entry(
        "threads_left",
        """
import _thread
lock = _thread.allocate_lock()
lock.acquire()
for _ in range(10000): _thread.start_new_thread(lock.acquire, ())
""",
        status="limit",
        reason="processes",
        says="cell 2 was stopped: it left so many processes",
    ),
    Entry("long_text", change=replaced("return length / 2", "return 'x' * 10**8"), final=70),
    Entry(
        "broadcast",
        change=replaced("return length / 2", "import numpy; return numpy.broadcast_to(0.0, (10**6, 10**6))"),
        final=70,
    ),
    Entry("huge_integer", "x = 10 ** 10**6\nprint(x)", says="ValueError"),
    Entry(
        "many_nodes",
        change=in_callback("for i in range(10**6): rclpy.create_node(f'n{i}')"),
        final=50,
        status="limit",
        reason="time|size|memory",
    ),
    Entry(
        "many_timers",
        change=in_callback("for i in range(10**6): self.create_timer(1e9 + i, print)"),
        final=50,
        status="limit",
        reason="time|size|memory",
    ),
)
