"""`ros2 interface`: message, service and action types and their definitions."""

import re
from argparse import Namespace
from collections.abc import Iterator
from functools import partial

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.messages import message_class
from course_lib.ros.messages.conversions import Style, to_yaml
from course_lib.ros.messages.definitions import (
    DEFAULTS,
    FOLDERS,
    PRIMITIVES,
    definition,
    find_package,
    type_names,
    typestore,
)
from course_lib.ros.messages.interface_files import ACTION_PARTS, PLACEHOLDER, SERVICE_PARTS
from course_lib.tools.sources import Source
from course_lib.tools.verb import Option, Verb, Write, flag, value

_FIRST_PARTS = {"msg": "", "srv": SERVICE_PARTS[0], "action": ACTION_PARTS[0]}
_TITLES = {"msg": "Messages", "srv": "Services", "action": "Actions"}


def interfaces(kind: str) -> list[str]:
    """List the types of a kind, msg, srv or action, by name."""
    part = _FIRST_PARTS[kind]
    names = [name.removesuffix(part) for name in type_names() if f"/{kind}/" in name and name.endswith(part)]
    return [name for name in names if "_" not in name.rsplit("/", 1)[1]]


def _list_all(source: Source, arguments: Namespace, write: Write) -> None:
    for kind in _kinds(arguments):
        write(f"{_TITLES[kind]}:\n" + "".join(f"    {name}\n" for name in interfaces(kind)))


def _list_packages(source: Source, arguments: Namespace, write: Write) -> None:
    write("".join(f"{name}\n" for name in sorted(_packages(*_kinds(arguments)))))


def _list_package(source: Source, arguments: Namespace, write: Write) -> None:
    wanted = arguments.package_name
    _check_package(wanted)
    for kind in _kinds(arguments):
        write("".join(f"{name}\n" for name in interfaces(kind) if name.startswith(f"{wanted}/")))


def _show(source: Source, arguments: Namespace, write: Write) -> None:
    name = _checked(arguments.type)
    write("".join(_shown(name, 0, not arguments.no_comments, arguments.all_comments)))


def _proto(source: Source, arguments: Namespace, write: Write) -> None:
    name = _checked(arguments.type)
    message = message_class(name + _FIRST_PARTS[name.split("/")[1]])()
    quote = "" if arguments.no_quotes else '"'
    write(f"{quote}{to_yaml(message, Style(truncate=None))}{quote}\n")


def _kinds(arguments: Namespace) -> list[str]:
    """Return the kinds that the flags select; without a flag all."""
    return [kind for kind in _TITLES if getattr(arguments, f"only_{kind}s")] or list(_TITLES)


def _packages(*kinds: str) -> set[str]:
    return {name.split("/")[0] for kind in kinds for name in interfaces(kind)}


def _check_package(name: str) -> None:
    find_package(name)
    there = _packages(*_TITLES)
    if name not in there:
        raise CourseError(f"Unknown package '{name}'{did_you_mean(name, there)}")


def _checked(name: str) -> str:
    if len(name.split("/")) != 3:
        close = did_you_mean(name.replace("/", "/msg/", 1), type_names())
        raise CourseError(f"Invalid name '{name}'. Expected three parts separated by '/'{close}")
    _check_package(name.split("/")[0])
    there = [known for kind in _TITLES for known in interfaces(kind)]
    if name not in there:
        raise CourseError(f"Could not find the interface '{name}'{did_you_mean(name, there)}")
    return name


def _shown(name: str, depth: int, comments: bool, nested_comments: bool) -> Iterator[str]:
    for line in _lines(name):
        text = line if comments else line.split("#")[0].strip()
        if text or comments:
            yield "\t" * depth * bool(text) + f"{text}\n"
        base = re.match(r"([\w/]+)(\[[<=\d]*\])? +\w+ *($|[^=\s])", line)
        if base and base[1] not in PRIMITIVES and base[1] != "wstring":
            inner = base[1].replace("/", "/msg/") if "/" in base[1] else f"{name.split('/')[0]}/msg/{base[1]}"
            yield from _shown(inner, depth + 1, nested_comments, nested_comments)


def _lines(name: str) -> list[str]:
    """Return the lines of a type's file; for types that only rosbags defines, lines without comments."""
    for path in (path for folder in FOLDERS for path in folder.glob(f"{name}.*")):
        return [line.rstrip() for line in path.read_text(encoding="utf-8").splitlines()]
    here = f"{name.split('/')[0]}/"
    lines = [f"{base} {constant}={number}" for constant, base, number in typestore().fielddefs[name][0]]
    for field in (field for field in definition(name).fields if field.name != PLACEHOLDER):
        bound = f"<={field.string_bound}" if field.string_bound else ""
        most = f"<={field.size}" if field.size else ""
        size = {"scalar": "", "array": f"[{field.size}]", "sequence": f"[{most}]"}[field.container]
        default = DEFAULTS.get((name, field.name))
        tail = "" if default is None else f" {default:g}" if default is not False else " false"
        lines.append(f"{field.base.replace('/msg/', '/').removeprefix(here)}{bound}{size} {field.name}{tail}")
    return lines


_ONLY: tuple[Option, ...] = tuple(
    flag(f"-{kind[0]}", f"--only-{kind}s", help=f"Only the {_TITLES[kind][:-1].lower()} types")
    for kind in _TITLES
)
_TYPE = value("type", help="Show an interface definition (e.g. 'example_interfaces/msg/String')")
_IN_PACKAGE = (*_ONLY, value("package_name", help="Name of the ROS package (e.g. 'example_interfaces')"))
_NO_QUOTES = flag("--no-quotes", help="if true output has no outer quotes.")
_COMMENTS = (
    flag("--all-comments", help="Show all comments, including for nested interface definitions"),
    flag("--no-comments", help="Show no comments or whitespace"),
)
_verb = partial(Verb, "interface", looks=False)
INTERFACE_VERBS = (
    _verb("list", "List all interface types available", _ONLY, _list_all),
    _verb(
        "package",
        "Output a list of available interface types within one package",
        _IN_PACKAGE,
        _list_package,
    ),
    _verb("packages", "Output a list of packages that provide interfaces", _ONLY, _list_packages),
    _verb("proto", "Output an interface prototype", (_TYPE, _NO_QUOTES), _proto),
    _verb("show", "Output the interface definition", (*_COMMENTS, _TYPE), _show),
)
