import pytest

from course_lib.displays.display import Display
from course_lib.displays.properties import descriptions
from course_lib.displays.registry import PACKAGE, REGISTRY, OwnDisplay, describe_class
from course_lib.displays.views import VIEWS
from tests.displays.bench import Bench

# rviz_default_plugins/plugins_description.xml of Jazzy
CLASSES = [
    "AccelStamped", "Axes", "Camera", "CameraInfo", "DepthCloud", "Effort", "FluidPressure", "Grid",
    "GridCells", "Illuminance", "Image", "InteractiveMarkers", "LaserScan", "Map", "Marker",
    "MarkerArray", "Odometry", "Path", "PointCloud", "PointCloud2", "PointStamped", "Polygon", "Pose",
    "PoseArray", "PoseWithCovariance", "Range", "RelativeHumidity", "RobotModel", "TF", "Temperature",
    "TwistStamped", "Wrench",
]  # fmt: skip


def add(name: str) -> Display:
    return Bench().session.add(f"{PACKAGE}/{name}", name, {"Topic": {"Value": "/t"}})


@pytest.mark.parametrize("name", CLASSES)
def test_each_display_class_of_rviz_can_be_drawn(name: str) -> None:
    assert add(name).class_name == f"{PACKAGE}/{name}"


def test_registry_contains_each_class_exactly_once() -> None:
    assert sorted(REGISTRY) == sorted(f"{PACKAGE}/{name}" for name in CLASSES)


# RViz has no description of these.
NOT_DESCRIBED = {"Enabled", "Namespaces"}


@pytest.mark.parametrize("name", [*CLASSES, *VIEWS])
def test_each_property_of_rviz_has_its_description(name: str) -> None:
    kind = VIEWS.get(name) or REGISTRY[f"{PACKAGE}/{name}"]
    lacking = {prop.label for prop in kind.properties if not kind.describe(prop)}
    assert lacking <= NOT_DESCRIBED


def test_each_display_class_has_the_description_of_rviz() -> None:
    assert describe_class(f"{PACKAGE}/Path") == "Displays data from a nav_msgs::Path message as lines."
    assert all(f"{PACKAGE}/{name}" in descriptions()["classes"] for name in CLASSES)


def test_custom_display_is_described_by_its_docstring(monkeypatch: pytest.MonkeyPatch) -> None:
    class Battery(OwnDisplay):
        """The charge, as a bar
        above the robot.

        More.
        """

    monkeypatch.setitem(REGISTRY, "my_robot/Battery", Battery)
    assert describe_class("my_robot/Battery") == "The charge, as a bar above the robot."
