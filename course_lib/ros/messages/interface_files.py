"""The types in .msg, .srv, .action and .idl files, in the format of rosbags' type store.

A service consists of two messages, ``std_srvs/srv/Trigger_Request`` and
``std_srvs/srv/Trigger_Response``; an action of three, plus those that rosidl adds for its services
and its topic.

The interface files of the kit are stored by package: ``interfaces/nav2_msgs.txt`` contains all
files of ``nav2_msgs``, each after a line ``=== msg/Costmap.msg``. As hundreds of small files they
would take three times the space in the wheel, and longer to find when a program starts.

On import rosbags creates a class for each of its types, which takes a third of the time that a
small node takes to start. So the types of one version of rosbags and the parsed interface files of
the kit are written to a table, `known_types.json`, when the kit is built or installed.
"""

import ast
import importlib.util
import keyword
import os
import re
from collections.abc import Iterator, Mapping, MutableMapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any
from zlib import crc32

from course_lib.errors import CourseError
from course_lib.third_party import read_json, read_text

FILE = Path(__file__).with_name("known_types.json")


@dataclass(frozen=True)
class TypeTable:
    """The content of the table.

    Args:
        types: Constants and fields by type name, in rosbags' format but with lists instead of
            tuples.
        files: By path in the folder of interfaces: the checksum of a file, its types and its
            defaults.
    """

    types: dict[str, Any]
    files: dict[str, tuple[int, dict[str, Any], dict[str, dict[str, Any]]]]


def read_table() -> TypeTable | None:
    """Return the table, or None if it does not exist or belongs to another version of rosbags."""
    try:
        table = read_json(FILE.read_bytes())
    except FileNotFoundError:
        return None
    spec = importlib.util.find_spec("rosbags")
    places = (spec and spec.submodule_search_locations) or ()
    # importlib.metadata also has the version, but importing it takes as long as reading the table.
    is_same = any(Path(place).with_name(f"rosbags-{table['rosbags']}.dist-info").is_dir() for place in places)
    return TypeTable(table["types"], table["files"]) if is_same else None


def to_rosbags_form(definition: Any) -> Any:
    """Convert a definition in the table to rosbags' format: two lists of tuples."""
    return tuple([_as_tuples(item) for item in part] for part in definition)


def _as_tuples(value: Any) -> Any:
    return tuple(map(_as_tuples, value)) if isinstance(value, list) else value


SERVICE_PARTS = ("_Request", "_Response")
ACTION_PARTS = ("_Goal", "_Result", "_Feedback")
# CDR has no empty struct, so a message without fields has one byte with this name.
PLACEHOLDER = "structure_needs_at_least_one_member"
PARTS: Mapping[str, tuple[str, ...]] = {"msg": ("",), "srv": SERVICE_PARTS, "action": ACTION_PARTS}
# From rosidl_adapter/parser.py: valid names of types and fields, and what may follow a field's
# name.
_TYPE_NAME = "[A-Z][A-Za-z0-9]*"
_FIELD_NAME = "(?!.*__)(?!.*_$)[a-z][a-z0-9_]*"
# A string in quotes, in which a backslash escapes a quote.
_QUOTED = r"""\"(?:\\.|[^\"\\])*\"|'(?:\\.|[^'\\])*'"""
_ELEMENT = re.compile(rf"{_QUOTED}|[^,\s][^,]*")
_FIELD = re.compile(
    r"\s*(?P<type>[\w/]+(<=\d+)?(\[(<=)?\d*\])?)\s+(?P<name>\w+)"
    rf"(\s+(?P<default>{_QUOTED}|[^\s#=\"'][^#]*?))?\s*(#.*)?"
)
# The bound of a string, and the size or bound of an array.
_SIZES = re.compile(r"\s*[\w/]+(?:<=(-?\d+))?(?:\[(?:<=)?(-?\d+)\])?\s")
_CONSTANT = re.compile(r"\s*(?P<type>\w+)\s+(?P<name>[A-Z]\w*)\s*=\s*(?P<default>[^#]*?)\s*(#.*)?")
_INTEGERS: dict[str, tuple[int, int]] = {
    **{f"int{bits}": (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) for bits in (8, 16, 32, 64)},
    **{f"uint{bits}": (0, 2**bits - 1) for bits in (8, 16, 32, 64)},
    **dict.fromkeys(("byte", "char"), (0, 255)),
}
_BOOLEANS = {"true": True, "1": True, "false": False, "0": False}
# Messages that rosidl derives from an action's three parts (rosidl_parser/definition.py, class
# Action).
_ACTION_TRANSPORT: Mapping[str, str] = {
    "_SendGoal_Request": "unique_identifier_msgs/UUID goal_id\n{action}_Goal goal",
    "_SendGoal_Response": "bool accepted\nbuiltin_interfaces/Time stamp",
    "_GetResult_Request": "unique_identifier_msgs/UUID goal_id",
    "_GetResult_Response": "int8 status\n{action}_Result result",
    "_FeedbackMessage": "unique_identifier_msgs/UUID goal_id\n{action}_Feedback feedback",
}


