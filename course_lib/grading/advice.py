"""Hints for a failed task: one for the cause, then further ones for students who remain stuck.

Some causes are slips that raise no error, which `slips.py` finds.
"""

import ast
import math
import re
import tomllib
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cache
from importlib import resources
from typing import Any

import numpy as np

from course_lib.course.exercise import code_cells, read_notebook
from course_lib.course.exercise import source as text_of
from course_lib.course.material import exercises_dir, first_lesson
from course_lib.errors import CourseError, format_count
from course_lib.export.module import without_magics
from course_lib.grading.caught_errors import CaughtErrors
from course_lib.grading.evidence import Evidence
from course_lib.grading.judge import NEEDS_ANOTHER
from course_lib.grading.kept_state import find_growing_list
from course_lib.grading.node_slips import find_slip, late_publishers
from course_lib.grading.records import TaskResult
from course_lib.grading.run.scenario import NO_NODE
from course_lib.grading.slips import IN_PLACE, UNREAD, Function, find_hidden_error, parse
from course_lib.grading.task import HINTS, Task, resolve
from course_lib.ros.messages import to_plain

MAX_PLACES = 3
# The maximum length of a call that is shown below failed checks, in characters.
LONGEST_CALL = 100
FILL_IN = (
    "Your code still stops at the line with raise NotImplementedError. Replace it with your own "
    "lines, or delete it when they are there, then check again."
)
NO_ID = (
    "Your student ID is not set, so your personal values are those of a guest. Enter it in the form in {}."
)
BETTER = "Better: this is worth more points than before."
_SNIPPET = re.compile(r"`([^`]+)`")
# Messages that RViz2 displays with its default Reliable, and that sensors do not publish.
RELIABLE_TYPES = ("visualization_msgs/msg/", "nav_msgs/msg/", "geometry_msgs/msg/", "vision_msgs/msg/")
SILENT = "nothing was published on an expected topic"
# Errors of a line that is right, because another line is wrong.
_VAGUE = ("InvalidHandle", "There is no display '/")
AFTER_AN_ERROR = (
    "Your code stopped with the error above. Fix that line first: the failed checks follow from it."
)
# Each call of a function is checked by itself, so that an error does not explain the others.
AFTER_AN_ERROR_IN_A_CALL = (
    "One call of your function stopped with the error above: fix that line. "
    "Other calls return a wrong value. "
)

# Kinds of mistakes that may be caused by a list that keeps the items of earlier calls, unless the
# task has its own hint for them. Old stamps are always a reason to look for such a list.
_OLD_ITEMS = {
    *("a stamp is in the past", "a stamp is not the expected one"),
    *("a level is wrong", "a status message lacks an expected word", "a message has more than one status"),
    *("too many messages on a topic", "a trajectory has the wrong number of points"),
    "the controller rejects the trajectory",
}
_SURPLUS = {
    "markers with the same ns and id replace each other",
    "a marker is twice in one array",
    "the count is wrong",
    "a topic shows more markers than the task asks for",
    "a path has the wrong number of poses",
    "the numbers of names and positions differ",
    "a joint is named more than once",
}

TOO_MUCH = (
    "Your code publishes far too much. Is each timer's period in seconds, and not 0? Does no "
    "callback publish on the topic that it subscribes to, or again and again in a loop?"
)


