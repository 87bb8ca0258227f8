"""The arguments behind `--ros-args` on a command line: parameters, other names, log levels."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from rclpy.exceptions import NameValidationException, RCLInvalidROSArgsError, UnknownROSArgsError
from rclpy.impl import names
from rclpy.impl.logging_severity import LoggingSeverity
from rclpy.parameter import Parameter

_RULE = re.compile(r"(?:(?P<node>[A-Za-z_]\w*):)?(?P<match>[\w~/{}.-]+):=(?P<to>.*)", re.DOTALL)
_FLAGS = {"-p": "--param", "-r": "--remap"}
_WORDS = {  # what rcl calls a flag's value, and what it says where there is none
    "--param": ("parameter override rule", "No parameter override rule found."),
    "--remap": ("remap rule", "No remap rule found."),
    "--params-file": ("params file", "No file path provided."),
    "--log-level": ("log level", "No log level provided."),
}


@dataclass(frozen=True)
class Remap:
    """`from:=to`; of all nodes, or of those of one name."""

    node: str | None
    match: str  # a topic or a service, or __node, or __ns
    to: str


@dataclass
class Arguments:
    """The settings of one command line."""

    remaps: list[Remap] = field(default_factory=list)  # the first that fits counts
    overrides: list[tuple[str, dict[str, Any]]] = field(default_factory=list)  # by nodes; the last counts
    log_levels: dict[str, LoggingSeverity] = field(default_factory=dict)  # by logger; "" is every one

    def renamed(self, node_name: str, what: str, name: str) -> str:
        """Return the node's name (`what` is __node) or namespace (__ns) that replaces `name`."""
        return next((rule.to for rule in self._of(node_name) if rule.match == what), name)

    def remapped(self, full: str, node_name: str, namespace: str, kind: names.Kind) -> str:
        """Return the full name that replaces a topic's or a service's."""
        for rule in self._of(node_name):
            if not rule.match.startswith("__"):
                match, to = (names.expand_name(n, node_name, namespace, kind) for n in (rule.match, rule.to))
                if match == full:
                    return to
        return full

    def parameters(self, full_node_name: str) -> dict[str, Parameter]:
        """Return the values for the parameters of one node."""
        found: dict[str, Parameter] = {}
        for nodes, values in self.overrides:
            if _pattern(nodes).fullmatch(full_node_name):
                found |= {name: Parameter(name, value=value) for name, value in values.items()}
        return found

    def _of(self, node_name: str) -> Iterator[Remap]:
        return (rule for rule in self.remaps if rule.node in (None, node_name))


def parse(args: Sequence[str]) -> Arguments:
    """Read a command line; raises RCLInvalidROSArgsError or UnknownROSArgsError, with rcl's texts."""
    parsed, unknown, words = Arguments(), list[str](), _for_ros(args)
    for word in words:
        flag = _FLAGS.get(word, word)
        if flag not in _WORDS:
            unknown.append(word)
            continue
        what, missing = _WORDS[flag]
        value = next(words, None)
        if value is None:
            raise _invalid(f"Couldn't parse trailing {word} flag. {missing}")
        try:
            _add(parsed, flag, value)
        except ValueError as error:
            raise _invalid(f"Couldn't parse {what}: '{word} {value}'. Error: {error}") from error
    if unknown:
        raise UnknownROSArgsError(repr(unknown))
    return parsed


def joined(first: Arguments, second: Arguments) -> Arguments:
    """Join two sets of arguments, of which the first one counts more."""
    levels = second.log_levels | first.log_levels
    return Arguments(first.remaps + second.remaps, second.overrides + first.overrides, levels)


def _pattern(nodes: str) -> "re.Pattern[str]":
    """Return the pattern of full names of nodes: `*` is one part of a name, `**` any number of them."""
    parts = re.split(r"(/\*\*|/\*)", nodes if nodes.startswith("/") else f"/{nodes}")
    wild = {"/**": r"(/\w+)*", "/*": r"(/\w+)"}
    return re.compile("".join(wild.get(part, re.escape(part)) for part in parts))


def _for_ros(args: Sequence[str]) -> Iterator[str]:
    for_ros = False
    for word in args:
        if word in ("--ros-args", "--"):
            for_ros = word == "--ros-args"
        elif for_ros:
            yield word


def _add(parsed: Arguments, flag: str, value: str) -> None:
    """Add one flag's value; raises ValueError if it is wrong."""
    from course_lib.ros.parameter_yaml import read_file, read_value  # YAML is needed only here

    if flag == "--params-file":
        parsed.overrides += read_file(value)
    elif flag == "--log-level":
        logger, _, level = value.rpartition(":=")
        if level.upper() not in LoggingSeverity.__members__:
            raise ValueError(f"{level!r} is none of debug, info, warn, error, fatal")
        parsed.log_levels[logger] = LoggingSeverity[level.upper()]
    else:
        rule = _RULE.fullmatch(value)
        if rule is None:
            raise ValueError("Expected name:=value" if flag == "--param" else "Expected from:=to")
        node, match, to = rule.group("node", "match", "to")
        if flag == "--param":
            parsed.overrides.append((f"/**/{node}" if node else "/**", {match: read_value(to)}))
        else:
            _check_remap(match, to)
            parsed.remaps.append(Remap(node, "__node" if match == "__name" else match, to))


def _check_remap(match: str, to: str) -> None:
    """Raise NameValidationException, which rcl reports as part of its own complaint, for a bad name."""
    try:
        if match in ("__node", "__name"):
            names.validate_node_name(to)
        elif match == "__ns":
            names.validate_namespace(to)
        else:
            names.validate_topic_name(match)
            names.validate_topic_name(to)
    except NameValidationException as error:
        raise ValueError(str(error)) from error


def _invalid(text: str) -> RCLInvalidROSArgsError:
    return RCLInvalidROSArgsError(f"Failed to parse ROS arguments: {text}")
