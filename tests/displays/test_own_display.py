import re
from collections.abc import Iterator
from pathlib import Path
from textwrap import dedent
from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import BatteryState
from std_msgs.msg import Float32

from course_lib.displays import registry
from course_lib.displays.display import Display
from course_lib.displays.layout import read_layout
from course_lib.displays.registry import REGISTRY, FailedDisplay, OwnDisplay, register, solid
from course_lib.displays.session import RvizSession
from course_lib.displays.viewer import Viewer
from course_lib.displays.writer import save_rviz
from course_lib.errors import CourseError
from course_lib.viewer.drawables import Drawable, Solids
from course_lib.viewer.scene import Scene
from tests.displays.bench import Bench

CLASS = "my_robot/Battery"
BAR = "displays/Battery/drawn/bar"


@pytest.fixture(autouse=True)
def restored_registry() -> Iterator[None]:
    before = dict(REGISTRY)
    yield
    REGISTRY.clear()
    REGISTRY.update(before)


@pytest.fixture
def lesson() -> None:
    """Run the code that the docstring shows, which is the lesson's, but for the viewer."""
    match = re.search(r"::\n\n(.*?)\n\n    viewer\.add", registry.__doc__ or "", re.S)
    assert match
    exec(dedent(match[1]), {})


def battery(percentage: float, frame: str = "base") -> BatteryState:
    message = BatteryState(percentage=percentage)
    message.header.frame_id = frame
    return message


def show_battery(bench: Bench, percentage: float = 0.5) -> Display:
    display = bench.session.add(CLASS, "Battery", {"Topic": "/battery"})
    bench.transform("map", "base", (2.0, 0.0, 0.0))
    bench.publish("/battery", battery(percentage))
    bench.update()
    return display


def bar(bench: Bench) -> Solids:
    drawable = bench.scene.objects()[BAR]
    assert isinstance(drawable, Solids)
    return drawable


@pytest.mark.usefixtures("lesson")
def test_custom_display_draws_messages_in_their_frame() -> None:
    bench = Bench()
    display = show_battery(bench)
    np.testing.assert_allclose(
        bar(bench).placements[0], np.diag([0.1, 0.1, 0.5, 1]) + 0.25 * np.eye(4)[2][:, None] * np.eye(4)[3]
    )
    np.testing.assert_allclose(bench.scene.world_transform(BAR)[:3, 3], [2, 0, 0])
    assert bench.status(display, "Topic") is not None
    display["Height"] = 2.0
    assert bar(bench).placements[0, 2, 2] == 1.0
    display["Enabled"] = False
    assert not bench.scene.is_visible("displays/Battery")


@pytest.mark.usefixtures("lesson")
def test_custom_display_waits_for_its_frame() -> None:
    bench = Bench()
    display = bench.session.add(CLASS, "Battery", {"Topic": "/battery"})
    bench.publish("/battery", battery(0.5, "nowhere"))
    bench.update()
    assert BAR not in bench.scene.objects()
    assert "waiting for tf2" in bench.hints(display)[0]


@pytest.mark.usefixtures("lesson")
def test_custom_display_is_saved_in_a_layout_and_restored(tmp_path: Path) -> None:
    bench = Bench()
    show_battery(bench)["Height"] = 2.0
    save_rviz(bench.session, tmp_path / "mine.rviz")
    reloaded = RvizSession(Scene())
    reloaded.apply(read_layout(tmp_path / "mine.rviz"))
    (display,) = (display for display in reloaded.displays if display.name == "Battery")
    assert (display.class_name, display["Height"], display["Topic"]) == (CLASS, 2.0, "/battery")
    del REGISTRY[CLASS]
    reloaded.apply(read_layout(tmp_path / "mine.rviz"))
    assert isinstance(reloaded.displays[-1], FailedDisplay)


@pytest.mark.usefixtures("lesson")
def test_custom_display_is_added_like_rviz_displays() -> None:
    viewer = Viewer()
    assert viewer.add("Battery", "/battery", height=0.5)["Height"] == 0.5
    assert viewer.add(CLASS).name == "Battery"
    viewer.close()


def test_exception_in_the_drawing_method_is_a_status_and_later_messages_are_drawn() -> None:
    @register
    class Broken(OwnDisplay):
        class_name = CLASS
        type_name = "sensor_msgs/msg/BatteryState"

        def drawing(self, message: Any) -> dict[str, Drawable]:
            return {"bar": solid("box", size=(1, 1, 1 / message.percentage))}

    bench = Bench()
    display = show_battery(bench, 0.0)
    level, text = bench.status(display, "Drawing") or ("", "")
    assert level == "error"
    assert "ZeroDivisionError" in text
    assert "1 / message.percentage" in text
    bench.publish("/battery", battery(0.5))
    assert bench.status(display, "Drawing") is None
    assert bar(bench).placements[0, 2, 2] == 2.0


def test_messages_without_a_header_are_drawn_in_the_fixed_frame() -> None:
    @register
    class Speed(OwnDisplay):
        class_name = CLASS
        type_name = "std_msgs/msg/Float32"

        def drawing(self, message: Any) -> dict[str, Drawable]:
            return {"bar": solid("box", size=(message.data, 1, 1))}

    bench = Bench()
    bench.session.add(CLASS, "Battery", {"Topic": "/speed"})
    bench.publish("/speed", Float32(data=3.0))
    assert bar(bench).placements[0, 0, 0] == 3.0


@pytest.mark.parametrize(
    ("name", "message"), [("", "my_robot/Thing"), ("rviz_default_plugins/TF", "belongs to RViz")]
)
def test_custom_display_requires_a_unique_name(name: str, message: str) -> None:
    class ThingDisplay(OwnDisplay):
        class_name = name

    with pytest.raises(CourseError, match=message):
        register(ThingDisplay)