@cache
def hints_by_mistake() -> Mapping[str, str]:
    """Return the general hint for each kind of mistake. A * in a kind matches any text."""
    text = resources.files("course_lib.grading.vocabulary").joinpath("hints.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)


class Advice:
    """The hints that a student has seen, counted per task during the life of the kernel.

    A hint for the cause of the failure always comes first. The ladder of the task's own hints,
    whose last step is nearly the answer, is for students who are stuck: it advances only if a check
    fails for a cause of an earlier check, and no more checks pass than in the previous one. A
    student who fixes one mistake after another never sees it.
    """

    def __init__(self) -> None:
        self._before: dict[str, _TaskProgress] = {}
        # The causes of all earlier checks: a student may go back and forth between two mistakes.
        self._seen: set[tuple[str, tuple[str, ...]]] = set()
        self._steps: Counter[str] = Counter()

    def notes(
        self,
        task: Task,
        result: TaskResult,
        evidence: Sequence[Evidence],
        student: str | None,
        source: str,
        caught: CaughtErrors | None = None,
    ) -> list[str]:
        """Return the lines below a task's result: help after a failure, then remarks.

        Args:
            task: The task.
            result: The verdicts of the checks.
            evidence: The evidence of the public scenarios.
            student: The student's ID, if it is known.
            source: The student's code.
            caught: The errors that the student's code caught.
        """
        lines: list[str] = []
        if result.is_untouched:
            lines = [FILL_IN]
        elif task.scenarios and not result.passed:
            hints = self.hint(task, result, source, caught)
            incompatible = incompatible_policy_hint(evidence)
            # A mistake in the code that a handler of the student hides.
            hidden = caught.mistake if caught is not None else ""
            causes = (
                [f"Hint: {hidden}"] * bool(hidden)
                or parameter_order_hint(task, source)
                or missing_return_hint(task, evidence, source)
                or wrong_type_hint(evidence)
                or (bool(incompatible) and (_policy_as_depth(source) or incompatible))
                or missing_node_hint(evidence, source)
                or [*nan_hint(evidence), *hints]
            )
            lines = [*call_note(task, result, evidence), *causes]
        if task.personal and student is None:
            lines = [*lines, NO_ID.format(first_lesson())]
        lines += large_message_hint(evidence)
        lines += best_effort_hint(evidence)
        accepted = (wall_clock_hint, _policy_as_depth, _fixed_frame_slash, late_publishers)
        remarks = accepted if result.passed else ()
        return [*lines, *(line for remark in remarks for line in remark(source))]

    def hint(
        self,
        task: Task,
        result: TaskResult,
        source: str = "",
        caught: CaughtErrors | None = None,
    ) -> list[str]:
        """Return the lines of help for a failed result.

        Args:
            task: The task.
            result: The result of this check.
            source: The student's code. Hints that only suggest code that it already contains are
                skipped.
            caught: The errors that the student's code caught.
        """
        # The first failure that does not follow from another one.
        failing = (check for check in result.checks if not check.passed and check.mistake != NEEDS_ANOTHER)
        first = next(failing, None)
        causes = first.mistake.split("; ") if first is not None else []
        if result.errors:
            # The cell and the line change from run to run.
            causes = [re.sub(r" \((cell In\[\d+\], )?line \d+.*", "", result.errors[0], flags=re.DOTALL)]
        passed_count = sum(check.passed for check in result.checks)
        now, before = _TaskProgress(passed_count, result.fraction), self._before.get(task.id)
        self._before[task.id] = now
        is_new = (task.id, tuple(causes)) not in self._seen
        self._seen.add((task.id, tuple(causes)))
        code = Code(source)
        # rclpy calls a callback that is None itself, so that no line of the student's has failed.
        has_line = bool(result.errors) and bool(re.search(r"line \d", result.errors[0]))
        texts = [_hint_by_cause(task, cause) for cause in causes]
        # A run that exceeds a limit is stopped, and its error does not state the cause.
        too_much = bool(result.errors) and "exceed the limit of a submission" in result.errors[0]
        if too_much:
            texts = [TOO_MUCH]
        elif result.errors:
            texts = [AFTER_AN_ERROR if has_line else "The error above is the cause: begin with it."]
            # Mistakes of a call that returned nothing, which the error explains.
            missing = re.compile(rf"{NEEDS_ANOTHER}|a value is missing|there is no .*")
            failed_checks = (c.mistake for c in result.checks if not c.passed)
            wrong = (mistake for mistake in failed_checks if not missing.fullmatch(mistake))
            has_calls = any(len(scenario.calls) > 1 for scenario in task.scenarios)
            returned = next(wrong, "") if has_calls and has_line else ""
            if returned:
                texts = [AFTER_AN_ERROR_IN_A_CALL + _hint_by_cause(task, returned.split("; ")[0])]
        elif causes[:1] == [SILENT]:
            hidden = caught.other if caught is not None else ""
            own = _missing_call(code, result) or hidden or find_hidden_error(source)
            texts = [own or task.mistakes.get(SILENT) or _silence_hint(code), *texts]
        # Code that is stopped after its time has no other sign of the cause.
        too_long = bool(result.errors) and "is it an endless loop?" in result.errors[0]
        is_vague = bool(result.errors) and result.errors[0].startswith(_VAGUE)
        slip = find_slip(source) if too_much or too_long or is_vague or not has_line else ""
        if not slip and not result.errors:
            slip = _missing_subscription_hint(task, code) or _late_timer_hint(task, source)
        is_weak = slip.endswith("is it used?")
        if (not slip or is_weak) and (too_much or not result.errors):
            # A list that gets one item in each call is a reason only if a check found too many or
            # old items.
            failed = {
                kind for check in result.checks if not check.passed for kind in check.mistake.split("; ")
            }
            found_surplus = bool(failed & (_OLD_ITEMS | _SURPLUS - set(task.mistakes)))
            slip = find_growing_list(source, is_certain=not found_surplus) or slip
        # A message that is never sent has a better hint, the missing call.
        if causes[:1] == [SILENT] and (slip.endswith(UNREAD) or is_weak) and texts[0]:
            slip = ""
        best_hint = slip or next((text for text in texts if text and not code.has_code_of(text)), "")
        lines = [f"Hint: {best_hint}"] if best_hint else []
        if before is not None and (now.passed, now.fraction) > (before.passed, before.fraction):
            of = f"{now.passed} of {len(result.checks)}"
            better = (
                f"Better: {of} checks pass now, {before.passed} before."
                if passed_count > before.passed
                else BETTER
            )
            return [better, *lines]
        if not is_new or not lines:
            lines += self._next_step(task, code)
        return lines

    def _next_step(self, task: Task, code: "Code") -> list[str]:
        """Return the next of the task's step-by-step hints, or the last one again."""
        steps = [number for number, text in enumerate(task.hints, 1) if not code.has_code_of(text)]
        if not steps:
            return []
        later = [number for number in steps if number > self._steps[task.id]]
        step = self._steps[task.id] = later[0] if later else steps[-1]
        return [f"Hint {step} of {HINTS}: {task.hints[step - 1]}"]


@dataclass(frozen=True)
class _TaskProgress:
    """A student's progress at a check: the passed checks and the share of the points."""

    passed: int
    fraction: float


class Code:
    """A student's code, searchable for the code in a hint."""

    def __init__(self, source: str) -> None:
        tree = parse(source)
        self._nodes = list(ast.walk(tree))
        # A launch file is a string in the student's code, and is searched, too.
        texts = [node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)]
        inner = [parse(text) for text in texts if isinstance(text, str) and "\n" in text]
        self._expressions = set().union(*map(_expressions, [tree, *inner]))

    def has_call(self, method: str) -> bool:
        """Return whether the code calls a method, or passes it on to be called."""
        return any(isinstance(node, ast.Attribute) and node.attr == method for node in self._nodes)

    def mentions_topic(self, topic: str) -> bool:
        """Return whether a string in the code is the name of a topic, with or without the slash."""
        strings = (node.value for node in self._nodes if isinstance(node, ast.Constant))
        return any(isinstance(s, str) and s.strip("/") == topic.strip("/") for s in strings)

    def subscriptions(self) -> list[str]:
        """Return the topics of all subscriptions, or [] if one topic is not a string literal in the code."""
        topics = []
        for node in self._nodes:
            if isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "create_subscription":
                match node.args:
                    case [_, ast.Constant(value=str(topic)), *_]:
                        topics.append(topic)
                    case _:
                        return []
        return topics

    @property
    def is_plain_node(self) -> bool:
        """Whether the code is one class derived from Node, which inherits no publisher or timer."""
        bases = [
            ast.unparse(base) for node in self._nodes if isinstance(node, ast.ClassDef) for base in node.bases
        ]
        return bases == ["Node"]

    def has_code_of(self, hint: str) -> bool:
        """Return whether the code already contains the code that a hint has in backticks."""
        snippets = _SNIPPET.findall(hint)
        return bool(snippets) and all(self.has(snippet) for snippet in snippets)

    def has(self, snippet: str) -> bool:
        """Return whether the code contains each statement or expression of a snippet.

        The object whose attribute is set may have any name: `pose.position.z = 0.5` is found in
        `cube.pose.position.z = 0.5`.
        """
        tree = parse(snippet)
        expressions = [_expressions(statement, whole=True) for statement in getattr(tree, "body", ())]
        return bool(expressions) and all(
            any(
                part in self._expressions
                or (" = " in part and any(e.endswith(f".{part}") for e in self._expressions))
                for part in parts
            )
            for parts in expressions
        )


