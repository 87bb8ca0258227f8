"""ROS's rules for the names of nodes, namespaces and topics (validate_*.c in rmw and rcl)."""

import re
from collections.abc import Callable
from functools import lru_cache
from typing import Literal

from rclpy.exceptions import (
    InvalidNamespaceException,
    InvalidNodeNameException,
    InvalidParameterException,
    InvalidServiceNameException,
    InvalidTopicNameException,
    NameValidationException,
)
from rclpy.impl.implementation_singleton import RCLError, RMWError

HIDDEN_TOPIC_PREFIX = "_"
TOPIC_SEPARATOR_STRING = "/"
Kind = Literal["topic", "service"]
_ERRORS = {"topic": InvalidTopicNameException, "service": InvalidServiceNameException}
# Patterns of invalid names with their messages. The first match is reported.
Rules = tuple[tuple[str, str], ...]

# The error points at the group "at" of a match or, without such a group, at the match's beginning.
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
TOPIC_TOKENS: Rules = ((r"/(?P<at>[0-9])", "topic name token must not start with a number"),)
# Applies to actions only: rcl's own check of this rule misses it in other names, like `~t`.
_ACTION_TOKENS: Rules = (
    (r"^~(?P<at>[^/])", "topic name must not have a tilde '~' that is not followed by a forward slash '/'"),
)
_WORD = r"(?:[A-Za-z_][A-Za-z0-9_]*)?"
# Matches a topic name up to its first invalid character.
_SOUND = rf"~?(?:[A-Za-z0-9_/]|{{{_WORD}}})*"
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


def _absolute(subject: str, unless: str, length: str, limit: int, limit_name: str) -> Rules:
    return (
        (r"^\Z", f"{subject} must not be empty"),
        (r"^[^/]", f"{subject} must be absolute, it must lead with a '/'"),
        (r"/\Z", f"{subject} must not end with a '/'{unless}"),
        (r"[^A-Za-z0-9_/]", f"{subject} must not contain characters other than alphanumerics, '_', or '/'"),
        (r"/(?P<at>/)", f"{subject} must not contain repeated '/'"),
        (r"/(?P<at>[0-9])", f"{subject} must not have a token that starts with a number"),
        (rf"^.{{{limit - 1}}}(?P<at>.)(?=.)", f"{length} should not exceed '{limit_name}'"),
    )


NAMESPACE = _absolute("namespace", ", unless only a '/'", "namespace", 245, "RMW_NAMESPACE_MAX_NAME_LENGTH")
FULL_TOPIC = _absolute("topic name", "", "topic length", 247, "255U - 8U")


def _require_text(name: object, function: str, failed: str, null: str = "") -> None:
    """Raise the errors of rclpy's C functions for a name that is not a string.

    Args:
        name: The name.
        function: The C function's name.
        failed: The beginning of the text about None.
        null: The argument that rcl calls null; rmw sets no error.
    """
    if name is None:
        if null:
            raise RCLError(f"failed to {failed}: {null} argument is null")
        raise RMWError(f"failed to {failed}: error not set")
    if not isinstance(name, str):
        raise TypeError(f"{function}(): incompatible function arguments.")


def validate_node_name(node_name: str) -> bool:
    """Raise InvalidNodeNameException for an invalid node name; else return True, as in rclpy."""
    _require_text(node_name, "rclpy_get_validation_error_for_node_name", "validate node name")
    _reject(node_name, NODE_NAME, InvalidNodeNameException)
    return True


def validate_namespace(namespace: str) -> bool:
    """Raise InvalidNamespaceException unless `namespace` is valid and absolute; else return True."""
    _require_text(namespace, "rclpy_get_validation_error_for_namespace", "validate namespace")
    if namespace != "/":
        _reject(namespace, NAMESPACE, InvalidNamespaceException)
    return True


def validate_full_topic_name(name: str, *, is_service: bool = False) -> bool:
    """Return True, or raise Invalid(Topic or Service)NameException for an invalid or relative name."""
    _require_text(name, "rclpy_get_validation_error_for_full_topic_name", "validate name")
    _reject(name, FULL_TOPIC, _ERRORS["service" if is_service else "topic"])
    return True


