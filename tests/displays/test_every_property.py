"""Every property of every display class changes the picture, or is listed with a reason why not."""

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
import pytest

from course_lib.displays.display import TopicDisplay
from course_lib.displays.properties import LimitedConversion, Property, color, flag, vector
from course_lib.displays.registry import REGISTRY
from course_lib.ros.graph.topics import Qos
from tests.displays.bench import Bench
from tests.displays.samples import messages

LATCHED = Qos(durability="transient_local")
PROPERTIES = {
    f"{name.rpartition('/')[2]}: {prop.label}": (name, prop)
    for name, display in sorted(REGISTRY.items())
    for prop in display.properties
    if not prop.is_read_only
}

# Not seen in RViz either: label -> why.
SILENT = {
    "Topic/Filter size": "counts while messages wait for tf2 only; see marker/test_display",
    "Position Transformer": "RViz has one, XYZ",
    "Links/Expand Joint Details": "opens rows of the panel",
    "Links/Expand Link Details": "opens rows of the panel",
    "Links/Expand Tree": "opens rows of the panel",
    "Links/Link Tree Style": "arranges rows of the panel; see robot_model/test_display",
    "Selectable": "is for the Select tool; see test_panels",
    "Visibility": "names other displays; see test_camera",
    "LaserScan: Use Fixed Frame": "scans are projected into the fixed frame, so both are one",
    "Accept NaN Values": "is for messages with NaN; see test_screws",
    "Topic Filter": "offers fewer topics in RViz's panel",
    "Effort: Alpha": "RViz has it and never uses it",
    "Show Visual Aids": "shows during a drag only; see interactive/test_display",
    "Use Timestamp": "counts while the map's frame moves; see map/test_display",
}
# Properties that must be set for others to be visible, by the label of the dependent property.
_OF_AXES = ("Axes Length", "Axes Radius", "Shape/Axes Length", "Shape/Axes Radius")
_OF_ARROWS = ("Shaft Length", "Shaft Radius", "Head Length", "Head Radius")
_OF_PATHS = ("Pose Color", "Shaft Length", "Shaft Diameter", "Head Length", "Head Diameter")
_OF_RAINBOWS = ("Use rainbow", "Invert Rainbow", "Autocompute Intensity Bounds")
MEASURED = ("FluidPressure", "Illuminance", "RelativeHumidity", "Temperature")
CLOUDS = ("DepthCloud", "LaserScan", "PointCloud", "PointCloud2", *MEASURED)
_BY_Z = {"Color Transformer": "Intensity", "Channel Name": "z"}
_BY_AXIS = {"Color Transformer": "AxisColor"}
NEEDS: Mapping[tuple[str, ...], Mapping[str, Any]] = {
    ("Line Width", "Line Style/Line Width"): {"Line Style": "Billboards"},
    ("Min Value", "Max Value"): {"Normalize Range": False},
    ("Size (Pixels)",): {"Style": "Points"},
    ("Min Color", "Max Color"): {"Use rainbow": False},
    ("Min Intensity", "Max Intensity"): {"Autocompute Intensity Bounds": False},
    (
        "Axis",
        "Autocompute Value Bounds",
    ): _BY_AXIS,
    ("Use Fixed Frame",): {**_BY_AXIS, "Axis": "X"},
    ("Autocompute Value Bounds/Min Value", "Autocompute Value Bounds/Max Value"): (
        {**_BY_AXIS, "Autocompute Value Bounds": False}
    ),
    _OF_AXES: {"Shape": "Axes"},
    tuple(f"PoseArray: {label}" for label in _OF_ARROWS): {"Shape": "Arrow (3D)"},
    ("Path: Length", "Path: Radius"): {"Pose Style": "Axes"},
    tuple(f"Path: {label}" for label in _OF_PATHS): {"Pose Style": "Arrows"},
    ("Binary threshold",): {"Binary representation": True},
    ("Hide Small Values",): {"History Length": 2},
    ("Position Tolerance",): {"Angle Tolerance": 5.0},
    ("Angle Tolerance",): {"Position Tolerance": 5.0},
    tuple(f"{name}: Color" for name in CLOUDS): {"Color Transformer": "FlatColor"},
    # one point has the lowest colour wherever it is, unless the bounds are given
    tuple(f"{name}: Axis" for name in MEASURED): {**_BY_AXIS, "Autocompute Value Bounds": False},
    tuple(f"{name}: Use Fixed Frame" for name in MEASURED): (
        {**_BY_AXIS, "Axis": "X", "Autocompute Value Bounds": False}
    ),
    ("Description File",): {"Description Source": "File"},
    (
        "InteractiveMarkers: Enabled",
        "Interactive Markers Namespace",
        "Show Descriptions",
        "Show Axes",
        "Enable Transparency",
    ): ({"Interactive Markers Namespace": "/t"}),
    ("Show polygons", "CameraInfo: Color"): {"Not show side polygons": False},
    ("Color Transport Hint",): {"Color Image Topic": "/color"},
    ("Occlusion Compensation/Occlusion Time-Out",): {"Occlusion Compensation": True},
    ("DepthCloud: Channel Name",): {"Color Transformer": "Intensity"},
    tuple(f"DepthCloud: {label}" for label in _OF_RAINBOWS): _BY_Z,
    ("DepthCloud: Min Color", "DepthCloud: Max Color"): {**_BY_Z, "Use rainbow": False},
    ("DepthCloud: Min Intensity", "DepthCloud: Max Intensity"): {
        **_BY_Z,
        "Autocompute Intensity Bounds": False,
    },
}
# Properties with an effect whose rows RViz hides.
HIDDEN = {f"{name}: {label}" for name in MEASURED for label in ("Position Transformer", "Color Transformer")}
VALUES: Mapping[str, Any] = {
    "Topic": "/other", "Update Topic": "/other", "Description Topic": "/other",
    "Description File": "/nowhere.urdf", "TF Prefix": "robot", "Channel Name": "x", "Median window": 1,
    "Namespaces": {"n": False}, "Decay Time": 5.0, "Position Tolerance": 5.0, "Keep": 1,
    "Frame Timeout": 1.0, "Filter (whitelist)": "arm", "Filter (blacklist)": "arm", "Binary threshold": 30,
    "Occlusion Compensation/Occlusion Time-Out": 0.5, "Interactive Markers Namespace": "/other",
    }  # fmt: skip