def _expressions(tree: ast.AST, *, whole: bool = False) -> set[str]:
    """Return the normalized source of each expression and assignment in a tree, or of one statement."""
    texts = set()
    for node in [tree] if whole else ast.walk(tree):
        if isinstance(node, ast.Assign):
            texts |= {f"{ast.unparse(target)} = {ast.unparse(node.value)}" for target in node.targets}
        elif isinstance(node, ast.keyword) and node.arg:
            texts.add(f"{node.arg} = {ast.unparse(node.value)}")
        elif isinstance(node, ast.Expr):
            texts.add(ast.unparse(node.value))
        elif isinstance(node, ast.expr | ast.stmt):
            texts.add(ast.unparse(node))
    return texts


def _missing_subscription_hint(task: Task, code: Code) -> str:
    """Return a hint if a node subscribes to none of the topics on which messages arrive, or ""."""
    inputs = {
        message.topic: None
        for scenario in task.scenarios
        for message in scenario.inputs
        if "/srv/" not in message.type_name
    }
    expected = [topic for topic in inputs if topic not in ("/tf", "/tf_static", "/clock")]
    topics = code.subscriptions()
    if not code.is_plain_node or not topics or len(expected) != 1:
        return ""
    if any(topic.startswith("~") or topic.strip("/") == expected[0].strip("/") for topic in topics):
        return ""
    return f"Your node subscribes to {' and '.join(topics)}, but the messages arrive on {expected[0]}."


