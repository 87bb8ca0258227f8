"""`%rqt graph`: nodes and topics as a drawing, with the filters of rqt_graph's dotcode.py."""

import re
from collections.abc import Iterable
from itertools import pairwise

from course_lib.errors import CourseError, counted
from course_lib.ros.graph import EndpointInfo
from course_lib.ros.qos import incompatible
from course_lib.tools.rqt.layered import Edge, Layers, Point, layered
from course_lib.tools.rqt.markup import drawing, tag, text
from course_lib.tools.rqt.view import RqtView

NODES, ACTIVE, ALL = "Nodes only", "Nodes/Topics (active)", "Nodes/Topics (all)"
_KINDS = {  # what each check box hides
    "Debug": re.compile(r"/(rosout|clock|time|statistics|rqt|rviz|_ros2cli)|.*/_[^/]*$"),
    "tf": re.compile(r"/tf(_static)?$"),
    "Params": re.compile(r"/parameter_events$"),
}
_ARROW = (
    '<defs><marker id="rqt-arrow" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="8" markerHeight="8" '
    'orient="auto"><path d="M0 0 8 4 0 8z" fill="var(--rqt-dim)"/></marker></defs>'
)
_BAD = " (QoS!)"  # some publisher does not reach some subscription
_HALF = 14.0  # [px] half the height of a node


class GraphView(RqtView):
    """Nodes as ellipses, topics as boxes, dashed where incompatible QoS keeps messages back."""

    name, title = "graph", "Node Graph"

    def build(self) -> None:
        """Create the controls of rqt_graph."""
        self.add_choice("Show", (NODES, ACTIVE, ALL), ACTIVE)
        self.add_text("Node filter", "/")
        self.add_text("Topic filter", "/")
        for name in ("Dead sinks", "Leaf topics", *_KINDS):
            self.add_check(f"Hide {name}", on=name in ("Debug", "Params"))
        self.add_check("Group namespaces", on=True)

    def picture(self) -> str:
        """Draw the graph as SVG."""
        nodes, edges = set(self._names().values()), self._edges()
        topics = {name for edge in edges for name in edge} - nodes
        bad = self._incompatible()
        names = {name: name.strip() + _BAD * (name[1:] in bad) for name in sorted(nodes | topics)}
        if not names:
            return "<p>No node is there: make one, like node = MyNode().</p>"
        widths = {name: 26 + 6.8 * len(words) for name, words in names.items()}
        longest = max((len(line) for lines in edges.values() for line in lines), default=0)
        is_grouped = self["Group namespaces"]
        groups = {name: words.rpartition("/")[0] if is_grouped else "" for name, words in names.items()}
        layers = layered(widths, edges, groups, 60 + 6.2 * longest)
        shapes = [_ARROW, *map(_group, layers.boxes, layers.boxes.values())]
        shapes += [_edge(layers, edge, lines) for edge, lines in edges.items()]
        shapes += [_node(layers.places[n], widths[n], names[n], n in topics, n[1:] in bad) for n in names]
        links = (f"{names[a]} to {names[b]} {' '.join(lines)}".strip() for (a, b), lines in edges.items())
        return drawing("".join(shapes), *layers.size, f"{counted(len(nodes), 'node')}. {', '.join(links)}")

    def _shown(self, name: str, kind: str) -> bool:
        hidden = any(rule.match(name) and self[f"Hide {what}"] for what, rule in _KINDS.items())
        return not hidden and passes(name, self[f"{kind} filter"])

    def _names(self) -> dict[int, str]:
        """Return the full names of the shown nodes, by id."""
        full = {node.id: node.full_name for node in self.graph.nodes()}
        return {number: name for number, name in full.items() if self._shown(name, "Node")}

    def _ends(self) -> dict[str, list[EndpointInfo]]:
        """Return the shown topics' endpoints at shown nodes; an action's topics are one, as in rqt."""
        names, found = self._names(), dict[str, list[EndpointInfo]]()
        for end in self.graph.endpoints():
            topic = re.sub("/_action/.*", "/action_topics", end.topic)
            if end.service is None and end.node in names and self._shown(topic, "Topic"):
                found.setdefault(topic, []).append(end)
        return {topic: ends for topic, ends in sorted(found.items()) if not self._is_left_out(ends)}

    def _is_left_out(self, ends: Iterable[EndpointInfo]) -> bool:
        kinds = [end.kind for end in ends]
        return (
            (self["Show"] != ALL and len(set(kinds)) < 2)
            or (self["Hide Dead sinks"] and "sub" not in kinds)
            or (self["Hide Leaf topics"] and len(kinds) < 2)
        )

    def _edges(self) -> dict[Edge, list[str]]:
        """Return the arrows with their labels; names of topics begin with a space, as in rqt."""
        names, edges = self._names(), dict[Edge, list[str]]()
        for topic, ends in self._ends().items():
            if self["Show"] == NODES:
                pairs = ((a, b) for a in ends for b in ends if (a.kind, b.kind) == ("pub", "sub"))
                for a, b in pairs:
                    lines = edges.setdefault((names[a.node], names[b.node]), [])
                    line = topic + _BAD * _mismatch(a, b)
                    lines += [line] if line not in lines else []
            else:
                for end in ends:
                    ways = (names[end.node], f" {topic}")
                    edges[ways if end.kind == "pub" else ways[::-1]] = []
        return edges

    def _incompatible(self) -> set[str]:
        """Return the topics on which some publisher does not match some subscription."""
        ends = self._ends().items()
        return {t for t, e in ends for a in e for b in e if a.kind < b.kind and _mismatch(a, b)}


