from collections.abc import Callable
from typing import Any

import pytest

from course_lib.grading.catalog import load_catalog
from course_lib.grading.evidence import Evidence
from course_lib.grading.records import Course
from course_lib.grading.reports import ghost_view
from course_lib.grading.reports.scenes import compared, expected

TOPIC = "/visualization_marker"


def test_the_ghost_is_drawn_pale_beside_what_the_student_drew(
    course: Course, evidence: Callable[..., Evidence], cube: Callable[..., Any]
) -> None:
    task = load_catalog(course.exercises).task("week01.red_cube")
    scene = compared(task, evidence((1.0, TOPIC, cube())))
    drawn = [path for path in scene.objects() if "Marker" in path]
    assert any("expected" in path for path in drawn)
    assert any("basic_shapes" in path for path in drawn)


def test_a_ghost_alone_is_there_where_the_student_drew_nothing(
    course: Course, evidence: Callable[..., Evidence]
) -> None:
    task = load_catalog(course.exercises).task("week01.red_cube")
    assert any("expected" in path for path in compared(task, evidence()).objects())
    assert expected(task, {}).samples[0].topic == TOPIC


def test_below_a_check_a_box_hides_what_is_expected(
    course: Course,
    evidence: Callable[..., Evidence],
    cube: Callable[..., Any],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    shown: list[Any] = []
    monkeypatch.setattr(ghost_view, "display", shown.append)
    task = load_catalog(course.exercises).task("week01.red_cube")
    ghost_view.show_ghost(task, evidence((1.0, TOPIC, cube())))
    (tick, legend), scene = shown[0].children, shown[1].scene
    assert "Pale: what is expected" in legend.value
    drawn = [path for path in scene.objects() if "Marker" in path]
    assert all(scene.visible(path) for path in drawn)
    tick.value = False
    assert {"expected" in path for path in drawn if not scene.visible(path)} == {True}
    assert any(scene.visible(path) for path in drawn)
