import math
from collections.abc import Callable
from typing import Any

import pytest
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path

from course_lib.grading import expect_parameters, expect_path
from course_lib.grading.evidence import Evidence

MakeEvidence = Callable[..., Evidence]
CHECK = expect_path("/way", count=3, frame="map", ends=((0, 0, 0), (2, 0, 0)), yaw=1.0)


def way(count: int = 3, frame: str = "map", y: float = 0.0, yaw: float = 1.0) -> Any:
    path = Path()
    path.header.frame_id = frame
    for number in range(count):
        pose = PoseStamped(header=path.header)
        pose.pose.position.x, pose.pose.position.y = float(number), y
        pose.pose.orientation.z, pose.pose.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
        path.poses.append(pose)
    return (1.0, "/way", path)


def test_correct_path_passes(evidence: MakeEvidence) -> None:
    assert CHECK.judge(evidence(way())).score == 1


@pytest.mark.parametrize(
    ("end", "cause"),
    [((0.0, 1.0, 0.0), "x and y are exchanged"), ((-1.0, 0.0, 0.0), "each sign is reversed")],
)
def test_exchanged_or_reversed_coordinates_of_a_path_are_reported(
    evidence: MakeEvidence, end: tuple[float, float, float], cause: str
) -> None:
    check = expect_path("/way", count=2, frame="map", ends=((0, 0, 0), end))
    message = check.judge(evidence(way(count=2))).message
    assert message.startswith("the last pose of /way is at (1.00, 0.00, 0.00) m")
    assert message.endswith(f": {cause}")


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (way(count=4), "the last path on /way has 4 poses, expected 3"),
        (way(frame="odom"), "the path on /way is in frame 'odom', expected 'map'"),
        (way(y=1.0), "the first pose of /way is at (0.00, 1.00, 0.00) m, expected (0.00, 0.00, 0.00) m"),
        (way(yaw=0.0), "the last pose of /way is turned by 0.00 rad (0°) about z, expected 1.00 rad (57°)"),
    ],
)
def test_faults_of_a_path_are_reported(evidence: MakeEvidence, wrong: Any, message: str) -> None:
    verdict = CHECK.judge(evidence(wrong))
    assert (verdict.score, verdict.message) == (0, message)


@pytest.mark.parametrize(
    ("count", "kind"),
    [
        (4, "a path has one pose too many or too few"),
        (5, "a path has the wrong number of poses"),
        (1, "a path has too few poses"),
    ],
)
def test_number_of_poses_that_is_off_by_one_is_a_kind_of_its_own(
    evidence: MakeEvidence, count: int, kind: str
) -> None:
    assert CHECK.judge(evidence(way(count=count))).mistake == kind


def test_pose_without_the_frame_of_its_path_is_reported(evidence: MakeEvidence) -> None:
    wrong = way()
    wrong[2].poses[1] = PoseStamped(pose=wrong[2].poses[1].pose)
    verdict = CHECK.judge(evidence(wrong))
    assert verdict.message == "a pose of the path on /way has the frame '' in its own header, expected 'map'"
    assert verdict.mistake == "the frame of a pose in a path is wrong"


def test_mirrored_pose_has_its_own_kind_of_mistake(evidence: MakeEvidence) -> None:
    check = expect_path("/way", count=2, frame="map", ends=((0, 0, 0), (-1.0, 0, 0)))
    assert check.judge(evidence(way(count=2))).mistake == "a pose of a path is mirrored"


def test_quaternion_without_unit_length_is_reported(evidence: MakeEvidence) -> None:
    wrong = way(yaw=1.2)
    check = expect_path("/way", count=3, frame="map", ends=((0, 0, 0), (2, 0, 0)), yaw=1.2)
    assert check.judge(evidence(wrong)).score == 1
    wrong[2].poses[-1].pose.orientation.w = 1.0
    assert check.judge(evidence(wrong)).message == (
        "the last pose of /way is turned by 1.03 rad (59°) about z, expected 1.20 rad (69°): "
        "its quaternion has the length 1.15, expected 1"
    )


def returned(text: Any) -> Evidence:
    return Evidence("week07.params", "public", 5.0, returns=(text,))


@pytest.mark.parametrize(
    "text",
    [
        "/**:\n  ros__parameters: {rate: 5.0}\n",
        "talker:\n  ros__parameters:\n    rate: 5.0\n",
        "/talker: {ros__parameters: {rate: 5.}}",
        "/**: {ros__parameters: {rate: 1.0}}\ntalker: {ros__parameters: {rate: 5.0}}",
    ],
)
def test_parameter_is_accepted_in_every_ros_notation(text: str) -> None:
    assert expect_parameters("/talker", {"rate": 5.0}).judge(returned(text)).score == 1


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("talker: {ros__parameters: {rate: 5}}", "rate of /talker is the integer 5, expected a double"),
        (
            "listener: {ros__parameters: {rate: 5.0}}",
            "there is no rate for /talker in the file, only for /listener",
        ),
        (
            "listener: {ros__parameters: {gain: 5.0}}",
            "there is no rate for /talker in the file, whose nodes are /listener",
        ),
        ("talker: {rate: 5.0}", "ROS rejects the file: Cannot have a value before ros__parameters at line 1"),
        ("a: &x {}\nb: *x", "ROS rejects the file: Will not support aliasing at line 2"),
        (None, "no parameters file was returned"),
    ],
)
def test_faults_of_a_parameter_file_are_reported(text: Any, message: str) -> None:
    verdict = expect_parameters("/talker", {"rate": 5.0}).judge(returned(text))
    assert (verdict.score, verdict.message) == (0, message)


def test_file_that_changes_another_default_is_reported() -> None:
    check = expect_parameters("/talker", {"rate": 5.0}, unchanged={"gain": 1.0})
    text = "/**: {ros__parameters: {gain: 2.0}}\ntalker: {ros__parameters: {rate: 5.0}}"
    verdict = check.judge(returned(text))
    assert verdict.message == "gain of /talker is 2.0, expected its default, 1.0"
    assert verdict.mistake == "a parameter does not keep its default"
    assert check.judge(returned(text.replace("2.0", "1.0"))).score == 1


def test_wrong_message_type_on_the_path_topic_is_reported(evidence: MakeEvidence) -> None:
    verdict = CHECK.judge(evidence((1.0, "/way", PoseStamped())))
    assert verdict.message == "/way carries geometry_msgs/msg/PoseStamped, expected nav_msgs/msg/Path"
    assert verdict.mistake == "a topic has the wrong message type"
