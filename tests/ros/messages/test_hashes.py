import hashlib
import json

import pytest

from course_lib.errors import CourseError
from course_lib.ros.messages.definitions import describe_type, is_known, type_hash, type_names

# From real ROS 2: the docs of rmw_zenoh, `ros2 topic info -v` in public logs, and the .json files
# of Jazzy's and Lyrical's packages, as other implementations cite them.
PUBLISHED = {
    "std_msgs/msg/String": "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
    "std_msgs/msg/Char": "3ad2d04dd29ba19d04b16659afa3ccaedd691914b02a64e82e252f2fa6a586a9",
    "geometry_msgs/msg/Twist": "9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a",
    "geometry_msgs/msg/TwistStamped": "5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64",
    "rcl_interfaces/msg/ParameterDescriptor": (
        "52175dbfda6c51153101d33d2a9da05743f66f02d5ab2ca9ec4709b46b73d704"
    ),
    "action_msgs/msg/GoalStatusArray": "6c1684b00f177d37438febe6e709fc4e2b0d4248dca4854946f9ed8b30cda83e",
    "example_interfaces/srv/AddTwoInts": "e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a",
    "std_srvs/srv/Empty": "5888399dedec5ccc85ea6451949fd2c9f97bfdf963f9a588821639fcd31b5d19",
    "std_srvs/srv/SetBool": "abe9e4bb6b41b40e6789712c00ec8871923e089af3f667a79992a428cff2da0a",
    "std_srvs/srv/Trigger": "eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f",
    "sensor_msgs/srv/SetCameraInfo": "a10cca5d33dc637c8d49db50ab288701a3592bb9cd854f2f16a0659613b68984",
    "action_msgs/srv/CancelGoal": "573d8b0a534451d7bc2ac8c5ffde8ac14b8593b7001175d0cd6516dcbeb8689a",
    "example_interfaces/action/Fibonacci_SendGoal": (
        "d1a57fb2a4afe8c21e34fb10db206f16ce6729b28531141472df92277c55b557"
    ),
    "example_interfaces/action/Fibonacci_GetResult": (
        "1b0de0d5d29dc955d92f546706568428632771db13ec84c15ec1c1a59f424a57"
    ),
    "example_interfaces/action/Fibonacci_FeedbackMessage": (
        "c1de71afd52e49a89c53d8262366884185bc0a02f78ce051c4e46b0a7fe59bb2"
    ),
}


@pytest.mark.parametrize("type_name", PUBLISHED)
def test_type_hashes_equal_the_published_ones(type_name: str) -> None:
    assert type_hash(type_name) == f"RIHS01_{PUBLISHED[type_name]}"


def test_type_hash_is_the_sha256_of_the_type_description() -> None:
    for name in [*(name for name in type_names() if "/msg/" in name), *PUBLISHED]:
        others = describe_type(name)
        first = others.pop(name)
        whole = {
            "type_description": first,
            "referenced_type_descriptions": [others[key] for key in sorted(others)],
        }
        assert type_hash(name) == f"RIHS01_{hashlib.sha256(json.dumps(whole).encode()).hexdigest()}", name


def test_unknown_type_has_no_hash() -> None:
    assert not is_known("secret_msgs/msg/Plan")
    assert not is_known("secret_msgs/srv/Plan")
    with pytest.raises(CourseError, match="No message type 'secret_msgs/msg/Plan' here"):
        type_hash("secret_msgs/msg/Plan")
