from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import Point, PoseWithCovariance
from sensor_msgs.msg import Image
from std_msgs.msg import Header, String
from visualization_msgs.msg import Marker

from course_lib.ros.messages import to_plain


def test_plain_fields_keep_the_message_order() -> None:
    assert to_plain(Header(frame_id="map")) == {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "map"}
    assert list(to_plain(Marker()))[:3] == ["header", "ns", "id"]
    assert to_plain(Marker(points=[Point(x=1.0)]))["points"] == [{"x": 1.0, "y": 0.0, "z": 0.0}]


def test_arrays_become_lists_and_bytes_become_characters() -> None:
    assert to_plain(Image(data=[1, 2]))["data"] == [1, 2]
    assert to_plain(PoseWithCovariance())["covariance"] == [0.0] * 36
    assert to_plain(DiagnosticStatus(level=b"\x02"))["level"] == "\x02"


def test_long_values_are_truncated_on_request() -> None:
    assert to_plain(Image(data=bytes(5)), truncate=3)["data"] == [0, 0, 0, "..."]
    assert to_plain(String(data="abcd"), truncate=3) == {"data": "abc..."}
    assert to_plain(String(data="abc"), truncate=3) == {"data": "abc"}
