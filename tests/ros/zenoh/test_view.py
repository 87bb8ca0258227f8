import pytest
from visualization_msgs.msg import Marker

from course_lib import Viewer
from course_lib.displays.frames import ViewTime
from course_lib.displays.panel.panels import LiveTime, TimeChange
from course_lib.ros.graph.graph import use_graph
from course_lib.tools.rqt.monitors import RobotMonitorView
from course_lib.viewer.encoding import MessageError
from tests.ros.zenoh.conftest import Kits
from tests.ros.zenoh.test_two_kits import BEST_EFFORT, connect, talker, topics


@pytest.mark.slow
def test_viewer_shows_a_marker_of_a_robot_regardless_of_its_qos(kits: Kits) -> None:
    robot, student = kits.join(send="/marker /other"), kits.join()
    out = talker(robot, "/marker", "visualization_msgs/msg/Marker", BEST_EFFORT)
    talker(robot, "/other", "visualization_msgs/msg/Marker", BEST_EFFORT)
    with use_graph(student):
        viewer = Viewer("map")
    viewer.add("Marker", "/marker")
    marker = Marker(type=Marker.CUBE)
    marker.header.frame_id, marker.color.a = "map", 1.0
    marker.scale.x = marker.scale.y = marker.scale.z = 1.0
    drawn: list[str] = []

    def shown() -> bool:
        drawn[:] = [name for name in viewer.scene.objects() if "Marker" in name]
        return bool(drawn)

    connect(kits, robot, out, drawn, marker, shown)
    assert "/other" not in topics(robot, "sub")
    viewer.close()
    kits.until(lambda: "/marker" not in topics(robot, "sub"), "the end of the subscription")


def test_rqt_view_subscribes_only_to_its_own_topics_of_a_robot(kits: Kits) -> None:
    robot, student = kits.join(send="/image /diagnostics"), kits.join()
    talker(robot, "/image", "sensor_msgs/msg/Image")
    talker(robot, "/diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
    with use_graph(student):
        view = RobotMonitorView(student, [])
    view.listen()
    kits.until(lambda: "/diagnostics" in topics(robot, "sub"), "the subscription")
    assert "/image" not in topics(robot, "sub")
    view.close()


def test_time_of_a_robot_cannot_be_controlled(kits: Kits) -> None:
    time = LiveTime(kits.join(), ViewTime(0, False))
    time.act(TimeChange())
    with pytest.raises(MessageError, match="cannot be paused"):
        time.act(TimeChange(paused=True))
    assert not time.time().paused
