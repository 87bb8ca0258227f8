"""Interact's property Hide Inactive Objects."""

import pytest
from visualization_msgs.msg import InteractiveMarkerControl as C

from course_lib.displays.panel.panels import CommandHandler
from tests.displays.interactive.control_stage import Stage, box
from tests.displays.interactive.pointing import command

HANDLES = "displays/InteractiveMarkers/handles"
HELD = f"{HANDLES}/box/controls/move"
OTHERS = (f"{HANDLES}/box/controls/button", f"{HANDLES}/far/controls/turn")


def visibilities(stage: Stage) -> list[bool]:
    return [stage.viewer.scene.is_visible(path) for path in (HELD, *OTHERS, f"{HANDLES}/far/controls/button")]


@pytest.mark.parametrize("hides", [True, False])
def test_other_controls_are_hidden_during_a_drag_unless_always_visible(stage: Stage, hides: bool) -> None:
    far = box(C.ROTATE_AXIS, name="far")
    far.controls[-1].always_visible = True
    stage.add(far)
    stage.show(box(C.MOVE_AXIS))
    session = stage.viewer.session
    session.tools[0]["Hide Inactive Objects"] = hides
    handler = CommandHandler(session)
    handler.execute(command(f"{HELD}/0/mesh", "down", (0.5, 0.0, 0.0)))
    handler.execute(command(f"{HELD}/0/mesh", "move", (0.6, 0.0, 0.0)))
    assert visibilities(stage) == [True, not hides, not hides, True]
    handler.execute(command(f"{HELD}/0/mesh", "up", (0.6, 0.0, 0.0)))
    assert visibilities(stage) == [True] * 4
