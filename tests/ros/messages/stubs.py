"""Write the stand-in's message packages: the stubs that editors and mypy read.

Run ``python -m tests.ros.messages.stubs`` after rosbags brought other types; with ``--check`` it only
says whether the files on disk are what it would write.
"""

import sys
from pathlib import Path
from typing import Any

from course_lib.ros.messages.definitions import FieldDefinition, MessageDefinition, definition, type_names
from course_lib.ros.messages.interface_files import ACTION_PARTS, PLACEHOLDER, SERVICE_PARTS
from course_lib.ros.messages.primitives import PRIMITIVES
from course_lib.ros.standin_path import STANDIN

_HEADER = "# Written by `python -m tests.ros.messages.stubs`; don't edit.\n"
_BASE = "from course_lib.ros.messages.message import Message"
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


def files() -> dict[Path, str]:
    """Give the text of every file of the message packages, by its path below the stand-in folder."""
    texts: dict[Path, str] = {}
    modules: dict[Path, list[MessageDefinition]] = {}
    for type_name in type_names():
        modules.setdefault(Path(type_name).parent, []).append(definition(type_name))
    for module, messages in modules.items():
        texts |= {module.parent / name: "" for name in ("__init__.py", "py.typed")}
        texts[module / "__init__.pyi"] = module_stub(messages)
    return texts


def module_stub(messages: list[MessageDefinition]) -> str:
    """Give the stub of one package's messages, its services, or its actions."""
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
    """Declare the classes of services or actions, which hold their parts."""
    names = [message.type_name.rsplit("/", 1)[1] for message in messages]
    return [
        f"class {name}:\n" + "".join(f"    {part[1:]}: TypeAlias = {name}{part}\n" for part in parts)
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
    return f"class {name}(Message):\n" + "".join(f"    {line}\n" for line in body)


def _constructor(parameters: list[str]) -> list[str]:
    """Declare the constructor, in a line if it fits."""
    line = f"def __init__({', '.join(parameters)}) -> None: ..."
    if len(line) <= _WIDTH:
        return [line]
    return ["def __init__(", *(f"    {parameter}," for parameter in parameters), ") -> None: ..."]


def _field_lines(field: FieldDefinition) -> list[str]:
    """Declare one field; one that accepts more than it gives is a property."""
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
    """Whether a field's values are kept as array.array or numpy array."""
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


def main(arguments: list[str]) -> int:
    """Write the files, or with ``--check`` name those that differ; returns the exit code."""
    texts = files()
    stale = [path for path, text in texts.items() if _read(STANDIN / path) != text]
    if "--check" in arguments:
        sys.stdout.writelines(f"{path} is not what `python -m {__spec__.name}` writes\n" for path in stale)
        return 1 if stale else 0
    for path in stale:
        (STANDIN / path).parent.mkdir(parents=True, exist_ok=True)
        (STANDIN / path).write_text(texts[path], encoding="utf-8")
    return 0


def _read(path: Path) -> str | None:
    return path.read_text(encoding="utf-8") if path.is_file() else None


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
