# ruff: noqa: E501  attacks are lines of their own kind
"""Submissions with honest mistakes."""

from tests.hostile.entry import Entry, replaced

MISTAKES = (
    Entry("typo", "fro x in y", says="SyntaxError"),
    Entry("no_keyboard", "name = input('Your name? ')", says="input"),
    Entry("debugger", "breakpoint()"),
    Entry("magics", "%matplotlib inline\n%timeit -n1 -r1 1 + 1"),
    Entry("cell_magic", "%%time\nx = 1"),
    Entry("shell", "!ls\n!pip install x", says="Grading has no shell"),
    Entry("pip", "%pip install x", says="Grading has no shell"),
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
    Entry("renamed", change=replaced("def half", "def halve"), final=70, says="half is not defined"),
    Entry("duplicated", "def half(length):\n    return 0.0\n"),
    Entry(
        "endless_function",
        change=replaced("return length / 2", "\n    while True: pass"),
        final=70,
        status="limit",
        reason="time",
    ),
    Entry(
        "helper_below",
        "print(helper(1))\ndef helper(x): return x",
        says="NameError: name 'helper' is not defined",
    ),
    Entry("stale_name", "print(only_in_the_old_kernel)", says="NameError"),
    Entry("password", "import getpass\ngetpass.getpass()", says="getpass"),
    Entry("post_mortem", "import pdb\npdb.set_trace()"),
    Entry("many_figures", "import matplotlib.pyplot as plt\nfor i in range(300): plt.figure(i)"),
    Entry(
        "chance",
        "import random, numpy\nrandom.seed(); print(random.random(), numpy.random.default_rng().random(), set('abc'))",
    ),
    Entry(
        "own_clock", "import time, datetime\nprint(time.time(), datetime.datetime.now(), time.perf_counter())"
    ),
    Entry(
        "closes_output", "import sys, os\nsys.stdout.close(); sys.stderr.close(); os.close(1); os.close(2)"
    ),
    Entry("twice", change=lambda cell: cell + "\n" + cell if "class" not in cell else cell),
    Entry("shuts_down", "rclpy.init()\nrclpy.shutdown()\nrclpy.shutdown()"),
    Entry("forgets_shutdown", "rclpy.init()\nleft = RedCubeNode()"),
    Entry("reads_beside", "open('../data/points.csv')", says="FileNotFoundError"),
)