# Cached because every node creates services of the same names.
@lru_cache
def validate_topic_name(name: str, *, is_service: bool = False) -> bool:
    """Raise Invalid(Topic or Service)NameException unless `name` is valid; else return True."""
    _require_text(name, "rclpy_get_validation_error_for_topic_name", "validate name", "topic_name")
    error = _ERRORS["service" if is_service else "topic"]
    _reject(name, TOPIC_NAME, error)
    sound = re.match(_SOUND, name)
    _reject(name, _AFTER_SOUND, error, sound.end() if sound else 0)
    _reject(name, TOPIC_TOKENS, error)
    return True


def expand_topic_name(topic_name: str, node_name: str, node_namespace: str) -> str:
    """Expand a node's topic name to a full name, without validating the result.

    Raises ValueError with rcl's message if one of the names is invalid.
    """
    for check, kind, name, argument in (
        (validate_topic_name, "topic name", topic_name, "input_topic_name"),
        (validate_node_name, "node name", node_name, "node_name"),
        (validate_namespace, "node namespace", node_namespace, "node_namespace"),
    ):
        _require_text(name, "rclpy_expand_topic_name", "do name expansion", argument)
        try:
            check(name)
        except NameValidationException as error:
            raise ValueError(f"{kind} '{name}' is invalid: {error.error_msg}") from None
    return _expand(topic_name, node_name, node_namespace)


def expand_name(topic: str, node_name: str, namespace: str, kind: Kind = "topic") -> str:
    """Expand a topic or service name to its full name and validate it.

    `x` is relative to the namespace, `~/x` to the node's name; `{node}` and `{ns}` are substituted.
    """
    validate_topic_name(topic, is_service=kind == "service")
    full = _expand(topic, node_name, namespace)
    _reject(full, FULL_TOPIC, _ERRORS[kind])
    return full


def reason_without_name(error: ValueError | NameValidationException) -> str:
    """Return the reason why a name is invalid, without the name."""
    if isinstance(error, NameValidationException):
        return error.error_msg
    return str(error).partition(" is invalid: ")[2]


def require_action_name(
    name: str,
    side: Literal["client", "server"],
    node_name: str,
    namespace: str,
) -> None:
    """Raise the errors of rcl_action if an action cannot have this name."""
    failed = f"Failed to create action {side}"
    if name is None:
        raise ValueError(f"{failed}: action_name argument is null")
    if not isinstance(name, str):
        raise TypeError("__init__(): incompatible constructor arguments.")
    if not name and side == "client":
        raise ValueError(f"{failed}: failed to get goal service name")
    colon = ": : " if side == "server" else ": "
    prefix = f"{failed} due to invalid topic name '{name}' {colon}"
    if not name:
        raise ValueError(f"{prefix}invalid empty action name")
    try:
        # rcl_action validates the name of its first service, so some errors differ from a topic's
        # errors.
        expand_name(f"{name}/_action/send_goal", node_name, namespace)
        _reject(name, _ACTION_TOKENS, InvalidTopicNameException)
    except (ValueError, NameValidationException) as error:
        raise ValueError(f"{prefix}{reason_without_name(error)}") from None


def topic_or_service_is_hidden(name: str) -> bool:
    """Return whether a token of a name begins with an underscore."""
    return any(part.startswith(HIDDEN_TOPIC_PREFIX) for part in name.split("/"))


def validate_parameter_name(name: str) -> bool:
    """Raise InvalidParameterException if the name is empty; else return True, as in rclpy."""
    if not name:
        raise InvalidParameterException(name)
    return True


def _expand(topic: str, node_name: str, namespace: str) -> str:
    prefix = namespace.rstrip("/")
    expanded = f"{prefix}/{node_name}{topic[1:]}" if topic.startswith("~") else topic
    replacements = {"node": node_name, "ns": namespace, "namespace": namespace}
    for word in re.findall(r"\{(\w*)\}", expanded):
        if word not in replacements:
            raise ValueError(f"topic name '{topic}' is invalid: unknown substitution: {{{word}}}")
        expanded = expanded.replace(f"{{{word}}}", replacements[word])
    return expanded if expanded.startswith("/") else f"{prefix}/{expanded}"


def join(namespace: str, name: str) -> str:
    """Join a namespace and a name into a fully qualified name."""
    return f"{namespace.rstrip('/')}/{name}"


def _reject(
    name: str,
    rules: Rules,
    error: Callable[[str, str, int], Exception],
    start: int = 0,
) -> None:
    for pattern, complaint in rules:
        match = re.search(pattern, name[start:], re.DOTALL)
        if match:
            raise error(name, complaint, start + match.start("at" if "at" in match.groupdict() else 0))
