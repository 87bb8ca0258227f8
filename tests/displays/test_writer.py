from pathlib import Path

import pytest
from ruamel.yaml import YAML

from course_lib.displays.layout import read_layout
from course_lib.displays.session import Session
from course_lib.displays.views import Orbit
from course_lib.displays.writer import document, save_rviz
from course_lib.errors import CourseError
from course_lib.viewer.scene import Scene
from tests.displays.test_layout import LAYOUT

REAL = sorted((Path(__file__).parents[1] / "data" / "rviz_reference").glob("*/view.rviz"))


def session_of(path: Path) -> Session:
    session = Session(Scene())
    session.apply(read_layout(path))
    return session


def saved(session: Session, path: Path) -> str:
    save_rviz(session, path)
    return path.read_text(encoding="utf-8")


@pytest.fixture
def layout(tmp_path: Path) -> Path:
    path = tmp_path / "view.rviz"
    path.write_text(LAYOUT)
    return path


@pytest.mark.parametrize("path", REAL, ids=lambda path: path.parent.name)
def test_saving_what_was_saved_changes_nothing(path: Path, tmp_path: Path) -> None:
    once = saved(session_of(path), tmp_path / "once.rviz")
    assert saved(session_of(tmp_path / "once.rviz"), tmp_path / "twice.rviz") == once


def test_what_is_not_known_is_kept(layout: Path) -> None:
    foreign = {"Class": "my_plugins/Thing", "Odd": {"b": None, "a": ""}, "Enabled": True, "Name": "Thing"}
    with layout.open() as file:
        text = YAML(typ="safe").load(file)
    text["Visualization Manager"]["Displays"].append(foreign)
    text["Visualization Manager"]["Tools"] = [{"Class": "my_plugins/Tool", "Topic": "/x"}]
    with layout.open("w") as file:
        YAML().dump(text, file)
    manager = document(session_of(layout))["Visualization Manager"]
    assert manager["Displays"][-1] == foreign
    assert manager["Tools"] == [{"Class": "my_plugins/Tool", "Topic": "/x"}]


def test_groups_stay_groups(layout: Path) -> None:
    group = document(session_of(layout))["Visualization Manager"]["Displays"][1]
    assert (group["Class"], [inner["Name"] for inner in group["Displays"]]) == (
        "rviz_common/Group",
        ["Boxes"],
    )


def test_values_have_the_forms_of_rviz(layout: Path, tmp_path: Path) -> None:
    session = session_of(layout)
    session.saved_views.append(Orbit(distance=0.3))
    text = saved(session, tmp_path / "saved.rviz")
    for line in (
        "        Line Width: 0.10000000149011612", "      Color: 160; 160; 164", "        X: 1",
        "          Namespaces:\n            {}", '  Class: ""', "        Distance: 0.30000001192092896",
    ):  # fmt: skip
        assert f"{line}\n" in text


def test_keys_are_sorted_as_in_qt_maps(layout: Path, tmp_path: Path) -> None:
    (grid, *_) = YAML(typ="safe").load(saved(session_of(layout), tmp_path / "saved.rviz"))[
        "Visualization Manager"
    ]["Displays"]
    assert list(grid) == sorted(grid)


def test_no_saved_view_is_a_null(layout: Path, tmp_path: Path) -> None:
    assert "    Saved: ~\n" in saved(session_of(layout), tmp_path / "saved.rviz")


def test_a_folder_that_is_not_there_is_named(layout: Path, tmp_path: Path) -> None:
    with pytest.raises(CourseError, match="nowhere"):
        save_rviz(session_of(layout), tmp_path / "nowhere" / "view.rviz")
