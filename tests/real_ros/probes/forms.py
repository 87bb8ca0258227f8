# mypy: ignore-errors
"""ROS arguments in all their forms, of a node and of its context."""

from typing import Any

from probing import lines, main
from rclpy.context import Context
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Trigger

REMAPS = {
    "topic": "chatter:=other",
    "absolute": "/chatter:=/abs",
    "relative_to_absolute": "chatter:=/abs",
    "private": "~/p:=q",
    "private_to_private": "~/p:=~/q",
    "node": "__node:=renamed",
    "name": "__name:=renamed",
    "namespace": "__ns:=/space",
    "relative_namespace": "__ns:=space",
    "only_of_the_node": "n:chatter:=other",
    "only_of_another_node": "m:chatter:=other",
    "name_of_the_node": "n:__node:=z",
    "namespace_of_the_node": "n:__ns:=/z",
    "all": "*:=x",
    "one_token": "/*/chatter:=/x",
    "any_tokens": "/**/chatter:=/x",
    "token_that_is_used": "/(*)/chatter:=/x/\\1",
    "of_topics": "rostopic://chatter:=t",
    "of_services": "rosservice://serve:=s",
    "topic_as_service": "rosservice://chatter:=s",
    "service": "serve:=s",
    "to_nothing": "chatter:=",
    "from_nothing": ":=x",
    "equals_sign": "chatter=x",
    "two_assignments": "a:=b:=c",
    "space": "chatter:=a b",
    "digit": "chatter:=1a",
    "slash_at_the_end": "chatter:=a/",
    "two_slashes": "chatter:=a//b",
    "two_slashes_in_front": "chatter//x:=a",
    "tilde_in_the_middle": "chatter:=a/~b",
    "slash_in_a_node_name": "__node:=a/b",
    "digit_in_a_node_name": "__node:=1a",
    "digit_in_a_namespace": "__ns:=/1a",
    "root_namespace": "__ns:=/",
    "substitution_in_the_name": "{node}/p:=q",
    "substitution": "chatter:={node}/x",
}
ARGUMENTS = {
    **{name: ["-r", rule] for name, rule in REMAPS.items()},
    "long_flag": ["--remap", "chatter:=other"],
    "name_and_namespace": ["-r", "__node:=x", "-r", "__ns:=/y"],
    "first_of_two": ["-r", "chatter:=a", "-r", "chatter:=b"],
    "no_chain": ["-r", "chatter:=a", "-r", "a:=b"],
    "nothing": [],
    "after_the_end": ["-r", "chatter:=x", "--", "-r", "chatter:=y"],
    "before_the_end": ["--", "chatter:=y", "--ros-args", "-r", "chatter:=x"],
    "again": ["-r", "chatter:=x", "--", "--ros-args", "-r", "chatter:=y"],
    "no_rule": ["-r"],
    "parameter_and_rule": ["-p", "a:=1", "-r", "chatter:=x"],
    "level": ["--log-level", "debug"],
    "level_of_a_logger": ["--log-level", "n:=debug"],
    "level_of_rcl": ["--log-level", "rcl:=warn"],
    "unknown_option": ["--foo"],
    "unknown_flag": ["-x"],
    "positional": ["foo"],
    "no_file": ["--params-file"],
    "no_parameter": ["-p"],
    "parameter_without_a_value": ["-p", "a"],
}
VALUES = (
    "",
    "[1,2]",
    "5",
    "null",
    "'1'",
    "1e3",
    "0x10",
    "1_000",
    "on",
    "yes",
    ".5",
    "-.inf",
    "~",
    "a b",
    "[]",
)


def _names(node: Node) -> Any:
    """Return the names of a node and of its endpoints."""
    publishers = [node.create_publisher(String, name, 1) for name in ("chatter", "~/p")]
    service = node.create_service(Trigger, "serve", lambda request, response: response)
    return [
        node.get_fully_qualified_name(),
        *(publisher.topic_name for publisher in publishers),
        service.service_name,
        node.resolve_topic_name("x/chatter"),
        node.resolve_service_name("chatter"),
        node.resolve_topic_name("chatter", only_expand=True),
        node.get_logger().name,
    ]


def _of_node(words: Any, **options: Any) -> Any:
    return _names(Node("n", cli_args=["--ros-args", *words], **options))


def _of_context(words: Any) -> Any:
    context = Context()
    context.init(args=["program", "--ros-args", *words])
    try:
        return _names(Node("n", context=context)), _names(
            Node("m", context=context, use_global_arguments=False)
        )
    finally:
        context.try_shutdown()


def _override(rule: Any) -> Any:
    node = Node("n", cli_args=["--ros-args", "-p", rule])
    return [(name, value.type_.name, value.value) for name, value in node._parameter_overrides.items()]


for _name, _words in ARGUMENTS.items():
    lines(
        "arguments",
        **{
            f"{_name}_of_a_node": lambda words=_words: _of_node(words),
            f"{_name}_without_those_of_the_context": lambda words=_words: _of_node(
                words, use_global_arguments=False, namespace="/own"
            ),
            f"{_name}_of_a_context": lambda words=_words: _of_context(words),
        },
    )
for _name in ("a", "n:a", "m:a", "a.b", "/**:a", "*:a", "ns/n:a"):
    lines("override", **{_name: lambda name=_name: _override(f"{name}:=5")})
for _value in VALUES:
    lines("value", **{_value or "nothing": lambda value=_value: _override(f"a:={value}")})

if __name__ == "__main__":
    main()
