"""Mistakes that a program can make to any right solution; shared by all weeks."""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass

Replacement = str | Callable[[re.Match[str]], str]


@dataclass(frozen=True)
class Operator:
    """One kind of mistake: every place where the pattern matches gives one mutant.

    Args:
        name: Kind of mistake, and which.
        pattern: Where it is made, a regular expression.
        replacement: What stands there then.
        names: What some message or kind of mistake must say of it, a regular expression.
        only_other_inputs: Whether it is right for the inputs of the public scenario.
    """

    name: str
    pattern: str
    replacement: Replacement
    names: str
    only_other_inputs: bool = False


GEOMETRY = "position|[Dd]istance|size|scale|circle|point|width|height|line|at the end|turn|the part"

OPERATORS = (
    Operator(
        "sign: sine",
        r"math\.sin\(",
        "-math.sin(",
        "direction|clockwise|sign|value|turned|orientation|position",
    ),
    Operator("sign: height", r"(position\.z = )", r"\1-", "position|height"),
    Operator("frame", r'frame_id = "map"', 'frame_id = "base_link"', "frame"),
    Operator("unit: centimetres", r"(?<=[=*] )(\d+\.\d+)(?=.*# \[m\])", r"\1 * 100", GEOMETRY),
    Operator("unit: degrees", r"2 \* math\.pi", "360", "turn|direction|circle|shorter way|swing"),
    Operator("stamp: not set", r"(marker|state)\.header\.stamp = .*", "pass", "stamp"),
    Operator(
        "stamp: late",
        r"((?:marker|state)\.header\.stamp) = .*",
        r'\1 = (self.get_clock().now() - __import__("rclpy").duration.Duration(seconds=1)).to_msg()',
        "stamp",
    ),
    Operator(
        "constant: length", r"(?<== )(\d+\.\d+)(?= .*# \[m\])", lambda m: f"{float(m[1]) + 0.1:.2f}", GEOMETRY
    ),
    Operator(
        "constant: color",
        r"(marker\.color\.[^=]*[ba] = .*)(?<=\D)1\.0|(?<=color\.a = )0\.8",
        r"\g<1>0.5",
        "color|wide",
    ),
    Operator(
        "constant: rate", r"create_timer\((\d\.\d)", r"create_timer(2 * \1", "rate|slow|turn|wrong time"
    ),
    Operator("off by one: first item lost", r"enumerate\((\w+)\)", r"enumerate(\1[1:])", "shows 2|count"),
    Operator("off by one: one number for all", r"id=number", "id=0", "shows 1|count"),
    Operator("off by one: last point lost", r"\[\*(\w+), \1\[0\]\]", r"\1", "points"),
    Operator(
        "off by one: one id for all", r"id=int\([^)]*\)", "id=0", r"id|shows \d|count|no marker|place|turn"
    ),
    Operator("half forgotten", r" / 2(?= \+|  #)", "", GEOMETRY),
    Operator("layout: policy", '"Best Effort"', '"Reliable"', "Reliab|RELIAB|status|draws nothing"),
    Operator("layout: fixed frame", r'(fixed_frame ?= ?)"world"', r'\1"map"', "Fixed Frame"),
    Operator("comparison: limit", "charge >= ", "charge > ", "value"),
    Operator("groups not entered", r"yield from found\(.*", "continue", "list"),
    Operator("comparison turned", r"(?<=score) >= ", " < ", "shows|count|no marker"),
    Operator("lifetime: none", r"marker\.lifetime = .*", "pass", "lifetime"),
    Operator(
        "frame: not copied",
        r"(marker\.header)( = message\.header)(?=\n)",
        r"\1.stamp\2.stamp",
        "frame",
    ),
    Operator(
        "stamp: not copied", r"(marker\.header)( = message\.header)(?=\n)", r"\1.frame_id\2.frame_id", "stamp"
    ),
    Operator("frame: misspelled", r'stamped\("base_link"', 'stamped("base"', "frame|tree|tf2"),
    Operator(
        "frame: parent and child exchanged",
        r'stamped\("(\w+)", "(\w+)"',
        r'stamped("\2", "\1"',
        "parent|tf2|place|frame|came",
    ),
    Operator(
        "stamp: 0",
        r"self\.get_clock\(\)\.now\(\)\.to_msg\(\)(?=\n.*hand_link)",
        "TransformStamped().header.stamp",
        "tf2|stamp|transform",
    ),
    Operator("yaw: outward", r" \+ math\.pi / 2(?=\n)", "", "turned|orientation"),
    Operator("frame: map, always", r', "map"\)', ', "base_link")', "frame|missing"),
    Operator("turn: the long way", r"math\.remainder\((.*), 2 \* math\.pi\)", r"(\1)", "way round|wrong"),
    Operator(
        "unit: degrees for radians", r"math\.radians\((\w+)\)", r"\1", "degrees, where radians are wanted"
    ),
    Operator("joint: misspelled", r'"elbow_joint"', '"elbow"', "has no joint elbow"),
    Operator("joint: the last one lost", r"(\.position = \[.*), 0\.0\]", r"\1]", "names and .* positions"),
    Operator(
        "order: turned, then shifted", r"@ (shifted\(.*\)) @ (turned\(.*\))", r"@ \2 @ \1", "value is wrong"
    ),
    Operator("beams: those that do not count", r" if low <= \w+ <= high", "", "position"),
    Operator("type", r"Marker\.(CUBE|SPHERE|CYLINDER|LINE_STRIP)", "Marker.POINTS", "type|shows 0|POINTS"),
    Operator("threshold", r" ([<>]=?) (\d\.\d+)(?=.*# \[m\])", r" \1 3 * \2", "points|shows|value|nothing"),
    Operator("frame: of the map", r'place\("base_link"', 'place("map"', "points|shows"),
    Operator("off by one: no new stripe", r"\.id \+ 1", ".id", "shows"),
    Operator("joint: prefix lost", r'"ur10(?=elbow)', '"', "the controller refuses"),
    Operator("velocities: none", r", velocities=\[[^)]*(?=\))", "", "has no velocities"),
    Operator("unit: seconds", r"(time_from_start\.)sec = 3", r"\1nanosec = 3", "time of a trajectory"),
    Operator("threshold: just sure enough", r">= threshold", "> threshold", "shows|count"),
    Operator("order: the worst first", ", reverse=True", "", "id|shows|count|expected '/"),
    Operator("stale: shown for ever", r"age_of\(.*\) > ", "0 > ", "shows|count"),
    Operator("color: of every class", r"self\.has_parameter\((\w+)\)", "False", "color"),
    Operator("axes: rows from columns", r"k\[4\] \* y", "k[4] * x", "rectangle|value"),
    Operator("center: forgotten", r" \+ k\[2\]", "", "rectangle|value"),
    Operator("behind: forgotten", r"any\(z < ", "any(z < -9", "items|rectangle|value"),
    Operator("trajectory: endless", r"\[-most:\]", "", "poses"),
    Operator("orientation: forgotten", r"pose\.pose\.orientation = .*", "pass", "orientation"),
    Operator(
        "transform: the other way round",
        r"lookup_transform\(world, base,",
        "lookup_transform(base, world,",
        "place|frame",
    ),
    Operator("type: an integer for a double", r"5\.0\n", "5\n", "double"),
    Operator("parameters: of another node", "trajectory_node:", "trajectory:", "gets no"),
    Operator("paths: one color", r"255; 160; 0", "25; 255; 0", "colors"),
    Operator("edge: the wrong end", r"cut\(b, a\), cut\(a, b\)", "cut(a, b), cut(b, a)", "part|value"),
    Operator("clip: none", r"min\(max\((.*), 0\.0\), 1\.0\)", r"\1", "value"),
    Operator("sign: height of the wrist", r"-math\.atan2\(up", "math.atan2(up", "value"),
    Operator("half of the wall", r"\.mean\(\)", ".sum()", "value"),
    Operator("count: never back to 0", r"(publish\(array\)\n +)self\.count = 0", r"\1pass", "the level is"),
    Operator("off by one: n gaps", r"\(len\(times\) - 1\)", "len(times)", "expected"),
    Operator("unit: milliseconds", r"round\(stamp \* 1000\)", "round(stamp)", "expected"),
    Operator("limit: none above", r"<= 60\.0", "<= 600.0", "too fast"),
    Operator("parameter: followed no more", r"1 / parameter\.value", "1000", "nothing|once|silent|too slow"),
    Operator(
        "hard-coded: one student's value",
        r"my_values\(.*?\)\[.*?\]",
        "9.9",
        f"{GEOMETRY}|too slow|your robot|'Keep'|threshold|shows 0 markers|word behind",
    ),
    Operator(
        "hard-coded: as long as the public run",
        r"(self\.publisher\.publish\((marker|state)\))",
        r"(self.get_clock().now().nanoseconds < 1_700_000_006_500_000_000) and \1",
        "silent|too few",
        only_other_inputs=True,
    ),
)


def mutants(code: str) -> Iterator[tuple[Operator, str]]:
    """Yield (operator, mutated code) for every place where an operator applies."""
    for operator in OPERATORS:
        for match in re.finditer(operator.pattern, code):
            new = (
                operator.replacement(match)
                if callable(operator.replacement)
                else match.expand(operator.replacement)
            )
            yield operator, code[: match.start()] + new + code[match.end() :]
