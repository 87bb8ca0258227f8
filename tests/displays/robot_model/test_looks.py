"""Appearance of links. Their shapes are compared with Pinocchio in tests/robots/test_links.py."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from course_lib.displays.robot_model import LinkShapes, inertia
from course_lib.robots.urdf import Geometry, Inertial, Link, Material
from course_lib.viewer.drawables import Solids

BOX = Geometry("box", np.eye(4), (1.0, 1.0, 1.0))


def test_texture_is_drawn_in_its_mean_color(tmp_path: Path) -> None:
    picture = Image.new("RGB", (2, 1), (255, 0, 0))
    picture.putpixel((1, 0), (0, 0, 255))
    picture.save(tmp_path / "half.png")
    material = Material((1.0, 1.0, 1.0, 1.0), f"file://{tmp_path}/half.png")
    drawn = LinkShapes(Link("a", (BOX,), (), material, None), None).draw(BOX, 1.0, False)
    assert isinstance(drawn, Solids)
    np.testing.assert_allclose(drawn.colors, [0.5, 0, 0.5, 1])


def test_missing_texture_is_white() -> None:
    material = Material((1.0, 1.0, 1.0, 1.0), "file:///nowhere.png")
    drawn = LinkShapes(Link("a", (BOX,), (), material, None), None).draw(BOX, 0.5, False)
    assert isinstance(drawn, Solids)
    np.testing.assert_allclose(drawn.colors, [1, 1, 1, 0.5])


@pytest.mark.parametrize("size", [(1.0, 2.0, 3.0), (0.1, 0.1, 5.0)])
def test_inertia_box_has_the_inertia_of_the_link(size: tuple[float, float, float]) -> None:
    mass, squares = 3.0, np.square(size)
    turned, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
    moments = turned @ np.diag(mass / 12 * (squares.sum() - squares)) @ turned.T
    drawn = inertia(Inertial(mass, moments, np.eye(4)))
    assert drawn is not None
    box = drawn.placements[0, :3, :3].astype(float)
    np.testing.assert_allclose(sorted(np.linalg.norm(box, axis=0)), sorted(size), rtol=1e-5)
    np.testing.assert_allclose(box @ box.T, turned @ np.diag(squares) @ turned.T, atol=1e-5)


@pytest.mark.parametrize("moments", [(0, 0, 0), (1, 1, 3), (-1, 1, 1), (np.nan, 1, 1)])
def test_physically_impossible_inertia_is_not_drawn(moments: tuple[float, ...]) -> None:
    assert inertia(Inertial(1.0, np.diag(moments).astype(float), np.eye(4))) is None
