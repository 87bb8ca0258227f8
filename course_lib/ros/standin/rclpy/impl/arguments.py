"""The arguments after `--ros-args` on a command line: parameters, remappings, log levels."""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any

from course_lib.errors import join_words
from course_lib.ros.near_names import nearest
from rclpy.exceptions import NameValidationException
from rclpy.impl import names
from rclpy.impl.implementation_singleton import RCLInvalidROSArgsError, UnknownROSArgsError
from rclpy.parameter import Parameter

_RULE = re.compile(
    r"(?:(?P<node>[A-Za-z_]\w*):(?!//))?(?:(?P<kind>rostopic|rosservice)://)?(?P<match>[\w~/.-]+):=(?P<to>.*)",
    re.DOTALL,
)
INVALID_ARGUMENTS = "Failed to parse ROS arguments: "
# Topics and services that every node has.
_OF_EACH_NODE = ("/rosout", "/parameter_events")
_SCHEMES: dict[str, names.Kind] = {"rostopic": "topic", "rosservice": "service"}
# In the order in which rclpy reads the values of a parameter, each before lists of any type.
_TYPES = (bool, int, float, str)
_FLAGS = {"-p": "--param", "-r": "--remap"}
# rcl's term for the value of each flag, and its message if the value is missing.
_WORDS = {
    "--param": ("parameter override rule", "No parameter override rule found."),
    "--remap": ("remap rule", "No remap rule found."),
    "--params-file": ("params file", "No file path provided."),
    "--log-level": ("log level", "No log level provided."),
}


class LoggingSeverity(IntEnum):
    """The severities, as rcutils numbers them."""

    UNSET = 0
    DEBUG = 10
    INFO = 20
    WARN = 30
    ERROR = 40
    FATAL = 50


@dataclass
class LogLevels:
    """The log levels of one program in a run, by logger name."""

    by_logger: dict[str, int] = field(default_factory=dict)
    # Contexts that were initialized with logging and not shut down since. As in rclpy, only the
    # first one of them sets the levels of its command line.
    contexts: int = 0


@dataclass(frozen=True)
class Remap:
    """A remapping rule `from:=to`, for all nodes or for nodes of one name."""

    node: str | None
    # A topic or service name, or __node, or __ns.
    match: str
    to: str
    # None: the rule applies to topics and services.
    kind: names.Kind | None = None


@dataclass
class RequestedNames:
    """The full names that nodes of a program requested, and the remapping rules applied to them."""

    topics: set[str] = field(default_factory=set)
    nodes: set[str] = field(default_factory=set)
    parameters: set[str] = field(default_factory=set)
    applied: set[str] = field(default_factory=set)
    # Hints about values of `-p` that a file replaces.
    replaced: dict[str, None] = field(default_factory=dict)


