import struct
from typing import Any

import pytest

from course_lib.grading.run.scenario import ALL, MOST_FIELDS, POINT_CLOUD, ROOM, ImageLimit, _count_fields
from course_lib.ros.graph.graph import Sample
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import deserialize, message_class, serialize

IMAGE = "sensor_msgs/msg/Image"


def sample(size: int, topic: str = "/camera", type_name: str = IMAGE) -> Sample:
    make = message_class(IMAGE)
    message: Any = make(height=1, width=size // 3, step=size, encoding="rgb8", data=bytes(size))
    return Sample(0, topic, type_name, serialize(message), Qos(), 1)


def test_images_beyond_the_size_limit_lose_only_their_pixels() -> None:
    room, picture = ImageLimit(), sample(ROOM // 2 - 1000)
    assert [room.limit_size(picture) is picture for _ in range(4)] == [True, True, False, False]
    kept: Any = deserialize(room.limit_size(picture).cdr, message_class(IMAGE))
    assert (kept.encoding, kept.step, len(kept.data)) == ("rgb8", ROOM // 2 - 1000, 0)


def test_image_limit_applies_per_topic_and_not_to_other_messages() -> None:
    room, large = ImageLimit(), sample(ROOM + 3)
    other = sample(ROOM + 3, type_name="std_msgs/msg/String")
    assert room.limit_size(large) is not large
    small = sample(300, "/depth")
    assert room.limit_size(small) is small
    assert room.limit_size(other) is other


def test_total_image_size_of_all_topics_is_limited() -> None:
    room = ImageLimit()
    pictures = [sample(ROOM // 2, f"/camera_{n}") for n in range(20)]
    kept = [picture for picture in pictures if room.limit_size(picture) is picture]
    assert 0 < sum(len(picture.cdr) for picture in kept) <= ALL


def test_invalid_image_message_is_kept_without_bytes() -> None:
    broken = Sample(0, "/camera", IMAGE, b"\xff" * (ROOM + 1), Qos(), 1)
    assert ImageLimit().limit_size(broken).cdr == b""


@pytest.mark.parametrize("is_little_endian", [True, False])
@pytest.mark.parametrize("frame_id", ["", "map", "camera_link"])
def test_point_cloud_with_too_many_fields_is_not_decoded(frame_id: str, is_little_endian: bool) -> None:
    def cdr(fields: int) -> bytes:
        field = message_class("sensor_msgs/msg/PointField")(name="x")
        made: Any = message_class(POINT_CLOUD)(fields=[field] * fields, data=bytes(ROOM))
        made.header.frame_id = frame_id
        return bytes(serialize(made))

    data = cdr(4)
    if not is_little_endian:
        count = struct.pack("<I", 4)
        assert _count_fields(data) == 4
        length = struct.pack(">I", len(frame_id) + 1)
        data = b"\0\0\0\0" + bytes(8) + length + data[16:].replace(count, count[::-1], 1)
    assert _count_fields(data) == 4
    kept: Any = deserialize(ImageLimit().limit_size(cloud(cdr(4))).cdr, message_class(POINT_CLOUD))
    assert (len(kept.fields), len(kept.data)) == (4, 0)
    assert ImageLimit().limit_size(cloud(cdr(MOST_FIELDS + 1))).cdr == b""


def cloud(cdr: bytes) -> Sample:
    return Sample(0, "/cloud", POINT_CLOUD, cdr, Qos(), 1)
