"""ROS's rules for the names of nodes, namespaces and topics (rmw and rcl, validate_*.c)."""

import re
from collections.abc import Callable
from functools import lru_cache
from typing import Literal

from rclpy.exceptions import (
    InvalidNamespaceException,
    InvalidNodeNameException,
    InvalidServiceNameException,
    InvalidTopicNameException,
)

Kind = Literal["topic", "service"]
_ERRORS = {"topic": InvalidTopicNameException, "service": InvalidServiceNameException}
Rules = tuple[tuple[str, str], ...]  # what must not be found, and the complaint; the first one counts

# A match's group "at", or else its beginning, is the character that the complaint points at.
NODE_NAME: Rules = (
    (r"^\Z", "node name must not be empty"),
    (r"[^A-Za-z0-9_]", "node name must not contain characters other than alphanumerics or '_'"),
    (r"^[0-9]", "node name must not start with a number"),
    (r"^.{254}(?P<at>.)(?=.)", "node name length should not exceed '255'"),
)
TOPIC_NAME: Rules = (
    (r"^\Z", "topic name must not be empty string"),
    (r"^[0-9]", "topic name token must not start with a number"),
    (r"/\Z", "topic name must not end with a forward slash"),
)
TOPIC_TOKENS: Rules = (
    (r"/(?P<at>[0-9])", "topic name token must not start with a number"),
    (r"^~(?P<at>[^/])", "topic name must not have a tilde '~' that is not followed by a forward slash '/'"),
)
_WORD = r"(?:[A-Za-z_][A-Za-z0-9_]*)?"
_SOUND = rf"~?(?:[A-Za-z0-9_/]|{{{_WORD}}})*"  # a topic's name up to its first bad character
_AFTER_SOUND: Rules = (
    (rf"^{{{_WORD}\Z|^}}", "topic name must not have unmatched (unbalanced) curly braces '{}'"),
    (r"^\{(?P<at>[0-9])", "substitution name must not start with a number"),
    (rf"^({{{_WORD})?(?P<at>~)", "topic name must not have tilde '~' unless it is the first character"),
    (
        rf"^{{{_WORD}(?P<at>.)",
        "substitution name must not contain characters other than alphanumerics or '_'",
    ),
    (r"^.", "topic name must not contain characters other than alphanumerics, '_', '~', '{', or '}'"),
)


def _absolute(what: str, unless: str, length: str, limit: int) -> Rules:
    return (
        (r"^\Z", f"{what} must not be empty"),
        (r"^[^/]", f"{what} must be absolute, it must lead with a '/'"),
        (r"/\Z", f"{what} must not end with a '/'{unless}"),
        (r"[^A-Za-z0-9_/]", f"{what} must not contain characters other than alphanumerics, '_', or '/'"),
        (r"/(?P<at>/)", f"{what} must not contain repeated '/'"),
        (r"/(?P<at>[0-9])", f"{what} must not have a token that starts with a number"),
        (rf"^.{{{limit - 1}}}(?P<at>.)(?=.)", f"{length} should not exceed '{limit}'"),
    )


NAMESPACE = _absolute("namespace", ", unless only a '/'", "namespace", 245)
FULL_TOPIC = _absolute("topic name", "", "topic length", 247)


def validate_node_name(name: str) -> bool:
    """Raise InvalidNodeNameException unless `name` may be a node's name; else return True, as rclpy does."""
    _refuse(name, NODE_NAME, InvalidNodeNameException)
    return True


def validate_namespace(namespace: str) -> bool:
    """Raise InvalidNamespaceException unless `namespace` is a valid absolute namespace; else return True."""
    if namespace != "/":
        _refuse(namespace, NAMESPACE, InvalidNamespaceException)
    return True


def validate_full_topic_name(name: str, *, is_service: bool = False) -> bool:
    """Raise Invalid(Topic or Service)NameException unless `name` is valid and absolute; else return True."""
    _refuse(name, FULL_TOPIC, _ERRORS["service" if is_service else "topic"])
    return True


@lru_cache  # every node has the same services
def validate_topic_name(name: str, *, is_service: bool = False) -> bool:
    """Raise Invalid(Topic or Service)NameException unless `name` may be written for one; else return True."""
    error = _ERRORS["service" if is_service else "topic"]
    _refuse(name, TOPIC_NAME, error)
    sound = re.match(_SOUND, name)
    _refuse(name, _AFTER_SOUND, error, sound.end() if sound else 0)
    _refuse(name, TOPIC_TOKENS, error)
    return True


def expand_topic_name(topic_name: str, node_name: str, node_namespace: str) -> str:
    """Return the full name of a topic of a node, as `rclpy.expand_topic_name` does."""
    return expand_name(topic_name, node_name, node_namespace)


def expand_name(topic: str, node_name: str, namespace: str, kind: Kind = "topic") -> str:
    """Expand a name: `x` is in the namespace, `~/x` under the node; `{node}` and `{ns}` are replaced."""
    validate_topic_name(topic, is_service=kind == "service")
    prefix = namespace.rstrip("/")
    expanded = f"{prefix}/{node_name}{topic[1:]}" if topic.startswith("~") else topic
    known = {"node": node_name, "ns": namespace, "namespace": namespace}
    for word in re.findall(r"\{(\w*)\}", expanded):
        if word not in known:
            raise ValueError(f"topic name '{topic}' is invalid: unknown substitution: {{{word}}}")
        expanded = expanded.replace(f"{{{word}}}", known[word])
    full = expanded if expanded.startswith("/") else f"{prefix}/{expanded}"
    _refuse(full, FULL_TOPIC, _ERRORS[kind])
    return full


def join(namespace: str, name: str) -> str:
    """Join a namespace and a name to a fully qualified name."""
    return f"{namespace.rstrip('/')}/{name}"


def _refuse(name: str, rules: Rules, error: Callable[[str, str, int], Exception], start: int = 0) -> None:
    for pattern, complaint in rules:
        found = re.search(pattern, name[start:], re.DOTALL)
        if found:
            raise error(name, complaint, start + found.start("at" if "at" in found.groupdict() else 0))
