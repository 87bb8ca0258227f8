"""Type stubs of the stand-in's message packages, written when the kit is built or installed."""

from pathlib import Path
from typing import Any

from course_lib.ros.messages.definitions import (
    PRIMITIVES,
    FieldDefinition,
    MessageDefinition,
    definition,
    type_names,
)
from course_lib.ros.messages.interface_files import ACTION_PARTS, PLACEHOLDER, SERVICE_PARTS

_HEADER = "# Written by course_lib/ros/messages/stubs.py when the kit is installed; don't edit.\n"
_BASE = "from course_lib.ros.messages.message import RosMessage"
_STANDARD = (  # what a stub imports if it holds the word
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
_WIDTH = 106  # of a line in a class


def write_stubs(standin: Path) -> list[Path]:
    """Write the stubs of all message packages.

    Args:
        standin: The folder of the stand-in's packages.

    Returns:
        The files that were written; those that already hold the right text are left as they are.
    """
    written = []
    for path, text in stubs().items():
        file = standin / path
        if not file.is_file() or file.read_text(encoding="utf-8") != text:
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8")
            written.append(file)
    return written


def stubs() -> dict[Path, str]:
    """Return the text of each stub by its path below the stand-in's folder."""
    modules: dict[Path, list[MessageDefinition]] = {}
    for type_name in type_names():
        modules.setdefault(Path(type_name).parent, []).append(definition(type_name))
    return {module / "__init__.pyi": _module_stub(messages) for module, messages in modules.items()}


def _module_stub(messages: list[MessageDefinition]) -> str:
    """Return the stub of one package's messages, services or actions."""
    body = "".join(f"\n{_class(message)}" for message in messages)
    modules = {_module(f.base) for message in messages for f in message.fields if f.is_message}
    body += "".join(f"\n{text}" for text in _wholes(messages, SERVICE_PARTS))
    actions = _wholes(messages, ACTION_PARTS)
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


def _wholes(messages: list[MessageDefinition], parts: tuple[str, ...]) -> list[str]:
    """Declare the service or action classes, which hold their parts."""
    names = [message.type_name.rsplit("/", 1)[1] for message in messages]
    event = "    Event: type[RosMessage]\n" if parts == SERVICE_PARTS else ""
    return [
        f"class {name}:\n" + "".join(f"    {part[1:]}: TypeAlias = {name}{part}\n" for part in parts) + event
        for name in (name.removesuffix(parts[0]) for name in names if name.endswith(parts[0]))
    ]


def _module(type_name: str) -> str:
    return type_name.rsplit("/", 1)[0].replace("/", ".")


def _class(message: MessageDefinition) -> str:
    fields = [field for field in message.fields if field.name != PLACEHOLDER]
    defaults = {f"{f.name.upper()}__DEFAULT": f.default for f in fields if f.default is not None}
    body = [f"{name}: Final = {_literal(value)}" for name, value in {**message.constants, **defaults}.items()]
    body += [line for field in fields for line in _field_lines(field)]
    accepted = [f"{field.name}: {_accepted(field)} = ..." for field in fields]
    body += _constructor(["self", "*", *accepted, "check_fields: bool = ..."])
    name = message.type_name.rsplit("/", 1)[1]
    return f"class {name}(RosMessage):\n" + "".join(f"    {line}\n" for line in body)


def _constructor(parameters: list[str]) -> list[str]:
    """Declare the constructor, on one line if it fits."""
    line = f"def __init__({', '.join(parameters)}) -> None: ..."
    if len(line) <= _WIDTH:
        return [line]
    return ["def __init__(", *(f"    {parameter}," for parameter in parameters), ") -> None: ..."]


def _field_lines(field: FieldDefinition) -> list[str]:
    """Declare one field; a field that accepts more types than it returns is a property."""
    given, accepted = _given(field), _accepted(field)
    if given == accepted:
        return [f"{field.name}: {given}"]
    return [
        "@property",
        f"def {field.name}(self) -> {given}: ...",
        f"@{field.name}.setter",
        f"def {field.name}(self, value: {accepted}) -> None: ...",
    ]


def _item(field: FieldDefinition) -> str:
    return field.base.replace("/", ".") if field.is_message else PRIMITIVES[field.base].python.__name__


def _packed(field: FieldDefinition) -> bool:
    """Return whether the field's values are stored as array.array or numpy.ndarray."""
    return field.container != "scalar" and not field.is_message and bool(PRIMITIVES[field.base].code)


def _given(field: FieldDefinition) -> str:
    if field.container == "scalar":
        return _item(field)
    if not _packed(field):
        return f"list[{_item(field)}]"
    if field.container == "sequence":
        return f"array[{_item(field)}]"
    return f"NDArray[np.{PRIMITIVES[field.base].dtype.name}]"


def _accepted(field: FieldDefinition) -> str:
    return f"Sequence[{_item(field)}] | NDArray[Any]" if _packed(field) else _given(field)


def _literal(value: Any) -> str:
    return repr(value).replace("'", '"')