def _mismatch(publisher: EndpointInfo, subscription: EndpointInfo) -> bool:
    """Return whether two ends meet on one topic, not only in one action, and their QoS do not fit."""
    same = publisher.topic == subscription.topic
    return same and bool(incompatible(publisher.qos, subscription.qos))


def passes(name: str, rule: str) -> bool:
    """Return whether a name passes a filter of comma-separated patterns; a leading - excludes names.

    Raises:
        CourseError: One is not a regular expression.
    """
    parts = [part.strip() for part in rule.split(",") if part.strip() not in ("", "/")]
    try:
        out = any(re.fullmatch(part[1:], name) for part in parts if part.startswith("-"))
        wanted = [part for part in parts if not part.startswith("-")]
        return not out and (not wanted or any(re.fullmatch(part, name) for part in wanted))
    except re.error as error:
        raise CourseError(
            f"{rule!r} is not a filter: {error}. Write names or patterns, like /arm/.*, -/tf"
        ) from error


def _group(name: str, box: tuple[float, float, float, float]) -> str:
    x, y, width, height = box
    look = {"fill": "var(--rqt-dim)", "fill_opacity": ".08", "stroke": "var(--rqt-line)"}
    frame = tag("rect", x=x, y=y, width=width, height=height, rx=6, **look)
    return frame + text(name, x + 6, y + 13, font_size=11)


def _node(at: Point, width: float, words: str, is_topic: bool, is_bad: bool) -> str:
    (x, y), half = at, width / 2
    border = {"stroke": "#c9281f", "stroke_dasharray": "4 3", "stroke_width": "2"}
    look = border if is_bad else {"stroke": "var(--rqt-text)"}
    if is_topic:
        box = {"x": x - half, "y": y - _HALF + 2, "width": width, "height": 2 * _HALF - 4}
        shape = tag("rect", fill="var(--rqt-back)", **box, **look)
    else:
        shape = tag("ellipse", cx=x, cy=y, rx=half, ry=_HALF, fill="#4c8dd6", fill_opacity=".18", **look)
    why = "<title>Incompatible QoS: not every subscription hears every publisher</title>" if is_bad else ""
    return tag("g", why + shape + text(words, x, y + 4, "middle"))


def _edge(layers: Layers, edge: Edge, lines: list[str]) -> str:
    if edge[0] == edge[1]:
        x, y = layers.places[edge[0]]
        path = f"M{x - 14} {y - 13}C{x - 26} {y - 34} {x + 26} {y - 34} {x + 14} {y - 13}"
        x, y = x, y - 30
    else:
        points = layers.routes[edge]
        path = f"M{points[0][0]:.1f} {points[0][1]:.1f}"
        for (x0, y0), (x1, y1) in pairwise(points):
            bend = (x0 + x1) / 2
            path += f"C{bend:.1f} {y0:.1f} {bend:.1f} {y1:.1f} {x1:.1f} {y1:.1f}"
        (x, y), (x1, y1) = points[:2]  # labels stand near the start: the way back has its own
        x, y = x + 0.35 * (x1 - x), y + 0.25 * (y1 - y)
    halo = {"stroke": "var(--rqt-back)", "stroke_width": 4, "paint_order": "stroke", "font_size": 11}
    top = y - 4 - 6.5 * (len(lines) - 1)
    labels = "".join(text(line, x, top + 13 * row, "middle", **halo) for row, line in enumerate(lines))
    look = {"fill": "none", "stroke": "var(--rqt-dim)", "marker_end": "url(#rqt-arrow)"}
    return tag("path", d=path, stroke_width=1.3, **look) + labels
