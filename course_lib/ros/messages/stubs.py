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
    """Return the content of each stub by its path relative to the stand-in's folder.

    There is one for the messages of a package, one for its services and one for its actions.
    """
    messages_by_folder: dict[Path, list[MessageDefinition]] = {}
    for type_name in type_names():
        messages_by_folder.setdefault(Path(type_name).parent, []).append(definition(type_name))
    texts: dict[Path, str] = {}
    for folder, messages in messages_by_folder.items():
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
        texts[folder / "__init__.pyi"] = f"{_HEADER}\n{imports}\n{body}"
    return texts


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
    parameters = ["self", "*"]
    for field in fields:
        stored_type, accepted_type = _types_of(field)
        parameters.append(f"{field.name}: {accepted_type} = ...")
        if stored_type == accepted_type:
            body.append(f"{field.name}: {stored_type}")
        else:
            # A field that accepts more types than it returns is a property.
            body += ["@property", f"def {field.name}(self) -> {stored_type}: ..."]
            body += [f"@{field.name}.setter", f"def {field.name}(self, value: {accepted_type}) -> None: ..."]
    parameters.append("check_fields: bool = ...")
    line = f"def __init__({', '.join(parameters)}) -> None: ..."
    if len(line) <= _WIDTH:
        body.append(line)
    else:
        body += ["def __init__(", *(f"    {parameter}," for parameter in parameters), ") -> None: ..."]
    name = message.type_name.rsplit("/", 1)[1]
    return f"class {name}(RosMessage):\n" + "".join(f"    {line}\n" for line in body)


def _types_of(field: FieldDefinition) -> tuple[str, str]:
    """Return the type of a field's stored values, and the types of values that it accepts."""
    if field.is_message:
        item, is_packed = field.base.replace("/", "."), False
    else:
        primitive = PRIMITIVES[field.base]
        # Whether the values are stored as array.array or numpy.ndarray.
        item, is_packed = primitive.python.__name__, bool(primitive.code)
    if field.container == "scalar":
        return item, item
    if not is_packed:
        return f"list[{item}]", f"list[{item}]"
    accepted_type = f"Sequence[{item}] | NDArray[Any]"
    if field.container == "sequence":
        return f"array[{item}]", accepted_type
    return f"NDArray[np.{PRIMITIVES[field.base].dtype.name}]", accepted_type


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