def read_interface(path: Path, package: str) -> dict[str, Any]:
    """Read an interface file's messages by type name.

    The package defaults to the name of the folder.
    """
    return parse_interface(read_text(path), file_name(path, package), path)


def read_defaults(path: Path, package: str) -> dict[tuple[str, str], Any]:
    """Read the default values of an interface file by type name and field. See `read_interface`."""
    return parse_defaults(read_text(path), file_name(path, package), path)


def file_name(path: Path, package: str = "") -> str:
    """Return the name of an interface file relative to its workspace, ``my_msgs/msg/Name.msg``.

    As in rosidl, folders below ``msg`` are not part of the name.
    """
    folder = path.suffix[1:]
    if folder == "idl":
        folder = next((parent.name for parent in path.parents if parent.name in PARTS), "msg")
    return f"{package or path.parent.parent.name}/{folder}/{path.name}"


def parse_interface(text: str, file: str, path: Path | None = None) -> dict[str, Any]:
    """Parse the text of ``my_msgs/msg/Name.msg`` and return its messages by type name.

    Raises a CourseError, with ``path`` if given, for a wrong number of parts, and for an .idl file
    that is invalid or does not define the type.
    """
    package, folder, name = file.rpartition(".")[0].split("/")
    if file.endswith(".idl"):
        types = _IdlReader(text, str(path or file)).types
        for missing in [name for name in type_names_in(file) if name not in types][:1]:
            if folder != "action" or not missing.endswith(tuple(_ACTION_TRANSPORT)):
                raise CourseError(f"{path or file} does not define a struct for the type {missing}.")
    else:
        pieces = re.split(r"^---[ \t]*\n?", text, flags=re.MULTILINE)
        parts = PARTS[folder]
        if len(pieces) != len(parts):
            raise CourseError(
                f"{path or file}: a .{folder} file has {len(parts) - 1 or 'no'} "
                f"line{'s' if len(parts) == 3 else ''} with --- between its parts, not {len(pieces) - 1}."
            )
        texts = zip(parts, pieces, strict=True)
        types = {f"{package}/{folder}/{name}{part}": _parse(text, package) for part, text in texts}
    if folder == "action":
        # The messages that rosidl derives from the parts of an action.
        action = f"{package}/action/{name}"
        for part, text in _ACTION_TRANSPORT.items():
            types[action + part] = _parse(text.format(action=action), package)
    return types


def split_definitions(type_name: str, text: str) -> dict[str, str]:
    """Split the definition of a type that a bag stores into one text for each interface file.

    Lines of = and `MSG: my_msgs/Name` precede each type that the first one refers to. Definitions
    in IDL, and those of services, also begin with such lines.

    Raises a CourseError for an invalid name.
    """
    first, *others = re.split(r"^={80}\n", text, flags=re.MULTILINE)
    files = {}
    for part in (f"MSG: {type_name}\n{first}", *others) if first.strip() or not others else others:
        heading, _, content = part.partition("\n")
        match = re.fullmatch(
            rf"(MSG|IDL|SRV): ([a-z][a-z0-9_]*)/(?:(msg|srv|action)/)?({_TYPE_NAME})\s*", heading
        )
        if match is None:
            raise CourseError(
                f"A definition in the bag begins with {heading!r:.100}, expected 'MSG: my_msgs/Name'."
            )
        suffix = match[1].lower()
        folder = match[3] or ("srv" if suffix == "srv" else "msg")
        files[f"{match[2]}/{folder}/{match[4]}.{suffix}"] = content
    return files


