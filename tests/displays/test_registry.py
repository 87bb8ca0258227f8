import pytest

from course_lib.displays.display import Display
from course_lib.displays.registry import PACKAGE, REGISTRY
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
