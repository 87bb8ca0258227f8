import errno
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
import yaml

from course_lib import Viewer
from course_lib.displays.layout import read_layout
from course_lib.displays.session import RvizSession
from course_lib.displays.views import Orbit
from course_lib.displays.writer import document, save_rviz
from course_lib.errors import CourseError
from course_lib.viewer.renderer import Picture
from course_lib.viewer.scene import Scene
from tests.displays.test_layout import LAYOUT
from tests.patience import PATIENCE

REAL = sorted((Path(__file__).parents[1] / "data" / "rviz_reference").glob("*/view.rviz"))


def session_of(path: Path) -> RvizSession:
    session = RvizSession(Scene())
    session.apply(read_layout(path))
    return session


def saved(session: RvizSession, path: Path) -> str:
    save_rviz(session, path)
    return path.read_text(encoding="utf-8")


def saved_path(session: RvizSession, folder: Path) -> Path:
    save_rviz(session, folder / "saved.rviz")
    return folder / "saved.rviz"


@pytest.fixture
def layout(tmp_path: Path) -> Path:
    path = tmp_path / "view.rviz"
    path.write_text(LAYOUT)
    return path


@pytest.mark.parametrize("path", REAL, ids=lambda path: path.parent.name)
def test_saving_a_loaded_layout_is_idempotent(path: Path, tmp_path: Path) -> None:
    once = saved(session_of(path), tmp_path / "once.rviz")
    assert saved(session_of(tmp_path / "once.rviz"), tmp_path / "twice.rviz") == once


FOREIGN = """\
    - Alpha: 1.0
      Class: my_plugins/Thing
      Enabled: True
      Name: Thing
      Odd:
        a: ""
        b: ~
        c: 0x10
        d: "~"
        e:
          {}
"""
TOOLS = """\
  Tools:
    - Class: my_plugins/Tool
      Speed: 1.50
    - Class: rviz_default_plugins/SetGoal
      Topic:
        Depth: 7
        Durability Policy: Volatile
        History Policy: Keep Last
        Reliability Policy: Best Effort
        Value: /my_goal
      Unknown: 1e3
    - Class: rviz_default_plugins/Measure
      Line color: 1; 2; 3
"""
VIEW = """\
    Current:
      Class: my_plugins/Drone
      Distance: 3.50
      Name: Current View
      Odd: ~
"""


def test_unknown_entries_are_saved_verbatim(layout: Path, tmp_path: Path) -> None:
    before, view = LAYOUT.split("    Current:\n")
    before = before.replace("  Enabled: true\n  Global", FOREIGN + "  Enabled: true\n  Global")
    after = view[view.index("    Saved:") :]
    layout.write_text(before.replace("  Views:", f"{TOOLS}  Views:") + VIEW + after)
    text = saved(session_of(layout), tmp_path / "saved.rviz")
    for kept in (FOREIGN.replace("True", "true"), TOOLS, VIEW):
        assert kept in text


def test_tools_are_saved_with_their_settings(layout: Path, tmp_path: Path) -> None:
    session = session_of(layout)
    pose = next(tool for tool in session.tools if tool.class_name.endswith("SetInitialPose"))
    pose["Covariance x"], pose["Reliability Policy"] = 0.5, "Best Effort"
    reloaded = session_of(saved_path(session, tmp_path))
    same = next(tool for tool in reloaded.tools if tool.class_name.endswith("SetInitialPose"))
    assert (same["Covariance x"], same["Topic/Reliability Policy"]) == (0.5, "Best Effort")


def test_groups_are_saved_as_groups(layout: Path) -> None:
    group = document(session_of(layout))["Visualization Manager"]["Displays"][1]
    assert (group["Class"], [inner["Name"] for inner in group["Displays"]]) == (
        "rviz_common/Group",
        ["Boxes"],
    )


def test_values_are_formatted_as_in_rviz(layout: Path, tmp_path: Path) -> None:
    session = session_of(layout)
    session.saved_views.append(Orbit(distance=0.3))
    text = saved(session, tmp_path / "saved.rviz")
    for line in (
        "        Line Width: 0.10000000149011612", "      Color: 160; 160; 164", "        X: 1",
        "          Namespaces:\n            {}", '  Class: ""', "        Distance: 0.30000001192092896",
    ):  # fmt: skip
        assert f"{line}\n" in text


def test_keys_are_sorted_as_in_qt_maps(layout: Path, tmp_path: Path) -> None:
    (grid, *_) = yaml.safe_load(saved(session_of(layout), tmp_path / "saved.rviz"))["Visualization Manager"][
        "Displays"
    ]
    assert list(grid) == sorted(grid)


def test_missing_saved_views_are_written_as_null(layout: Path, tmp_path: Path) -> None:
    assert "    Saved: ~\n" in saved(session_of(layout), tmp_path / "saved.rviz")


def test_missing_folder_is_created(layout: Path, tmp_path: Path) -> None:
    assert saved(session_of(layout), tmp_path / "my_files" / "view.rviz")


def test_unwritable_folder_is_reported(layout: Path, tmp_path: Path) -> None:
    (tmp_path / "nowhere").write_text("a file")
    with pytest.raises(CourseError, match="nowhere"):
        save_rviz(session_of(layout), tmp_path / "nowhere" / "view.rviz")


@pytest.mark.parametrize("name", ["view.rviz", "view.html", "view.png"])
def test_full_disk_leaves_the_saved_file_unchanged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    viewer, path = Viewer(), tmp_path / name
    saves: dict[str, Callable[[], object]] = {
        ".rviz": lambda: viewer.save_rviz(path),
        ".html": lambda: viewer.save_html(path),
        ".png": lambda: Picture(b"new", "numpy").save(path),
    }
    path.write_text("old")

    def fail(_: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises((CourseError, OSError), match="No space left"):
        saves[path.suffix]()
    assert [(one.name, one.read_text()) for one in tmp_path.iterdir()] == [(name, "old")]


@pytest.mark.skipif(sys.platform == "win32", reason="Windows ends programs without signals")
def test_killed_save_leaves_the_layout_unchanged(layout: Path) -> None:
    before = layout.read_bytes()
    code = (
        "import os, signal, sys\n"
        "from course_lib import Viewer\n"
        "os.fsync = lambda _: os.kill(os.getpid(), signal.SIGKILL)\n"
        "Viewer().save_rviz(sys.argv[1])\n"
    )
    killed = subprocess.run([sys.executable, "-c", code, layout], timeout=PATIENCE)
    assert killed.returncode == -signal.SIGKILL
    assert layout.read_bytes() == before


def test_layout_that_is_a_symlink_is_written_to_its_target(layout: Path) -> None:
    link = layout.with_name("link.rviz")
    link.symlink_to(layout)
    session = session_of(link)
    session.displays[0].name = "Renamed"
    save_rviz(session, link)
    assert link.is_symlink()
    assert "Renamed" in layout.read_text()
