"""A scenario's graph, with inputs and a recorder, and the run of the student's object on it.

`check` does both in a notebook's kernel. When a submission is graded, the grader owns the
scenario's graph (`submission_run.py`), and a worker in the jail runs the object (`worker.py`).
"""

import _thread
import ctypes
import io
import pickle
import signal
import struct
import threading
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

from course_lib.errors import CourseError
from course_lib.grading.evidence import Evidence
from course_lib.grading.inputs import build
from course_lib.grading.run.outcome import MAX_ERRORS, RAISED, Outcome, describe, plain, still_running_message
from course_lib.grading.task import ON_A_GRAPH, Message, Scenario, Task, resolve
from course_lib.ros.graph import remote
from course_lib.ros.graph.graph import START_NS, Graph, Sample, current_graph, use_graph
from course_lib.ros.graph.topics import OWN_TOPICS, SERVICE_HEADER, SERVICE_TOPICS, Qos
from course_lib.ros.messages import deserialize, message_class, serialize
from course_lib.ros.programs import import_path
from course_lib.ros.programs.program import seed_generators
from course_lib.ros.time import virtual_time
from course_lib.ros.time.time_lock import EndBehavior, ShutDown, StoppedThread, time_lock
from course_lib.ros.tracebacks import line_of_thread, loop_of_traceback

INPUT_NODE = "scenario"
POINT_CLOUD = "sensor_msgs/msg/PointCloud2"
SET_PARAMETERS = "rcl_interfaces/srv/SetParameters"
NO_NODE = "Node not found:"
# MOST_INPUTS serialized inputs are cached; an input larger than LARGE bytes is not.
MOST_INPUTS, LARGE = 2048, 10_000
MOST_REJECTIONS = 10  # limit on the rejections that a scenario reports
LONGEST_REASON = 200  # limit on the characters of a reason
MOST_EVIDENCE = 32 * 2**20  # [B] limit per submission; all correct solutions take 1.2 MB
SAMPLE_BYTES = 200  # [B] memory of a sample in addition to its message
ROOM = 4 << 20  # [B] limit on images per topic
ALL = 8 << 20  # [B] limit on the images of all topics
MOST_FIELDS = 256  # limit on the fields of a point cloud


@dataclass(frozen=True)
class Instructions:
    """The part of a scenario that is sent to the student's side: kind of the task, seed, calls."""

    kind: str
    seed: int
    calls: Sequence[tuple[Sequence[Any], dict[str, Any]]] = ()


