"""Malformed messages, returned values and strings: random ones, and corrupted valid ones."""

import random
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cache
from typing import Any

from course_lib.grading.evidence import Evidence
from course_lib.ros.graph.graph import START_NS, Sample
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import message_class, serialize, type_name
from course_lib.ros.messages.definitions import FieldDefinition, definition, type_names
from course_lib.ros.messages.interface_files import PLACEHOLDER

NAN, INF = float("nan"), float("inf")
FLOATS = (0.0, -0.0, 1.0, -1.0, 0.5, NAN, INF, -INF, 3e38, -3e38, 1e-45, 1e9, 3.14159)
DOUBLES = (*FLOATS, 1.7e308, -1.7e308, 5e-324)
TEXTS = ("", "map", "base_link", "odom", "/", "x" * 5000, "\u202e", "é", "{title}", "%s", "a\nb", "joint_1")
BITS = {"8": 8, "16": 16, "32": 32, "64": 64}
COUNTS = (0, 0, 1, 2, 3, 7, 50)
LAYOUT = """Visualization Manager:
  Global Options: {Fixed Frame: map, Frame Rate: 30}
  Displays:
    - {Class: rviz_default_plugins/LaserScan, Enabled: true, Topic: {Value: /scan, Depth: 5}, Size (m): 0.1}
    - {Class: rviz_default_plugins/TF, Enabled: true, Frames: {All Enabled: true}}
    - {Class: rviz_common/Group, Displays: [{Class: rviz_default_plugins/MarkerArray, Topic: {Value: /m}}]}
  Views: {Current: {Class: rviz_default_plugins/Orbit, Distance: 8, Focal Point: {X: 1, Y: 0, Z: 0}}}
"""
PARAMETERS = "/**:\n  ros__parameters: {rate: 5.0, names: [a, b]}\nnode: {ros__parameters: {n: 3}}\n"
PIECES = (
    "", ":", "-", "- ", "[", "]", "{", "}", "&a ", "*a", "'", '"', "\n", "  ", "\t", "null", "~",
    "!!python/x ", "1e999", ".nan", "true", "-1", "9" * 5000, "x" * 300, "|", ">", "<<: ", "? ", "%",
    "---\n", "...\n", "#", "\0", "\ud800", "é", "\ufeff", ",", "0x", "0o7", "1_0",
    "Class: rviz_default_plugins/Grid", "Enabled: false", "Displays: ", "Value: ", "ros__parameters: ",
)  # fmt: skip


def chosen_value(chance: random.Random, field: FieldDefinition, depth: int) -> Any:
    """Return one value of a field's base type."""
    if field.is_message:
        return random_message(chance, field.base, depth + 1)
    base = field.base
    if base in ("string", "wstring"):
        text = chance.choice(TEXTS)
        return text[: field.string_bound] if field.string_bound else text
    if base in ("float32", "float64"):
        return chance.choice(FLOATS if base == "float32" else DOUBLES)
    if base in ("bool", "boolean"):
        return chance.random() < 0.5
    if base in ("byte", "octet"):
        return bytes([chance.choice((0, 1, 2, 3, 255))])
    bits = next((bits for ending, bits in BITS.items() if base.endswith(ending)), 8)
    low = 0 if base.startswith("u") or base == "char" else -(2 ** (bits - 1))
    high = low + 2**bits - 1
    return chance.choice((0, 1, 2, 3, low, high, chance.randint(low, high)))


def random_message(chance: random.Random, kind: str, depth: int = 0) -> Any:
    """Return a message of any content that its type allows."""
    message = message_class(kind)()
    for field in definition(kind).fields:
        if chance.random() < 0.4 or depth > 4 or field.name == PLACEHOLDER:
            continue
        value: Any
        if field.container == "scalar":
            value = chosen_value(chance, field, depth)
        else:
            most = field.size or 10**9
            count = field.size if field.container == "array" else min(chance.choice(COUNTS), most)
            count = count if depth < 2 or field.container == "array" else min(count, 2)
            value = [chosen_value(chance, field, depth) for _ in range(count)]
        with suppress(AssertionError):  # the error of ROS for an invalid field value
            setattr(message, field.name, value)
    return message


@cache
def all_types() -> tuple[str, ...]:
    """Return every message type that the kit knows."""
    return tuple(name for name in type_names() if "/msg/" in name)


def random_bytes(chance: random.Random, kind: str) -> bytes:
    """Return a message's bytes, occasionally corrupted."""
    cdr = serialize(random_message(chance, kind))
    return spoilt(chance, cdr) if chance.random() < 0.1 else cdr


def spoilt(chance: random.Random, data: bytes) -> bytes:
    """Return the bytes with some of them removed, changed or repeated."""
    at, to = sorted((chance.randint(0, len(data)), chance.randint(0, len(data))))
    match chance.randrange(4):
        case 0:
            return data[:at]
        case 1:
            return data[:at] + chance.randbytes(chance.randint(0, 8)) + data[at:]
        case 2:
            return data[:at] + data[to:]
    to = min(to, at + 8)
    return data[:at] + chance.choice((b"\xff", b"\0", b"\x7f")) * (to - at) + data[to:]


