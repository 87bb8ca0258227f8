"""Which class of display is made by what; the table to add one to."""

from course_lib.displays.axes import AxesDisplay
from course_lib.displays.clouds.laser_scan import LaserScanDisplay
from course_lib.displays.clouds.point_cloud2 import PointCloud2Display
from course_lib.displays.display import Context, Display
from course_lib.displays.grid import GridDisplay
from course_lib.displays.images.camera import CameraDisplay
from course_lib.displays.images.display import ImageDisplay
from course_lib.displays.map.display import MapDisplay
from course_lib.displays.marker.display import MarkerArrayDisplay, MarkerDisplay
from course_lib.displays.poses.path import PathDisplay
from course_lib.displays.poses.pose import PoseDisplay
from course_lib.displays.poses.pose_array import PoseArrayDisplay
from course_lib.displays.range import RangeDisplay
from course_lib.displays.robot_model.display import RobotModelDisplay
from course_lib.displays.tf.display import TfDisplay

PACKAGE = "rviz_default_plugins"

REGISTRY: dict[str, type[Display]] = {
    display.class_name: display
    for display in (
        AxesDisplay,
        CameraDisplay,
        GridDisplay,
        ImageDisplay,
        LaserScanDisplay,
        MapDisplay,
        MarkerArrayDisplay,
        MarkerDisplay,
        PathDisplay,
        PointCloud2Display,
        RobotModelDisplay,
        TfDisplay,
        PoseArrayDisplay,
        PoseDisplay,
        RangeDisplay,
    )
}

# What else RViz2 has (rviz_default_plugins/plugins_description.xml).
_RVIZ_ONLY = (
    "AccelStamped", "CameraInfo", "DepthCloud", "Effort", "FluidPressure", "GridCells",
    "Illuminance", "InteractiveMarkers", "Odometry", "PointCloud",
    "PointStamped", "Polygon", "PoseWithCovariance",
    "RelativeHumidity", "Temperature", "TwistStamped", "Wrench",
)  # fmt: skip


class FailedDisplay(Display):
    """Stands for a display that cannot be made; its configuration is kept as it came."""

    def __init__(self, context: Context, name: str, path: str, wanted: str) -> None:
        super().__init__(context, name, path)
        self.wanted = wanted

    def reset(self) -> None:
        """Say why nothing is drawn: in RViz's words, if RViz would not draw it either."""
        super().reset()
        package, _, short = self.wanted.rpartition("/")
        if package == PACKAGE and short in _RVIZ_ONLY:
            self.statuses.hint("Class", f"RViz2 draws {short}; this viewer does not, and keeps its settings.")
            return
        self.statuses.set(
            "error",
            "Class",
            f"The class required for this display, '{self.wanted}', could not be loaded.<br><b>Error:</b><br>"
            f"According to the loaded plugin descriptions the class {self.wanted} with base class type "
            f"rviz_common::Display does not exist. Declared types are  {' '.join(_declared())}",
        )


def make_display(context: Context, class_name: str, name: str, path: str) -> Display:
    """Make a display by its class name, ``rviz_default_plugins/Marker``."""
    known = REGISTRY.get(class_name)
    return known(context, name, path) if known else FailedDisplay(context, name, path, class_name)


def full_name(class_name: str) -> str:
    """Return a class name with its package, which may be left out for RViz's own."""
    return class_name if "/" in class_name else f"{PACKAGE}/{class_name}"


def short_name(class_name: str) -> str:
    """Return a class name without its package, as RViz names a new display."""
    return class_name.rpartition("/")[2]


def _declared() -> list[str]:
    return sorted({*REGISTRY, *(f"{PACKAGE}/{name}" for name in _RVIZ_ONLY)})