def type_names_in(file: str) -> list[str]:
    """Return the types of the messages in a file ``my_msgs/msg/Name.msg`` without reading it."""
    name, _, suffix = file.rpartition(".")
    parts = PARTS[name.split("/")[1] if suffix == "idl" else suffix]
    return [name + part for part in (*parts, *(_ACTION_TRANSPORT if parts == ACTION_PARTS else ()))]


def _parse(text: str, package: str) -> Any:
    """Parse one message. Types without a package are messages of the same package."""
    from rosbags.typesys import get_types_from_msg

    # The defaults are read by `parse_defaults`, and rosbags rejects some of their quotes.
    fields = map(_FIELD.fullmatch, text.splitlines())
    lines = (
        f"{field['type']} {field['name']}" if field is not None and field["default"] else line
        for field, line in zip(fields, text.splitlines(), strict=True)
    )
    content = "\n".join(lines).strip() or f"uint8 {PLACEHOLDER}"
    # rosbags has no limit of wide strings, which `definitions` rejects in any case.
    content = re.sub(r"^(\s*wstring)<=\d+", r"\1", content, flags=re.MULTILINE)
    (definition,) = get_types_from_msg(content, f"{package}/msg/A").values()
    return definition


def parse_defaults(text: str, file: str, path: Path | None = None) -> dict[tuple[str, str], Any]:
    """Parse the default values in the text of ``my_msgs/msg/Name.msg``, by type name and field."""
    if file.endswith(".idl"):
        return _IdlReader(text, str(path or file)).defaults
    package, folder, name = file.rpartition(".")[0].split("/")
    parts, defaults = iter(PARTS[folder]), {}
    part = next(parts)
    for line in text.splitlines():
        field = _FIELD.fullmatch(line)
        if line.startswith("---"):
            part = next(parts)
        elif field is not None and field["default"]:
            value = _parse_value(field["type"], field["default"])
            defaults[f"{package}/{folder}/{name}{part}", field["name"]] = value
    return defaults


def check_interface(path: Path) -> None:
    """Raise a CourseError for the first line that is invalid, or for a name that rosidl rejects."""
    if not re.fullmatch(_TYPE_NAME, path.stem):
        raise CourseError(f"{path}: the file name must be a type name like JointLimit, not {path.stem!r}.")
    try:
        text = read_text(path)
    except (OSError, UnicodeDecodeError) as error:
        raise CourseError(f"{path} cannot be read as a text file in UTF-8: {error}.") from error
    check_lines(text, str(path))


def check_lines(text: str, source: str) -> None:
    """Raise a CourseError for the first line of an interface that is invalid."""
    from rosbags.typesys import TypesysError

    if source.endswith(".idl"):
        _IdlReader(text, source)
        return
    names = set[str]()
    for number, line in enumerate(text.splitlines(), start=1):
        field = _FIELD.fullmatch(line)
        if line.startswith("---"):
            names.clear()
        place = f"{source}, line {number}"
        if field is not None:
            if not re.fullmatch(_FIELD_NAME, field["name"]):
                raise CourseError(
                    f"{place}: '{field['name']}' is an invalid field name. It should have the "
                    f"pattern '^{_FIELD_NAME}$', like joint_limit."
                )
            if keyword.iskeyword(field["name"]):
                raise CourseError(
                    f"{place}: '{field['name']}' is a keyword of Python, so choose another name for "
                    "the field."
                )
        sizes = _SIZES.match(line)
        if sizes is not None and any(size and int(size) < 1 for size in sizes.groups()):
            raise CourseError(
                f"{place}: a size in '{sizes[0].strip()}' is less than 1. For an array of any length, "
                "write [] without a number."
            )
        constant = _CONSTANT.fullmatch(line)
        declaration = constant or field
        if declaration is not None:
            if declaration["name"] in names:
                kind = "constant" if constant else "field"
                name = declaration["name"]
                raise CourseError(f"{place}: the {kind} '{name}' is already defined above.")
            names.add(declaration["name"])
        if declaration is not None and declaration["default"]:
            try:
                _parse_value(declaration["type"], declaration["default"])
            except ValueError:
                raise CourseError(
                    f"{place}: {declaration['default']!r} is not a value of the type {declaration['type']}."
                ) from None
        try:
            _parse("" if line.startswith("---") else line, "x")
        except TypesysError as error:
            raise CourseError(
                f"{source}, line {number}: {line.strip()!r:.100} is neither a field, like `float64 "
                "speed`, nor a constant, like `uint8 FAST=1`."
            ) from error


