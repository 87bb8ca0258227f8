"""Layout of directed graphs in layers from left to right, with a lane per group of nodes."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import fmean

Edge = tuple[str, str]
Point = tuple[float, float]
ROW = 44.0  # [px] from one node to the next below it
_PAD = 26.0  # [px] between lanes, and round them
_SWEEPS = 4


@dataclass(frozen=True)
class Layers:
    """Positions of nodes (centres), edges (points) and groups (x, y, width, height), [px]."""

    places: Mapping[str, Point]
    routes: Mapping[Edge, Sequence[Point]]
    boxes: Mapping[str, tuple[float, float, float, float]]
    size: Point


def layered(
    widths: Mapping[str, float], edges: Iterable[Edge], groups: Mapping[str, str], gap: float
) -> Layers:
    """Place nodes so that most edges lead to the right, with few crossings.

    Args:
        widths: Of the nodes, by name, [px].
        edges: From a node to another one.
        groups: The group of each node; "" is none.
        gap: Between two layers, [px].
    """
    edges = [edge for edge in dict.fromkeys(edges) if edge[0] != edge[1]]
    depths = _depths(list(widths), edges)
    chains = {edge: _chain(edge, depths) for edge in edges}
    links = [link for chain in chains.values() for link in pairwise(chain)]
    depth_of = {name: depth for chain in chains.values() for name, depth in chain} | depths
    lane_of = {name: groups[chain[0][0]] for chain in chains.values() for name, _ in chain} | dict(groups)
    cells: dict[tuple[str, int], list[str]] = {}
    for name in sorted(depth_of):
        cells.setdefault((lane_of[name], depth_of[name]), []).append(name)
    _untangle(cells, [(one[0], other[0]) for one, other in links])
    return _placed(cells, widths, chains, groups, gap)


def _depths(names: Sequence[str], edges: Sequence[Edge]) -> dict[str, int]:
    """Return the length of the longest path to each node; edges that close a circle do not count."""
    heights: dict[str, int] = {}  # the longest way from each node on; -1 while it is looked for

    def height(name: str) -> int:
        if name not in heights:
            heights[name] = -1
            heights[name] = 1 + max((height(end) for start, end in edges if start == name), default=-1)
        return heights[name]

    ends, depths = {end for _, end in edges}, dict[str, int]()
    for name in sorted(names, key=lambda name: name in ends):  # sources first
        height(name)
    for name in sorted(names, key=lambda name: -heights[name]):
        before = (start for start, end in edges if end == name and heights[start] > heights[name])
        depths[name] = 1 + max((depths[start] for start in before), default=-1)
    return depths


def _chain(edge: Edge, depths: Mapping[str, int]) -> list[tuple[str, int]]:
    """List the cells that an edge passes from left to right; long edges bend round other nodes."""
    left, right = sorted(edge, key=lambda name: depths[name])
    between = range(depths[left] + 1, depths[right])
    bends = [(f"{edge[0]}\0{edge[1]}\0{depth}", depth) for depth in between]
    return [(left, depths[left]), *bends, (right, depths[right])]


def _untangle(cells: Mapping[tuple[str, int], list[str]], links: Sequence[Edge]) -> None:
    """Sort each cell by the positions of its neighbours."""
    near: dict[str, list[str]] = {}
    for one, other in links:
        near.setdefault(one, []).append(other)
        near.setdefault(other, []).append(one)
    for sweep in range(_SWEEPS):
        rank = {name: index - len(cell) / 2 for cell in cells.values() for index, name in enumerate(cell)}
        for key in sorted(cells, key=lambda key: key[1], reverse=bool(sweep % 2)):
            middle = {name: fmean([rank[n] for n in near.get(name, [name])]) for name in cells[key]}
            cells[key].sort(key=lambda name, middle=middle: (middle[name], name))  # type: ignore[misc]  # bound now
            rank |= {name: index - len(cells[key]) / 2 for index, name in enumerate(cells[key])}


def _placed(
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
    left = [_PAD + sum(wide[:depth]) + gap * depth for depth in columns]
    places: dict[str, Point] = {}
    boxes: dict[str, tuple[float, float, float, float]] = {}
    y = 0.0
    for lane in sorted({lane for lane, _ in cells}):
        rows = max(len(cell) for (of, _), cell in cells.items() if of == lane)
        y += _PAD
        for (of, depth), cell in cells.items():
            top = y + ROW * (rows - len(cell)) / 2
            if of == lane:
                places |= {
                    n: (left[depth] + wide[depth] / 2, top + ROW * (i + 0.5)) for i, n in enumerate(cell)
                }
        members = [(places[n][0], widths[n] / 2) for n, group in groups.items() if lane and group == lane]
        if members:
            start = min(x - half for x, half in members) - 12
            boxes[lane] = start, y - 10, max(x + half for x, half in members) + 12 - start, ROW * rows + 14
        y += ROW * rows
    routes = {edge: _route(edge, chain, places, widths) for edge, chain in chains.items()}
    size = (max((x + w for x, w in zip(left, wide, strict=True)), default=0.0) + _PAD, y + _PAD)
    return Layers({name: places[name] for name in widths}, routes, boxes, size)


def _route(
    edge: Edge, chain: Sequence[tuple[str, int]], places: Mapping[str, Point], widths: Mapping[str, float]
) -> list[Point]:
    """Return the points of an edge from border to border; an edge that leads back is drawn lower."""
    back = chain[0][0] != edge[0]
    points = [places[name] for name, _ in chain]
    (x0, y0), (x1, y1) = points[0], points[-1]
    points[0] = x0 + widths[chain[0][0]] / 2, y0 + 7 * back
    points[-1] = x1 - widths[chain[-1][0]] / 2, y1 + 7 * back
    return points[::-1] if back else points
