"""Two messages for every display class, in known frames."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from geometry_msgs.msg import (
    AccelStamped,
    Point,
    Point32,
    PointStamped,
    PolygonStamped,
    PoseArray,
    PoseStamped,
    PoseWithCovarianceStamped,
    TwistStamped,
    WrenchStamped,
)
from nav_msgs.msg import GridCells, OccupancyGrid, Odometry, Path
from sensor_msgs.msg import (
    CameraInfo,
    ChannelFloat32,
    FluidPressure,
    Illuminance,
    Image,
    JointState,
    LaserScan,
    PointCloud,
    PointCloud2,
    Range,
    RelativeHumidity,
    Temperature,
)
from std_msgs.msg import String
from visualization_msgs.msg import (
    InteractiveMarker,
    InteractiveMarkerControl,
    InteractiveMarkerUpdate,
    Marker,
    MarkerArray,
)

from tests.displays.bench import marker
from tests.displays.clouds.clouds import cloud, plain
from tests.displays.images.test_camera import info
from tests.displays.images.test_pixels import image
from tests.displays.robot_model.robots import ARM, CYLINDER

FRAME = "arm"
SCREWS = {"accel": ("linear", "angular"), "twist": ("linear", "angular"), "wrench": ("force", "torque")}
GREY = np.full((6, 8, 3), 90, np.uint8)
CELLS = np.add.outer(np.arange(6), np.arange(8))


def placed(message: Any, x: float) -> Any:
    """Fill in a pose with a covariance."""
    pose = getattr(message.pose, "pose", message.pose)
    pose.position.x = x
    pose.orientation.z, pose.orientation.w = (0.6, 0.8) if x else (0.8, 0.6)
    if pose is not message.pose:
        message.pose.covariance = np.diag([0.1, 0.2, 0.3, 0.1, 0.2, 0.3]).ravel()
    return message


def array_of_poses(x: float) -> PoseArray:
    return PoseArray(poses=[placed(PoseStamped(), x + step).pose for step in range(3)])


def path(x: float) -> Path:
    return Path(poses=[placed(PoseStamped(), x + step) for step in range(3)])


def grid(x: float) -> OccupancyGrid:
    message = OccupancyGrid(data=[-1, 0, 20, 50, 99, 100, 110, -100])
    message.info.width, message.info.height, message.info.resolution = 4, 2, 0.5
    message.info.origin.position.x = x
    return message


def scan(x: float) -> LaserScan:
    return LaserScan(
        angle_min=-1.0,
        angle_increment=0.5,
        range_max=9.0,
        ranges=[1.0, 2.0, 3.0 + x],
        intensities=[1.0, 5.0, 9.0],
    )


def points(x: float) -> PointCloud2:
    at = np.array([[0.0, 1.0, 2.0], [1.0, 2.0, 0.0], [2.0 + x, 0.0, 1.0]])
    return cloud(plain(at, intensity=np.array([1, 5, 9], np.float32), height=np.array([3, 2, 1], np.float32)))


def legacy(x: float) -> PointCloud:
    places = [Point32(y=1.0, z=2.0), Point32(x=1.0, y=2.0), Point32(x=2.0 + x, z=1.0)]
    values = {"intensity": [1.0, 5.0, 9.0], "height": [3.0, 2.0, 1.0]}
    channels = [ChannelFloat32(name=name, values=numbers) for name, numbers in values.items()]
    return PointCloud(points=places, channels=channels)


def calibrated() -> CameraInfo:
    message = info()
    message.k = message.p.reshape(3, 4)[:, :3].ravel()
    return message


def depth(x: float) -> Image:
    return image((1000 + 100 * CELLS * (3 - x)).astype(np.uint16), "16UC1")


def screw(message: Any, field: str, x: float) -> Any:
    first, second = (getattr(getattr(message, field), name) for name in SCREWS[field])
    first.x, second.z = 1.0 if x else 1e-4, 2.0
    return message


def polygon(x: float) -> PolygonStamped:
    message = PolygonStamped()
    message.polygon.points = [Point32(x=x), Point32(y=1.0), Point32(z=1.0)]
    return message


def handled(x: float) -> InteractiveMarkerUpdate:
    """Create markers that can be moved; the second message has another one."""
    control = InteractiveMarkerControl(interaction_mode=InteractiveMarkerControl.MOVE_AXIS)
    message = InteractiveMarker(name=f"m{x}", description="words", controls=[control])
    message.header.frame_id = FRAME
    return InteractiveMarkerUpdate(type=InteractiveMarkerUpdate.UPDATE, markers=[message])


# Message factories by topic for each class; their argument [m] distinguishes successive messages.
SAMPLES: dict[str, dict[str, Callable[[float], Any]]] = {
    "AccelStamped": {"/t/image": lambda x: screw(AccelStamped(), "accel", x)},
    "Camera": {"/t/camera_info": lambda _: info(), "/t/image": lambda _: image(GREY, "rgb8")},
    "CameraInfo": {"/t/image": lambda _: info()},
    "DepthCloud": {"/t/camera_info": lambda _: calibrated(), "/t/image": depth},
    "Effort": {
        "/robot_description": lambda _: String(data=ARM.format(arm=CYLINDER)),
        "/t/image": lambda x: JointState(name=["j"], effort=[1.0 + x]),
    },
    "FluidPressure": {"/t/image": lambda x: FluidPressure(fluid_pressure=100_000.0 + x)},
    "GridCells": {"/t/image": lambda x: GridCells(cell_width=1.0, cell_height=1.0, cells=[Point(x=x)])},
    "Illuminance": {"/t/image": lambda x: Illuminance(illuminance=300.0 + x)},
    "Image": {"/t/image": depth},
    "InteractiveMarkers": {"/t/update": handled},
    "LaserScan": {"/t/image": scan},
    "Map": {"/t/image": grid},
    "Marker": {"/t/image": lambda x: marker(frame=FRAME, ns="n", number=int(x))},
    "MarkerArray": {"/t/image": lambda x: MarkerArray(markers=[marker(frame=FRAME, number=int(x))])},
    "Odometry": {"/t/image": lambda x: placed(Odometry(), x)},
    "Path": {"/t/image": path},
    "PointCloud": {"/t/image": legacy},
    "PointCloud2": {"/t/image": points},
    "PointStamped": {"/t/image": lambda x: PointStamped(point=Point(x=x))},
    "Polygon": {"/t/image": polygon},
    "Pose": {"/t/image": lambda x: placed(PoseStamped(), x)},
    "PoseArray": {"/t/image": array_of_poses},
    "PoseWithCovariance": {"/t/image": lambda x: placed(PoseWithCovarianceStamped(), x)},
    "Range": {"/t/image": lambda x: Range(range=1.0 + x / 4, max_range=4.0, field_of_view=0.5)},
    "RelativeHumidity": {"/t/image": lambda x: RelativeHumidity(relative_humidity=0.4 + x / 9)},
    "RobotModel": {"/t/image": lambda _: String(data=ARM.format(arm=CYLINDER))},
    "Temperature": {"/t/image": lambda x: Temperature(temperature=20.0 + x)},
    "TwistStamped": {"/t/image": lambda x: screw(TwistStamped(), "twist", x)},
    "Wrench": {"/t/image": lambda x: screw(WrenchStamped(), "wrench", x)},
}  # fmt: skip


def messages(class_name: str, number: int) -> Iterator[tuple[str, Any]]:
    """Yield the simultaneous messages for a display class, with their topics."""
    for topic, made in SAMPLES.get(class_name.rpartition("/")[2], {}).items():
        message = made(2.0 * number)
        header = getattr(message, "header", None)
        if header is not None and not isinstance(message, CameraInfo | Marker):
            header.frame_id = FRAME
        if isinstance(message, CameraInfo):
            message.header.frame_id = FRAME
        yield topic, message