def _parse_value(kind: str, text: str) -> Any:
    """Convert the text of a constant or default to a value of a type, as rosidl_adapter does.

    Raises ValueError for an invalid value.
    """
    base, bracket, size = kind.partition("[")
    if not bracket:
        return _parse_scalar(base, text)
    if not (text.startswith("[") and text.endswith("]")):
        raise ValueError(text)
    elements = _ELEMENT.findall(text[1:-1]) if "string" in base else text[1:-1].split(",")
    values = [_parse_scalar(base, element.strip()) for element in elements if text != "[]"]
    limit = size.removesuffix("]")
    if limit and len(values) > int(limit.removeprefix("<=")):
        raise ValueError(text)
    if limit.isdecimal() and len(values) != int(limit):
        raise ValueError(text)
    return values


def _parse_scalar(kind: str, text: str) -> Any:
    base, _, max_length = kind.partition("<=")
    if base == "bool":
        if text.lower() not in _BOOLEANS:
            raise ValueError(text)
        return _BOOLEANS[text.lower()]
    if base in ("float32", "float64"):
        return float(text)
    if base in ("string", "wstring"):
        if re.fullmatch(_QUOTED, text):
            text = text[1:-1].replace(f"\\{text[0]}", text[0])
        if max_length and len(text) > int(max_length):
            raise ValueError(text)
        return text
    if base not in _INTEGERS:
        raise ValueError(text)
    lowest, highest = _INTEGERS[base]
    number = int(text) if text.lstrip("-").isdecimal() else int(text, 0)
    if not lowest <= number <= highest:
        raise ValueError(text)
    return bytes([number]) if base == "byte" else number


def line_of_field(path: Path, name: str) -> int:
    """Return the line of a field in its file, or 0 for a field that rosidl adds."""
    text = read_text(path)
    if path.suffix == ".idl":
        return _IdlReader(text, str(path)).lines.get(name, 0)
    fields = map(_FIELD.fullmatch, text.splitlines())
    return next(
        (number for number, field in enumerate(fields, start=1) if field and field["name"] == name), 0
    )


# The types of IDL with their names in .msg files (rosidl_parser/grammar.lark).
_IDL_TYPES = {
    "short": "int16",
    "unsigned short": "uint16",
    "long": "int32",
    "unsigned long": "uint32",
    "long long": "int64",
    "unsigned long long": "uint64",
    "float": "float32",
    "double": "float64",
    "boolean": "bool",
    "octet": "byte",
    **{name: name for name in _INTEGERS if "int" in name},
}
_IDL_STRING = r'"(?:\\.|[^"\\])*"'
# Comments and lines like #include are skipped. A number may have an exponent with a sign.
_IDL_TOKEN = re.compile(
    r"(?:\s|//[^\n]*|/\*.*?\*/|\#[^\n]*)*+"
    rf"(?P<token>{_IDL_STRING}|::|[A-Za-z_]\w*|[-+]?\.?\d[\w.]*(?:(?<=[eE])[-+]\w+)?|[^\w\s]|$)",
    re.DOTALL,
)
# How rosbags numbers the forms of a field's type: rosbags.interfaces.Nodetype.
_IDL_BASE, _IDL_NAME, _IDL_ARRAY, _IDL_SEQUENCE = 1, 2, 3, 4
_NESTED = "{} are not supported: put the inner one into a struct"


