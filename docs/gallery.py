"""Pictures for the gallery: one small run of a robot, and what each display shows of it."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import rclpy
from geometry_msgs.msg import (
    AccelStamped,
    Point,
    Point32,
    PointStamped,
    PolygonStamped,
    Pose,
    PoseArray,
    PoseStamped,
    PoseWithCovarianceStamped,
    TwistStamped,
    Vector3,
    WrenchStamped,
)
from interactive_markers import InteractiveMarkerServer
from nav_msgs.msg import GridCells, OccupancyGrid, Odometry, Path
from rclpy.node import Node
from sensor_msgs.msg import (
    CameraInfo,
    ChannelFloat32,
    FluidPressure,
    Illuminance,
    Image,
    JointState,
    PointCloud,
    RelativeHumidity,
    Temperature,
)
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import InteractiveMarker, InteractiveMarkerControl, Marker, MarkerArray

from course_lib import Viewer, load_robot, sensors, spin_for
from course_lib.displays import Orbit
from course_lib.robots import JointStatePublisher, RobotStatePublisher
from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.viewer import renderer

SIZE = (320, 240)  # [px]
SECONDS = 1.0  # [s] of robot time
KINDS = (Marker.CUBE, Marker.SPHERE, Marker.CYLINDER)
COLOURS = ((1.0, 0.4, 0.2), (0.2, 0.7, 1.0), (0.4, 0.9, 0.3), (1.0, 0.85, 0.2))


@dataclass(frozen=True)
class Entry:
    """One display of the gallery.

    Args:
        alt: The picture in words.
        topic: The topic that it listens to.
        message: Builds the message that `Everything` publishes there; None where a sensor publishes.
        distance: Of the camera, [m].
        settings: Properties by RViz's labels.
        frame: The fixed frame.
    """

    alt: str
    topic: str | None = None
    message: Callable[[], Any] | None = None
    distance: float = 6.0
    settings: dict[str, Any] = field(default_factory=dict)
    frame: str = "map"


def pose(x: float, y: float, yaw: float = 0.0) -> Pose:
    """Return a pose in the plane, [m] and [rad]."""
    made = Pose(position=Point(x=x, y=y))
    made.orientation.z, made.orientation.w = float(np.sin(yaw / 2)), float(np.cos(yaw / 2))
    return made


def uncertain_pose(message: Any) -> Any:
    """Fill in a pose with a covariance."""
    message.pose.pose = pose(0.0, 0.0, 0.5)
    message.pose.covariance = np.diag([0.3, 0.1, 0.05, 0.01, 0.01, 0.1]).ravel()
    return message


def vectors(message: Any, first: str, second: str) -> Any:
    """Fill in two vectors, one ahead and one up."""
    part = getattr(message, type(message).__name__.removesuffix("Stamped").lower())
    setattr(part, first, Vector3(x=1.5))
    setattr(part, second, Vector3(z=1.0))
    return message


def curve() -> list[Pose]:
    """Return poses along a spiral."""
    return [pose(0.2 * t * np.cos(t), 0.2 * t * np.sin(t), t + 1.4) for t in np.arange(0.0, 9.0, 0.3)]


def room() -> OccupancyGrid:
    """Return the map of a room with a door, and what is behind its walls unknown."""
    cells = np.full((30, 40), -1)
    cells[4:26, 4:36] = 100
    cells[5:25, 5:35] = 0
    cells[12:16, 35] = cells[14:20, 14] = 0
    cells[5:15, 20] = 100
    message = OccupancyGrid(data=cells.ravel().tolist())
    message.info.width, message.info.height, message.info.resolution = 40, 30, 0.1
    message.info.origin = pose(-2.0, -1.5)
    return message


def ball() -> PointCloud:
    """Return points on a ball, with an intensity that grows to its top."""
    z = np.linspace(-1, 1, 600)
    turn = np.arange(600) * np.pi * (3 - 5**0.5)
    x, y = np.sqrt(1 - z**2) * [np.cos(turn), np.sin(turn)]
    places = [Point32(x=a, y=b, z=c) for a, b, c in zip(x.tolist(), y.tolist(), z.tolist(), strict=True)]
    return PointCloud(points=places, channels=[ChannelFloat32(name="intensity", values=z)])


def marker(kind: int, number: int, x: float, y: float = 0.0) -> Marker:
    """Return a marker of half a metre."""
    made = Marker(type=kind, id=number, pose=pose(x, y, 0.4), scale=Vector3(x=0.5, y=0.5, z=0.5))
    made.header.frame_id = "map"
    red, green, blue = COLOURS[number % len(COLOURS)]
    made.color = ColorRGBA(r=red, g=green, b=blue, a=1.0)
    return made


def depth() -> Image:
    """Return a depth image of waves."""
    v, u = np.indices((60, 80))
    far = (900 + 120 * np.sin(u / 8) * np.cos(v / 8)).astype("<u2")  # [mm]
    return Image(width=80, height=60, encoding="16UC1", step=160, data=far.view(np.uint8).ravel())


def polygon() -> PolygonStamped:
    """Return a star."""
    message = PolygonStamped()
    for number in range(10):
        angle, radius = number * np.pi / 5, 1.5 if number % 2 else 0.6
        message.polygon.points.append(Point32(x=radius * np.cos(angle), y=radius * np.sin(angle)))
    return message


def ring() -> GridCells:
    """Return cells in a ring."""
    angles = np.arange(24) * np.pi / 12
    cells = [
        Point(x=round(1.5 * np.cos(a) / 0.2) * 0.2, y=round(1.5 * np.sin(a) / 0.2) * 0.2) for a in angles
    ]
    return GridCells(cell_width=0.2, cell_height=0.2, cells=cells)


def along(message: Any) -> Any:
    """Give an array of poses or a path the spiral."""
    message.poses = curve() if isinstance(message, PoseArray) else [PoseStamped(pose=one) for one in curve()]
    return message


SPOT = {"Size (m)": 0.6, "Style": "Spheres"}
ENTRIES: dict[str, Entry] = {
    "AccelStamped": Entry("A red arrow ahead, and a yellow one with a circle", "/accel",
                          lambda: vectors(AccelStamped(), "linear", "angular"), 4.0),
    "Axes": Entry("Three axes, red, green and blue", distance=3.0),
    "Camera": Entry("A camera's picture in the corner: a box by a column", "/camera/image_raw"),
    "CameraInfo": Entry("The pyramid of what a camera sees", "/camera/camera_info", distance=3.0),
    "DepthCloud": Entry("A wavy surface of points", "/depth/image", depth, 4.0),
    "Effort": Entry("Rings around the joints of an arm", "/joint_efforts", lambda: JointState(
        name=["shoulder_pan_joint", "elbow_joint"], effort=[200.0, -90.0]), 3.0, frame="base_link"),
    "FluidPressure": Entry("One coloured ball", "/pressure", lambda: FluidPressure(fluid_pressure=101_325.0),
                           3.0, SPOT),
    "Grid": Entry("A grid of ten by ten cells", distance=12.0),
    "GridCells": Entry("Green cells in a ring", "/cells", ring, 5.0),
    "Illuminance": Entry("One coloured ball", "/light", lambda: Illuminance(illuminance=400.0), 3.0, SPOT),
    "Image": Entry("A camera's picture in the corner: a box, a ball and a column", "/camera/image_raw"),
    "InteractiveMarkers": Entry("A cube with arrows and rings to drag", distance=3.0,
                                settings={"Interactive Markers Namespace": "/handles"}),
    "LaserScan": Entry("White points where a laser scanner met things", "/scan", None, 9.0,
                       {"Size (m)": 0.06}),
    "Map": Entry("The map of a room with white floor and black walls", "/map", room, 5.0),
    "Marker": Entry("A red cylinder", "/marker", lambda: marker(Marker.CYLINDER, 0, 0.0), 2.5),
    "MarkerArray": Entry("Cubes, balls and columns", "/markers", lambda: MarkerArray(markers=[
        marker(kind, 4 * row + column, row - 1.0, column - 1.5)
        for row, kind in enumerate(KINDS) for column in range(4)]), 5.0),
    "Odometry": Entry("An arrow with an ellipsoid and a cone of uncertainty", "/odom",
                      lambda: uncertain_pose(Odometry()), 4.0),
    "Path": Entry("A green spiral", "/path", lambda: along(Path())),
    "PointCloud": Entry("A ball of points in many colours", "/ball", ball, 4.0, {"Size (m)": 0.05}),
    "PointCloud2": Entry("Points of a 3D scanner on a box, a ball and a column", "/points", None, 8.0,
                         {"Size (m)": 0.04}),
    "PointStamped": Entry("A violet ball", "/point", lambda: PointStamped(), 2.0),
    "Polygon": Entry("A green star of lines", "/polygon", polygon, 4.0),
    "Pose": Entry("A red arrow", "/pose", lambda: PoseStamped(pose=pose(0.0, 0.0, 0.5)), 3.0),
    "PoseArray": Entry("Small red arrows along a spiral", "/poses", lambda: along(PoseArray())),
    "PoseWithCovariance": Entry("An arrow with an ellipsoid of uncertainty", "/estimate",
                                lambda: uncertain_pose(PoseWithCovarianceStamped()), 4.0),
    "Range": Entry("A white cone from a range finder to a wall", "/range", None, 6.0),
    "RelativeHumidity": Entry("One coloured ball", "/humidity",
                              lambda: RelativeHumidity(relative_humidity=0.6), 3.0, SPOT),
    "RobotModel": Entry("A robot arm", "/robot_description", None, 2.5, frame="base_link"),
    "TF": Entry("The frames of a robot arm as axes, joined by arrows", None, None, 2.5, frame="base_link"),
    "Temperature": Entry("A coloured ball", "/warmth", lambda: Temperature(temperature=21.0), 3.0, SPOT),
    "TwistStamped": Entry("A red arrow ahead, and a yellow one with a circle", "/twist",
                          lambda: vectors(TwistStamped(), "linear", "angular"), 4.0),
    "Wrench": Entry("A red arrow ahead, and a yellow one with a circle", "/wrench",
                    lambda: vectors(WrenchStamped(), "force", "torque"), 5.0),
}  # fmt: skip


class Everything(Node):
    """Publishes the messages of the table, and a cube with handles."""

    def __init__(self) -> None:
        super().__init__("everything")
        self.create_timer(0.5, self.publish)
        self.senders = {
            one.topic: (self.create_publisher(type(made := one.message()), one.topic, 1), made)
            for one in ENTRIES.values()
            if one.message and one.topic
        }
        info = sensors.Pinhole(80, 60, 70.0).info(Header())
        self.senders["/depth/camera_info"] = (
            self.create_publisher(CameraInfo, "/depth/camera_info", 1),
            info,
        )
        self.server = InteractiveMarkerServer(self, "handles")
        self.server.insert(handles())
        self.server.applyChanges()

    def publish(self) -> None:
        """Publish each message once."""
        for sender, message in self.senders.values():
            if hasattr(message, "header"):
                message.header.frame_id = "base_link" if isinstance(message, JointState) else "map"
            sender.publish(message)


def handles() -> InteractiveMarker:
    """Return a cube that can be moved and turned."""
    made = InteractiveMarker(name="cube", scale=1.0)
    made.header.frame_id = "map"
    made.controls.append(InteractiveMarkerControl(always_visible=True, markers=[marker(Marker.CUBE, 1, 0.0)]))
    modes = InteractiveMarkerControl.MOVE_AXIS, InteractiveMarkerControl.ROTATE_AXIS
    for axis in "xyz":
        for mode in modes:
            control = InteractiveMarkerControl(name=f"{mode} {axis}", interaction_mode=mode)
            control.orientation.w = 1.0
            setattr(control.orientation, axis, 1.0)
            made.controls.append(control)
    return made


def robot_nodes() -> list[Node]:
    """Return an arm, and sensors in a small world; all frames are those of map."""
    world = sensors.World([
        sensors.Thing(sensors.plane(), sensors.placed(0.0, 0.0, -0.5), (0.5, 0.5, 0.5)),
        sensors.Thing(sensors.box(1.0, 1.0, 1.0), sensors.placed(3.0, 0.0, 0.0, 0.5), COLOURS[0]),
        sensors.Thing(sensors.cylinder(0.4, 1.5), sensors.placed(2.5, 1.7, 0.2), COLOURS[1]),
        sensors.Thing(sensors.sphere(0.6), sensors.placed(2.2, -1.6, 0.0), COLOURS[2]),
    ])  # fmt: skip
    ahead = np.array([[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0.3], [0, 0, 0, 1]])  # optical axes: z ahead
    arm = load_robot("ur5")
    start = {"shoulder_lift_joint": -1.2, "elbow_joint": 1.4}
    return [
        JointStatePublisher(arm.urdf, zeros=start),
        RobotStatePublisher(arm.urdf),
        sensors.CameraNode(world, ahead, frame_id="map"),
        sensors.LaserScanNode(world, sensors.placed(0.0, 0.0, 0.2), frame_id="map"),
        sensors.PointCloudNode(world, sensors.placed(0.0, 0.0, 0.5), frame_id="map", rings=32),
        sensors.RangeNode(world, sensors.placed(0.0, 0.0, 0.0), frame_id="map"),
    ]


def pictures() -> Iterator[tuple[str, str, bytes]]:
    """Yield name, words and PNG of each display."""
    with use_graph(Graph()):
        rclpy.init()
        viewers = {name: viewer_of(name, entry) for name, entry in ENTRIES.items()}
        spin_for(SECONDS, Everything(), *robot_nodes())
        for name, viewer in viewers.items():
            viewer.refresh()
            yield name, ENTRIES[name].alt, renderer.draw(viewer.scene, SIZE)
        rclpy.shutdown()


def viewer_of(name: str, entry: Entry) -> Viewer:
    """Return a viewer with one display on a grid."""
    viewer = Viewer(entry.frame)
    viewer.view = Orbit(distance=entry.distance, yaw=-0.9, pitch=0.6)
    if name != "Grid":
        display = viewer.add(name, entry.topic, **entry.settings)
        if entry.topic and not entry.message and name != "RobotModel":
            display["Topic/Reliability Policy"] = "Best Effort"  # sensors do not resend
    return viewer
