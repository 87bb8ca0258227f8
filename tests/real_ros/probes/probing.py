"""Collects probes: functions that run under the real rclpy as well as under the kit, one after the other.

The outcome of a probe is what it returns or raises, as text. `main()` prints all of them as one
JSON object.
"""

import contextlib
import gc
import importlib
import importlib.util
import io
import json
import os
import re
import sys
import tempfile
import time
from collections.abc import Callable
from typing import Any

# There is no wheel of example_interfaces, and the kit has not got test_msgs.
_ACTIONS = "test_msgs.action" if importlib.util.find_spec("test_msgs") else "example_interfaces.action"
Fibonacci: Any = importlib.import_module(_ACTIONS).Fibonacci

_IS_KIT = "course_lib" in sys.modules
Probe = Callable[[], object]
_probes: dict[str, Probe] = {}


def probe(function: Probe) -> Probe:
    """Register a probe by its name."""
    _probes[function.__name__] = function
    return function


def lines(prefix: str, /, **calls: Probe) -> None:
    """Register many short probes."""
    _probes.update({f"{prefix}.{name}": call for name, call in calls.items()})


def outcome(call: Callable[..., object], *args: Any, **options: Any) -> str:
    """Return the result or exception of a call, without addresses, C locations and the kit's hints."""
    try:
        text = repr(call(*args, **options))
    except BaseException as error:
        text = f"{type(error).__name__}: {error}"
    text = re.sub(r"\b(test_msgs|example_interfaces)(?=\.action)", "interfaces", text)
    # The complaints of rcl's parsers name their states, and files are temporary ones.
    text = re.sub(r"(Couldn't parse [^:]*: '.*?'\. Error: ).*", r"\1", text, flags=re.DOTALL)
    text = re.sub(r"/tmp/tmp\w+/", "", text)
    # Pybind lists the signatures and the arguments behind that.
    text = re.sub(r"(incompatible (?:constructor|function) arguments\.).*", r"\1", text, flags=re.DOTALL)
    text = re.sub(r", at [^ ,|'\"]*\.(c|h|cpp):\d+|(?<=msg)\._\w+(?=\.)", "", text)
    return re.sub(r" at 0x[0-9a-f]+", " at 0x", text)


def captured(call: Probe) -> tuple[str, str]:
    """Return the outcome of a call, and what it writes to stderr, as Python or as C code does."""
    sys.stderr.flush()
    kept, replaced = os.dup(2), io.StringIO()
    with tempfile.TemporaryFile() as file:
        os.dup2(file.fileno(), 2)
        try:
            with contextlib.redirect_stderr(replaced):
                found = outcome(call)
        finally:
            os.dup2(kept, 2)
            os.close(kept)
        file.seek(0)
        return found, file.read().decode(errors="backslashreplace") + replaced.getvalue()


def said(call: Probe) -> list[Any]:
    """Return the outcome of a call and its lines on stderr, without times."""
    found, text = captured(call)
    return [found, re.sub(r"\[\d+\.\d+\]", "[T]", text).splitlines()]


def spun(node: Any, ready: Callable[[], object], seconds: float = 3.0, executor: Any = None) -> bool:
    """Spin a node until `ready()` or the end of a time [s]; return the last `ready()`."""
    from rclpy.executors import SingleThreadedExecutor

    end = time.monotonic() + seconds
    executor = executor or SingleThreadedExecutor()
    executor.add_node(node)
    while not ready() and time.monotonic() < end:
        executor.spin_once(timeout_sec=0.1)
    executor.shutdown()
    return bool(ready())


def response(node: Any, kind: Any, service: str, request: Any) -> Any:
    """Return the response of a node's service to another node, or None after 3 s."""
    from rclpy.executors import SingleThreadedExecutor
    from rclpy.node import Node

    caller = Node("caller")
    client = caller.create_client(kind, service)
    client.wait_for_service(2.0)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    executor.add_node(caller)
    future = client.call_async(request)
    executor.spin_until_future_complete(future, 3.0)
    executor.shutdown()
    return future.result()


def main() -> None:
    """Run each probe between `rclpy.init` and `rclpy.shutdown`, and print the outcomes."""
    import rclpy

    printed, sys.stdout = sys.stdout, sys.stderr
    found: dict[str, str] = {}
    # What has been imported is not searched for garbage after each probe.
    gc.freeze()
    for name, function in _probes.items():
        rclpy.init(args=[])
        found[name] = outcome(function)
        rclpy.try_shutdown()
        # Entities of a probe that are not destroyed would be in the real graph of the next one.
        if not _IS_KIT:
            gc.collect()
    printed.write(f"{json.dumps(found)}\n")
    printed.flush()
    # Destructors of rclpy at the end of Python print warnings that are unrelated to the probes.
    os._exit(0)
