"""`%rqt graph`: nodes and topics as a drawing, with the filters of rqt_graph's dotcode.py.

The layout is a layered drawing: nodes are assigned to columns by the longest path to them, an edge
over several columns gets a bend in each column between, and the nodes of a column are sorted by the
mean position of their neighbors so that few edges cross. Namespaces are drawn in separate lanes.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import fmean

from course_lib.errors import CourseError, format_count
from course_lib.ros.graph.graph import EndpointInfo
from course_lib.ros.graph.topics import find_incompatible_policy
from course_lib.tools.rqt.view import RqtView, drawing, tag, text

Edge = tuple[str, str]
Point = tuple[float, float]
# Vertical distance between nodes [px].
ROW = 44.0
# Margin between and around lanes [px].
_PAD = 26.0
# Number of passes that sort the columns.
_SWEEPS = 4


@dataclass(frozen=True)
class Layers:
    """Positions of nodes (centers), edges (points) and groups (x, y, width, height), [px]."""

    positions: Mapping[str, Point]
    routes: Mapping[Edge, Sequence[Point]]
    boxes: Mapping[str, tuple[float, float, float, float]]
    size: Point


def lay_out(
    widths: Mapping[str, float], edges: Iterable[Edge], groups: Mapping[str, str], gap: float
) -> Layers:
    """Place nodes so that most edges lead to the right and few of them cross.

    Args:
        widths: The width of each node, [px].
        edges: Pairs of start and end.
        groups: The group of each node; "" for none.
        gap: Distance between two columns, [px].
    """
    edges = [edge for edge in dict.fromkeys(edges) if edge[0] != edge[1]]
    depths = _depths(list(widths), edges)
    # The cells of each edge from left to right. Long edges bend around the nodes between.
    chains: dict[Edge, list[tuple[str, int]]] = {}
    for edge in edges:
        left_end, right_end = sorted(edge, key=lambda name: depths[name])
        between = range(depths[left_end] + 1, depths[right_end])
        bends = [(f"{edge[0]}\0{edge[1]}\0{depth}", depth) for depth in between]
        chains[edge] = [(left_end, depths[left_end]), *bends, (right_end, depths[right_end])]
    links = [link for chain in chains.values() for link in pairwise(chain)]
    depth_of = {name: depth for chain in chains.values() for name, depth in chain} | depths
    lane_of = {name: groups[chain[0][0]] for chain in chains.values() for name, _ in chain} | dict(groups)
    cells: dict[tuple[str, int], list[str]] = {}
    for name in sorted(depth_of):
        cells.setdefault((lane_of[name], depth_of[name]), []).append(name)
    _untangle(cells, [(start[0], end[0]) for start, end in links])
    return _place_cells(cells, widths, chains, groups, gap)


def _depths(names: Sequence[str], edges: Sequence[Edge]) -> dict[str, int]:
    """Return the length of the longest path to each node, ignoring edges that close a cycle."""
    # The longest path from each node; -1 while it is computed.
    heights: dict[str, int] = {}

    def height(name: str) -> int:
        if name not in heights:
            heights[name] = -1
            heights[name] = 1 + max((height(end) for start, end in edges if start == name), default=-1)
        return heights[name]

    ends, depths = {end for _, end in edges}, dict[str, int]()
    # Sources come first, so that a cycle is cut where it returns to them.
    for name in sorted(names, key=lambda name: name in ends):
        height(name)
    for name in sorted(names, key=lambda name: -heights[name]):
        sources = (start for start, end in edges if end == name and heights[start] > heights[name])
        depths[name] = 1 + max((depths[start] for start in sources), default=-1)
    return depths


def _untangle(cells: Mapping[tuple[str, int], list[str]], links: Sequence[Edge]) -> None:
    """Sort the nodes of each cell by the mean position of their neighbors."""
    neighbors: dict[str, list[str]] = {}
    for start, end in links:
        neighbors.setdefault(start, []).append(end)
        neighbors.setdefault(end, []).append(start)
    for sweep in range(_SWEEPS):
        rank = {name: index - len(cell) / 2 for cell in cells.values() for index, name in enumerate(cell)}
        for key in sorted(cells, key=lambda key: key[1], reverse=bool(sweep % 2)):
            middle = {name: fmean([rank[n] for n in neighbors.get(name, [name])]) for name in cells[key]}
            cells[key].sort(key=lambda name, middle=middle: (middle[name], name))  # type: ignore[misc]  # bound now
            rank |= {name: index - len(cells[key]) / 2 for index, name in enumerate(cells[key])}


def _place_cells(
    cells: Mapping[tuple[str, int], list[str]],
    widths: Mapping[str, float],
    chains: Mapping[Edge, Sequence[tuple[str, int]]],
    groups: Mapping[str, str],
    gap: float,
) -> Layers:
    columns = range(1 + max((depth for _, depth in cells), default=-1))
    wide = [
        max(widths.get(n, 0.0) for (_, at), c in cells.items() if at == depth for n in c) for depth in columns
    ]
    left_edges = [_PAD + sum(wide[:depth]) + gap * depth for depth in columns]
    positions: dict[str, Point] = {}
    boxes: dict[str, tuple[float, float, float, float]] = {}
    y = 0.0
    for lane in sorted({lane for lane, _ in cells}):
        rows = max(len(cell) for (of, _), cell in cells.items() if of == lane)
        y += _PAD
        for (of, depth), cell in cells.items():
            top = y + ROW * (rows - len(cell)) / 2
            if of == lane:
                positions |= {
                    n: (left_edges[depth] + wide[depth] / 2, top + ROW * (i + 0.5))
                    for i, n in enumerate(cell)
                }
        members = [(positions[n][0], widths[n] / 2) for n, group in groups.items() if lane and group == lane]
        if members:
            start = min(x - half for x, half in members) - 12
            boxes[lane] = start, y - 10, max(x + half for x, half in members) + 12 - start, ROW * rows + 14
        y += ROW * rows
    # The points of each edge from border to border. An edge to the left is drawn lower.
    routes: dict[Edge, list[Point]] = {}
    for edge, chain in chains.items():
        is_reversed = chain[0][0] != edge[0]
        points = [positions[name] for name, _ in chain]
        (x0, y0), (x1, y1) = points[0], points[-1]
        points[0] = x0 + widths[chain[0][0]] / 2, y0 + 7 * is_reversed
        points[-1] = x1 - widths[chain[-1][0]] / 2, y1 + 7 * is_reversed
        routes[edge] = points[::-1] if is_reversed else points
    size = (max((x + w for x, w in zip(left_edges, wide, strict=True)), default=0.0) + _PAD, y + _PAD)
    return Layers({name: positions[name] for name in widths}, routes, boxes, size)


NODES, ACTIVE, ALL = "Nodes only", "Nodes/Topics (active)", "Nodes/Topics (all)"
# The topics that each check box hides.
_KINDS = {
    "Debug": re.compile(r"/(rosout|clock|time|statistics|rqt|rviz|_ros2cli)|.*/_[^/]*$"),
    "tf": re.compile(r"/tf(_static)?$"),
    "Params": re.compile(r"/parameter_events$"),
}
_ARROW = (
    '<defs><marker id="rqt-arrow" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="8" markerHeight="8" '
    'orient="auto"><path d="M0 0 8 4 0 8z" fill="var(--rqt-dim)"/></marker></defs>'
)
# Suffix of topics on which some publisher and subscription do not match.
_BAD_QOS = " (QoS!)"
# Half the height of a node [px].
_HALF = 14.0


class GraphView(RqtView):
    """Nodes as ellipses and topics as boxes, dashed if incompatible QoS policies block messages."""

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
        endpoints = self._endpoints().items()
        # The topics on which some publisher does not match some subscription.
        bad_topics = {
            t for t, e in endpoints for a in e for b in e if a.kind < b.kind and _has_incompatible_qos(a, b)
        }
        names = {name: name.strip() + _BAD_QOS * (name[1:] in bad_topics) for name in sorted(nodes | topics)}
        if not names:
            return "<p>There is no node. Create one, like node = MyNode().</p>"
        widths = {name: 26 + 6.8 * len(label) for name, label in names.items()}
        longest = max((len(line) for lines in edges.values() for line in lines), default=0)
        is_grouped = self["Group namespaces"]
        groups = {name: label.rpartition("/")[0] if is_grouped else "" for name, label in names.items()}
        layers = lay_out(widths, edges, groups, 60 + 6.2 * longest)
        shapes = [_ARROW]
        look = {"fill": "var(--rqt-dim)", "fill_opacity": ".08", "stroke": "var(--rqt-line)"}
        for name, (x, y, width, height) in layers.boxes.items():
            shapes.append(tag("rect", x=x, y=y, width=width, height=height, rx=6, **look))
            shapes.append(text(name, x + 6, y + 13, font_size=11))
        shapes += [_edge(layers, edge, lines) for edge, lines in edges.items()]
        shapes += [
            _node(layers.positions[n], widths[n], names[n], n in topics, n[1:] in bad_topics) for n in names
        ]
        links = (f"{names[a]} to {names[b]} {' '.join(lines)}".strip() for (a, b), lines in edges.items())
        return drawing(
            "".join(shapes), *layers.size, f"{format_count(len(nodes), 'node')}. {', '.join(links)}"
        )

    def _is_displayed(self, name: str, kind: str) -> bool:
        is_hidden = any(rule.match(name) and self[f"Hide {kind_name}"] for kind_name, rule in _KINDS.items())
        return not is_hidden and matches_filter(name, self[f"{kind} filter"])

    def _names(self) -> dict[int, str]:
        """Return the full names of the shown nodes by id."""
        full = {node.id: node.full_name for node in self.graph.nodes()}
        return {number: name for number, name in full.items() if self._is_displayed(name, "Node")}

    def _endpoints(self) -> dict[str, list[EndpointInfo]]:
        """Return the endpoints of shown topics at shown nodes.

        As in rqt, the topics of an action count as one.
        """
        names, endpoints_by_topic = self._names(), dict[str, list[EndpointInfo]]()
        for info in self.graph.endpoints():
            topic = re.sub("/_action/.*", "/action_topics", info.topic)
            if info.service is None and info.node in names and self._is_displayed(topic, "Topic"):
                endpoints_by_topic.setdefault(topic, []).append(info)
        shown_endpoints = {}
        for topic, endpoints in sorted(endpoints_by_topic.items()):
            kinds = [info.kind for info in endpoints]
            is_dead = self["Hide Dead sinks"] and "sub" not in kinds
            is_leaf = self["Hide Leaf topics"] and len(kinds) < 2
            if not (is_dead or is_leaf or (self["Show"] != ALL and len(set(kinds)) < 2)):
                shown_endpoints[topic] = endpoints
        return shown_endpoints

    def _edges(self) -> dict[Edge, list[str]]:
        """Return the labels of each arrow. As in rqt, names of topics begin with a space."""
        names, edges = self._names(), dict[Edge, list[str]]()
        for topic, endpoints in self._endpoints().items():
            if self["Show"] == NODES:
                pairs = ((a, b) for a in endpoints for b in endpoints if (a.kind, b.kind) == ("pub", "sub"))
                for a, b in pairs:
                    lines = edges.setdefault((names[a.node], names[b.node]), [])
                    line = topic + _BAD_QOS * _has_incompatible_qos(a, b)
                    lines += [line] if line not in lines else []
            else:
                for info in endpoints:
                    edge = (names[info.node], f" {topic}")
                    edges[edge if info.kind == "pub" else edge[::-1]] = []
        return edges


def _has_incompatible_qos(publisher: EndpointInfo, subscription: EndpointInfo) -> bool:
    """Return whether two endpoints are on the same topic but with incompatible QoS policies."""
    same = publisher.topic == subscription.topic
    return same and bool(find_incompatible_policy(publisher.qos, subscription.qos))


def matches_filter(name: str, rule: str) -> bool:
    """Return whether a name matches a filter of comma-separated patterns.

    A leading - excludes names.

    Raises:
        CourseError: A pattern is not a regular expression.
    """
    patterns = [pattern.strip() for pattern in rule.split(",") if pattern.strip() not in ("", "/")]
    try:
        is_excluded = any(re.fullmatch(pattern[1:], name) for pattern in patterns if pattern.startswith("-"))
        included = [pattern for pattern in patterns if not pattern.startswith("-")]
        return not is_excluded and (not included or any(re.fullmatch(pattern, name) for pattern in included))
    except re.error as error:
        raise CourseError(
            f"{rule!r} is not a filter: {error}. Write names or patterns, like /arm/.*, -/tf"
        ) from error


def _node(at: Point, width: float, label: str, is_topic: bool, is_bad: bool) -> str:
    (x, y), half = at, width / 2
    border = {"stroke": "#c9281f", "stroke_dasharray": "4 3", "stroke_width": "2"}
    look = border if is_bad else {"stroke": "var(--rqt-text)"}
    if is_topic:
        box = {"x": x - half, "y": y - _HALF + 2, "width": width, "height": 2 * _HALF - 4}
        shape = tag("rect", fill="var(--rqt-back)", **box, **look)
    else:
        shape = tag("ellipse", cx=x, cy=y, rx=half, ry=_HALF, fill="#4c8dd6", fill_opacity=".18", **look)
    why = "<title>Incompatible QoS: some subscriptions do not receive all messages</title>" if is_bad else ""
    return tag("g", why + shape + text(label, x, y + 4, "middle"))


def _edge(layers: Layers, edge: Edge, lines: list[str]) -> str:
    if edge[0] == edge[1]:
        x, y = layers.positions[edge[0]]
        path = f"M{x - 14} {y - 13}C{x - 26} {y - 34} {x + 26} {y - 34} {x + 14} {y - 13}"
        x, y = x, y - 30
    else:
        points = layers.routes[edge]
        path = f"M{points[0][0]:.1f} {points[0][1]:.1f}"
        for (x0, y0), (x1, y1) in pairwise(points):
            bend = (x0 + x1) / 2
            path += f"C{bend:.1f} {y0:.1f} {bend:.1f} {y1:.1f} {x1:.1f} {y1:.1f}"
        # Labels are near the start, so that the labels of an edge and of its reverse do not
        # overlap.
        (x, y), (x1, y1) = points[:2]
        x, y = x + 0.35 * (x1 - x), y + 0.25 * (y1 - y)
    halo = {"stroke": "var(--rqt-back)", "stroke_width": 4, "paint_order": "stroke", "font_size": 11}
    top = y - 4 - 6.5 * (len(lines) - 1)
    labels = "".join(text(line, x, top + 13 * row, "middle", **halo) for row, line in enumerate(lines))
    look = {"fill": "none", "stroke": "var(--rqt-dim)", "marker_end": "url(#rqt-arrow)"}
    return tag("path", d=path, stroke_width=1.3, **look) + labels
