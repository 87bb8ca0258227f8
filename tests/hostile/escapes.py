# ruff: noqa: E501  attacks are lines of their own kind
"""Submissions that try to leave the jail."""

from tests.hostile.entry import Entry, tries

ESCAPES = (
    tries("reads_files",
          "open(TOP + '/secret.txt').read()", "open(TOP + '/in/aaa_honest/week01_exercise.ipynb').read()",
          "open(TOP + '/course/solutions/checks/week01.py').read()", "os.listdir(TOP)", "os.listdir('/root')",
          "open('/etc/passwd').read()", "open('/proc/self/environ').read()", "open('/proc/1/environ').read()",
          "open(f'/proc/{GRADER}/environ').read()", "open('/proc/self/mem', 'rb')", "os.environ['GRADER_TOKEN']",
          "os.symlink(TOP + '/secret.txt', 'link'); open('link').read()",
          "os.link(TOP + '/secret.txt', 'hard'); open('hard').read()", "os.listdir(os.path.expanduser('~root'))",
          "open('../../secret.txt').read()"),
    tries("finds_files",
          "os.chdir(TOP)", "os.stat(TOP)", "os.stat(TOP + '/secret.txt')", "os.stat(TOP + '/course/exercises/course.toml')",
          "os.stat(f'/proc/{GRADER}')", "os.stat('/etc/passwd')", "assert os.access(TOP, os.F_OK)",
          "os.open(TOP + '/in', os.O_PATH)"),
    tries("writes_files",
          "open(TOP + '/out/gradebook.csv', 'a')", "open(TOP + '/new', 'w')", "open(LIB, 'a')", "os.remove(LIB)",
          "os.rename(LIB, LIB + 'x')", "open('/tmp/x', 'w')", "open('/dev/shm/x', 'w')", "os.mkdir('/tmp/d')",
          "open(os.__file__, 'a')", "os.chmod(LIB, 0o666); assert os.stat(LIB).st_mode & 0o777 == 0o666", "os.truncate(LIB, 0)", "os.mkfifo(TOP + '/fifo')"),
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
    tries("reads_more",
          "open(f'/proc/{os.getppid()}/mem', 'rb')", "open('/proc/self/maps').read()", "os.listdir('/proc')",
          "open(os.path.expanduser('~/.ssh/id_rsa')).read()", "open('/root/.ssh/id_rsa').read()",
          "os.listdir('/home')", "os.listdir('/dev/shm')", "os.open(TOP, os.O_PATH | os.O_DIRECTORY); os.listdir(TOP)",
          "open('/var/run/docker.sock')", "open('/sys/kernel/notes', 'rb').read()", "os.listdir('/run')",
          "os.mkfifo('pipe'); os.mknod('block', 0o60600, os.makedev(254, 0)); open('block', 'rb').read(1)"),
    # Pages of such memory belong to no process once they are unmapped, and no limit would count
    # them.
    tries("memory_of_nobody", "import mmap; mmap.mmap(-1, 4096)", "open('/dev/zero', 'rb')",
          *(f"socket.socketpair()[{end}].setsockopt(socket.SOL_SOCKET, {option}, 2**22)"
            for end in (0, 1) for option in (7, 8, 32, 33))),
    tries("network_by_libraries",
          "import urllib.request as r; r.urlopen('http://127.0.0.1:' + PORT, timeout=1)",
          "import http.client as h; h.HTTPConnection('127.0.0.1', int(PORT), timeout=1).request('GET', '/')",
          "import asyncio; asyncio.run(asyncio.open_connection('127.0.0.1', int(PORT)))",
          "import multiprocessing.connection as c; c.Client(('127.0.0.1', int(PORT)))",
          "import tornado.httpserver as t; t.HTTPServer(print).listen(0)",
          "import webbrowser; assert webbrowser.open('http://127.0.0.1:' + PORT)"),
    Entry("late_daemon", """
import os
if os.fork() == 0:
    os.setsid()
    if os.fork() == 0:
        while True:
            for name in ("gradebook.csv", "results/late_daemon/week01_exercise.json"):
                try: open(TOP + "/out/" + name, "w").write("BROKEN")
                except OSError: pass
    os._exit(0)
"""),
    Entry("poisons_the_next", """
import os, pathlib
for name in ("sitecustomize.py", "numpy.py", ".ipython/profile_default/startup/00.py", ".config/matplotlib/matplotlibrc", "course_lib/__init__.py", "__pycache__/x.pyc"):
    path = pathlib.Path.home() / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("print('BRO' 'KEN')")
os.environ["PYTHONSTARTUP"] = "sitecustomize.py"
os.environ["PYTHONHASHSEED"] = "7"
import numpy, random
numpy.random.seed(1); random.seed(1)
"""),
    Entry("hooks_of_python", """
import os, site, sys
for folder in {*site.getsitepackages(), *sys.path} - {"", os.getcwd(), os.path.expanduser("~")}:
    for name in ("evil.pth", "sitecustomize.py", "usercustomize.py"):
        try: open(os.path.join(folder, name), "w").write("raise SystemExit"); print("BRO" "KEN", folder)
        except OSError: pass
"""),
    Entry("reads_processes", """
import glob, os
for path in glob.glob("/proc/[0-9]*"):
    if int(path.split("/")[2]) == os.getpid(): continue
    for name in ("environ", "maps", "mem"):
        try:
            if open(os.path.join(path, name), "rb").read(100): print("BRO" "KEN", path, name)
        except OSError: pass
"""),
    Entry("deaf_daemon", """
import contextlib, os, signal, time
if os.fork() == 0:
    os.setsid()
    for number in range(1, 65):
        with contextlib.suppress(OSError, ValueError): signal.signal(number, signal.SIG_IGN)
    if os.fork() == 0:
        end = time.time() + 600
        while time.time() < end: pass
    os._exit(0)
"""),
    tries("sets_clocks", "import time; time.clock_settime(0, 1.0)", "call(227, 0, b'\\0' * 16)",
          "call(164, b'\\0' * 16, 0)", "call(159, b'\\0' * 208)", "call(170, b'x', 1)"),
    tries("kernel_objects", "call(323, 0)", "call(298, 0, 0, 0, 0, 0)", "call(425, 1, b'\\0' * 120)",
          "call(248, b'user', b'x', b'y', 1, -3)", "call(29, 0, 4096, 0o1600)", "call(68, 0, 0o1600)",
          "call(240, b'/q', 64, 0o600, 0)", "call(175, b'', 0, b'')", "call(246, 0, 0, 0, 0)"),
)  # fmt: skip
