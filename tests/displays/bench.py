"""A session for tests: publish messages, advance time, and inspect the scene."""

from typing import Any

import numpy as np
import numpy.typing as npt
from geometry_msgs.msg import Point, Pose, Quaternion, TransformStamped, Vector3
from std_msgs.msg import ColorRGBA
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

from course_lib.displays.display import Display
from course_lib.displays.session import RvizSession
from course_lib.displays.statuses import Level
from course_lib.ros.graph.graph import Sample
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import RosMessage, serialize, type_name
from course_lib.viewer.scene import Scene

START_NS = 1_000_000_000_000  # [ns]
TOPIC, ARRAY = "/markers", "/marker_arrays"


class Bench:
    """A session with a Marker and a MarkerArray display; times are in [s] since it began."""

    def __init__(self, fixed_frame: str = "map", match_qos: bool = True) -> None:
        self.scene = Scene()
        self.session = RvizSession(self.scene, fixed_frame, START_NS, match_qos)
        self.marker = self.session.add("rviz_default_plugins/Marker", "Marker", {"Topic": TOPIC})
        self.array = self.session.add("rviz_default_plugins/MarkerArray", "MarkerArray", {"Topic": ARRAY})

    def publish(self, topic: str, message: Any, at: float = 0.0, qos: Qos | None = None) -> None:
        """Publish a message."""
        assert isinstance(message, RosMessage)
        sample = Sample(ns(at), topic, type_name(message), serialize(message), qos or Qos(), 1)
        self.session.receive(sample)

    def show(self, *markers: Marker, at: float = 0.0) -> None:
        """Publish markers in one array, and update the scene."""
        self.publish(ARRAY, MarkerArray(markers=list(markers)), at)
        self.update(at)

    def update(self, at: float = 0.0) -> None:
        """Update the scene."""
        self.session.update(ns(at))

    def transform(
        self,
        parent: str,
        child: str,
        at_xyz: tuple[float, float, float] = (0.0, 0.0, 0.0),
        *,
        yaw: float = 0.0,
        at: float = 0.0,
        static: bool = True,
    ) -> None:
        """Publish a transform, stamped with the time of publishing."""
        message = TransformStamped(child_frame_id=child)
        message.header.frame_id = parent
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(ns(at), 10**9)
        message.transform.translation = Vector3(x=at_xyz[0], y=at_xyz[1], z=at_xyz[2])
        message.transform.rotation = Quaternion(z=float(np.sin(yaw / 2)), w=float(np.cos(yaw / 2)))
        qos = Qos(durability="transient_local") if static else Qos()
        self.publish("/tf_static" if static else "/tf", TFMessage(transforms=[message]), at, qos)

    def status(self, display: Display, name: str) -> tuple[Level, str] | None:
        """Return RViz's status of a name."""
        rows = {row.name: row for row in display.rows() if row.level != "hint"}
        return (rows[name].level, rows[name].text) if name in rows else None

    def hints(self, display: Display) -> list[str]:
        """Return the hints of the kit."""
        return [
            row.text for row in self.session.rows() if row.display == display.name and row.level == "hint"
        ]

    def marker_names(self) -> list[str]:
        """Return the names of the visible markers, ns/id."""
        paths = [path for path in self.scene.objects() if self.scene.is_visible(path)]
        return sorted({"/".join(path.split("/")[-3:-1]) for path in paths})

    def place(self, name: str) -> npt.NDArray[np.float64]:
        """Return the transform from a marker, ns/id, to the fixed frame, shape (4, 4)."""
        paths = [path for path in self.scene.objects() if path.rpartition("/")[0].endswith(name)]
        return self.scene.world_transform(paths[0])


def ns(at: float) -> int:
    return START_NS + round(at * 1e9)


def marker(
    kind: int = Marker.CUBE, number: int = 0, *, ns: str = "n", frame: str = "map", **fields: Any
) -> Marker:
    """Create a red marker of 1 m at the origin."""
    message = Marker(type=kind, id=number, ns=ns, **fields)
    message.header.frame_id = frame
    if "scale" not in fields:
        message.scale = Vector3(x=1.0, y=1.0, z=1.0)
    if "color" not in fields:
        message.color = ColorRGBA(r=1.0, a=1.0)
    return message


def at(x: float) -> Pose:
    return Pose(position=Point(x=x))


def points(*coordinates: tuple[float, float, float]) -> list[Point]:
    return [Point(x=x, y=y, z=z) for x, y, z in coordinates]
