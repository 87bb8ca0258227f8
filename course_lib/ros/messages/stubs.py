"""Files written when the kit is built: stubs of the message packages and the table of types."""

import json
from importlib.metadata import version
from pathlib import Path
from typing import Any
from zlib import crc32

from course_lib.ros.messages.definitions import (
    PRIMITIVES,
    FieldDefinition,
    MessageDefinition,
    definition,
    type_names,
)
from course_lib.ros.messages.interface_files import (
    ACTION_PARTS,
    FILE,
    PLACEHOLDER,
    SERVICE_PARTS,
    kit_files,
    parse_defaults,
    parse_interface,
)

_HEADER = "# Written by course_lib/ros/messages/stubs.py when the kit is installed; don't edit.\n"
_BASE = "from course_lib.ros.messages.message import RosMessage"
# Imports that a stub needs if it contains the string.
_STANDARD = (
    ("array[", "from array import array"),
    ("Sequence[", "from collections.abc import Sequence"),
    ("NDArray[Any]", "from typing import Any"),
    ("Final", "from typing import Final"),
    ("TypeAlias", "from typing import TypeAlias"),
)
_NUMPY = (("np.", "import numpy as np"), ("NDArray[", "from numpy.typing import NDArray"))
_IMPL = """    class Impl:
        SendGoalService: TypeAlias = {name}_SendGoal
        GetResultService: TypeAlias = {name}_GetResult
        FeedbackMessage: TypeAlias = {name}_FeedbackMessage
        CancelGoalService: TypeAlias = action_msgs.srv.CancelGoal
        GoalStatusMessage: TypeAlias = action_msgs.msg.GoalStatusArray
"""
# Limit on the length of a line in a class.
_WIDTH = 106


def write_stubs(standin: Path) -> list[Path]:
    """Write the stubs of all message packages.

    Args:
        standin: The folder of the stand-in's packages.

    Returns:
        The files that were written. Files that are up to date are not written.
    """
    files = []
    for path, text in stubs().items():
        file = standin / path
        if not file.is_file() or file.read_text(encoding="utf-8") != text:
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8")
            files.append(file)
    return files


def stubs() -> dict[Path, str]:
    """Return the content of each stub by its path relative to the stand-in's folder."""
    modules: dict[Path, list[MessageDefinition]] = {}
    for type_name in type_names():
        modules.setdefault(Path(type_name).parent, []).append(definition(type_name))
    return {module / "__init__.pyi": _module_stub(messages) for module, messages in modules.items()}


def _module_stub(messages: list[MessageDefinition]) -> str:
    """Return the stub of a package's messages, services or actions."""
    body = "".join(f"\n{_class(message)}" for message in messages)
    bases = {field.base for message in messages for field in message.fields if field.is_message}
    modules = {base.rsplit("/", 1)[0].replace("/", ".") for base in bases}
    body += "".join(f"\n{text}" for text in _container_stubs(messages, SERVICE_PARTS))
    actions = _container_stubs(messages, ACTION_PARTS)
    if actions:
        body += "".join(f"\n{text}{_IMPL.format(name=text.split()[1][:-1])}" for text in actions)
        modules |= {"action_msgs.msg", "action_msgs.srv"}
    blocks = (
        [line for word, line in _STANDARD if word in body],
        [line for word, line in _NUMPY if word in body],
        sorted([_BASE, *(f"import {module}" for module in modules)]),
    )
    imports = "\n\n".join("\n".join(block) for block in blocks if block)
    return f"{_HEADER}\n{imports}\n{body}"


def _container_stubs(messages: list[MessageDefinition], parts: tuple[str, ...]) -> list[str]:
    """Declare the service or action classes, which contain their parts."""
    names = [message.type_name.rsplit("/", 1)[1] for message in messages]
    event = "    Event: type[RosMessage]\n" if parts == SERVICE_PARTS else ""
    return [
        f"class {name}:\n" + "".join(f"    {part[1:]}: TypeAlias = {name}{part}\n" for part in parts) + event
        for name in (name.removesuffix(parts[0]) for name in names if name.endswith(parts[0]))
    ]


def _class(message: MessageDefinition) -> str:
    fields = [field for field in message.fields if field.name != PLACEHOLDER]
    defaults = {f"{f.name.upper()}__DEFAULT": f.default for f in fields if f.default is not None}
    constants = {
        name: repr(value).replace("'", '"') for name, value in {**message.constants, **defaults}.items()
    }
    body = [f"{name}: Final = {literal}" for name, literal in constants.items()]
    for field in fields:
        stored_type, accepted_type = _stored_type(field), _accepted_type(field)
        if stored_type == accepted_type:
            body.append(f"{field.name}: {stored_type}")
        else:
            # A field that accepts more types than it returns is a property.
            body += ["@property", f"def {field.name}(self) -> {stored_type}: ..."]
            body += [f"@{field.name}.setter", f"def {field.name}(self, value: {accepted_type}) -> None: ..."]
    values = [f"{field.name}: {_accepted_type(field)} = ..." for field in fields]
    parameters = ["self", "*", *values, "check_fields: bool = ..."]
    line = f"def __init__({', '.join(parameters)}) -> None: ..."
    if len(line) <= _WIDTH:
        body.append(line)
    else:
        body += ["def __init__(", *(f"    {parameter}," for parameter in parameters), ") -> None: ..."]
    name = message.type_name.rsplit("/", 1)[1]
    return f"class {name}(RosMessage):\n" + "".join(f"    {line}\n" for line in body)


def _item(field: FieldDefinition) -> str:
    return field.base.replace("/", ".") if field.is_message else PRIMITIVES[field.base].python.__name__


def _is_packed(field: FieldDefinition) -> bool:
    """Return whether the field's values are stored as array.array or numpy.ndarray."""
    return field.container != "scalar" and not field.is_message and bool(PRIMITIVES[field.base].code)


def _stored_type(field: FieldDefinition) -> str:
    if field.container == "scalar":
        return _item(field)
    if not _is_packed(field):
        return f"list[{_item(field)}]"
    if field.container == "sequence":
        return f"array[{_item(field)}]"
    return f"NDArray[np.{PRIMITIVES[field.base].dtype.name}]"


def _accepted_type(field: FieldDefinition) -> str:
    return f"Sequence[{_item(field)}] | NDArray[Any]" if _is_packed(field) else _stored_type(field)


def write_table(file: Path = FILE) -> None:
    """Write the table of types unless it is up to date. See `interface_files`."""
    from rosbags.typesys import Stores, get_typestore

    files = {}
    for name, content in sorted(kit_files().items()):
        defaults: dict[str, dict[str, Any]] = {}
        for (owner, field), value in parse_defaults(content, name).items():
            defaults.setdefault(owner, {})[field] = value
        files[name] = crc32(content.encode()), parse_interface(content, name), defaults
    types = dict(get_typestore(Stores.ROS2_JAZZY).fielddefs)
    text = json.dumps({"rosbags": version("rosbags"), "types": types, "files": files}, separators=(",", ":"))
    if not file.is_file() or file.read_text(encoding="utf-8") != text:
        file.write_text(text, encoding="utf-8")
