from pathlib import Path

import numpy as np
import pytest

from course_lib.displays.statuses import StatusTable
from tests.displays.bench import Bench
from tests.displays.robot_model.robots import CYLINDER, MISSING, robot, standing, visible_drawables

KNOWN = '<mesh filename="package://example-robot-data/robots/ur_description/meshes/ur10/visual/base.dae"/>'


def unseen() -> Bench:
    bench = Bench()
    bench.session.context.is_seen = False
    return bench


def status_table(bench: Bench) -> str:
    bench.update(1.0)
    return str(StatusTable(bench.session.rows()))


@pytest.mark.parametrize("arm", [CYLINDER, MISSING, KNOWN, "broken"])
def test_invisible_robot_has_the_same_statuses_without_drawing(arm: str, tmp_path: Path) -> None:
    broken_file = tmp_path / "broken.stl"
    broken_file.write_text("no mesh")
    shape = f'<mesh filename="{broken_file.as_uri()}"/>' if arm == "broken" else arm
    benches = [Bench(), unseen()]
    for bench in benches:
        standing(bench, arm=shape)
    assert len({status_table(bench) for bench in benches}) == 1
    assert (bool(visible_drawables(benches[0])), visible_drawables(benches[1])) == (True, {})


def test_bundled_meshes_are_not_read_for_the_statuses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr("course_lib.displays.robot_model.load_mesh")
    bench = unseen()
    standing(bench, arm=KNOWN)
    assert "could not load" not in status_table(bench).lower()


def test_robot_is_drawn_at_its_current_pose_on_the_first_scene_request() -> None:
    benches = [Bench(), unseen()]
    for bench in benches:
        robot(bench)
        for number in range(5):
            bench.transform("map", "base", (float(number), 0.0, 0.0), at=number / 5, static=False)
            bench.session.tick(bench.session.context.now_ns + 10**8)
    benches[1].session.context.show()
    seen, shown = (visible_drawables(bench) for bench in benches)
    assert shown.keys() == seen.keys()
    for path in seen:
        one, other = (bench.scene.world_transform(f"displays/Robot/links/{path}") for bench in benches)
        assert np.array_equal(one, other), path