@dataclass
class Arguments:
    """The ROS arguments of one command line."""

    # The first matching rule wins.
    remaps: list[Remap] = field(default_factory=list)
    # Parameter values by node name pattern; the last matching entry wins.
    overrides: list[tuple[str, dict[str, Any]]] = field(default_factory=list)
    # Node name pattern, name and value of each `-p`, without lists.
    given: list[tuple[str, str, Any]] = field(default_factory=list)
    # Levels by logger name; "" applies to all loggers.
    log_levels: dict[str, LoggingSeverity] = field(default_factory=dict)
    # Warnings that rcl logs about the command line.
    warnings: list[str] = field(default_factory=list)
    # Hints about arguments that ROS does not read.
    ignored: list[str] = field(default_factory=list)
    # The names that nodes of the program requested, and the applied rules: for `find_unused`.
    requested: RequestedNames = field(default_factory=RequestedNames)

    def remap_node(self, node_name: str, kind: str, name: str) -> str:
        """Apply the remapping rules to a node name (`kind` is __node) or namespace (__ns)."""
        return next((rule.to for rule in self._of(node_name) if rule.match == kind), name)

    def remap(self, full: str, node_name: str, namespace: str, kind: names.Kind) -> str:
        """Apply the remapping rules to a fully qualified topic or service name."""
        self.requested.topics.add(full)
        for rule in self._of(node_name):
            if not rule.match.startswith("__") and rule.kind in (None, kind):
                match, to = (names.expand_name(n, node_name, namespace, kind) for n in (rule.match, rule.to))
                if match == full:
                    self.requested.applied.add(rule.match)
                    return to
        return full

    def find_unused(self) -> Iterator[str]:
        """Yield hints about rules without effect, which ROS ignores silently.

        Rules and files are often shared by several nodes. A hint needs a similar name, or a rule
        that the command line has for this program.
        """
        yield from self.ignored
        yield from self.requested.replaced
        topics, nodes, declared = self.requested.topics, self.requested.nodes, self.requested.parameters
        for rule in self.remaps:
            if not rule.match.startswith("__") and rule.match not in self.requested.applied:
                known = [topic for topic in topics if not topic.startswith(_OF_EACH_NODE)]
                if near := nearest(rule.match if rule.match.startswith("/") else f"/{rule.match}", known):
                    yield f"nothing is called {rule.match}, so {rule.match}:={rule.to} has no effect. " + (
                        f"Did you mean {near}?"
                    )
        patterns = [pattern for pattern, _ in self.overrides]
        if nodes and patterns and not self.requested.applied.intersection(patterns):
            yield (
                f"the parameters are for {join_words(sorted(set(patterns)))}, and the program's node is "
                f"{join_words(sorted(nodes))}: in the file, the name of the node comes first."
            )
        for pattern, values in self.overrides:
            for name in values if pattern in self.requested.applied else ():
                near = "" if name in declared else nearest(name, declared - values.keys())
                if near:
                    yield f"no node declares the parameter {name}. Did you mean {near}?"

    def log_warnings(self, log: Callable[[str], object]) -> None:
        """Pass each warning to `log`, once."""
        while self.warnings:
            log(self.warnings.pop(0))

    def parameters(self, full_node_name: str) -> dict[str, Parameter]:
        """Return the parameter overrides of one node, by parameter name."""
        self.requested.nodes.add(full_node_name)
        parameters: dict[str, Parameter] = {}
        for nodes, values in self.overrides:
            if _matches(nodes, full_node_name):
                self.requested.applied.add(nodes)
                # In rcl an empty list has no type, so it is not a value.
                parameters |= {n: Parameter(n, value=None if v == [] else v) for n, v in values.items()}
        given = [row[1:] for row in self.given if _matches(row[0], full_node_name)]
        for name, value in given:
            used = parameters[name].value
            # A difference in type is reported while the values are merged.
            if type(used) is type(value) and (name, used) not in given:
                node = full_node_name.rpartition("/")[2]
                self.requested.replaced[
                    f"the parameter {name} of {full_node_name} is {used!r}, not {value!r}: an entry of the "
                    "parameter file replaces the value of -p. Write the name of the node, behind the file: "
                    f"-p {node}:{name}:={value}."
                ] = None
        return parameters

    def _of(self, node_name: str) -> Iterator[Remap]:
        return (rule for rule in self.remaps if rule.node in (None, node_name))


def _matches(nodes: str, full_node_name: str) -> bool:
    """Return whether a pattern matches: `*` one token of a full name, `**` any number of tokens."""
    parts = re.split(r"(/\*\*|/\*)", nodes if nodes.startswith("/") else f"/{nodes}")
    wild = {"/**": r"(/\w+)*", "/*": r"(/\w+)"}
    pattern = "".join(wild.get(part, re.escape(part)) for part in parts)
    return re.fullmatch(pattern, full_node_name) is not None


