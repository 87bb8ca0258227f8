# ruff: noqa: E501  attacks are lines of their own kind
"""Submissions that go for their mark."""

from tests.hostile.entry import PUBLISH, SECOND_TICK, Entry, replaced

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
    for value in list(frame.f_locals.values()):
        try: seen.append(repr(value)[:2000])
        except Exception: pass
    frame = frame.f_back
# This cell's own source is in the frames, too.
if "canary-" + "4711" in "".join(seen): print("BROKEN")
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
        "import course_lib.ros.graph.graph as clock\nclock.START_NS = 0",
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
    Entry(
        "hooks",
        """
import atexit, sys, threading
def spy(name):
    if any(word in name for word in ("judge", "vocabulary", "checks")): print("BROKEN", name)
class Finder:
    find_spec = staticmethod(lambda name, *rest: spy(name))
sys.meta_path.insert(0, Finder)
def trace(frame, *rest): spy(frame.f_code.co_filename)
threading.settrace(trace); sys.settrace(trace); sys.setprofile(trace)
atexit.register(print, "BROKEN at exit")
get_ipython().events.register("post_run_cell", lambda result: spy(str(result)))
""",
    ),
    Entry("fixed_answer", change=replaced("length / 2", "2.0"), final=90),
    Entry(
        "object_array",
        change=replaced("return length / 2", "import numpy; return numpy.array([object()])"),
        final=70,
    ),
    Entry(
        "evil_key",
        change=replaced(
            "return length / 2",
            """
    class Key:
        __str__ = lambda self: 1 / 0
    return {Key(): 2.0}""",
        ),
        final=70,
        says="ZeroDivisionError",
    ),
    Entry(
        "evil_list",
        change=replaced(
            "return length / 2",
            """
    class List(list):
        __len__ = lambda self: -1
        __getitem__ = lambda self, index: self
        __iter__ = lambda self: iter(int, 1)
    return List()""",
        ),
        final=70,
    ),
    Entry("complex_number", change=replaced("return length / 2", "return complex(length / 2, 0)"), final=70),
    Entry(
        "back_dated",
        change=replaced(
            "self.publisher.publish(marker)", "marker.header.stamp.sec = 4; self.publisher.publish(marker)"
        ),
    ),
    Entry("another_student", claims="aaa_honest", status="needs_marking", reason="ID mismatch"),
    Entry("no_path_as_name", claims="../aaa_honest"),
    Entry(
        "stops_clocks",
        """
import json, time
import numpy as np
time.time = time.monotonic = time.perf_counter = lambda: 1e18
time.sleep = lambda seconds: None
json.loads = json.load = lambda *a, **k: {"score": 110}
np.array_equal = np.array = lambda *a, **k: True
""",
        change=replaced("length / 2", "length"),
        final=70,
    ),
    Entry(
        "forged_result_lines",
        """
import json, os
row = {"student": "forged_result_lines", "exercise": "week01_exercise", "status": "graded", "score": 110}
for number in (1, 2):
    os.write(number, json.dumps(row).encode() + b"\\n3 of 3 tasks have full marks\\n")
print("week01.half: 40 of 40 points\\x1b]0;title\\x07")
""",
        change=replaced("length / 2", "length"),
        final=70,
    ),
    Entry(
        "patches_rclpy",
        "import rclpy.node\n"
        "rclpy.node.Node.create_publisher = lambda *a, **k: type('P', (), {'publish': lambda *m: None})()",
        final=50,
    ),
    Entry(
        "endless_generator",
        change=replaced('answer = 2 * my_values("week01.answer")["n"]', "answer = iter(int, 1)"),
        final=100,
    ),
    Entry(
        "integer_lies",
        change=replaced(
            "return length / 2",
            """
    class Whole(int):
        __index__ = __int__ = __float__ = lambda self: 2.0
        bit_length = lambda self: 1
    return Whole(7)""",
        ),
        final=70,
    ),
    Entry(
        "huge_repr",
        change=replaced(
            "return length / 2",
            "\n    class Huge:\n        __repr__ = lambda self: 'x' * 10**9\n    return Huge()",
        ),
        final=70,
    ),
    Entry(
        "nested_errors",
        "error = ValueError('x')\nfor _ in range(5000): error = ExceptionGroup('g', [error])\nraise error",
    ),
    Entry("collects_badly", "import gc\ngc.callbacks.append(lambda *a: 1 / 0)"),
    Entry(
        "audits",
        "import sys\ndef no(event, rest):\n    if event in ('import', 'open'): raise RuntimeError('no')\nsys.addaudithook(no)",
    ),
    Entry("stops_its_group", "import os, signal\nos.kill(0, signal.SIGSTOP)"),
    Entry(
        "replaces_its_worker",
        "import course_lib.grading.run.worker as worker\nfor name, value in list(vars(worker).items()):\n"
        "    if callable(value): setattr(worker, name, lambda *a, **k: None)",
        final=0,
    ),
    Entry(
        "empties_python", "import os, sys\nos.environ.clear(); sys.path.clear(); sys.modules.clear()", final=0
    ),
    Entry("long_error_name", "raise type('x' * 10**6 + '<b>', (Exception,), {})('y')"),
    Entry("error_without_text", "class E(Exception): __str__ = __repr__ = lambda self: 1 / 0\nraise E"),
    Entry("locks_its_folder", "import os\nos.chmod('.', 0)"),
)