def _late_timer_hint(task: Task, source: str) -> str:
    """Return a sentence about a timer that is due only after the longest scenario, or ""."""
    seconds = max((scenario.seconds for scenario in task.scenarios), default=0.0)  # [s]
    for node in ast.walk(parse(source)):
        match node:
            case ast.Call(func=ast.Attribute(attr="create_timer"), args=[period, callback, *_]):
                if 0 < seconds < (value := _constant_value(period)):
                    return (
                        f"The timer calls {ast.unparse(callback)} for the first time after "
                        f"{value:g} s, and the check runs for {seconds:g} s: a period is in "
                        "seconds, 0.1 for 10 times a second."
                    )
    return ""


def _constant_value(node: ast.expr) -> float:
    """Return the value of a number, a product or a quotient of numbers, or NaN."""
    match node:
        case ast.Constant(value=int() | float() as value):
            return float(value)
        case ast.BinOp(left=left, op=ast.Mult(), right=right):
            return _constant_value(left) * _constant_value(right)
        case ast.BinOp(left=left, op=ast.Div(), right=right) if _constant_value(right):
            return _constant_value(left) / _constant_value(right)
    return math.nan


def _missing_call(code: Code, result: TaskResult) -> str:
    """Return the call that is missing in a node that publishes nothing on a topic, or ""."""
    silent = (re.search(r"nothing was published on (\S+) in", check.message) for check in result.checks)
    topic = next((found[1] for found in silent if found), "")
    if not topic:
        return ""
    others = re.findall(r", only on (.+)", "\n".join(check.message for check in result.checks))
    for other in (", ".join(others)).split(", ") if code.mentions_topic(topic) else ():
        if other.endswith(topic):
            return (
                f"{topic.strip('/')!r} without a slash in front is a name inside the node's "
                f"namespace, here {other}: write {topic!r}, or leave out the namespace."
            )
    if code.has_call("create_publisher") and not code.mentions_topic(topic) and code.has_call("publish"):
        return f"No string in your code is {topic}: compare the name in create_publisher letter by letter."
    if not code.is_plain_node:
        return ""
    if not code.has_call("publish") and not code.has_call("sendTransform"):
        return "Your code never calls publish(): `self.publisher.publish(message)` sends a message."
    if not code.has_call("create_timer") and not code.has_call("create_subscription"):
        return "Nothing calls your method: in __init__, create a timer or a subscription that does."
    return ""


