from typing import Any

from course_lib.grading.run.scenario_graph import ALL, ROOM, ImageRoom
from course_lib.ros.graph import Sample
from course_lib.ros.messages import deserialize, message_class, serialize
from course_lib.ros.qos import Qos

IMAGE = "sensor_msgs/msg/Image"


def sample(size: int, topic: str = "/camera", type_name: str = IMAGE) -> Sample:
    make = message_class(IMAGE)
    message: Any = make(height=1, width=size // 3, step=size, encoding="rgb8", data=bytes(size))
    return Sample(0, topic, type_name, serialize(message), Qos(), 1)


def test_pictures_beyond_the_room_keep_all_but_their_pixels() -> None:
    room, picture = ImageRoom(), sample(ROOM // 2 - 1000)
    assert [room.fitted(picture) is picture for _ in range(4)] == [True, True, False, False]
    kept: Any = deserialize(room.fitted(picture).cdr, message_class(IMAGE))
    assert (kept.encoding, kept.step, len(kept.data)) == ("rgb8", ROOM // 2 - 1000, 0)


def test_each_topic_has_its_own_room_and_other_messages_are_never_cut() -> None:
    room, large = ImageRoom(), sample(ROOM + 3)
    other = sample(ROOM + 3, type_name="std_msgs/msg/String")
    assert room.fitted(large) is not large
    small = sample(300, "/depth")
    assert room.fitted(small) is small
    assert room.fitted(other) is other


def test_many_topics_keep_no_more_than_a_few() -> None:
    room = ImageRoom()
    pictures = [sample(ROOM // 2, f"/camera_{n}") for n in range(20)]
    kept = [picture for picture in pictures if room.fitted(picture) is picture]
    assert 0 < sum(len(picture.cdr) for picture in kept) <= ALL


def test_bytes_that_are_no_picture_keep_nothing() -> None:
    broken = Sample(0, "/camera", IMAGE, b"\xff" * (ROOM + 1), Qos(), 1)
    assert ImageRoom().fitted(broken).cdr == b""
