from itertools import combinations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from course_lib.tools.rqt.graph import ROW, lay_out

GRAPHS = st.integers(1, 8).flatmap(
    lambda n: st.tuples(
        st.just(n), st.lists(st.tuples(st.integers(0, n - 1), st.integers(0, n - 1)), max_size=12)
    )
)


@pytest.mark.slow
@given(GRAPHS, st.booleans())
def test_nodes_never_overlap_and_stay_inside_the_image(
    graph: tuple[int, list[tuple[int, int]]], grouped: bool
) -> None:
    names = [f"n{i}" for i in range(graph[0])]
    widths = {name: 40.0 + 10 * i for i, name in enumerate(names)}
    edges = [(names[a], names[b]) for a, b in graph[1]]
    groups = {name: f"g{i % 3}" if grouped else "" for i, name in enumerate(names)}
    layers = lay_out(widths, edges, groups, 50.0)
    for one, other in combinations(names, 2):
        (x0, y0), (x1, y1) = layers.positions[one], layers.positions[other]
        assert abs(y0 - y1) >= ROW / 2 - 1e-6 or abs(x0 - x1) >= (widths[one] + widths[other]) / 2
    for name, (x, y) in layers.positions.items():
        assert 0 <= x - widths[name] / 2 <= x + widths[name] / 2 <= layers.size[0]
        assert 0 <= y <= layers.size[1]
    assert set(layers.routes) == {edge for edge in edges if edge[0] != edge[1]}


def test_edges_lead_to_the_right_and_each_cycle_is_cut_once() -> None:
    names = ["a", "b", "c"]
    edges = [("a", "b"), ("b", "c"), ("c", "a")]
    layers = lay_out(dict.fromkeys(names, 40.0), edges, dict.fromkeys(names, ""), 50.0)
    to_right = [layers.routes[edge][-1][0] > layers.routes[edge][0][0] for edge in edges]
    assert sum(to_right) == 2


def test_group_box_encloses_only_its_nodes() -> None:
    groups = {"a": "", "b": "/g", "c": "/g"}
    layers = lay_out(dict.fromkeys(groups, 40.0), [("a", "b"), ("b", "c")], groups, 50.0)
    ((x, y, width, height),) = layers.boxes.values()
    inside = {n for n, (nx, ny) in layers.positions.items() if x <= nx <= x + width and y <= ny <= y + height}
    assert inside == {"b", "c"}