def _silence_hint(code: Code) -> str:
    """Return a suggestion for a node that publishes nothing, depending on its timers, or ""."""
    if not code.is_plain_node:
        return ""
    if not code.has_call("create_timer"):
        return (
            "Is your callback ever called, and does it get as far as publish()? Compare the topic "
            "in create_subscription letter by letter with the name in the task, then print "
            "something in the callback."
        )
    return (
        "Is your callback ever called, and does it get as far as publish()? Check that the timer's "
        "period is in seconds, then print something in the callback."
    )


def _hint_by_cause(task: Task, mistake: str) -> str:
    """Return the task's hint for a kind of mistake, else the general hint, else ""."""
    table = hints_by_mistake()
    # A kind that ends with a part of the value, "a value is
    # wrong: the gap", may have a hint of its own.
    if mistake not in task.mistakes and ": the " in mistake:
        mistake = mistake.partition(": the ")[0]
    general = table.get(mistake) or next((table[kind] for kind in table if fnmatchcase(mistake, kind)), "")
    return task.mistakes.get(mistake) or general


def call_note(task: Task, result: TaskResult, evidence: Sequence[Evidence]) -> list[str]:
    """Return a line with the call whose return value the first failed check judges.

    Students can run it in a cell of their own. A long call would hide the hints.
    """
    runs = zip(task.scenarios, evidence, strict=True)
    checks = [(scenario, run, check) for scenario, run in runs for check in scenario.checks]
    for (scenario, run, check), outcome in zip(checks, result.checks, strict=True):
        if outcome.passed or task.kind != "function" or check.origin is None:
            continue
        # The call of this check is right: only another check, which it requires, has failed.
        if outcome.mistake == NEEDS_ANOTHER:
            continue
        index = check.origin.arguments.get("call")
        if index is None or not (scenario.calls[index].args or scenario.calls[index].kwargs):
            return []
        args, kwargs = resolve((scenario.calls[index].args, scenario.calls[index].kwargs), run.personal)
        keywords = [f"{name}={_as_code(value)}" for name, value in kwargs.items()]
        call = f"{task.name}({', '.join([*map(_as_code, args), *keywords])})"
        return [f"The first failed check calls {call}"] if len(call) <= LONGEST_CALL else []
    return []


def _as_code(value: Any) -> str:
    """Return a plain value as Python writes it, with at most four decimals."""
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_as_code, value))}]"
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{key!r}: {_as_code(item)}' for key, item in value.items())}}}"
    return repr(round(value, 4) if isinstance(value, float) else value)


