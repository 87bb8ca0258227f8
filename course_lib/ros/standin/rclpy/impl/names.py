"""ROS's rules for the names of nodes, namespaces and topics (rmw and rcl, validate_*.c)."""

import re

from rclpy.exceptions import InvalidNamespaceException, InvalidNodeNameException, InvalidTopicNameException

MAX_LENGTH = {"node name": 255, "namespace": 245, "topic": 247}  # rmw/validate_*.h

_UNBALANCED = "topic name must not have unmatched (unbalanced) curly braces '{}'"

Finding = tuple[str, int]  # what is wrong, and the index of the character


def validate_node_name(name: str) -> None:
    """Raise InvalidNodeNameException unless `name` may be a node's name."""
    finding = _node_name_error(name)
    if finding:
        raise InvalidNodeNameException(name, *finding)


def validate_namespace(namespace: str) -> None:
    """Raise InvalidNamespaceException unless `namespace` is a valid absolute namespace."""
    finding = None if namespace == "/" else _full_name_error(namespace, "namespace")
    if finding:
        raise InvalidNamespaceException(namespace, *finding)


def validate_topic_name(name: str) -> None:
    """Raise InvalidTopicNameException unless `name` may be written for a topic."""
    finding = _topic_name_error(name)
    if finding:
        raise InvalidTopicNameException(name, *finding)


def expand_topic_name(topic: str, node_name: str, namespace: str) -> str:
    """Make a topic's name absolute: `x` is in the namespace, `~/x` under the node; `{node}`, `{ns}` count."""
    validate_topic_name(topic)
    prefix = namespace.rstrip("/")
    expanded = f"{prefix}/{node_name}{topic[1:]}" if topic.startswith("~") else topic
    known = {"node": node_name, "ns": namespace, "namespace": namespace}
    for word in re.findall(r"\{(\w*)\}", expanded):
        if word not in known:
            raise ValueError(f"topic name '{topic}' is invalid: unknown substitution: {{{word}}}")
        expanded = expanded.replace(f"{{{word}}}", known[word])
    full = expanded if expanded.startswith("/") else f"{prefix}/{expanded}"
    finding = _full_name_error(full, "topic")
    if finding:
        raise InvalidTopicNameException(full, *finding)
    return full


def join(namespace: str, name: str) -> str:
    """Join a namespace and a name to a fully qualified name."""
    return f"{namespace.rstrip('/')}/{name}"


def _node_name_error(name: str) -> Finding | None:
    if not name:
        return "node name must not be empty", 0
    if strange := re.search(r"[^A-Za-z0-9_]", name):
        return "node name must not contain characters other than alphanumerics or '_'", strange.start()
    if name[0].isdigit():
        return "node name must not start with a number", 0
    return _length_error(name, "node name")


def _full_name_error(name: str, kind: str) -> Finding | None:
    what = "topic name" if kind == "topic" else kind
    if not name:
        return f"{what} must not be empty", 0
    if not name.startswith("/"):
        return f"{what} must be absolute, it must lead with a '/'", 0
    if name.endswith("/"):
        unless = ", unless only a '/'" if kind == "namespace" else ""
        return f"{what} must not end with a '/'{unless}", len(name) - 1
    if strange := re.search(r"[^A-Za-z0-9_/]", name):
        return f"{what} must not contain characters other than alphanumerics, '_', or '/'", strange.start()
    if bad := re.search(r"/([/0-9])", name):
        repeated = bad.group(1) == "/"
        fault = "contain repeated '/'" if repeated else "have a token that starts with a number"
        return f"{what} must not {fault}", bad.start() + 1
    return _length_error(name, kind)


def _topic_name_error(name: str) -> Finding | None:
    if not name:
        return "topic name must not be empty string", 0
    if name[0].isdigit():
        return "topic name token must not start with a number", 0
    if name.endswith("/"):
        return "topic name must not end with a forward slash", len(name) - 1
    if finding := _character_error(name):
        return finding
    if number := re.search(r"/[0-9]", name):
        return "topic name token must not start with a number", number.start() + 1
    if re.match(r"~[^/]", name):
        return "topic name must not have a tilde '~' that is not followed by a forward slash '/'", 1
    return None


def _character_error(name: str) -> Finding | None:
    opened: int | None = None  # where the substitution begins that we are in
    for index, character in enumerate(name):
        if character.isascii() and (character.isalnum() or character == "_"):
            if character.isdigit() and opened is not None and opened == index - 1:
                return "substitution name must not start with a number", index
        elif character == "~":
            if index > 0:
                return "topic name must not have tilde '~' unless it is the first character", index
        elif character == "}":
            if opened is None:
                return _UNBALANCED, index
            opened = None
        elif opened is not None:
            return "substitution name must not contain characters other than alphanumerics or '_'", index
        elif character == "{":
            opened = index
        elif character != "/":
            allowed = "alphanumerics, '_', '~', '{', or '}'"
            return f"topic name must not contain characters other than {allowed}", index
    return None if opened is None else (_UNBALANCED, opened)


def _length_error(name: str, kind: str) -> Finding | None:
    limit = MAX_LENGTH[kind]
    if len(name) <= limit:
        return None
    words = {"namespace": "namespace", "topic": "topic length"}.get(kind, "node name length")
    return f"{words} should not exceed '{limit}'", limit - 1