def parse(args: Sequence[str], parsed: Arguments | None = None) -> Arguments:
    """Parse a command line into `parsed`, by default new arguments, and return them.

    The warnings about arguments before an invalid one are stored, too.

    Raises:
        RCLInvalidROSArgsError: An argument is malformed; the message is rcl's.
        UnknownROSArgsError: There are arguments that ROS does not know.
    """
    parsed = Arguments() if parsed is None else parsed
    unknown = list[str]()
    words = _split(args)
    before = ""
    for word, is_for_ros in words:
        if not is_for_ros:
            is_rule = before in _FLAGS and ":=" in word
            if is_rule or (before == "--params-file" and word.endswith((".yaml", ".yml"))):
                parsed.ignored.append(
                    f"{before} {word} is not read: write --ros-args before it, as in "
                    f"--ros-args {before} {word}."
                )
            before = word
            remap = _ros_1_remap(word, parsed)
            if remap is not None:
                parsed.remaps.append(remap)
                parsed.warnings.append(
                    f"Found remap rule '{word}'. This syntax is deprecated. "
                    f"Use '--ros-args --remap {word}' instead."
                )
            continue
        flag = _FLAGS.get(word, word)
        if flag not in _WORDS:
            unknown.append(word)
            continue
        kind, missing = _WORDS[flag]
        value, is_its_value = next(words, ("", False))
        if not is_its_value:
            trailing = f"{kind} flag: '{word}'" if flag == "--log-level" else f"{word} flag"
            raise RCLInvalidROSArgsError(f"{INVALID_ARGUMENTS}Couldn't parse trailing {trailing}. {missing}")
        try:
            _add(parsed, flag, value)
        except ValueError as error:
            complaint = f"Couldn't parse {kind}: '{word} {value}'. Error: {error}"
            raise RCLInvalidROSArgsError(f"{INVALID_ARGUMENTS}{complaint}") from error
    if unknown:
        raise UnknownROSArgsError(repr(unknown))
    _merge_values(parsed)
    return parsed


def _merge_values(parsed: Arguments) -> None:
    """Keep one value of each parameter that has several ones for the same nodes.

    rcl stores a value of each type, and rclpy reads the first one in the order of the types. The
    order of files and arguments only matters for values of one type, and for different nodes.
    """
    merged: dict[str, tuple[str, dict[str, Any]]] = {}
    for nodes, values in parsed.overrides:
        _, kept = merged.setdefault(nodes if nodes.startswith("/") else f"/{nodes}", (nodes, {}))
        for name, value in values.items():
            if name not in kept or _order_of_type(value) <= _order_of_type(kept[name]):
                kept[name] = value
            elif value != []:
                parsed.ignored.append(
                    f"the parameter {name} is {kept[name]!r}, not {value!r}: of values with different types, "
                    "ROS uses the first one in the order bool, int, float, str. Write both with one type."
                )
    parsed.overrides = list(merged.values())


def _order_of_type(value: Any) -> int:
    """Return the position of a value's type in the order of rclpy. In rcl an empty list has no type."""
    item = value[0] if isinstance(value, list) and value else value
    kind = _TYPES.index(type(item)) if type(item) in _TYPES else len(_TYPES)
    return kind + len(_TYPES) * isinstance(value, list)


def merge_arguments(first: Arguments, second: Arguments) -> Arguments:
    """Merge two sets of arguments. The first one takes precedence."""
    levels = second.log_levels | first.log_levels
    remaps, overrides = first.remaps + second.remaps, second.overrides + first.overrides
    given = second.given + first.given
    return Arguments(remaps, overrides, given, levels, requested=second.requested)


def strip_ros_arguments(args: Sequence[str], parsed: Arguments) -> list[str]:
    """Return the arguments of the program itself. Raises the errors of `parse`."""
    parse(args, parsed)
    mine = [word for word, is_for_ros in _split(args) if not is_for_ros]
    return [word for word in mine if _ros_1_remap(word, Arguments()) is None]


def _split(args: Sequence[str]) -> Iterator[tuple[str, bool]]:
    """Yield each argument with whether it is for ROS, without `--ros-args` and its closing `--`."""
    for_ros = is_value = False
    for word in args:
        if not isinstance(word, str):
            raise TypeError("bad argument type for built-in operation")
        if not is_value and (word == "--ros-args" or (word == "--" and for_ros)):
            for_ros = word == "--ros-args"
        else:
            yield word, for_ros
            # As in rcl, the argument behind a flag is its value, even if it is `--`.
            is_value = for_ros and not is_value and _FLAGS.get(word, word) in _WORDS