class ScenarioGraph:
    """The graph of one scenario, with its inputs and a recorder of the student's messages.

    Args:
        task: The task of the scenario.
        scenario: The scenario to run.
        personal: The student's personal values.
        room: Maximum size of the recorded evidence [B].
    """

    def __init__(
        self,
        task: Task,
        scenario: Scenario,
        personal: Mapping[str, Any],
        room: float = MOST_EVIDENCE,
    ) -> None:
        self._task, self._scenario, self._personal = task, scenario, personal
        self.seconds = scenario.seconds
        self.graph = Graph(end_ns=START_NS + round(scenario.seconds * 1e9))
        self._input_node = self.graph.add_node(INPUT_NODE, "/")
        self._samples: list[Sample] = []
        self._rejections: list[str] = []
        self._images = ImageLimit(min(ALL, room / 2))
        self._room, self.recorded_bytes = room, 0  # [B]
        self.graph.tap(self._record)
        for message in scenario.inputs:
            is_request = "/srv/" in message.type_name
            if is_request:
                prefix, suffix = SERVICE_TOPICS[0]
                topic, type_name = f"{prefix}{message.topic}{suffix}", f"{message.type_name}_Request"
                message = replace(message, topic=topic, type_name=type_name)
            fields = pickle.dumps(resolve(message.fields, personal))
            serialize_fields = _serialize_input if len(fields) < LARGE else _serialize_input.__wrapped__
            cdr = serialize_fields(message.topic, message.type_name, fields)
            qos = Qos(reliability="best_effort" if message.best_effort else "reliable")
            endpoint = self.graph.add_publisher(self._input_node, message.topic, message.type_name, qos)
            publish = partial(
                self.graph.publish, endpoint, SERVICE_HEADER.pack(endpoint, 1) * is_request + cdr
            )
            due_ns = START_NS + round(message.at * 1e9)
            if is_request:
                publish = partial(self._request, publish, message)
            self.graph.call_at(due_ns, publish, node=self._input_node, entity=endpoint)
        parameter_services = {m.topic for m in scenario.inputs if m.type_name == SET_PARAMETERS}
        for service in sorted(parameter_services):
            self._record_rejections(service)
        calls = [plain(resolve((call.args, call.kwargs), personal)) for call in scenario.calls]
        self.instructions = Instructions(task.kind, scenario.seed, calls)

    def evidence(self, outcome: Outcome, *, output: str = "", stopped: str = "") -> Evidence:
        """Return the evidence with the messages recorded so far."""
        # A node that has failed is missing anyway.
        rejections = [text for text in self._rejections if not outcome.errors or NO_NODE not in text]
        return Evidence(
            task=self._task.id,
            scenario=self._scenario.name,
            seconds=self._scenario.seconds,
            samples=tuple(self._samples),
            returns=tuple(outcome.returns),
            output="".join(rejections) + output,
            errors=tuple(outcome.errors),
            stopped=stopped,
            personal=self._personal,
        )

    def count_bytes(self, size: int) -> None:
        """Count further bytes of evidence.

        Raises:
            MemoryLimitError: The evidence exceeds its limit.
        """
        if self.recorded_bytes + size > self._room:
            raise remote.MemoryLimitError(
                "messages and returned values exceed the limit of a submission "
                f"({MOST_EVIDENCE // 2**20} MB for all of its tasks), so it was stopped"
            )
        self.recorded_bytes += size

    def _request(self, publish: Callable[[], None], message: Message) -> None:
        """Send a request, or record what `ros2 param set` prints if the node does not exist."""
        publish()
        node, _, service = message.topic.removeprefix(SERVICE_TOPICS[0][0]).rpartition("/")
        is_served = any(endpoint.kind == "sub" for endpoint in self.graph.endpoints_on(message.topic))
        if not is_served and service.startswith("set_parameters"):
            texts = [f"At {message.at:.2f} s: {NO_NODE} {node}\n"]
            self._rejections += texts[: MOST_REJECTIONS - len(self._rejections)]

    def _record_rejections(self, service: str) -> None:
        """Record the text that `ros2 param set` would print for a rejected parameter."""

        def on_response(data: bytes, source_ns: int, _: int) -> None:
            seconds, reasons = (source_ns - START_NS) * 1e-9, rejection_reasons(data[SERVICE_HEADER.size :])
            messages = [f"At {seconds:.2f} s: Setting parameter failed: {reason}\n" for reason in reasons]
            self._rejections += messages[: MOST_REJECTIONS - len(self._rejections)]

        prefix, suffix = SERVICE_TOPICS[1]
        topic = f"{prefix}{service}{suffix}"
        self.graph.add_subscription(
            self._input_node, 0, topic, f"{SET_PARAMETERS}_Response", Qos(), on_response
        )

    def _record(self, sample: Sample) -> None:
        # /rosout contains file names, which differ from process to process for cells.
        if sample.node != self._input_node and sample.topic not in OWN_TOPICS:
            limit_size = self._images.limit_size(sample)
            self.count_bytes(len(limit_size.cdr) + SAMPLE_BYTES)
            self._samples.append(limit_size)


@lru_cache(maxsize=MOST_INPUTS)
def _serialize_input(topic: str, type_name: str, fields: bytes) -> bytes:
    """Return the bytes of an input message.

    Building one takes ten times as long as pickling its fields.
    """
    return serialize(build(Message(topic, type_name, pickle.loads(fields)), {}))


def rejection_reasons(cdr: bytes) -> list[str]:
    """Return the reasons for rejecting parameters in a reply from a student's node."""
    try:
        reply: Any = deserialize(cdr, message_class(f"{SET_PARAMETERS}_Response"))
    except Exception:
        # A student's process sent the bytes, which need not be a valid message.
        return []
    reasons = [result.reason or "(no reason)" for result in reply.results if not result.successful]
    return [reason[:LONGEST_REASON] for reason in reasons[:MOST_REJECTIONS]]


