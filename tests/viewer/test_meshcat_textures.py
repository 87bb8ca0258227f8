"""Textures of meshcat in pictures, and its static pages."""

from io import BytesIO
from typing import Any

import meshcat.geometry as g
import numpy as np
import pytest
from PIL import Image

from course_lib.viewer import encoding, renderer
from course_lib.viewer.drawables import MeshcatObject
from course_lib.viewer.scene import Scene
from course_lib.viewer.visualizer import Visualizer


def _quarters() -> bytes:
    """Return a PNG: red and green above, blue and yellow below."""
    pixels = np.zeros((8, 8, 3), np.uint8)
    pixels[:4, :4], pixels[:4, 4:] = (255, 0, 0), (0, 255, 0)
    pixels[4:, :4], pixels[4:, 4:] = (0, 0, 255), (255, 255, 0)
    png = BytesIO()
    Image.fromarray(pixels).save(png, "png")
    return png.getvalue()


def _textured(shape: Any, image: bytes) -> Scene:
    scene = Scene()
    texture = g.ImageTexture(image=g.PngImage(image))
    material = g.MeshBasicMaterial(map=texture)
    Visualizer(scene)["it"].set_object(g.Mesh(shape, material))
    return scene


@pytest.mark.parametrize(
    "shape",
    [
        g.Box([1, 1, 1]),
        g.Sphere(0.5),
        g.Cylinder(1.0, 0.5),
        g.Box([2, 1, 0.5]),
    ],
)
def test_image_texture_is_drawn_into_a_rendered_image(shape: Any) -> None:
    picture = Image.open(BytesIO(renderer.draw(_textured(shape, _quarters()), (200, 150)))).convert("RGB")
    colors = {color for _, color in picture.getcolors(maxcolors=30_000) or ()}
    assert len(colors & {(255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 0)}) >= 2


def test_snapshot_of_a_rendered_image_requires_no_image_loading() -> None:
    scene = _textured(g.Box([1, 1, 1]), _quarters())
    assert b"data:image/png" in encoding.snapshot(scene)
    assert b"data:image/png" not in encoding.encode_snapshot(scene)


def test_object_with_a_broken_image_texture_has_no_stand_in() -> None:
    (drawable,) = _textured(g.Box([1, 1, 1]), b"no png").objects().values()
    assert isinstance(drawable, MeshcatObject)
    assert drawable.stand_in is None


def test_static_page_shows_the_scene_offline() -> None:
    viewer = Visualizer(_textured(g.Box([1, 1, 1]), _quarters()))
    page = viewer.static_html()
    assert page.startswith("<!doctype html>")
    assert "an object of meshcat" in page
    assert "iframe srcdoc" in viewer.render_static().data