def look(class_name: str, early: tuple[tuple[str, Any], ...], late: str = "", value: Any = None) -> Any:
    """Display two messages, one second apart.

    Return the resulting scene and subscriptions, and the labels of the rows of the panel.

    Args:
        class_name: Of the display.
        early: Its properties, from the beginning.
        late: Another one, set from the beginning, too, and once more at the end.
        value: What it is set to.
    """
    bench = Bench()
    bench.session.remove(bench.marker)
    bench.session.remove(bench.array)
    bench.session.add("rviz_default_plugins/Grid", "Ground", {})
    bench.transform("map", "base", (1.0, 0.0, 0.0), yaw=0.3)
    bench.transform("base", "arm", (0.0, 2.0, 0.0), static=False)
    display = bench.session.add(class_name, "It", {})
    if isinstance(display, TopicDisplay):
        display[display.topic_label] = "/t/image"
    for label, before in early:
        display[label] = before
    if late and late != "Links/All Links Enabled":  # which is for the links that are known
        display[late] = value
    for number in range(2):
        for topic, message in messages(class_name, number):
            bench.publish(topic, message, float(number), LATCHED)
        bench.update(number + 0.5)
    bench.transform("base", "arm", (0.0, 3.0, 0.0), at=1.6, static=False)
    if late:
        display[late] = value
    bench.update(2.0)
    scene = bench.scene
    seen = {path: plain(vars(drawable)) for path, drawable in scene.objects().items()}
    places = {path: scene.world_transform(path).round(6).tobytes() for path in seen}
    shown = {path: scene.is_visible(path) for path in seen}
    asked = [(subscription.topic, subscription.qos) for subscription in display.subscriptions]
    texts = [row for row in display.rows() if row.name in ("URDF", "Topic")]
    rows = frozenset(prop.label for prop in display.properties if display.has_row(prop))
    return (seen, places, shown, asked, texts), rows


@cache
def usual(class_name: str, early: tuple[tuple[str, Any], ...]) -> Any:
    return look(class_name, early)


def plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: plain(part) for key, part in value.items()}
    return value.tobytes() if isinstance(value, np.ndarray) else repr(value)


def others(prop: Property) -> list[Any]:
    """Return values that a property may have instead of its default."""
    convert, default = prop.convert, prop.default
    if prop.label in VALUES:
        return [VALUES[prop.label]]
    if isinstance(convert, LimitedConversion) and convert.editor == "enum":
        return [option for option in convert.options if option != default]
    if isinstance(convert, LimitedConversion):
        tried = (0.5 if default == 1.0 else default * 2 + 1, default // 2, convert.low, convert.high)
        values = (convert(value if convert.editor == "number" else round(value)) for value in tried)
        return [next(value for value in values if value != default)]
    if convert is flag:
        return [not default]
    return [(1, 200, 30)] if convert is color else [(1, 2, 3)] if convert is vector else ["base"]


@pytest.mark.parametrize("name", PROPERTIES)
def test_each_property_changes_the_drawing(name: str) -> None:
    class_name, prop = PROPERTIES[name]
    if prop.label in SILENT or name in SILENT:
        return
    labels = {prop.label for prop in REGISTRY[class_name].properties}
    needs = [
        tuple(needed.items())
        for of, needed in NEEDS.items()
        if name in of or (prop.label in of and needed.keys() <= labels)
    ]
    early = needs[-1] if needs else ()
    before, rows = usual(class_name, early)
    changed = any(look(class_name, early, prop.label, value)[0] != before for value in others(prop))
    assert changed, (
        f"{name} changes nothing visible: does the display read self[{prop.label!r}]? A property "
        "that needs another one has a row in NEEDS above, one that is never visible in SILENT, "
        "with the reason"
    )
    assert prop.label in rows or name in HIDDEN