class _IdlReader:
    """Reads the types in an .idl file: modules, structs, typedefs, constants and default values.

    Values are literals, as in rosidl, so that no text takes long to read. The parser of rosbags gives
    the same types, but no default values, and its time doubles with each nested sequence in a bag.

    Args:
        text: The content of the file.
        source: The name of the file for errors.

    Attributes:
        types: Constants and fields by type name, in rosbags' format.
        defaults: Default values by type name and field.
        lines: The line of each field.

    Raises:
        CourseError: The text is invalid, or contains a type that Python's messages lack.
    """

    def __init__(self, text: str, source: str) -> None:
        self.types = dict[str, Any]()
        self.defaults = dict[tuple[str, str], Any]()
        self.lines = dict[str, int]()
        self._text, self._source = text, source
        # The end of the token that was taken last.
        self._end = 0
        self._typedefs = dict[str, Any]()
        self._numbers = dict[str, int]()
        self._constants = dict[str, list[tuple[str, str, Any]]]()
        while self._peek():
            self._read_definition(())
        for name in self._constants.keys() & self.types.keys():
            self.types[name][0].extend(self._constants[name])

    def _match(self) -> re.Match[str]:
        match = _IDL_TOKEN.match(self._text, self._end)
        if match is None:
            raise self._error(f"{self._text[self._end :].strip()[:1]!r} is not a character of IDL")
        return match

    def _peek(self) -> str:
        return self._match()["token"]

    def _take(self) -> str:
        match = self._match()
        self._end = match.end()
        return match["token"]

    def _skip(self, token: str) -> bool:
        is_next = self._peek() == token
        if is_next:
            self._take()
        return is_next

    def _expect(self, token: str) -> None:
        if not self._skip(token):
            raise self._error(f"expected {token!r}, not {self._peek()!r}")

    def _take_name(self) -> str:
        name = self._take()
        if not re.fullmatch(r"[A-Za-z_]\w*", name):
            raise self._error(f"expected a name, not {name!r}")
        return name

    def _error(self, text: str) -> CourseError:
        line = self._text.count("\n", 0, self._end) + 1
        return CourseError(f"{self._source}, line {line}: {text}.")

    def _read_definition(self, scope: tuple[str, ...]) -> None:
        self._read_annotations()
        word = self._take()
        if word == "module" and len(scope) < 3:
            inner = (*scope, self._take_name())
            self._expect("{")
            while not self._skip("}"):
                self._read_definition(inner)
        elif word == "struct":
            self._read_struct(scope)
        elif word == "typedef":
            form = self._read_type(scope)
            for name, form_of_name in self._read_declarators(form):
                self._typedefs["/".join((*scope, name))] = form_of_name
        elif word == "const":
            self._read_constant(scope)
        else:
            raise self._error(f"expected a module, struct, typedef or const, not {word!r}")
        self._expect(";")

    def _read_annotations(self) -> list[str]:
        """Skip annotations like `@key`. Return the tokens of the value in `@default (value=1)`."""
        default = list[str]()
        while self._skip("@"):
            name = self._take_name()
            tokens = list[str]()
            if self._skip("("):
                while (token := self._take()) != ")":
                    if not token:
                        raise self._error("expected ')'")
                    tokens.append(token)
            if name == "default" and tokens[:2] == ["value", "="]:
                default = tokens[2:]
        return default

    def _read_struct(self, scope: tuple[str, ...]) -> None:
        type_name = "/".join((*scope, self._take_name()))
        fields = list[tuple[str, Any]]()
        self._expect("{")
        while not self._skip("}"):
            default = self._read_annotations()
            for name, form in self._read_declarators(self._read_type(scope)):
                if keyword.iskeyword(name):
                    raise self._error(f"{name!r} is a keyword of Python, so choose another name")
                if any(name == other for other, _ in fields):
                    raise self._error(f"the field {name!r} is already defined above")
                fields.append((name, form))
                self.lines[name] = self._text.count("\n", 0, self._end) + 1
                if default:
                    self.defaults[type_name, name] = self._parse_default(form, default)
            self._expect(";")
        self.types[type_name] = [], fields or [(PLACEHOLDER, (_IDL_BASE, ("uint8", 0)))]

    def _read_declarators(self, form: Any) -> Iterator[tuple[str, Any]]:
        """Yield names with their types: `a, b[3]`."""
        while True:
            name = self._take_name()
            if self._skip("["):
                if form[0] in (_IDL_ARRAY, _IDL_SEQUENCE):
                    raise self._error(_NESTED.format("arrays of arrays and of sequences"))
                yield name, (_IDL_ARRAY, (form, self._read_size()))
                self._expect("]")
            else:
                yield name, form
            if not self._skip(","):
                return

    def _read_size(self) -> int:
        token = self._take()
        if token in self._numbers:
            return self._numbers[token]
        if not re.fullmatch(r"[1-9][0-9]{0,9}", token):
            raise self._error(f"expected a size above 0, not {token!r:.50}")
        return int(token)

    def _read_type(self, scope: tuple[str, ...]) -> Any:
        if self._skip("sequence"):
            self._expect("<")
            if self._peek() == "sequence":
                raise self._error(_NESTED.format("sequences of sequences"))
            inner = self._read_type(scope)
            if inner[0] in (_IDL_ARRAY, _IDL_SEQUENCE):
                raise self._error(_NESTED.format("sequences of arrays and of sequences"))
            size = self._read_size() if self._skip(",") else 0
            self._expect(">")
            return _IDL_SEQUENCE, (inner, size)
        if self._peek() in ("string", "wstring"):
            word, bound = self._take(), 0
            if self._skip("<"):
                bound = self._read_size()
                self._expect(">")
            # In rosbags' format a wide string is a message, see `_parse`.
            is_wide = word == "wstring"
            return (_IDL_NAME, f"{scope[0]}/msg/wstring") if is_wide else (_IDL_BASE, (word, bound))
        word = self._take_name()
        while word.split()[-1] in ("unsigned", "long") and self._peek() in ("short", "long", "double"):
            word += f" {self._take()}"
        if word in _IDL_TYPES:
            return _IDL_BASE, (_IDL_TYPES[word], 0)
        words = [word]
        while self._skip("::"):
            words.append(self._take_name())
        return self._resolve(words, scope)

    def _resolve(self, words: list[str], scope: tuple[str, ...]) -> Any:
        """Return the type of a name like `Point` or `geometry_msgs::msg::Point`."""
        for depth in range(len(scope), -1, -1):
            name = "/".join((*scope[:depth], *words))
            if name in self._typedefs:
                return self._typedefs[name]
            if name in self.types:
                return _IDL_NAME, name
        if len(words) == 3 and words[1] in PARTS:
            return _IDL_NAME, "/".join(words)
        raise self._error(
            f"{'::'.join(words)!r:.100} is not a type that messages can have, like double, "
            "sequence<string> or my_msgs::msg::Name"
        )

    def _read_constant(self, scope: tuple[str, ...]) -> None:
        """Read a constant. A module like `Name_Constants` contains the constants of a message."""
        form = self._read_type(scope)
        name = self._take_name()
        self._expect("=")
        tokens = list[str]()
        while self._peek() not in (";", ""):
            tokens.append(self._take())
        if form[0] == _IDL_BASE:
            base, _ = form[1]
            value = self._parse_value("uint8" if base == "byte" else base, tokens)
            if base in _INTEGERS and 0 < value < 2**32:
                self._numbers[name] = value
            owner = "/".join(scope).removesuffix("_Constants")
            self._constants.setdefault(owner, []).append((name, base, value))

    def _parse_default(self, form: Any, tokens: list[str]) -> Any:
        kind, detail = form
        if kind == _IDL_BASE:
            return self._parse_value(detail[0], tokens)
        inner, size = detail if kind in (_IDL_ARRAY, _IDL_SEQUENCE) else (form, 0)
        if inner[0] == _IDL_NAME:
            # Messages have no default values, and wide strings are rejected later.
            return None
        # rosidl writes the values of an array into a string: "(1, 2)".
        try:
            values = list(ast.literal_eval(self._parse_value("string", tokens)))
        except (ValueError, SyntaxError, TypeError, RecursionError, MemoryError):
            raise self._error('expected default values like "(1, 2)"') from None
        if size and (len(values) > size or (kind == _IDL_ARRAY and len(values) != size)):
            most = "" if kind == _IDL_ARRAY else "at most "
            raise self._error(f"expected {most}{size} default values, not {len(values)}")
        return [self._parse_value(inner[1][0], [repr(value)]) for value in values]

    def _parse_value(self, base: str, tokens: list[str]) -> Any:
        """Convert a literal, or strings next to each other, to a value of a type."""
        if base == "string" and all(re.fullmatch(_IDL_STRING, token) for token in tokens):
            return "".join(_parse_scalar(base, token) for token in tokens)
        text = "".join(tokens)
        try:
            # A number with a fixed point ends with d, or D.
            return _parse_scalar(base, re.sub("[dD]$", "", text) if base.startswith("float") else text)
        except ValueError:
            raise self._error(f"{text!r:.100} is not a value of the type {base}") from None