def missing_return_hint(task: Task, evidence: Iterable[Evidence], source: str = "") -> list[str]:
    """Return a hint about a missing return if a function ended normally and returned None."""
    ran = (record for record in evidence if not record.errors and not record.stopped)
    if task.kind in ("function", "launch") and any(
        returned is None for record in ran for returned in record.returns
    ):
        tree = parse(source)
        function = next((part for part in getattr(tree, "body", ()) if isinstance(part, Function)), None)
        returned = [node.value for node in own_returns(function)] if function is not None else []
        # A loop that `return` ends early is the cause then, and has its own hint.
        if find_slip(source).startswith("return ends the loop"):
            return []
        last = function.body[-1] if function is not None else None
        inner = [part for part in function.body if isinstance(part, Function)] if function is not None else []
        helpers = {part.name: part for part in getattr(tree, "body", ()) if isinstance(part, Function)}
        if not returned and inner:
            return [
                f"{task.name} returned None: the lines of def {inner[0].name} run only when they are "
                f"called. Write return {inner[0].name}(…) after them, or leave out the inner def."
            ]
        match last:
            case ast.Expr(value=ast.Call(func=ast.Name(id="print"))):
                return [f"{task.name} returned None: print shows a value, and return gives it to the caller."]
            case ast.Return(value=ast.Call(func=ast.Name(id="print"))):
                return [f"{task.name} returned None: print(…) returns nothing. Return the value itself."]
            case ast.Return(value=ast.Call(func=ast.Attribute(attr=name) as target)) if (
                all(returned) and name not in IN_PLACE
            ):
                call = ast.unparse(target)
                return [
                    f"{task.name} returned None: {call}(…) returns nothing. Call it on a line of "
                    "its own, then return the value."
                ]
        for value in returned:
            match value:
                case ast.Call(func=ast.Name(id=name)) if name in helpers and not any(
                    node.value for node in own_returns(helpers[name])
                ):
                    return [f"{task.name} returned None: {name} has no return with a value."]
        calls = [
            value.func.attr
            for value in returned
            if isinstance(value, ast.Call) and isinstance(value.func, ast.Attribute)
        ]
        for method in calls:
            if method in IN_PLACE:
                return [f"{task.name} returned None: {method}() changes its object, and returns nothing."]
        if any(returned):
            return [f"{task.name} returned None: does each path through it end with a return and a value?"]
        return [f"{task.name} returned None: is there a return?"]
    return []


def own_returns(function: ast.AST) -> Iterator[ast.Return]:
    """Yield the return statements of a function, without nested functions."""
    for node in ast.iter_child_nodes(function):
        if isinstance(node, ast.Return):
            yield node
        if not isinstance(node, Function | ast.Lambda | ast.ClassDef):
            yield from own_returns(node)


def parameter_order_hint(task: Task, source: str) -> list[str]:
    """Return a sentence about parameters whose number or order differs from the exercise, or []."""
    given = _released_parameters(task.week, task.name)
    tree = parse(source)
    for node in getattr(tree, "body", ()):
        is_class = isinstance(node, ast.ClassDef) and task.kind == "function"
        if is_class and getattr(node, "name", "") == task.name in given:
            return [
                f"Hint: {task.name} is a class here, and the task asks for a function: write "
                f"def {task.name}({', '.join(given[task.name])})."
            ]
        is_node = task.kind == "node" and getattr(node, "name", "") == task.name
        returned = any(one.value for one in own_returns(node))
        if is_node and isinstance(node, Function) and not returned:
            return [
                f"Hint: {task.name} is a function here that returns no node: write class "
                f"{task.name}(Node), with def __init__(self) and the callback in it."
            ]
        if isinstance(node, Function) and node.name == task.name in given:
            expected = given[task.name]
            most = len(node.args.posonlyargs) + len(node.args.args)
            if node.args.vararg is None and not most - len(node.args.defaults) <= len(expected) <= most:
                count = format_count(most, "parameter")
                return [
                    f"Hint: {task.name} has {count} here, and {len(expected) or 'none'} in the "
                    f"exercise: write def {task.name}({', '.join(expected)})."
                ]
    for node in ast.walk(tree):
        match node:
            case ast.Call(func=ast.Name(id=name), args=args) if expected := _released_parameters(
                task.week, name
            ).get(name, []):
                passed = [getattr(argument, "id", "") for argument in args]
                for parameter, own_name in zip(expected, passed, strict=False):
                    if own_name in expected and own_name != parameter and parameter not in passed:
                        return [
                            f"Hint: {name} gets {own_name} where its {parameter} belongs. Its "
                            f"parameters are ({', '.join(expected)})."
                        ]
    for name, own in _parameters(tree):
        expected = given.get(name, [])
        in_place = [name not in own or own.index(name) == place for place, name in enumerate(expected)]
        # Errors about a missing or surplus parameter have hints of their own.
        if len(own) == len(expected) and not all(in_place):
            return [
                f"Hint: The parameters of {name} are in a different order than in the exercise: "
                f"write def {name}({', '.join(expected)})."
            ]
    return []


def _parameters(tree: ast.AST) -> Iterator[tuple[str, list[str]]]:
    """Yield the name and the positional parameters of each function and each method."""
    for node in getattr(tree, "body", ()):
        if isinstance(node, Function):
            yield node.name, [argument.arg for argument in (*node.args.posonlyargs, *node.args.args)]
        elif isinstance(node, ast.ClassDef):
            yield from _parameters(node)


