"""No YAML file causes a traceback, and saving a loaded layout twice gives equal files."""

from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from course_lib.displays.layout import read_layout, yaml_text
from course_lib.displays.registry import REGISTRY
from course_lib.displays.session import RvizSession
from course_lib.displays.views import VIEWS
from course_lib.displays.writer import save_rviz
from course_lib.errors import CourseError
from course_lib.viewer.scene import Scene
from tests.displays.test_layout import LAYOUT

LINES = LAYOUT.splitlines()
ODD = [
    "", "~", "{}", "[]", "-1", "1e999", ".nan", "0x10", "[1, [2]]", "{a: b}", "*x", "&x y", "'", "\t", "- ",
    "!!int x", "yes", "1; 2", "\u2028", "🤖", "\x00", "2001-01-01", "<<: 1", "? a", "|", "# no",
]  # fmt: skip
LABELS = sorted({prop.label for display in REGISTRY.values() for prop in display.properties} | {"Displays"})
OPTIONS = ["Fixed Frame", "Frame Rate", "Background Color"]
HOW = ["cut", "twice", "value", "odd"]
scalars = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5) | st.sampled_from(ODD)
values = st.recursive(
    scalars,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(LABELS), inner, max_size=3),
    max_leaves=5,
)
classes = st.sampled_from([*REGISTRY, "rviz/Grid", "my/Thing", "rviz_common/Group"])


def configured(names: st.SearchStrategy[str]) -> st.SearchStrategy[Any]:
    """Return configurations of classes, with properties that some class has."""
    properties = st.dictionaries(st.sampled_from(LABELS), values, max_size=6)
    return st.builds(lambda name, given: {**given, "Class": name}, names, properties)


views = {"Current": configured(st.sampled_from([*VIEWS])) | values, "Saved": values}
managers = st.fixed_dictionaries(
    {
        "Displays": st.lists(configured(classes) | values, max_size=3),
        "Global Options": st.dictionaries(st.sampled_from(OPTIONS), values),
        "Tools": st.lists(values, max_size=2) | values,
        "Views": st.fixed_dictionaries(views) | values,
    }
)
edited = st.tuples(st.sampled_from(range(len(LINES))), st.sampled_from(HOW), st.sampled_from(ODD))


def check(text: str, folder: Path) -> None:
    """Open a layout, save it, and open the saved file. Any error except `CourseError` fails."""
    first, second, third = (folder / name for name in ("first.rviz", "second.rviz", "third.rviz"))
    first.write_text(text, encoding="utf-8")
    try:
        layout = read_layout(first)
    except CourseError:
        return
    session = RvizSession(Scene())
    session.apply(layout)
    session.rows()
    save_rviz(session, second)
    reloaded = RvizSession(Scene())
    reloaded.apply(read_layout(second))
    save_rviz(reloaded, third)
    assert third.read_text() == second.read_text()


@pytest.mark.slow
@given(edits=st.lists(edited, max_size=4))
@settings(max_examples=60, deadline=None)
def test_hand_edited_layout_is_loaded_or_reported(
    edits: list[tuple[int, str, str]], tmp_path_factory: Any
) -> None:
    lines = list(LINES)
    for at, how, odd in edits:
        line = lines[at]
        key = line.partition(":")[0]
        lines[at] = {"cut": "", "twice": f"{line}\n{line}", "value": f"{key}: {odd}", "odd": line + odd}[how]
    check("\n".join(lines), tmp_path_factory.mktemp("odd"))


@pytest.mark.slow
@given(manager=managers)
@settings(max_examples=60, deadline=None)
def test_any_readable_yaml_is_loaded_and_saved_unchanged(manager: Any, tmp_path_factory: Any) -> None:
    check(yaml_text({"Visualization Manager": manager}), tmp_path_factory.mktemp("odd"))


@given(text=st.text(alphabet=st.sampled_from("ab:-?[]{}&*!|>'\"%@#\n ~\t"), max_size=40))
@settings(max_examples=60, deadline=None)
@example(text="&a [*a, *a]")
def test_any_text_is_parsed_as_yaml_or_is_an_error_with_its_position(
    text: str, tmp_path_factory: Any
) -> None:
    check(text, tmp_path_factory.mktemp("odd"))


# Not an example, because hypothesis raises the recursion limit, and the time grows quadratically.
def test_excessive_nesting_is_an_error_with_its_position(tmp_path: Path) -> None:
    (tmp_path / "odd.rviz").write_text("[" * 5000)
    with pytest.raises(CourseError, match=r"line 1, column 1001: .*maximum nesting depth"):
        read_layout(tmp_path / "odd.rviz")
