"""Outputs that refactoring must not change, one text per part.

The parts are what users, marks and files depend on. `python -m tests.golden` prints where the code
now differs from the kept files in `data/`, and `python -m tests.golden --write` renews them.
"""

import ast
import hashlib
import io
import os
import re
import tempfile
import tomllib
from collections.abc import Callable, Iterable, Iterator
from contextlib import redirect_stderr
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from course_lib.authoring.edits import Edit, group_edits, make_edits, operators, read_answers
from course_lib.authoring.rehearsal import rehearse
from course_lib.course.exercise import exercise_path
from course_lib.course.material import solutions_dir
from course_lib.displays.registry import PACKAGE, REGISTRY
from course_lib.displays.writer import save_rviz
from course_lib.errors import CourseError
from course_lib.grading.records import TaskResult
from course_lib.grading.store import this_course
from course_lib.recording import Recording, read_bag
from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.ros.messages import RosMessage, message_class, serialize
from course_lib.ros.messages.definitions import type_hash, type_names
from course_lib.ros.time.driving import running_nodes
from course_lib.tools.ros2 import ros2
from course_lib.tools.sources import GraphSource
from tests import test_public_layouts as layouts
from tests import test_seed_programs as seeds
from tests.displays.bench import Bench
from tests.displays.samples import messages
from tests.golden import robot
from tests.notebooks.graded import WEEKS, cells_of, judged, run_of, solution

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
DIGITS = 12  # of a digest: enough to notice a change
GOAL_ID = re.compile(r"\b[0-9a-f]{32}\b")
DECIMALS = 5  # of numbers in messages: processors differ in the last bits


class Part(NamedTuple):
    """One file of `data/`.

    Args:
        make: Yields its lines.
        is_slow: Whether it takes more than a few seconds.
    """

    make: Callable[[], Iterable[str]]
    is_slow: bool = False


def digest(*content: str | bytes) -> str:
    """Return the first digits of the SHA-256 of some content."""
    total = hashlib.sha256()
    for part in content:
        total.update(part.encode() if isinstance(part, str) else part)
    return total.hexdigest()[:DIGITS]


def rounded(value: Any) -> str:
    """Return a message field as a string in which numbers are rounded."""
    if isinstance(value, RosMessage):
        return "".join(rounded(getattr(value, name)) for name in value.get_fields_and_field_types())
    if isinstance(value, np.ndarray) and value.dtype.kind == "f":
        # Adding zero turns -0.0 into 0.0.
        return digest((np.round(value.astype(np.float64), DECIMALS) + 0.0).tobytes())
    if isinstance(value, dict):
        return rounded(list(value.items()))
    if isinstance(value, list | tuple):
        return "".join(rounded(item) for item in value)
    if isinstance(value, float):
        return repr(round(value, DECIMALS) + 0.0)
    return digest(bytes(value)) if isinstance(value, np.ndarray) else repr(value)


def recording_lines(recording: Recording) -> Iterator[str]:
    """Yield a line for each topic of a recording: type, number of messages and their digest."""
    for topic in recording.topics():
        stamped = [f"{stamp} {rounded(message)}" for stamp, message in recording.messages(topic.name)]
        yield f"  {topic.name} [{topic.type_name}] {topic.count} messages, {digest(*stamped)}"


def message_lines() -> Iterator[str]:
    """Yield each message type with its hash and the digest of a default message's CDR bytes."""
    for name in sorted(type_names()):
        if name.split("/")[1] == "msg":
            yield f"{name} {type_hash(name)} {digest(serialize(message_class(name)()))}"


def ros2_lines() -> Iterator[str]:
    """Yield the output of each command of inputs/ros2_commands.txt over the nodes of robot.py."""
    commands = (HERE / "inputs" / "ros2_commands.txt").read_text("utf-8").splitlines()
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as folder, use_graph(Graph(notebook=True)) as graph:
        os.chdir(folder)
        try:
            running_nodes().extend(robot.start())
            for command in commands:
                if not command.startswith("#"):
                    yield f"$ ros2 {command}"
                    output = ros2_output(graph, command).replace(folder, "FOLDER").replace(str(ROOT), "ROOT")
                    yield GOAL_ID.sub("GOAL_ID", output)
        finally:
            os.chdir(before)


def ros2_output(graph: Graph, command: str) -> str:
    """Return what a command writes to stderr, then its output, followed by its error."""
    words, brace, rest = command.partition("{")
    written: list[str] = []
    try:
        with redirect_stderr(io.StringIO()) as stderr:
            ros2([*words.split(), *([brace + rest] if brace else [])], GraphSource(graph), written.append)
    except (CourseError, SystemExit) as error:
        written.append(f"{type(error).__name__}: {error}")
    return (stderr.getvalue() + "".join(written)).rstrip("\n")


def status_lines() -> Iterator[str]:
    """Yield the statuses of each display: without messages, with messages, and in an unknown frame."""
    for name in sorted(REGISTRY):
        bench = Bench()
        has_topic = any(prop.label == "Topic" for prop in REGISTRY[name].properties)
        bench.session.add(name, "it", {"Topic": "/t/image"} if has_topic else {})
        for moment in ("no message", "a message", "its frame is known"):
            if moment == "a message":
                for topic, message in messages(name, 1):
                    bench.publish(topic, message, 0.1)
            elif moment == "its frame is known":
                bench.transform("map", "arm")
                for topic, message in messages(name, 2):
                    bench.publish(topic, message, 0.2)
            bench.update(0.3)
            rows = [row for row in bench.session.rows() if row.display in ("it", "Global Status")]
            yield f"{name}, {moment}:"
            yield from (f"  {row.display} | {row.name} | {row.level} | {row.text}" for row in rows)


