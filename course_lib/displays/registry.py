"""The classes of displays by RViz's names; a new display is added to this table."""

from difflib import get_close_matches

from course_lib.displays.clouds.depth_cloud import DepthCloudDisplay
from course_lib.displays.clouds.display import LaserScanDisplay, PointCloud2Display, PointCloudDisplay
from course_lib.displays.clouds.scalar import (
    FluidPressureDisplay,
    IlluminanceDisplay,
    RelativeHumidityDisplay,
    TemperatureDisplay,
)
from course_lib.displays.display import Context, Display
from course_lib.displays.effort import EffortDisplay
from course_lib.displays.geometry import (
    AccelStampedDisplay,
    PointStampedDisplay,
    PolygonDisplay,
    RangeDisplay,
    TwistStampedDisplay,
    WrenchDisplay,
)
from course_lib.displays.grid_cells import GridCellsDisplay
from course_lib.displays.images.camera import CameraDisplay, CameraInfoDisplay
from course_lib.displays.images.display import ImageDisplay
from course_lib.displays.interactive.display import InteractiveMarkersDisplay
from course_lib.displays.map import MapDisplay
from course_lib.displays.marker.display import MarkerArrayDisplay, MarkerDisplay
from course_lib.displays.poses.pose import (
    OdometryDisplay,
    PathDisplay,
    PoseArrayDisplay,
    PoseDisplay,
    PoseWithCovarianceDisplay,
)
from course_lib.displays.reference_display import AxesDisplay, GridDisplay
from course_lib.displays.robot_model.display import RobotModelDisplay
from course_lib.displays.tf import TfDisplay
from course_lib.errors import CourseError

PACKAGE = "rviz_default_plugins"

REGISTRY: dict[str, type[Display]] = {
    display.class_name: display
    for display in (
        AccelStampedDisplay,
        AxesDisplay,
        CameraDisplay,
        CameraInfoDisplay,
        DepthCloudDisplay,
        EffortDisplay,
        FluidPressureDisplay,
        GridCellsDisplay,
        GridDisplay,
        IlluminanceDisplay,
        ImageDisplay,
        InteractiveMarkersDisplay,
        LaserScanDisplay,
        MapDisplay,
        MarkerArrayDisplay,
        MarkerDisplay,
        OdometryDisplay,
        PathDisplay,
        PointCloudDisplay,
        PointCloud2Display,
        PointStampedDisplay,
        PolygonDisplay,
        RobotModelDisplay,
        TemperatureDisplay,
        TfDisplay,
        PoseArrayDisplay,
        PoseDisplay,
        PoseWithCovarianceDisplay,
        RangeDisplay,
        RelativeHumidityDisplay,
        TwistStampedDisplay,
        WrenchDisplay,
    )
}


class FailedDisplay(Display):
    """A display of an unknown class; its configuration is kept as it came."""

    def __init__(self, context: Context, name: str, path: str, wanted: str) -> None:
        super().__init__(context, name, path)
        self.wanted = wanted

    def reset(self) -> None:
        """Show the reason for an empty picture, in RViz's words."""
        super().reset()
        self.statuses.set(
            "error",
            "Class",
            f"The class required for this display, '{self.wanted}', could not be loaded.<br><b>Error:</b><br>"
            f"According to the loaded plugin descriptions the class {self.wanted} with base class type "
            f"rviz_common::Display does not exist. Declared types are  {' '.join(sorted(REGISTRY))}",
        )
        near = get_close_matches(
            short_name(self.wanted), [short_name(name) for name in sorted(REGISTRY)], 1, 0.8
        )
        ros_1 = f"{self.wanted} is ROS 1's name. " if self.wanted.startswith("rviz/") else ""
        self.statuses.hint("Class", *(f"{ros_1}RViz2 has the class {full_name(name)}." for name in near))


def make_display(context: Context, class_name: str, name: str, path: str) -> Display:
    """Create a display by its class name, ``rviz_default_plugins/Marker``."""
    known = REGISTRY.get(class_name)
    return known(context, name, path) if known else FailedDisplay(context, name, path, class_name)


def full_name(class_name: str) -> str:
    """Return a class name with its package, which may be left out."""
    known = (name for name in REGISTRY if short_name(name) == class_name)
    return class_name if "/" in class_name else next(known, f"{PACKAGE}/{class_name}")


def known_name(class_name: str) -> str:
    """Return a class name with its package.

    Raises:
        CourseError: If there is no such display.
    """
    wanted = full_name(class_name)
    if wanted not in REGISTRY:
        known = [short_name(name) for name in REGISTRY]
        near = ", ".join(get_close_matches(short_name(class_name), known, 3) or known)
        raise CourseError(f"There is no display {class_name!r} here; add one of {near}.")
    return wanted


def short_name(class_name: str) -> str:
    """Return a class name without its package, as RViz names a new display."""
    return class_name.rpartition("/")[2]
