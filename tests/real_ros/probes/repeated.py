# mypy: ignore-errors
"""Values, names and maps that occur twice on a command line or in a parameter file."""

import re
import tempfile
from typing import Any

import rclpy
from probing import captured, lines, main, outcome
from rclpy.node import Node
from std_msgs.msg import String

_ALWAYS = ("start_type_description_service", "use_sim_time")


def _names_and_values() -> Any:
    node = Node("n", automatically_declare_parameters_from_overrides=True)
    topic = node.create_publisher(String, "t", 1).topic_name
    values = {name: one.value for name, one in node.get_parameters_by_prefix("").items()}
    return (
        node.get_fully_qualified_name(),
        topic,
        sorted((k, v) for k, v in values.items() if k not in _ALWAYS),
    )


def args(*words: Any) -> Any:
    """Return a probe of a command line: names, values of parameters, and the lines of rcl."""

    def call() -> Any:
        rclpy.shutdown()
        raised, printed = captured(lambda: (rclpy.init(args=["x", *words]), None)[1])
        logged = [re.sub(r"\[\d+\.\d+\]", "[T]", line) for line in printed.splitlines()]
        # The text of an error ends the outcome, so that it comes last.
        return logged, _names_and_values() if raised == "None" else raised

    return call


def with_file(text: Any, *words: Any) -> Any:
    """Return a probe of a command line with a parameter file instead of the word FILE."""

    def call() -> Any:
        with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
            file.write(text)
            file.flush()
            found = args("--ros-args", *[file.name if word == "FILE" else word for word in words])()
            return re.sub(r"/tmp/\w+", "F", outcome(lambda: found))

    return call


NAMESPACES = ("a", "", "/a b", "/a-b", "~", "/", "a/b", "/a//b", "/1a", "//a", "*", "/a{b}", ":", "~/a")
NODES = ("", "b-", "-b", "1a", "/a", "a b", "~", "a/b", "{a}")
for flags, title in (((), "old"), (("--ros-args", "-r"), "new")):
    lines(f"{title}.namespace", **{name: args(*flags, f"__ns:={name}") for name in NAMESPACES})
    lines(f"{title}.node", **{name: args(*flags, f"__node:={name}") for name in NODES})
OLD = ("n:__ns:=a", "__name:=1a", "rostopic://__ns:=/a")
lines("old.other", **{rule: args(rule) for rule in OLD})

PAIRS = (
    *(("1", "2.5"), ("2.5", "1"), ("x", "true"), ("true", "x")),
    *(("1", "[1]"), ("[1]", "1"), ("[1]", "[x]")),
    *(("[x]", "[1]"), ("[true]", "[1]"), ("1.5", "[1]")),
    *(("1", "'1'"), ("0x10", "1.5"), ("[1, 2]", "[3]")),
    *(("1", "{b: 1}"), ("{b: 1}", "1"), ("{b: 1}", "{c: 2}")),
    *(("1", "~"), ("1", ""), ("", "1"), ("1", "[]")),
    *(("[]", "1"), ("[]", "[]"), ("[1]", "[]"), ("{}", "1")),
    *(("1", "{}"), ("{}", "{}"), ("{b: x}", "{b: 1}")),
)
HEAD = "n:\n  ros__parameters:\n"
lines(
    "values",
    **{
        f"{first} {last}": with_file(f"{HEAD}    a: {first}\n    a: {last}\n", "--params-file", "FILE")
        for first, last in PAIRS
    },
)
MAPS = {
    "nested": "    a: {b: {}}\n    c: 1\n",
    "nested_with_more": "    a: {b: {}, d: 2}\n    c: 1\n",
    "before_a_list": "    a: {}\n    b: [1]\n",
    "before_maps": "    x: 1\n    a: {}\n    b: {c: {d: 1}}\n",
    "deep": "    x: {y: {z: {}}}\n    b: 1\n",
    "before_a_node": "    b: 1\n    a: {}\nm:\n  ros__parameters:\n    b: 1\n",
    "before_the_node": "    b: [1]\n    a: {}\nn:\n  ros__parameters:\n    a: 1\n",
    "two_lists": "    a: 1\n  ros__parameters:\n    b: 2\n",
    "two_nodes": f"    a: 1\n{HEAD}    a: x\n",
    "two_documents": f"    a: x\n---\n{HEAD}    a: 1\n",
    "dots": "    a.b: x\n    a: {b: 2}\n",
}
files = {name: with_file(HEAD + text, "--params-file", "FILE") for name, text in MAPS.items()}
lines("maps", **files)
ENTRY = "{}:\n  ros__parameters:\n    a: 1\n"
for name in ("/**", "n", "/*"):
    file = ("--params-file", "FILE")
    lines(
        f"entry.{name}",
        argument_first=with_file(ENTRY.format(name), "-p", "a:=7", *file),
        argument_last=with_file(ENTRY.format(name), *file, "-p", "a:=7"),
        of_node_first=with_file(ENTRY.format(name), "-p", "n:a:=7", *file),
        of_node_last=with_file(ENTRY.format(name), *file, "-p", "n:a:=7"),
        other_type=with_file(ENTRY.format(name), *file, "-p", "a:=x"),
        other_type_of_node=with_file(ENTRY.format(name), *file, "-p", "n:a:=x"),
        between=with_file(ENTRY.format(name), *file, "-p", "a:=7", *file),
    )

if __name__ == "__main__":
    main()
