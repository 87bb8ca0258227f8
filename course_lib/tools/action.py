"""`ros2 action list|info|type|send_goal`."""

import sys
from argparse import Namespace
from typing import Any, Literal

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.interrupts import until_interrupted
from course_lib.ros.messages import RosMessage, action_class, type_name
from course_lib.ros.messages.conversions import Style, to_yaml
from course_lib.tools.message_yaml import check_type, fill, kind_of
from course_lib.tools.sources import Source, answer, own_node
from course_lib.tools.verb import (
    NODE_OPTIONS,
    Verb,
    Write,
    count,
    flag,
    show_types,
    type_verb,
    value,
    write_names,
)

GOAL_LIMIT = 60.0  # [s] for a goal to come to its end, if nobody can press ■


def _list_all(source: Source, arguments: Namespace, write: Write) -> None:
    write_names(_actions(source), arguments, write)


def _info(source: Source, arguments: Namespace, write: Write) -> None:
    name = arguments.action_name
    write(f"Action: {name}\n")
    nodes = {node.id: node.full_name for node in source.graph.nodes()}
    sides: tuple[tuple[str, Literal["pub", "sub"]], ...] = (("clients", "sub"), ("servers", "pub"))
    for title, kind in sides:
        ends = source.endpoints(f"{name}/_action/feedback", kind)
        write(f"Action {title}: {len(ends)}\n")
        for end in () if arguments.count else ends:
            shown = f" [{end.type_name.removesuffix('_FeedbackMessage')}]" if arguments.show_types else ""
            write(f"    {nodes[end.node]}{shown}\n")


def _send_goal(source: Source, arguments: Namespace, write: Write) -> None:
    """Send a goal and wait for its end; ■ cancels it."""
    from rclpy.action import ActionClient

    kind, name = kind_of(action_class, arguments.action_type, "action"), arguments.action_name
    goal = kind.Goal()
    fill(goal, sys.stdin.read() if arguments.stdin else arguments.goal)
    there = _actions(source)
    check_type(name, type_name(kind.Goal).removesuffix("_Goal"), there)
    with until_interrupted(), own_node(source) as node:
        client = ActionClient(node, kind, name)
        node.add_waitable(client)
        write("Waiting for an action server to become available...\n")
        if not source.wait(client.server_is_ready, source.limit()):
            raise CourseError(f"Nobody serves the action '{name}'{did_you_mean(name, there) or '.'}")
        write(f"Sending goal:\n     {_text(goal)}\n")

        def show(message: Any) -> None:
            write(f"Feedback:\n    {_text(message.feedback)}\n")

        sent = client.send_goal_async(goal, show if arguments.feedback else None)
        handle = answer(source, sent, name, source.limit())
        if handle.accepted:
            write(f"Goal accepted with ID: {bytes(handle.goal_id.uuid).hex()}\n\n")
            _wait_for_the_end(source, handle, write)
        else:
            write("Goal was rejected.\n")


def _wait_for_the_end(source: Source, handle: Any, write: Write) -> None:
    from rclpy.action.server_goal_handle import STATES

    future = handle.get_result_async()
    try:
        result = answer(source, future, "The action", source.limit(GOAL_LIMIT))
        write(f"Result:\n    {_text(result.result)}\nGoal finished with status: {STATES[result.status]}\n")
    finally:
        if not future.arrived() and not source.graph.ended:
            write("Canceling goal...\n")
            response = answer(source, handle.cancel_goal_async(), "The action", source.limit())
            write("Goal canceled.\n" if response.goals_canceling else "Failed to cancel goal\n")


def _text(message: RosMessage) -> str:
    return to_yaml(message, Style(truncate=None))


def _actions(source: Source, with_hidden: bool = True) -> dict[str, list[str]]:
    from rclpy.impl.graph_queries import actions

    return dict(actions(source.graph.endpoints()))


_NAME = value("action_name", help="Name of the ROS action (e.g. '/fibonacci')")
_SHOW = show_types("action")
_COUNT = flag("-c", "--count", help="Only display the number of action clients and action servers")
_SEND = (
    value("action_type", help="Type of the ROS action (e.g. 'example_interfaces/action/Fibonacci')"),
    value("goal", nargs="?", default="{}", help="Goal request values in YAML format (e.g. '{order: 10}')"),
    flag("--stdin", help="Read goal from standard input"),
    flag("-f", "--feedback", help="Echo feedback messages for the goal"),
)
_LIST = (*NODE_OPTIONS, _SHOW, count("action"))
ACTION_VERBS = (
    Verb("action", "list", "Output a list of action names", _LIST, _list_all),
    type_verb("action", "Print a action's type", _actions, _NAME),
    Verb("action", "info", "Print information about an action", (*NODE_OPTIONS, _NAME, _SHOW, _COUNT), _info),
    Verb("action", "send_goal", "Send an action goal", (*NODE_OPTIONS, _NAME, *_SEND), _send_goal),
)