def property_lines() -> Iterator[str]:
    """Yield the message type of each of RViz's displays, and its properties with their defaults, in order."""
    # Displays that other tests have registered are left out.
    for name, display in sorted(item for item in REGISTRY.items() if item[0].startswith(f"{PACKAGE}/")):
        yield f"{name} [{getattr(display, 'type_name', '')}]"
        yield from (f"  {prop.label} = {prop.default!r}" for prop in display.properties)


def layout_lines() -> Iterator[str]:
    """Yield each layout of the course and of tests/data with the digest of the saved file."""
    own = sorted(path for room in ("exercises", "tests/data") for path in (ROOT / room).rglob("*.rviz"))
    with tempfile.TemporaryDirectory() as folder:
        for path in own:
            saved = Path(folder) / "saved.rviz"
            session = layouts.opened(path)
            save_rviz(session, saved)
            yield f"{path.relative_to(ROOT).as_posix()} {digest(saved.read_bytes())}"
            yield from (f"  {row.display} | {row.name} | {row.level} | {row.text}" for row in session.rows())


def seed_lines() -> Iterator[str]:
    """Yield the topics of the seed programs' recordings."""
    with tempfile.TemporaryDirectory() as folder:
        for name in (*seeds.PROGRAMS, "PerceptionDashboard"):
            program = Path(folder) / f"{name}.py"
            program.write_text(seeds.program(name), encoding="utf-8")
            bag = Path(folder) / name
            seeds.run(bag, program)
            yield f"{name}:"
            yield from recording_lines(read_bag(bag))


def answer_lines() -> Iterator[str]:
    """Yield the evidence of each week's solution and stub, and the points of all stored answers."""
    for week in WEEKS:
        answers = {"solution": solution(week), "stub": exercise_path(solution(week))}
        answers |= {path.stem: path for path in sorted((solutions_dir() / "answers").glob(f"{week}_*.py"))}
        for name, path in answers.items():
            yield f"{week}, {name}:"
            marked = run_of(path)
            for one in marked.runs if name == "solution" else ():
                returned = digest(rounded(one.evidence.returns))
                yield f" {one.evidence.task}, {one.scenario.name}: returned values {returned}"
                yield from recording_lines(one.evidence.recording)
            yield from result_lines(marked.judgement.tasks, with_checks=name != "stub")
        yield from edit_lines(week)


def result_lines(results: Iterable[TaskResult], *, with_checks: bool = True) -> Iterator[str]:
    """Yield the points of tasks and the checks that failed."""
    for result in results:
        yield f" {result.task}: {result.score:g} of {result.points:g} points"
        failed = [check for check in result.checks if not check.passed] if with_checks else []
        yield from (f"  {check.scenario}: {check.title}: {check.message}" for check in failed)


def edit_lines(week: str) -> Iterator[str]:
    """Yield the points of the wrong answers and mutants of a week."""
    course = this_course()
    tasks = judged(week)
    answers = read_answers(course.solutions, week)
    cells = cells_of(solution(week))
    edits = [e for e in make_edits(tasks, answers, cells, operators(course.solutions)) if isinstance(e, Edit)]
    for group, rehearsal in group_edits(edits, cells, week):
        results = {result.task: result for result in rehearse(rehearsal, course).results}
        for edit in group:
            yield f"{week}, {edit.name}:"
            yield from result_lines([results[edit.task]])


def text_lines() -> Iterator[str]:
    """Yield every text of an error, an option's help and a hint, sorted, so that moved code changes nothing.

    A `{…}` stands for a value. `CourseError` and its subclasses are found by the names that raise them.
    """
    texts = {text for path in (ROOT / "course_lib").rglob("*.py") for text in python_texts(path)}
    for path in (ROOT / "course_lib").rglob("*hints.toml"):
        texts |= set(strings_in(tomllib.loads(path.read_text("utf-8"))))
    yield from sorted(text.replace("\n", "\\n") for text in texts)


def python_texts(path: Path) -> Iterator[str]:
    """Yield the texts of a module's exceptions and of its `help` arguments."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call) and node.exc.args:
            yield from literal(node.exc.args[0])
        elif isinstance(node, ast.Call):
            for keyword in node.keywords:
                if keyword.arg == "help":
                    yield from literal(keyword.value)


def literal(node: ast.expr) -> Iterator[str]:
    """Yield the text of a string or an f-string, with `{…}` for each replacement field."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        yield node.value
    elif isinstance(node, ast.JoinedStr):
        yield "".join(str(v.value) if isinstance(v, ast.Constant) else "{…}" for v in node.values)


def strings_in(value: Any) -> Iterator[str]:
    """Yield all strings inside dicts and lists."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict | list):
        for item in value.values() if isinstance(value, dict) else value:
            yield from strings_in(item)


PARTS = {
    "answers": Part(answer_lines, is_slow=True),
    "layouts": Part(layout_lines),
    "messages": Part(message_lines),
    "properties": Part(property_lines),
    "ros2": Part(ros2_lines),
    "seeds": Part(seed_lines, is_slow=True),
    "statuses": Part(status_lines),
    "texts": Part(text_lines),
}


def text_of(name: str) -> str:
    """Return the text of a part that the current code generates."""
    return "\n".join(PARTS[name].make()) + "\n"


def kept_file(name: str) -> Path:
    """Return the file in which a part is stored."""
    return HERE / "data" / f"{name}.txt"