@cache
def _released_parameters(week: str, name: str) -> Mapping[str, list[str]]:
    """Return the parameters of a task's function, or of its class's methods, in the unchanged exercise."""
    try:
        notebook = read_notebook(exercises_dir() / f"{week}_exercise.ipynb")
    except CourseError:
        return {}
    for _, cell in code_cells(notebook):
        tree = parse(without_magics(text_of(cell)))
        body = [part for part in getattr(tree, "body", ()) if getattr(part, "name", "") == name]
        if body:
            return dict(_parameters(ast.Module(body, [])))
    return {}


def nan_hint(evidence: Iterable[Evidence]) -> list[str]:
    """Return a sentence that locates the first NaNs, or [].

    Only the last message of a topic is searched.
    """
    places: list[str] = []
    for record in evidence:
        for topic in {sample.topic: None for sample in record.samples if _may_hold_nan(sample.cdr)}:
            last = [to_plain(message) for _, message in record.messages(topic)[-1:]]
            places += (f"{place} on {topic}" for place in _nan_locations(last[0] if last else None, ""))
        places += (place for value in record.returns for place in _nan_locations(value, "the returned value"))
    named_places = list(dict.fromkeys(places))[:MAX_PLACES]
    cause = "a division 0 / 0, a root of a negative number, or a value that was never set?"
    return [f"NaN (not a number): {', '.join(named_places)}. Is it {cause}"] if named_places else []


def wrong_type_hint(evidence: Iterable[Evidence]) -> list[str]:
    """Return a sentence about the first topic that is subscribed to with another type, or []."""
    warnings = (re.search(r"Incompatible type on topic '(\S+)'", record.output) for record in evidence)
    topics = [matches[1] for matches in warnings if matches]
    return [
        f"Nothing arrives from {topic}: the type in create_subscription is not the one that is "
        "published there. Which type does the task name?"
        for topic in topics[:1]
    ]


def missing_node_hint(evidence: Iterable[Evidence], source: str) -> list[str]:
    """Return a sentence about a missing node whose parameters the scenario sets, or []."""
    ran = (record for record in evidence if not record.errors and not record.stopped)
    matches = [re.search(rf"{NO_NODE} (/\w+)", record.output) for record in ran]
    text = ""
    for node in ast.walk(parse(source)):
        match node:
            case ast.Call(
                func=ast.Attribute(attr="__init__", value=ast.Call()), args=[ast.Constant(value=name), *_]
            ):
                text = f", which here is {name!r}"
                break
    return [
        f"Hint: ros2 param set finds no node {match[1]}. Compare the name in super().__init__{text}."
        for match in matches[:1]
        if match
    ]


# Policies that a subscription requests and a publisher does not offer, with the value to pass
# instead.
_POLICIES = {
    "RELIABILITY": "it is published with Best Effort, and your subscription requests Reliable, as "
    "each number like 10 does. Pass qos_profile_sensor_data",
    "DURABILITY": "it is published as Volatile, and your subscription requests Transient Local. "
    "Pass a number like 10",
}


def incompatible_policy_hint(evidence: Iterable[Evidence]) -> list[str]:
    """Return a sentence about the first topic of which a subscription receives nothing, or []."""
    warning = r"New publisher discovered on topic '(\S+)', offering incompatible QoS\..* policy: (\w+)"
    found = (re.search(warning, record.output) for record in evidence)
    return [
        f"Hint: Nothing arrives from {match[1]}: {_POLICIES[match[2]]} as the last argument of "
        "create_subscription."
        for match in found
        if match and match[2] in _POLICIES
    ][:1]


def large_message_hint(evidence: Iterable[Evidence]) -> list[str]:
    """Return a sentence about the topic whose large messages take most of the time, or []."""
    descriptions = [record.large_message for record in evidence if record.large_message]
    advice = "and each message must be built, sent and checked. Are that many points needed?"
    return [f"This took long: {text}, {advice}" for text in descriptions[:1]]


