from typing import Any

import numpy as np
import pytest

from course_lib.errors import CourseError
from course_lib.sensors.detector import Detection, Detector
from course_lib.sensors.world import Thing, World, box, circle, cylinder, placed, sphere
from tests.sensors.scenes import AT_ORIGIN


def person(x: float, y: float = 0.0) -> Thing:
    return Thing(box(0.5, 0.5, 1.8), placed(x, y, 0), label="Person")


def found(*things: Thing, at: float = 0.0, **settings: Any) -> list[Detection]:
    return Detector(World(things), AT_ORIGIN, **settings).detect(at)


def test_detection_has_the_label_of_the_object() -> None:
    car = Thing(box(4.5, 2, 1.6), circle((8, 0, 0), 1, 2 * np.pi), label="Car")
    (detection,) = found(Thing(sphere(1), placed(0, 9, 0)), car)
    assert (detection.label, detection.size.tolist()) == ("Car", [4.5, 2, 1.6])
    np.testing.assert_allclose(detection.transform_box_to_world, car.transform_at(0))
    np.testing.assert_allclose(detection.velocity, (0, 1, 0), atol=1e-6)


def test_pose_is_evaluated_once_per_detection() -> None:
    times: list[float] = []

    def pose(seconds: float) -> Any:
        times.append(seconds)
        return placed(5, 0, 0)

    assert len(found(person(3, 2), person(4, -2), Thing(box(1, 1, 1), pose, label="Box"))) == 3
    assert times.count(0.0) == 1


def test_confidence_falls_with_distance() -> None:
    sure = [found(person(x))[0].confidence for x in (2, 5, 10, 19)]
    assert sure == sorted(sure, reverse=True)
    assert sure[2] == pytest.approx(0.75)
    assert found(person(25)) == []


def test_confidence_falls_with_occlusion() -> None:
    post = Thing(cylinder(0.15, 4), placed(3, 0.2, 0))
    wall = Thing(box(0.1, 4, 4), placed(3, 0, 0))
    clear, behind_post = found(person(6))[0].confidence, found(person(6), post)[0].confidence
    assert 0 < behind_post < clear
    assert found(person(6), wall) == []


def test_objects_outside_the_field_of_view_are_not_detected() -> None:
    things = person(5), person(0, 5), person(-5)
    assert len(found(*things)) == 3
    (ahead,) = found(*things, field_of_view=np.pi / 2)
    assert ahead.transform_box_to_world[0, 3] == 5


def test_tracks_are_kept_while_followed_and_renewed_after_a_gap() -> None:
    world = World([person(3), person(5, 3)])
    detector = Detector(world, AT_ORIGIN, keep=2.0)
    assert [[d.track for d in detector.detect(t)] for t in (0.0, 1.0, 2.5, 6.0)] == [[1, 2]] * 3 + [[3, 4]]


def test_misses_and_false_alarms_have_the_requested_rates() -> None:
    detector = Detector(World([person(3)]), AT_ORIGIN, miss_rate=0.3, false_alarms=0.5, keep=1e9)
    detections = [detector.detect(0.1 * number) for number in range(1000)]
    real = sum(d.track == detections_of_person(detections) for each in detections for d in each)
    assert real == pytest.approx(700, abs=60)
    alarms = [d for each in detections for d in each if d.track != detections_of_person(detections)]
    assert len(alarms) == pytest.approx(500, abs=80)
    assert len({alarm.track for alarm in alarms}) == len(alarms)
    assert max(alarm.confidence for alarm in alarms) <= 0.5


def detections_of_person(detections: list[list[Detection]]) -> int:
    return next(d.track for each in detections for d in each if d.transform_box_to_world[0, 3] == 3)


def test_equal_seeds_give_equal_detections() -> None:
    def run(seed: int) -> list[Any]:
        detector = Detector(
            World([person(3), person(5, 3)]), AT_ORIGIN, noise=0.1, miss_rate=0.2, false_alarms=1, seed=seed
        )
        every = [d for number in range(20) for d in detector.detect(number / 2)]
        return [(d.track, d.label, d.confidence, d.transform_box_to_world.tolist()) for d in every]

    assert run(1) == run(1)
    assert run(1) != run(2)


@pytest.mark.parametrize(
    ("settings", "text"),
    [
        ({"range_max": 0}, r"range_max \[m\] is 0"),
        ({"miss_rate": 2}, "miss_rate is 2; expected a number >= 0 and <= 1"),
        ({"false_alarms": -1}, "false_alarms is -1"),
        ({"field_of_view": 0}, r"field_of_view \[rad\] is 0"),
    ],
)
def test_invalid_settings_are_reported(settings: Any, text: str) -> None:
    with pytest.raises(CourseError, match=text):
        found(**settings)
