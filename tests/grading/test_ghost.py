from collections.abc import Callable
from typing import Any

import pytest

from course_lib.grading.evidence import Evidence
from course_lib.grading.reports import scenes
from course_lib.grading.reports.scenes import comparison_scene, expected_recording
from course_lib.grading.store import Course
from course_lib.grading.task import load_catalog

TOPIC = "/visualization_marker"


def test_expected_markers_are_drawn_transparent_next_to_the_published_markers(
    course: Course, evidence: Callable[..., Evidence], cube: Callable[..., Any]
) -> None:
    task = load_catalog(course.exercises).task("week01.red_cube")
    scene = comparison_scene(task, evidence((1.0, TOPIC, cube())))
    drawn = [path for path in scene.objects() if "Marker" in path]
    assert any("expected" in path for path in drawn)
    assert any("basic_shapes" in path for path in drawn)


def test_expected_markers_are_drawn_if_the_student_published_nothing(
    course: Course, evidence: Callable[..., Evidence]
) -> None:
    task = load_catalog(course.exercises).task("week01.red_cube")
    assert any("expected" in path for path in comparison_scene(task, evidence()).objects())
    assert expected_recording(task, {}).samples[0].topic == TOPIC


def test_checkbox_below_a_check_hides_the_expected_markers(
    course: Course,
    evidence: Callable[..., Evidence],
    cube: Callable[..., Any],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    shown: list[Any] = []
    monkeypatch.setattr(scenes, "display", shown.append)
    task = load_catalog(course.exercises).task("week01.red_cube")
    scenes.show_ghost(task, evidence((1.0, TOPIC, cube())))
    (tick, legend), scene = shown[0].children, shown[1].scene
    assert "Pale: the expected markers" in legend.value
    drawn = [path for path in scene.objects() if "Marker" in path]
    assert all(scene.is_visible(path) for path in drawn)
    tick.value = False
    assert {"expected" in path for path in drawn if not scene.is_visible(path)} == {True}
    assert any(scene.is_visible(path) for path in drawn)