class ImageLimit:
    """A limit on the size of images in the evidence, per topic and in total."""

    def __init__(self, most: float = ALL) -> None:
        self._max_bytes = most
        self._bytes_by_topic = Counter[str]()
        self._kept_bytes = 0

    def limit_size(self, sample: Sample) -> Sample:
        """Return the sample, without its pixels if they exceed the limit."""
        if sample.type_name not in remote.IMAGE_TYPES:
            return sample
        self._bytes_by_topic[sample.topic] += len(sample.cdr)
        if self._bytes_by_topic[sample.topic] > ROOM or self._kept_bytes + len(sample.cdr) > self._max_bytes:
            try:
                if sample.type_name == POINT_CLOUD and _count_fields(sample.cdr) > MOST_FIELDS:
                    raise ValueError("a point cloud with far too many fields")
                message: Any = sample.message()
            except Exception:
                # A student's process sent the bytes, which need not be a valid image.
                return replace(sample, cdr=b"")
            message.data = []
            return replace(sample, cdr=serialize(message))
        self._kept_bytes += len(sample.cdr)
        return sample


def _count_fields(cdr: bytes) -> int:
    """Return the number of fields of a serialized point cloud.

    Decoding would take 30 times its size.

    The fields follow the encapsulation (4 bytes), the stamp (8), frame_id, padded to 4, and two
    sizes.
    """
    order = "<" if cdr[1] else ">"
    (frame_id,) = struct.unpack_from(f"{order}I", cdr, 12)
    (count,) = struct.unpack_from(f"{order}I", cdr, 16 + -(-frame_id // 4) * 4 + 8)
    return int(count)


# a single call without arguments, the default of launch tasks
ONE_CALL: Sequence[tuple[Sequence[Any], dict[str, Any]]] = (((), {}),)
WALL_LIMIT = 20.0  # [s] wall time of a run in this process


def perform(part: Instructions, subject: Any, graph: Graph, outcome: Outcome) -> None:
    """Run the student's object on a graph, and store returned values and errors in `outcome`.

    Raises:
        KeyboardInterrupt: The run was interrupted before its end.
    """
    import_path.install()
    virtual_time.install()
    with time_lock.hold(), use_graph(graph), seed_generators(part.seed):
        for action in _actions(part, subject, outcome):
            try:
                with time_lock.at_end(EndBehavior.INTERRUPT):
                    action()
            except BaseException as error:
                # Student code may raise any exception, including SystemExit.
                is_end = graph.ended and isinstance(error, (KeyboardInterrupt, ShutDown, StoppedThread))
                # The end of the scenario acts like Ctrl+C, after which publishing and
                # `rclpy.shutdown()` raise, even in a `finally`. These errors must not count.
                if graph.ended and part.kind in ON_A_GRAPH:
                    continue
                if isinstance(error, KeyboardInterrupt) and not is_end:
                    raise
                problem = (
                    still_running_message((graph.now_ns - START_NS) / 1e9) if is_end else describe(error)
                )
                outcome.errors = [*outcome.errors, problem][:MAX_ERRORS]
        time_lock.finish_other_threads()


def _actions(part: Instructions, subject: Any, outcome: Outcome) -> list[Callable[[], None]]:
    if part.kind == "node":
        return [lambda: run_node(subject)]
    if part.kind == "launch":
        return [partial(_launch, subject, args, kwargs, outcome) for args, kwargs in part.calls or ONE_CALL]
    if part.kind == "file":
        return [lambda: outcome.returns.append(plain(Path(subject).read_text(encoding="utf-8")))]
    if part.kind != "function":
        return [lambda: outcome.returns.append(plain(subject))]

    def call(args: Sequence[Any], kwargs: dict[str, Any]) -> None:
        # A call that raises still needs an entry, so that later ones keep their index.
        outcome.returns.append(RAISED)
        outcome.returns[-1] = plain(_callable(subject, "a function")(*args, **kwargs))

    return [lambda a=args, k=kwargs: call(a, k) for args, kwargs in part.calls]  # type: ignore[misc]


def _launch(subject: Any, args: Sequence[Any], kwargs: dict[str, Any], outcome: Outcome) -> None:
    """Call the function and run the launch file that it returns.

    The subject may also be the text itself.
    """
    outcome.returns.append(RAISED)
    text = subject if isinstance(subject, str) else _callable(subject, "a function")(*args, **kwargs)
    if not isinstance(text, str) or not text.strip():
        outcome.returns[-1] = plain(text)
        return
    # Imported late, because it imports the stand-in for launch.
    from course_lib.grading.run.launching import launch

    outcome.returns[-1] = plain(launch(text).as_plain())


def run_node(make: Any) -> None:
    """Create the node or nodes and spin them.

    If the function returns None, it has spun them itself.
    """
    import rclpy
    from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
    from rclpy.node import Node
    from rclpy.signals import SignalHandlerOptions, uninstall_signal_handlers

    returned = _callable(make, "a node class")
    before = current_graph().nodes()
    # A function such as `main()` usually calls `rclpy.init()` itself.
    code = getattr(make, "__code__", None)
    if not (code is not None and "init" in code.co_names):
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    try:
        returned = returned()
        nodes = [returned] if isinstance(returned, Node) else list(returned or ())
        if nodes:
            executor = SingleThreadedExecutor()
            for node in nodes:
                executor.add_node(node)
            executor.spin()
        elif returned is None and current_graph().now_ns == START_NS and current_graph().nodes() == before:
            name = getattr(make, "__name__", "the function")
            raise CourseError(f"{name}() created no node, expected a class: class {name}(Node): …")
    except ExternalShutdownException:
        # The student's code called rclpy.shutdown(), which is a regular end.
        pass
    finally:
        uninstall_signal_handlers()


def _callable(subject: Any, expected: str) -> Callable[..., Any]:
    if not callable(subject):
        name = type(subject).__name__
        itself = "its name alone" if type(subject).__module__ == "builtins" else f"{name} itself"
        instead = f": pass {itself}, without ()"
        if isinstance(subject, str) and subject.isidentifier():
            instead = f": pass {subject} without quotes"
        raise CourseError(f"got an object of {name}, expected {expected}{instead}")
    function: Callable[..., Any] = subject
    return function


# The interrupt repeats after this time [s], for code that swallows the first one.
AGAIN = 1.0


class Watchdog:
    """A thread that interrupts a run after a time limit."""

    def __init__(self) -> None:
        self.has_fired = False
        self.line = ""  # location of a thread that was started during the run
        self._stopped = threading.Event()
        self._threads_before = set(threading.enumerate())

    def watch(self, seconds: float) -> None:
        """Interrupt after `seconds` of the wall clock, and repeat until the run is over."""
        while not self._stopped.wait(AGAIN if self.has_fired else seconds):
            self.has_fired = True
            for thread in set(threading.enumerate()) - self._threads_before - {threading.current_thread()}:
                self.line = self.line or line_of_thread(thread.ident or 0)
                end = ctypes.py_object(SystemExit)
                ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread.ident or 0), end)
            # A real signal also interrupts a wait for a lock.
            if hasattr(signal, "pthread_kill"):
                signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
            else:
                _thread.interrupt_main()

    def stop(self) -> None:
        """Stop the watchdog's thread."""
        self._stopped.set()