def _ros_1_remap(word: str, parsed: Arguments) -> Remap | None:
    """Parse a remapping in ROS 1 style, `chatter:=other`; return None for other arguments."""
    rule = _RULE.fullmatch(word)
    try:
        return None if rule is None else _remap(rule, parsed)
    except ValueError:
        return None


def _remap(rule: re.Match[str], parsed: Arguments) -> Remap:
    """Return a remapping rule. Raise ValueError, and for some warn as rcl, if it is invalid."""
    node, match, to = rule.group("node", "match", "to")
    if rule["kind"] and match.startswith("__"):
        raise ValueError(f"{rule['kind']}:// needs the name of a topic or service, not {match}")
    try:
        _check_remap(match, to)
    except ValueError:
        if match == "__ns":
            warning = f"Namespace not remapped to a fully qualified name (found: {to})"
            parsed.warnings.append(warning)
        elif match in ("__node", "__name") and not re.match("[A-Za-z_]", to):
            parsed.warnings.append(f"Node name not remapped to invalid name: '{to}'")
        raise
    kind = _SCHEMES.get(rule["kind"] or "")
    return Remap(node, "__node" if match == "__name" else match, to, kind)


def _add(parsed: Arguments, flag: str, value: str) -> None:
    """Add the value of one flag. Raise ValueError if it is invalid."""
    # YAML is needed only here.
    from course_lib.ros.programs.parameter_yaml import read_argument, read_file

    if flag == "--params-file":
        parsed.overrides += read_file(value)
    elif flag == "--log-level":
        logger, names_logger, level = value.partition(":=") if ":=" in value else ("", "", value)
        if names_logger and not logger:
            raise ValueError("Argument has an invalid logger item that name is empty")
        if level.upper() not in LoggingSeverity.__members__:
            raise ValueError(f"{level!r} is not a level: expected debug, info, warn, error or fatal")
        parsed.log_levels[logger] = LoggingSeverity[level.upper()]
    else:
        rule = _RULE.fullmatch(value)
        if rule is None:
            raise ValueError("Expected name:=value" if flag == "--param" else "Expected from:=to")
        if flag == "--param":
            node, match, to = rule.group("node", "match", "to")
            # The errors of rcl's parser for a character that a parameter name cannot contain.
            wrong = re.search(r"[^\w./]|\.(?=\.|$)|(?<=/)__", match, re.ASCII)
            if rule["kind"] or re.search(r"^[^A-Za-z_/]|(?:^|\.)__", match):
                raise ValueError("Expecting token or wildcard")
            if wrong is not None:
                at = wrong.start()
                raise ValueError(f"Expected lexeme type (22) not found, search ended at index {at}")
            nodes, argument = f"/{node}" if node else "/**", read_argument(to)
            parsed.overrides.append((nodes, {match: argument}))
            if not isinstance(argument, list):
                parsed.given.append((nodes, match, argument))
        else:
            parsed.remaps.append(_remap(rule, parsed))


def _check_remap(match: str, to: str) -> None:
    """Raise a ValueError if a name in a remapping rule is invalid.

    rcl's own error quotes its text.
    """
    # rcl reserves tokens that begin with two underscores, and `~` is only the namespace of the node.
    for name in (match.removeprefix("__"), to):
        if re.search(r"(?:^|/)__|~(?!/)", name):
            raise ValueError(f"{name!r} contains a reserved token")
    try:
        if match in ("__node", "__name"):
            names.validate_node_name(to)
        elif match == "__ns":
            # rcl accepts a slash at the end here, and rejects it when it creates the node.
            names.validate_namespace(to if to == "/" else to.removesuffix("/"))
        elif match.startswith("__"):
            raise ValueError(f"{match} is neither __node nor __ns")
        else:
            for name in (match, to):
                names.validate_topic_name(name)
                if "//" in name or "{" in name:
                    raise ValueError(f"{name!r} contains // or a substitution")
    except NameValidationException as error:
        raise ValueError(str(error)) from error