def best_effort_hint(evidence: Iterable[Evidence]) -> list[str]:
    """Return a sentence about a topic that RViz2 would not display, because it is published as Best Effort.

    Images and scans are often best effort, so that tasks with sensors intend it. A trajectory as
    Best Effort is not accepted: no controller receives it.
    """
    for sample in (sample for record in evidence for sample in record.samples):
        if sample.qos.reliability == "best_effort" and sample.type_name.startswith(RELIABLE_TYPES):
            return [
                f"Here the checks accept that {sample.topic} is published with Best Effort. On ROS "
                "2, the displays of RViz2 request Reliable and would receive nothing: pass a "
                "number like 10 as the last argument of create_publisher."
            ]
    return []


def wall_clock_hint(source: str) -> list[str]:
    """Return a sentence about the computer's clock in a node, or []."""
    tree = parse(source)
    imports = [node for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)]
    # `import time as t` and `from time import time as now` give a clock another name.
    modules = {
        name.asname or name.name: f"{getattr(node, 'module', '') or ''}.{name.name}".strip(".")
        for node in imports
        for name in node.names
    }
    for outer in ast.walk(tree):
        for node in ast.walk(outer) if isinstance(outer, ast.ClassDef) else ():
            called = ast.unparse(node.func) if isinstance(node, ast.Call) else ""
            first, dot, rest = called.partition(".")
            if re.fullmatch(_WALL_CLOCK, f"{modules.get(first, first)}{dot}{rest}"):
                return [
                    # The computer's clock and the robot's agree as long as no simulation runs.
                    f"Here the checks accept {called}(), but with a simulation or a bag "
                    "it is another time than self.get_clock().now()."
                ]
    return []


def _policy_as_depth(source: str) -> list[str]:
    """Return a sentence about a policy that is passed where the queue depth belongs, or []."""
    for node in ast.walk(parse(source)):
        match node:
            case ast.Call(
                func=ast.Attribute(attr="create_publisher" | "create_subscription"), args=[*_, last]
            ):
                policy = re.search(r"\b([A-Z]\w+)Policy\.[A-Z_]+$", ast.unparse(last))
                if policy:
                    return [
                        f"{policy[0]} is a number, which ROS takes as the queue depth. To set a "
                        f"policy, pass QoSProfile(depth=10, {policy[1].lower()}={policy[0]})."
                    ]
    return []


def _fixed_frame_slash(source: str) -> list[str]:
    """Return a sentence about a fixed frame with a slash in front, or []."""
    for node in ast.walk(parse(source)):
        match node:
            case (
                ast.keyword(arg="fixed_frame", value=value)
                | ast.Assign(targets=[ast.Attribute(attr="fixed_frame")], value=value)
            ) if re.match(r"f?['\"]/", ast.unparse(value)):
                return [
                    f"Viewer removes the slash in front of the fixed frame {ast.unparse(value)}. "
                    "Frames of tf2 have none: leave it out, also in RViz2."
                ]
    return []


# Functions that return the computer's time instead of the node's time.
_WALL_CLOCK = (
    r"time\.(time|time_ns|monotonic|perf_counter)|(datetime\.)?datetime\.(now|utcnow)|"
    r"(rclpy\.clock\.)?Clock\(.*\)\.now"
)


def _may_hold_nan(cdr: bytes) -> bool:
    """Return whether some bytes, interpreted as floating-point numbers, are NaN.

    This filter is fast; decoding and searching a million points takes seconds.
    """
    # Numbers are aligned relative to the end of the CDR header.
    body = cdr[4:]
    doubles, floats = (np.frombuffer(body[: len(body) // size * size], f"<f{size}") for size in (8, 4))
    return bool(np.isnan(doubles).any() or np.isnan(floats).any())


def _nan_locations(value: Any, path: str) -> Iterator[str]:
    if isinstance(value, float) and math.isnan(value):
        yield path.removeprefix(".")
    elif isinstance(value, dict):
        for key, item in value.items():
            yield from _nan_locations(item, f"{path}.{key}")
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from _nan_locations(item, f"{path}[{index}]")
