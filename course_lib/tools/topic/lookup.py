"""What the verbs of `ros2 topic` do alike: find a topic's type, and filter its messages."""

from collections.abc import Callable
from typing import Any

from course_lib.errors import CourseError
from course_lib.ros.messages import message_class
from course_lib.tools.sources import DISCOVERY, Source
from course_lib.tools.verb import Write


def full_name(topic: str) -> str:
    """Give a topic's name as the graph knows it."""
    return topic if topic.startswith("/") else f"/{topic}"


def type_of(source: Source, topic: str, write: Write, *, blocking: bool) -> str:
    """Find a topic's type; if it is not there yet, wait for it, as `hz`, `bw` and `delay` do.

    Raises:
        CourseError: There is no such topic, its type is not known here, or it has several.
    """
    if topic not in source.topics():
        if blocking or not source.live or source.graph.notebook:
            write(f"WARNING: topic [{topic}] does not appear to be published yet\n")
        if source.live and (blocking or not source.graph.notebook):
            source.wait(lambda: topic in source.topics(), source.limit() if blocking else DISCOVERY)
    types = source.topics().get(topic)
    if not types:
        raise CourseError(f"Could not determine the type for the passed topic. {topics_here(source)}")
    if len(types) > 1:
        found = ", ".join(types)
        raise CourseError(f"Cannot echo topic '{topic}', as it contains more than one type: [{found}]")
    message_class(types[0])  # says which type is not known
    return types[0]


def topics_here(source: Source) -> str:
    """Name the topics that there are, as a sentence."""
    return f"Topics here: {', '.join(source.topics()) or 'none'}."


def silence(source: Source, topic: str, since_ns: int) -> str:
    """Say how long nothing came on a topic."""
    seconds = (source.graph.now_ns - since_ns) * 1e-9
    return f"No message came on {topic} in {seconds:g} s of robot time."


def passes(expression: str | None) -> Callable[[Any], bool]:
    """Make a test for messages of a Python expression that calls them m.

    The test raises a CourseError if the expression fails.
    """
    if expression is None:
        return lambda _: True
    try:
        code = compile(expression, "--filter", "eval")
    except SyntaxError as error:
        raise CourseError(f"--filter {expression!r} is no Python expression: {error.msg}.") from error

    def test(message: Any) -> bool:
        try:
            return bool(eval(code, {"m": message}))
        except Exception as error:
            raise CourseError(f"--filter {expression!r} fails: {type(error).__name__}: {error}") from error

    return test