@cache
def kit_files() -> Mapping[str, str]:
    """Return the text of each interface file of the kit by its name, ``my_msgs/msg/Name.msg``."""
    texts = {}
    for entry in os.scandir(Path(__file__).parents[1] / "interfaces"):
        package, _, suffix = entry.name.partition(".")
        if suffix == "txt":
            sections = read_text(Path(entry)).split("=== ")[1:]
            for name, _, text in (section.partition("\n") for section in sections):
                texts[f"{package}/{name}"] = text
    return texts


class LazyTypes(MutableMapping[str, Any]):
    """The fields of types by name, for rosbags' store.

    Interface files are parsed on the first lookup. Parsing a file takes milliseconds and there are
    hundreds of them, but a program needs only a few.

    Args:
        definitions: Types that are already defined.
        files: The text of interface files by name, ``my_msgs/msg/Name.msg``.
        defaults: Receives the default values of each parsed file, by type and field.
        table: Further types and parsed files. A file whose text has changed since is parsed again.
    """

    def __init__(
        self,
        definitions: dict[str, Any],
        files: Mapping[str, str],
        defaults: dict[tuple[str, str], Any],
        table: TypeTable | None = None,
    ) -> None:
        self._known, self._defaults, self._texts = definitions, defaults, files
        self._table = table or TypeTable({}, {})
        self._files = {name: file for file in sorted(files) for name in type_names_in(file)}

    def __getitem__(self, name: str) -> Any:
        if name in self._known:
            return self._known[name]
        if name in self._table.types:
            self._known[name] = to_rosbags_form(self._table.types[name])
        elif name in self._files:
            file = self._files[name]
            text = self._texts[file]
            checksum, types, defaults = self._table.files.get(file, (None, {}, {}))
            if checksum == crc32(text.encode()):
                self._known |= {each: to_rosbags_form(definition) for each, definition in types.items()}
                for each, fields in defaults.items():
                    self._defaults |= {(each, field): value for field, value in fields.items()}
            else:
                self._known |= parse_interface(text, file)
                self._defaults |= parse_defaults(text, file)
        return self._known[name]

    def __setitem__(self, name: str, fields: Any) -> None:
        self._known[name] = fields

    def __delitem__(self, name: str) -> None:
        self._table.types.pop(name, None)
        del self._known[name]

    def __contains__(self, name: object) -> bool:
        return name in self._known or name in self._table.types or name in self._files

    def __iter__(self) -> Iterator[str]:
        yield from dict.fromkeys((*self._table.types, *self._known, *self._files))

    def __len__(self) -> int:
        return len(self._known.keys() | self._table.types.keys() | self._files.keys())
