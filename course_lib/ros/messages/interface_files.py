"""Reads .msg, .srv and .action files into what rosbags' type store takes.

A service is two messages, ``std_srvs/srv/Trigger_Request`` and ``std_srvs/srv/Trigger_Response``; an action
is three, with those that rosidl adds for the services and the topic on which it travels.
"""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

SERVICE_PARTS = ("_Request", "_Response")
ACTION_PARTS = ("_Goal", "_Result", "_Feedback")
# CDR knows no empty struct: a message without fields carries one byte under this name.
PLACEHOLDER = "structure_needs_at_least_one_member"
_PARTS: Mapping[str, tuple[str, ...]] = {"msg": ("",), "srv": SERVICE_PARTS, "action": ACTION_PARTS}
# What rosidl makes of an action's three parts (rosidl_parser/definition.py, class Action).
_ACTION_TRANSPORT: Mapping[str, str] = {
    "_SendGoal_Request": "unique_identifier_msgs/UUID goal_id\n{action}_Goal goal",
    "_SendGoal_Response": "bool accepted\nbuiltin_interfaces/Time stamp",
    "_GetResult_Request": "unique_identifier_msgs/UUID goal_id",
    "_GetResult_Response": "int8 status\n{action}_Result result",
    "_FeedbackMessage": "unique_identifier_msgs/UUID goal_id\n{action}_Feedback feedback",
}


def read_interface(path: Path) -> dict[str, Any]:
    """Read a file that lies as in a ROS package, ``my_msgs/msg/Name.msg``; gives messages by type name."""
    package, folder, name = path.parent.parent.name, path.parent.name, path.stem
    pieces = re.split(r"^---[ \t]*\n?", path.read_text(encoding="utf-8"), flags=re.MULTILINE)
    texts = dict(zip(_PARTS[folder], pieces, strict=True))
    if folder == "action":
        own = f"{package}/action/{name}"
        texts |= {part: text.format(action=own) for part, text in _ACTION_TRANSPORT.items()}
    return {f"{package}/{folder}/{name}{part}": _parse(text, package) for part, text in texts.items()}


def _parse(text: str, package: str) -> Any:
    """Parse one message; types without a package are the package's own messages."""
    from rosbags.typesys import get_types_from_msg

    (definition,) = get_types_from_msg(text.strip() or f"uint8 {PLACEHOLDER}", f"{package}/msg/A").values()
    return definition
