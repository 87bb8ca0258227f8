"""Layouts that others have made open, and are saved so that nothing changes any more.

tests/data has layouts that RViz2 reads. The folder that COURSE_LAYOUTS names may hold more, for
instance those of navigation2, turtlebot3 or moveit2; the documents in that of COURSE_SEEDS show
one.
"""

import os
import re
from pathlib import Path

import pytest

from course_lib.displays.layout import parse_yaml, read_layout
from course_lib.displays.session import RvizSession
from course_lib.displays.statuses import StatusRow
from course_lib.displays.writer import save_rviz
from course_lib.viewer.scene import Scene

FOLDER = os.environ.get("COURSE_LAYOUTS")
OWN = Path(__file__).parent / "data"
LAYOUTS = [path for folder in (OWN, FOLDER) if folder for path in sorted(Path(folder).rglob("*.rviz"))]
DOCUMENTS = sorted(Path(os.environ["COURSE_SEEDS"]).glob("*.txt")) if "COURSE_SEEDS" in os.environ else []


def opened(path: Path) -> RvizSession:
    session = RvizSession(Scene())
    session.apply(read_layout(path))
    return session


def lasting(session: RvizSession) -> list[StatusRow]:
    """Return the statuses, except hints about errors in the file that saving corrects."""
    return [row for row in session.rows() if row.name not in ("Layout", "View", "Properties")]


@pytest.mark.parametrize("path", LAYOUTS, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_public_layout_is_unchanged_after_saving_twice_with_equal_statuses(
    path: Path, tmp_path: Path
) -> None:
    once, twice = tmp_path / "once.rviz", tmp_path / "twice.rviz"
    session = opened(path)
    save_rviz(session, once)
    again = opened(once)
    save_rviz(again, twice)
    assert twice.read_text() == once.read_text()
    assert lasting(again) == lasting(session)
    before, after = (parse_yaml(file.read_text()).value for file in (path, once))
    for part in before.keys() - {"Visualization Manager"}:
        assert after[part] == before[part], part


@pytest.mark.skipif(not DOCUMENTS, reason="COURSE_SEEDS names no folder with the documents")
def test_layout_in_the_documents_opens_as_documented(tmp_path: Path) -> None:
    shown = (re.search(r"^Panels:\n.*?^ +Yaw: [\d.]+\n", text.read_text(), re.M | re.S) for text in DOCUMENTS)
    path = tmp_path / "view.rviz"
    path.write_text(next(found[0] for found in shown if found))
    session = opened(path)
    grid, robot, frames, markers = session.displays
    assert (grid["Plane Cell Count"], grid["Color"]) == (50, (160, 160, 160))
    assert (robot["Description Topic"], frames["Show Names"], markers["Topic"]) == (
        "/robot_description",
        True,
        "/detections",
    )
    assert (session.fixed_frame, session.view["Distance"], session.view["Yaw"]) == ("world", 10.0, 0.5)
    assert not [row for row in session.rows() if row.level == "hint"]
    save_rviz(session, tmp_path / "saved.rviz")
    assert opened(tmp_path / "saved.rviz").view["Pitch"] == 0.5