@contextmanager
def watchdog(seconds: float) -> Iterator[Watchdog]:
    """Raise KeyboardInterrupt in the main thread after `seconds`, and end threads started in the block."""
    dog = Watchdog()
    thread = threading.Thread(target=dog.watch, args=(seconds,), daemon=True)
    with _enable_interrupts():
        thread.start()
        try:
            yield dog
        finally:
            dog.stop()
            thread.join()


@contextmanager
def _enable_interrupts() -> Iterator[None]:
    """Raise KeyboardInterrupt on SIGINT even if it is ignored, as in programs started by `nohup` or `&`."""
    is_main = threading.current_thread() is threading.main_thread()
    if not is_main or signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        yield
        return
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.SIG_IGN)


MAX_PRINTED = 1_000_000  # limit on the characters of the output


class BoundedOutput(io.StringIO):
    """A stream that keeps MAX_PRINTED characters, so that endless loops do not fill the memory."""

    def write(self, text: str) -> int:
        """Append as much of the text as fits."""
        super().write(text[: max(0, MAX_PRINTED - self.tell())])
        return len(text)


def run_in_this_process(
    task: Task,
    scenario: Scenario,
    subject: Any,
    personal: Mapping[str, Any],
    *,
    wall_limit: float = WALL_LIMIT,
) -> Evidence:
    """Run a scenario in this process, and interrupt it after `wall_limit` [s] of the wall clock."""
    stage, outcome, output = ScenarioGraph(task, scenario, personal), Outcome(), BoundedOutput()
    stopped = ""
    with redirect_stdout(output), redirect_stderr(output), watchdog(wall_limit) as dog:
        try:
            perform(stage.instructions, subject, stage.graph, outcome)
        except KeyboardInterrupt as interrupt:
            if not dog.has_fired:
                raise
            # The next interrupt would end the check itself.
            dog.stop()
            stopped = "time"
            line = loop_of_traceback(interrupt.__traceback__) or dog.line
            outcome.errors.append(still_running_message(wall_limit, line))
    return stage.evidence(outcome, output=output.getvalue(), stopped=stopped)