def random_text(chance: random.Random) -> str:
    """Return a layout or parameter file with some fragments swapped, or a few random fragments."""
    text = chance.choice((LAYOUT, PARAMETERS, ""))
    for _ in range(chance.randint(0, 6)):
        at = chance.randint(0, len(text))
        text = text[:at] + chance.choice(PIECES) + text[at + chance.choice((0, 0, 1, 5, 40)) :]
    return text


def random_value(chance: random.Random, depth: int = 0) -> Any:
    """Return plain data, as a function may have returned it."""
    kinds: Sequence[Any] = (None, True, 0, -1, 2**63 - 1, *DOUBLES, "", {"object": "a Foo"}, [], {}, LAYOUT)
    pick = chance.random()
    if pick < 0.5 or depth > 3:
        return chance.choice(kinds)
    if pick < 0.6:
        return random_text(chance)
    items = [random_value(chance, depth + 1) for _ in range(chance.choice(COUNTS[:-1]))]
    return items if pick < 0.8 else {chance.choice((*TEXTS, "x", "image_rate")): item for item in items}


def random_evidence(chance: random.Random, topics: Sequence[tuple[str, str]], seconds: float) -> Evidence:
    """Return evidence in which these topics have messages, mostly of the type named with them."""
    samples = []
    for topic, kind in topics:
        for _ in range(chance.choice((0, 1, 2, 3, 5))):
            own = kind if chance.random() < 0.7 else chance.choice(all_types())
            at = START_NS + chance.choice((0, 1, round(chance.random() * seconds * 1e9)))
            samples.append(Sample(at, topic, own, random_bytes(chance, own), Qos(), 7))
    returns = tuple(random_value(chance) for _ in range(chance.randint(0, 3)))
    samples.sort(key=lambda sample: sample.stamp_ns)
    return Evidence("week01.demo", "public", seconds, tuple(samples), returns)


def nudge(chance: random.Random, message: Any) -> None:
    """Change one value somewhere in a message."""
    fields = [f for f in definition(type_name(message)).fields if f.name != PLACEHOLDER]
    if not fields:
        return
    field = chance.choice(fields)
    value = getattr(message, field.name)
    items = [value] if field.container == "scalar" else list(value)
    if field.is_message and items and chance.random() < 0.9:
        nudge(chance, chance.choice(items))  # in place: a list holds the same messages
        return
    if field.container == "scalar":
        new = chosen_value(chance, field, 0)
    elif field.container == "array" or (items and chance.random() < 0.5):
        items[chance.randrange(len(items))] = chosen_value(chance, field, 0)
        new = items
    else:
        new = chance.choice(([], items[:-1], items * 2, [*items, chosen_value(chance, field, 0)]))
    with suppress(AssertionError):  # the error of ROS for an invalid field value
        setattr(message, field.name, new)


def _spoilt_sample(chance: random.Random, old: Sample) -> Sample:
    if chance.random() < 0.7:
        message = old.message()
        nudge(chance, message)
        return replace(old, cdr=serialize(message))
    other = old.type_name if chance.random() < 0.4 else chance.choice(all_types())
    return replace(old, type_name=other, cdr=random_bytes(chance, other))


def spoilt_evidence(chance: random.Random, right: Evidence) -> Evidence:
    """Return right evidence with a few samples or returned values that are something else."""
    samples, returns = list(right.samples), list(right.returns)
    for _ in range(chance.randint(1, 4)):
        if samples:
            at = chance.choice((chance.randrange(len(samples)), len(samples) - 1))
            new = _spoilt_sample(chance, right.samples[min(at, len(right.samples) - 1)])
            samples[at : at + chance.choice((1, 1, 5, 10**6))] = [new] * chance.choice((0, 1, 1, 3))
        if returns:
            at = chance.randrange(len(returns))
            returns[at : at + 1] = [_spoilt_value(chance, returns[at])] * chance.choice((0, 1, 1, 1))
    return replace(right, samples=tuple(samples), returns=tuple(returns))


def _spoilt_value(chance: random.Random, value: Any) -> Any:
    """Return plain data with one value changed."""
    if isinstance(value, list) and value and chance.random() < 0.8:
        at = chance.randrange(len(value))
        return [*value[:at], _spoilt_value(chance, value[at]), *value[at + 1 :]]
    if isinstance(value, dict) and value and chance.random() < 0.8:
        key = chance.choice(list(value))
        return {**value, key: _spoilt_value(chance, value[key])}
    if isinstance(value, str) and value and chance.random() < 0.8:
        at = chance.randrange(len(value))
        return value[:at] + chance.choice(PIECES) + value[at + chance.choice((0, 1, 5, 40)) :]
    return random_value(chance)
