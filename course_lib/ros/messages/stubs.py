"""Write the stand-in's message packages: tiny modules, and the stubs that editors and mypy read.

Run ``python -m course_lib.ros.messages.stubs`` after rosbags brought other types; with ``--check`` it only
says whether the files on disk are what it would write.
"""

import sys
from pathlib import Path
from typing import Any

from course_lib.ros.messages.definitions import (
    PLACEHOLDER,
    FieldDefinition,
    MessageDefinition,
    definition,
    type_names,
)
from course_lib.ros.messages.message import snake_case
from course_lib.ros.messages.primitives import PRIMITIVES

STANDIN = Path(__file__).parent.parent / "standin"
_HEADER = "# Written by `python -m course_lib.ros.messages.stubs`; don't edit.\n"
_MODULE = '''"""The message types of {package}."""

from course_lib.ros.messages.registry import import_messages as _import_messages

globals().update(_import_messages(__name__))
'''


def files() -> dict[Path, str]:
    """Give the text of every file of the message packages, by its path below the stand-in folder."""
    texts: dict[Path, str] = {}
    packages: dict[str, list[str]] = {}
    for type_name in type_names():
        package, _, name = type_name.split("/")
        packages.setdefault(package, []).append(name)
        texts[Path(package, "msg", f"_{snake_case(name)}.pyi")] = message_stub(definition(type_name))
    for package, names in packages.items():
        imports = [f"from ._{snake_case(name)} import {name} as {name}\n" for name in names]
        texts[Path(package, "__init__.py")] = f'"""Stand-in for ROS 2\'s {package}."""\n'
        texts[Path(package, "py.typed")] = ""
        texts[Path(package, "msg", "__init__.py")] = _MODULE.format(package=package)
        texts[Path(package, "msg", "__init__.pyi")] = f"{_HEADER}\n{''.join(imports)}"
    return texts


def message_stub(message: MessageDefinition) -> str:
    """Give the text of one message's stub."""
    fields = [field for field in message.fields if field.name != PLACEHOLDER]
    defaults = {f"{f.name.upper()}__DEFAULT": f.default for f in fields if f.default is not None}
    constants = {**message.constants, **defaults}
    body = [f"{name}: Final = {_literal(value)}" for name, value in constants.items()]
    for field in fields:
        body += _field_lines(field)
    arguments = [f"    {field.name}: {_accepted(field)} = ...," for field in fields]
    body += [
        "def __init__(",
        "    self,",
        "    *,",
        *arguments,
        "    check_fields: bool = ...,",
        ") -> None: ...",
    ]
    name = message.type_name.rsplit("/", 1)[1]
    lines = "".join(f"    {line}\n" for line in body)
    return f"{_head(fields, bool(constants))}\nclass {name}(Message):\n{lines}"


def _head(fields: list[FieldDefinition], constants: bool) -> str:
    """Give the comment and the imports that the annotations need."""
    text = " ".join(f"{_given(field)} {_accepted(field)}" for field in fields)
    standard = [
        "from array import array" if "array[" in text else "",
        "from collections.abc import Sequence" if "Sequence[" in text else "",
        _import("typing", [name for name, used in (("Any", "Any" in text), ("Final", constants)) if used]),
    ]
    third = [
        "import numpy as np" if "np." in text else "",
        "from numpy.typing import NDArray" if "NDArray[" in text else "",
    ]
    own = {"from course_lib.ros.messages.message import Message", *map(_message_import, fields)}
    blocks = [[line for line in block if line] for block in (standard, third, sorted(own))]
    imports = "\n\n".join("\n".join(block) for block in blocks if block)
    return f"{_HEADER}\n{imports}\n"


def _import(module: str, names: list[str]) -> str:
    return f"from {module} import {', '.join(names)}" if names else ""


def _message_import(field: FieldDefinition) -> str:
    if not field.is_message:
        return ""
    package, _, name = field.base.split("/")
    return f"from {package}.msg._{snake_case(name)} import {name}"


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
    return field.base.rsplit("/", 1)[1] if field.is_message else PRIMITIVES[field.base].python.__name__


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
