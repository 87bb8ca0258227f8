"""Checks of absent messages and entities, and of images."""

from collections.abc import Callable
from typing import Any

import pytest
from sensor_msgs.msg import Image
from std_msgs.msg import String
from visualization_msgs.msg import Marker, MarkerArray

from course_lib.grading import (
    expect_gone,
    expect_images,
    expect_length,
    expect_nothing_before,
)
from course_lib.grading.evidence import Evidence

MakeEvidence = Callable[..., Evidence]


def cube(at: float) -> tuple[float, str, Any]:
    marker = Marker(type=Marker.CUBE, id=3)
    marker.lifetime.sec = 1
    return at, "/boxes", MarkerArray(markers=[marker])


@pytest.mark.parametrize(
    ("published", "message"),
    [
        ((cube(0.5), cube(1.0)), "as expected"),
        ((cube(0.5), cube(2.5)), "/boxes still shows 1 marker at the end, expected none"),
        ((), "nothing was published on /boxes in 3 s, nor on any other topic"),
    ],
)
def test_expect_gone_needs_an_object_that_was_shown_and_removed(
    evidence: MakeEvidence, published: tuple[Any, ...], message: str
) -> None:
    assert expect_gone("/boxes").judge(evidence(*published)).message == message


@pytest.mark.parametrize(
    ("at", "message"),
    [
        (1.1, "as expected"),
        (0.1, "/words was published after 0.10 s, expected nothing before 1.00 s"),
    ],
)
def test_premature_message_is_reported(evidence: MakeEvidence, at: float, message: str) -> None:
    recorded = evidence((at, "/words", String()), (2.0, "/words", String()))
    assert expect_nothing_before("/words", 1.0).judge(recorded).message == message


@pytest.mark.parametrize(
    ("image", "message"),
    [
        (Image(width=2, height=3, step=2, data=bytes(6), encoding="mono8"), "as expected"),
        (Image(), "an image on /image has 0 x 0 pixels"),
        (
            Image(width=2, height=3, step=2, encoding="mono8"),
            "the first image on /image has 0 bytes of data for 3 rows of 2 bytes (step)",
        ),
        (
            Image(width=4, height=1, step=2, data=bytes(2), encoding="mono8"),
            "the first image on /image has rows of 4 pixels of 'mono8' in 2 bytes (step), expected 4 or more",
        ),
        (
            Image(width=2, height=1, step=2, data=bytes(2), encoding="gray8"),
            "an image on /image has the encoding 'gray8', "
            "which RViz cannot draw, expected 'mono8', 'rgb8' or similar",
        ),
        (String(), "/image carries std_msgs/msg/String, expected sensor_msgs/msg/Image"),
    ],
)
def test_image_without_pixels_is_reported(evidence: MakeEvidence, image: Any, message: str) -> None:
    assert expect_images("/image").judge(evidence((1.0, "/image", image))).message == message


def test_later_images_without_pixels_are_accepted(evidence: MakeEvidence) -> None:
    later = Image(width=1, height=1, step=1, encoding="mono8")
    first = Image(width=1, height=1, step=1, encoding="mono8", data=[1])
    recorded = evidence((1.0, "/image", first), (2.0, "/image", later))
    assert expect_images("/image").judge(recorded).score == 1


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("one two three", "as expected"),
        ("one", "1 words, expected 2 to 3"),
        (None, "0 words, expected 2 to 3"),
        (5, "0 words, expected 2 to 3"),
    ],
)
def test_text_length_is_counted_in_words(text: Any, message: str) -> None:
    evidence = Evidence("week06.x", "public", 0.0, returns=(text,))
    assert expect_length(2, 3).judge(evidence).message == message
