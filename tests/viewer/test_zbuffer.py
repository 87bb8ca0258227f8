from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from course_lib.viewer import renderer
from course_lib.viewer.drawables import Camera, Drawable, Lines, Mesh, Points, Sheet, Solids, Spot, Text
from course_lib.viewer.scene import Scene

SIZE = (200, 160)


def scaled(size: float, z: float = 0.0) -> np.ndarray:
    transform_unit_to_node = np.diag([size, size, size, 1.0])
    transform_unit_to_node[2, 3] = z  # [m]
    return transform_unit_to_node


def from_above(*drawables: Drawable) -> Scene:
    """A scene seen from 10 m above, 20 pixels to the metre."""
    scene = Scene()
    scene.background = (0, 0, 0)
    scene.camera = Camera(eye=(0, 0, 10), target=(0, 0, 0), up=(0, 1, 0), orthographic_scale=20)
    for number, drawable in enumerate(drawables):
        scene.set_object(str(number), drawable)
    return scene


def render_pixels(scene: Scene) -> np.ndarray:
    return np.asarray(Image.open(BytesIO(renderer.draw(scene, SIZE)))).astype(int)


def middle(scene: Scene) -> list[int]:
    found: list[int] = render_pixels(scene)[SIZE[1] // 2, SIZE[0] // 2].tolist()
    return found


def box(color: tuple[float, ...], z: float = 0.0, size: float = 2.0) -> Solids:
    return Solids("box", [scaled(size, z)], color)


def test_face_toward_the_camera_has_its_unshaded_color() -> None:
    assert middle(from_above(box((1, 0.5, 0, 1)))) == [255, 128, 0]


def test_slanted_face_is_darker_with_the_same_hue() -> None:
    slanted = Mesh([[-2, -2, -2], [2, -2, 2], [2, 2, 2], [-2, 2, -2]], [[0, 1, 2], [0, 2, 3]], (1, 0.5, 0, 1))
    red, green, blue = middle(from_above(slanted))
    assert red == pytest.approx(255 * np.sqrt(0.5), abs=1)
    assert green == pytest.approx(red / 2, abs=1)
    assert blue == 0


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_nearer_object_is_drawn_in_front_regardless_of_order(order: tuple[int, int]) -> None:
    boxes = [box((1, 0, 0, 1), z=2), box((0, 1, 0, 1), z=-2)]
    assert middle(from_above(*(boxes[i] for i in order))) == [255, 0, 0]


def test_semi_transparent_objects_are_blended_with_the_background() -> None:
    assert middle(from_above(box((1, 0, 0, 0.5), z=2), box((0, 0, 1, 1)))) == [128, 0, 128]
    layers = (box((1, 0, 0, 0.5), z=2), box((0, 1, 0, 0.5), z=-2))
    assert middle(from_above(*layers)) == middle(from_above(*reversed(layers))) == [128, 64, 0]


def test_objects_with_alpha_zero_are_invisible() -> None:
    assert middle(from_above(box((1, 0, 0, 0)))) == [0, 0, 0]


def test_hidden_and_deleted_objects_are_not_drawn() -> None:
    scene = from_above(box((1, 0, 0, 1)), box((0, 1, 0, 1)))
    scene.set_visible("0", False)
    scene.delete("1")
    assert not render_pixels(scene).any()


def test_lines_have_the_requested_width_or_one_pixel() -> None:
    wide = render_pixels(from_above(Lines([[-3, 0, 0], [3, 0, 0]], (1, 1, 1, 1), width=0.5)))[..., 0]
    assert wide[:, 100].sum() / 255 == pytest.approx(10, abs=1)
    assert wide[80].sum() / 255 == pytest.approx(120, abs=1)
    thin = render_pixels(from_above(Lines([[-3, 0, 0], [3, 0, 0]], (1, 1, 1, 1))))[..., 0]
    assert thin[:, 100].sum() / 255 == pytest.approx(1, abs=0.5)


def test_line_starting_behind_the_camera_is_drawn() -> None:
    scene = from_above(Lines([[0, -1, 100], [0, 0, -100]], (1, 1, 1, 1), width=0.2))
    scene.camera = Camera(eye=(0, 0, 10), target=(0, 0, 0), up=(0, 1, 0))
    assert render_pixels(scene).any()


def test_points_are_squares_with_sizes_in_meters_or_pixels() -> None:
    metres = render_pixels(from_above(Points([[0, 0, 0]], (1, 1, 1, 1), (1.0, 0.5))))[..., 0] > 0
    assert metres.sum() == 20 * 10
    pixels = render_pixels(from_above(Points([[0, 0, 0]], (1, 1, 1, 1), (4, 4), pixels=True)))[..., 0] > 0
    assert pixels.sum() == 16


def test_capital_letters_have_the_requested_height_and_are_centered() -> None:
    rows, columns = np.nonzero(render_pixels(from_above(Text("H", 2.0)))[..., 0] > 128)
    assert np.ptp(rows) + 1 == pytest.approx(40, abs=1)
    assert (rows.min() + rows.max()) / 2 == pytest.approx(79.5, abs=1)
    assert (columns.min() + columns.max()) / 2 == pytest.approx(99.5, abs=2)


def test_text_at_or_beyond_the_image_edge_raises_no_exception() -> None:
    scene = from_above(Text("far away", 0.5, (1, 1, 1, 1)), Text("in the corner", 0.5, (1, 1, 1, 1)))
    for path, place in {"0": 100.0, "1": 5.0}.items():
        transform_text_to_scene = np.eye(4)
        transform_text_to_scene[:2, 3] = place  # [m]
        scene.set_transform(path, transform_text_to_scene)
    assert render_pixels(scene).shape == (SIZE[1], SIZE[0], 3)


def test_vertex_colors_are_interpolated() -> None:
    corners = [[-4, -3, 0], [4, -3, 0], [0, 3, 0]]
    mesh = Mesh(corners, None, [(1, 0, 0, 1), (0, 1, 0, 1), (0, 0, 1, 1)], lit=False)
    picture = render_pixels(from_above(mesh))
    assert picture[80, 100] == pytest.approx([64, 64, 128], abs=3)


def test_empty_scene_is_only_background() -> None:
    scene = from_above(Points([], [], (1, 1)), Lines([], []), Solids("box", [], []))
    scene.background = (1, 2, 3)
    assert (render_pixels(scene) == [1, 2, 3]).all()


@pytest.mark.filterwarnings("error")
def test_objects_with_non_finite_positions_are_not_drawn() -> None:
    nowhere = np.array([[np.nan, 0, 0], [1, np.inf, 0], [0, 1, 0]])
    scene = from_above(
        Lines(nowhere, (1, 1, 1, 1), width=0.1),
        Points(nowhere[:2], (1, 1, 1, 1), (1, 1)),
        Mesh(nowhere, None, (1, 1, 1, 1)),
        Solids("box", np.full((1, 4, 4), np.nan), (1, 1, 1, 1)),
    )
    assert not render_pixels(scene).any()


def test_flattened_solid_is_drawn_from_its_flat_side() -> None:
    flat = np.diag([2.0, 2.0, 0.0, 1.0])
    assert middle(from_above(Solids("box", [flat], (1, 0, 0, 1)))) == [255, 0, 0]


def test_flat_list_elements_keep_their_upper_side_along_the_node_y_axis() -> None:
    scene = from_above(Points([[0, 0, 0]], (1, 1, 1, 1), (4.0, 1.0)))
    scene.set_transform("0", [[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])  # a quarter turn
    rows, columns = np.nonzero(render_pixels(scene).max(axis=2))
    assert np.ptp(rows) > 3 * np.ptp(columns)


def test_sides_of_listed_boxes_are_shaded_as_in_rviz() -> None:
    cube = Points([[0, 0, 0]], (1, 1, 1, 1), (2.0, 2.0, 2.0), spot="box")
    assert middle(from_above(cube)) == [round(0.9 * 255)] * 3


def test_oblong_listed_sphere_is_an_ellipse_with_a_darker_rim() -> None:
    picture = render_pixels(from_above(Points([[0, 0, 0]], (1, 0, 0, 1), (4.0, 2.0, 1.0), spot="sphere")))[
        ..., 0
    ]
    rows, columns = np.nonzero(picture)
    assert (np.ptp(columns), np.ptp(rows)) == pytest.approx((79, 39), abs=2)
    assert picture[80, 100] > picture[80, 70] > 0.75 * 255


@pytest.mark.parametrize(("tilt", "height"), [(0.0, 40), (np.pi / 3, 20), (np.pi, 40)])
def test_tiles_lie_in_the_plane_of_their_node_and_are_two_sided(tilt: float, height: int) -> None:
    scene = from_above(Points([[0, 0, 0]], (1, 0, 0, 1), (2.0, 2.0), spot="tile"))
    turn = np.eye(4)
    turn[1:3, 1:3] = [[np.cos(tilt), -np.sin(tilt)], [np.sin(tilt), np.cos(tilt)]]
    scene.set_transform("0", turn)
    covered = render_pixels(scene)[..., 0] > 128
    assert covered.any(axis=0).sum() == pytest.approx(40, abs=1)
    assert covered.any(axis=1).sum() == pytest.approx(height, abs=1)


def test_points_in_pixels_are_round_if_drawn_as_discs() -> None:
    scene = from_above(Points([[0, 0, 0]], (1, 0, 0, 1), (40.0, 40.0), pixels=True, spot="disc"))
    area = (render_pixels(scene)[..., 0] > 128).sum()
    assert area == pytest.approx(4 * np.sin(np.pi / 4) * 20**2, rel=0.02)  # eight corners stand for a circle


CELLS = [[0, 1], [2, 3]]
PALETTE = np.tile([(1, 0, 0, 1), (0, 1, 0, 1), (0, 0, 1, 1), (1, 1, 1, 0)], (64, 1))


def on_sheet(scene: Scene) -> list[list[int]]:
    """The colours around the middle: left and right above, left and right below, 1 m from it."""
    x, y, away = SIZE[0] // 2, SIZE[1] // 2, 20
    return [render_pixels(scene)[y + dy, x + dx].tolist() for dy in (-away, away) for dx in (-away, away)]


def test_sheet_shows_its_rows_along_y_with_sharp_cells() -> None:
    scene = from_above(Sheet(CELLS, PALETTE, 2.0))
    scene.set_transform("0", [[1, 0, 0, -2], [0, 1, 0, -2], [0, 0, 1, 0], [0, 0, 0, 1]])
    assert on_sheet(scene) == [[0, 0, 255], [0, 0, 0], [255, 0, 0], [0, 255, 0]]


@pytest.mark.parametrize(("behind", "seen"), [(False, [255, 0, 0]), (True, [0, 0, 255])])
def test_sheet_behind_all_objects_hides_none_of_them(behind: bool, seen: list[int]) -> None:
    scene = from_above(box((0, 0, 1, 1)), Sheet([[0]], PALETTE, 2.0, is_behind=behind))
    scene.set_transform("1", [[1, 0, 0, -1], [0, 1, 0, -1], [0, 0, 1, 3], [0, 0, 0, 1]])
    assert middle(scene) == seen


@pytest.mark.parametrize("alpha", [1.0, 0.5])
def test_line_on_a_sheet_is_visible(alpha: int) -> None:
    sheet = Sheet([[0] * 4], [(1, 0, 0, alpha)] * 256, 2.0)
    line = Lines([(0, 1, 0), (8, 1, 0)], (0, 0, 1, 1), width=0.5)
    scene = from_above(sheet, line)
    scene.set_transform("1", np.eye(4))
    assert on_sheet(scene)[1] == [0, 0, 255]


def test_list_elements_are_scaled_in_z() -> None:
    spots = Points([(0, 0, 1), (0, 0, 3)], (1, 1, 1, 1), (1.0, 1.0), grow=True)
    assert (render_pixels(from_above(spots))[..., 0] > 0).sum() == pytest.approx(60**2, rel=0.05)  # 3 m wide


@pytest.mark.parametrize("scale", [None, 30.0])
@pytest.mark.parametrize(("spot", "size"), [("square", 0.1), ("disc", 0.1), ("sphere", 0.1), ("box", 0.05)])
def test_many_small_points_look_like_their_shapes(
    spot: Spot, size: float, scale: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = np.random.default_rng(1)
    places = rng.uniform(-3, 3, (2000, 3))
    scene = from_above(Points(places, (0.2, 0.5, 1.0, 1.0), (size,) * 3, False, spot))
    scene.camera = Camera(eye=(3, -8, 5), target=(0, 0, 0), orthographic_scale=scale)
    shapes = render_pixels(scene)
    monkeypatch.setattr(renderer, "_MANY_POINTS", 1000)
    dots = render_pixels(scene)
    # The shapes of discs are octagons, whose area is a tenth smaller.
    assert (dots > 0).mean() == pytest.approx((shapes > 0).mean(), rel=0.1)
    assert dots.mean(axis=(0, 1)) == pytest.approx(shapes.mean(axis=(0, 1)), rel=0.1)
    assert (dots != shapes).any()


def test_near_points_of_many_are_drawn_with_their_shape() -> None:
    far = np.tile([[0.0, 0.0, -500.0]], (20_000, 1))
    scene = from_above(Points([*far, (0, 0, 8)], (1, 1, 1, 1), (1, 1, 1), False, "box"))
    scene.camera = Camera(eye=(3, -3, 13), target=(0, 0, 8))
    few = from_above(Points([(0, 0, 8)], (1, 1, 1, 1), (1, 1, 1), False, "box"))
    few.camera = scene.camera
    picture = render_pixels(few)
    assert len(np.unique(picture)) > 3
    assert (render_pixels(scene)[60:100, 80:120] == picture[60:100, 80:120]).all()


def test_nearest_of_many_points_hides_the_others() -> None:
    places = np.zeros((20_000, 3))
    places[:, 2] = np.linspace(-3, 3, len(places))
    colors = np.tile([1.0, 0.0, 0.0, 1.0], (len(places), 1))
    colors[-1] = (0, 1, 0, 1)
    scene = from_above(Points(places, colors, (4, 4), pixels=True))
    assert middle(scene) == [0, 255, 0]
    colors[:, 3] = 0.5
    red, green, _ = middle(from_above(Points(places, colors, (4, 4), pixels=True)))
    assert red == pytest.approx(green, abs=2) == pytest.approx(127, abs=2)
