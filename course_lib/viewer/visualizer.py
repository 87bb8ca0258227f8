"""meshcat's interface to a scene: its Visualizer, its window, and its objects as drawables.

Code for meshcat draws into a scene of this kit, without a server. Objects with an equivalent
drawable are converted, so that pages and images agree; the page's three.js draws the others. A page
loads the images of textures a little later, but a screenshot cannot wait: there, a textured mesh
becomes triangles with colored vertices, fine enough to show the texture.
"""

import base64
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import replace
from io import BytesIO
from math import atan, radians, tan
from typing import Any, Protocol, TypeAlias

import meshcat
import numpy as np
import numpy.typing as npt
from PIL import Image

from course_lib.arrays import Float32s, Floats, Matrix
from course_lib.errors import CourseError
from course_lib.viewer import drawables
from course_lib.viewer.html import static_page
from course_lib.viewer.renderer import screenshot
from course_lib.viewer.scene import Scene, describe_scene

Json: TypeAlias = Mapping[str, Any]

# The number of steps along each side of a surface.
_STEPS = 48
_PREFIX = "base64,"
# three.js's wrappings of a texture coordinate: repeated, clamped, mirrored.
_WRAPPINGS: Mapping[int, Callable[[Floats], Floats]] = {
    1000: lambda at: at % 1.0,
    1001: lambda at: np.clip(at, 0.0, 1.0),
    1002: lambda at: 1.0 - np.abs(at % 2.0 - 1.0),
}


def textured_mesh(
    json: Json, geometry: Json, material: Json, color: Float32s, transform: Matrix
) -> drawables.Mesh | None:
    """Return a mesh colored by its texture, or None without a texture or for other geometries.

    Args:
        json: The object, with its textures and images.
        geometry: The geometry of the object.
        material: The material of the object.
        color: The material's RGBA, which multiplies the texture.
        transform: The transform from the geometry to the object's node, shape (4, 4).
    """
    surface = _SURFACES.get(str(geometry.get("type")))
    texture: Json = next((t for t in json.get("textures", ()) if t["uuid"] == material.get("map")), {})
    image: Json = next((i for i in json.get("images", ()) if i["uuid"] == texture.get("image")), {})
    url = str(image.get("url", ""))
    if surface is None or not url.startswith("data:image/") or _PREFIX not in url:
        return None
    try:
        with Image.open(BytesIO(base64.b64decode(url.partition(_PREFIX)[2]))) as picture:
            pixels = np.asarray(picture.convert("RGBA"), dtype=float) / 255
    except Exception:
        # Image decoders can raise any exception for a damaged file.
        return None
    vertices, coordinates, faces = surface(geometry)
    if not len(vertices):
        return None
    # The colors of the image at the texture coordinates, where v points up.
    repeat = np.asarray(texture.get("repeat", (1, 1)), float)
    wraps = [_WRAPPINGS.get(int(wrap), _WRAPPINGS[1001]) for wrap in texture.get("wrap", (1001, 1001))]
    u, v = (wrap(coordinates[:, axis] * repeat[axis]) for axis, wrap in enumerate(wraps))
    rows, columns = pixels.shape[:2]
    row = np.minimum(((1.0 - v) * rows).astype(int), rows - 1)
    colors = pixels[row, np.minimum((u * columns).astype(int), columns - 1)] * color
    if not material.get("transparent"):
        colors[:, 3] = 1.0
    transformed = vertices @ transform[:3, :3].T + transform[:3, 3]
    return drawables.Mesh(transformed, faces, colors, lit=material.get("type") != "MeshBasicMaterial")


def _grid(place: Callable[[Floats, Floats], Floats]) -> drawables.Surface:
    """Return a surface over u and v from 0 to 1; `place` computes its points, shape (V, 3)."""
    u, v = (part.ravel() for part in np.meshgrid(*[np.linspace(0, 1, _STEPS + 1)] * 2))
    corner = (np.arange(_STEPS)[:, None] * (_STEPS + 1) + np.arange(_STEPS)).ravel()
    right, up = corner + 1, corner + _STEPS + 1
    faces = np.concatenate([np.column_stack([corner, right, up]), np.column_stack([right, up + 1, up])])
    return place(u, v), np.column_stack([u, v]), faces


def _merge_surfaces(*surfaces: drawables.Surface) -> drawables.Surface:
    starts = np.cumsum([0, *(len(vertices) for vertices, _, _ in surfaces[:-1])])
    return (
        np.concatenate([vertices for vertices, _, _ in surfaces]),
        np.concatenate([coordinates for _, coordinates, _ in surfaces]),
        np.concatenate([faces + start for (_, _, faces), start in zip(surfaces, starts, strict=True)]),
    )


def _box(box: Json) -> drawables.Surface:
    """Return six sides, each with the whole image, oriented like three.js's BoxGeometry."""
    half = np.array([box["width"], box["height"], box["depth"]], float) / 2
    # The axes of u, v and of the side, with their directions; v points up in the picture.
    sides = (
        (2, -1, 1, 1, 0, 1), (2, 1, 1, 1, 0, -1), (0, 1, 2, -1, 1, 1),
        (0, 1, 2, 1, 1, -1), (0, 1, 1, 1, 2, 1), (0, -1, 1, 1, 2, -1),
    )  # fmt: skip

    def side(u_axis: int, u_sign: int, v_axis: int, v_sign: int, axis: int, sign: int) -> drawables.Surface:
        def place(u: Floats, v: Floats) -> Floats:
            points = np.empty((len(u), 3))
            points[:, u_axis] = (2 * u - 1) * half[u_axis] * u_sign
            points[:, v_axis] = (2 * v - 1) * half[v_axis] * v_sign
            points[:, axis] = half[axis] * sign
            return points

        return _grid(place)

    return _merge_surfaces(*(side(*axes) for axes in sides))


def _sphere(ball: Json) -> drawables.Surface:
    def place(u: Floats, v: Floats) -> Floats:
        around, down = 2 * np.pi * u, np.pi * (1 - v)
        directions = [-np.cos(around) * np.sin(down), np.cos(down), np.sin(around) * np.sin(down)]
        points: Floats = np.column_stack(directions) * ball["radius"]
        return points

    return _grid(place)


def _cylinder_surface(cylinder: Json) -> drawables.Surface:
    top, bottom, height = (float(cylinder[name]) for name in ("radiusTop", "radiusBottom", "height"))

    def wall(u: Floats, v: Floats) -> Floats:
        radius, around = bottom + (top - bottom) * v, 2 * np.pi * u
        return np.column_stack([radius * np.sin(around), (v - 0.5) * height, radius * np.cos(around)])

    def cap(radius: float, sign: float) -> drawables.Surface:
        points, polar, faces = _grid(
            lambda u, v: np.column_stack(
                [
                    radius * v * np.sin(2 * np.pi * u),
                    0 * u + sign * height / 2,
                    radius * v * np.cos(2 * np.pi * u),
                ]
            )
        )
        around = 2 * np.pi * polar[:, 0]
        flat = np.column_stack([np.cos(around), np.sin(around) * sign]) * polar[:, 1:] / 2 + 0.5
        return points, flat, faces

    return _merge_surfaces(_grid(wall), cap(top, 1.0), cap(bottom, -1.0))


def _triangles(geometry: Json) -> drawables.Surface:
    """Return the triangles of a BufferGeometry, subdivided into small ones.

    Without uv, the result is empty.
    """
    attributes = geometry["data"]["attributes"]
    if "uv" not in attributes:
        return np.empty((0, 3)), np.empty((0, 2)), np.empty((0, 3))
    data = [np.frombuffer(attributes[name]["array"].data, np.float32) for name in ("position", "uv")]
    points, coordinates = data[0].reshape(-1, 3), data[1].reshape(-1, 2)
    index = geometry["data"].get("index")
    order = np.arange(len(points)) if index is None else np.frombuffer(index["array"].data, np.uint32)
    corners = order.reshape(-1, 3)
    return drawables.subdivide(points[corners], coordinates[corners], _STEPS)


_SURFACES: Mapping[str, Callable[[Json], drawables.Surface]] = {
    "BoxGeometry": _box,
    "PlaneGeometry": lambda plane: _grid(
        lambda u, v: np.column_stack(
            [(u - 0.5) * float(plane.get("width", 1)), (v - 0.5) * float(plane.get("height", 1)), 0 * u]
        )
    ),
    "SphereGeometry": _sphere,
    "CylinderGeometry": _cylinder_surface,
    "BufferGeometry": _triangles,
}


# meshcat's msgpack extensions.
_TYPES = {0x12: np.uint8, 0x15: np.int32, 0x16: np.uint32, 0x17: np.float32}
# The axis of three.js's cylinders is y.
_TRANSFORM_UP_TO_Y = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])


def drawable_of(json: Json) -> drawables.Drawable:
    """Convert an object of meshcat. Objects without an equivalent are left to the page's three.js.

    Boxes, spheres, cylinders, triangles, points, lines and mesh files have an equivalent, unless
    they have textures or are wire frames.
    """
    mesh_object = json["object"]
    geometry, material = _resolve(json, "geometry", "geometries"), _resolve(json, "material", "materials")
    # meshcat stores the matrix column by column.
    transform_geometry_to_node = np.reshape(mesh_object.get("matrix", np.eye(4)), (4, 4)).T
    file = mesh_object if mesh_object["type"] == "_meshfile_object" else geometry
    special = material.get("map") or material.get("wireframe") or file.get("resources")
    if str(file.get("type", "")).startswith("_meshfile") and not special:
        content = file["data"].encode() if isinstance(file["data"], str) else bytes(file["data"].data)
        color = tuple(_color(material).tolist()) if material else None
        return _transform_drawable(
            drawables.parse_mesh(content, file["format"], color), transform_geometry_to_node
        )
    lit = material.get("type") != "MeshBasicMaterial"
    if mesh_object["type"] == "Mesh" and geometry.get("type") in _SOLIDS and not special:
        shape, transform_unit_to_geometry = _SOLIDS[geometry["type"]](geometry)
        placement = transform_geometry_to_node @ transform_unit_to_geometry
        return drawables.Solids(shape, [placement], _color(material), lit)
    if mesh_object["type"] in _BUFFERS and geometry.get("type") == "BufferGeometry" and not special:
        attributes = geometry["data"]["attributes"]
        colors = _colors(attributes, material)
        drawable = _BUFFERS[mesh_object["type"]](
            _array(attributes["position"]), colors, geometry["data"], material
        )
        return _transform_drawable(drawable, transform_geometry_to_node)
    if mesh_object["type"] != "Mesh" or not material.get("map"):
        return drawables.MeshcatObject(json, None)
    return drawables.MeshcatObject(
        json, textured_mesh(json, geometry, material, _color(material), transform_geometry_to_node)
    )


def _resolve(json: Json, field: str, library: str) -> Json:
    """Return the entry of `library` whose uuid is in the object's `field`, or {} if absent."""
    uuid = json["object"].get(field)
    return next((part for part in json.get(library, ()) if part["uuid"] == uuid), {})


def recolor(drawable: drawables.Drawable, color: Sequence[float]) -> drawables.Drawable:
    """Return the same object in a single color, RGBA in 0..1."""
    if isinstance(drawable, drawables.MeshcatObject):
        red, green, blue, alpha = (round(255 * part) for part in color)
        paint = {"color": red << 16 | green << 8 | blue, "opacity": alpha / 255, "transparent": alpha < 255}
        materials = [{**material, **paint} for material in drawable.json.get("materials", ())]
        return drawable_of({**drawable.json, "materials": materials})
    other = copy(drawable)
    setattr(other, "color" if isinstance(other, drawables.Text) else "colors", drawables.rgba(color))
    return other


def _color(material: Json) -> Float32s:
    rgb = int(material.get("color", 0xFFFFFF))
    alpha = float(material.get("opacity", 1)) if material.get("transparent") else 1.0
    parts = [(rgb >> shift & 255) / 255 for shift in (16, 8, 0)]
    return np.array([*parts, alpha], np.float32)


def _colors(attributes: Json, material: Json) -> Float32s:
    """Return the colors of the vertices if the material uses them, shape (V, 4), else its own color."""
    color = _color(material)
    if not material.get("vertexColors") or "color" not in attributes:
        return color
    rgb = _array(attributes["color"])
    return np.column_stack([rgb, np.full(len(rgb), color[3])]).astype(np.float32)


def _array(attribute: Json) -> Any:
    """Return an array of triples, shape (N, 3)."""
    return np.frombuffer(attribute["array"].data, _TYPES[attribute["array"].type]).reshape(-1, 3)


def _transform_drawable(drawable: drawables.Drawable, transform: Matrix) -> drawables.Drawable:
    """Transform a mesh, points or lines."""
    if np.array_equal(transform, np.eye(4)):
        return drawable
    other = copy(drawable)
    field = "vertices" if isinstance(drawable, drawables.Mesh) else "points"
    transformed = getattr(drawable, field) @ transform[:3, :3].T + transform[:3, 3]
    setattr(other, field, drawables.float_array(field, transformed, (None, 3)))
    if isinstance(other, drawables.Mesh):
        # Normals are invalid after a transform with scaling.
        other.normals = None
    return other


def _mesh(points: Float32s, colors: Float32s, data: Json, material: Json) -> drawables.Mesh:
    lit = material.get("type") != "MeshBasicMaterial"
    return drawables.Mesh(points, _array(data["index"]) if "index" in data else None, colors, lit=lit)


def _points(points: Float32s, colors: Float32s, _: Json, material: Json) -> drawables.Points:
    size = material.get("size", 0.001)  # [m]
    return drawables.Points(points, colors, (size, size))


_BUFFERS: dict[str, Callable[[Float32s, Float32s, Json, Json], drawables.Drawable]] = {
    "Mesh": _mesh,
    "Points": _points,
    "Line": lambda points, colors, *_: drawables.Lines(points, colors),
    "LineSegments": lambda points, colors, *_: drawables.Lines(points, colors, strip=False),
}


_SOLIDS: dict[str, Callable[[Json], tuple[drawables.Shape, Matrix]]] = {
    "BoxGeometry": lambda box: ("box", np.diag([box["width"], box["height"], box["depth"], 1])),
    "SphereGeometry": lambda ball: ("sphere", np.diag([2 * ball["radius"]] * 3 + [1])),
    "CylinderGeometry": lambda geometry: (
        "cylinder" if geometry["radiusTop"] else "cone",
        _TRANSFORM_UP_TO_Y
        @ np.diag([2 * geometry["radiusBottom"], 2 * geometry["radiusBottom"], geometry["height"], 1]),
    ),
}


# View height assumed for cameras that specify their extent in metres [px].
_HEIGHT = 400.0
# Direction of a camera whose target is its own position.
_AHEAD = np.array([0.0, 1.0, 0.0])


class MeshcatCamera:
    """The scene's camera, controlled by meshcat's commands."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        # The transform of the node /Cameras/default.
        self._transform_camera_to_scene: Matrix = np.eye(4)

    def place(self, transform_camera_to_scene: Matrix) -> None:
        """Move the camera's frame, including eye and target."""
        eye, target = self._local(self._scene.camera.eye), self._local(self._scene.camera.target)
        self._transform_camera_to_scene = transform_camera_to_scene
        self._look_at(eye, target)

    def aim(self, target: npt.ArrayLike) -> None:
        """Look at a point in the frame, shape (3,), in [m]."""
        self._look_at(self._local(self._scene.camera.eye), np.asarray(target, float))

    def set_property(self, name: str, value: Any) -> None:
        """Set the eye's position, with y up as in meshcat, or three.js's zoom, fov [deg] or near [m]."""
        camera = self._scene.camera
        if name == "position":
            x, up, minus_y = value
            self._look_at(np.array([x, -minus_y, up], float), self._local(camera.target))
        elif name == "zoom":
            self._scene.camera = replace(camera, vertical_fov=_zoom_fov(drawables.Camera.vertical_fov, value))
        elif name == "fov":
            self._scene.camera = replace(camera, vertical_fov=radians(value))
        elif name == "near":
            self._scene.camera = replace(camera, near=float(value))

    def set_object(self, json: Mapping[str, Any]) -> None:
        """Set the camera from a camera of three.js."""
        zoom = json.get("zoom", 1.0)
        if json["type"] == "OrthographicCamera":
            scale = _HEIGHT * zoom / (json["top"] - json["bottom"])
            self._scene.camera = replace(self._scene.camera, orthographic_scale=scale)
        else:
            fov = _zoom_fov(radians(json["fov"]), zoom)
            camera = replace(self._scene.camera, vertical_fov=fov, near=json["near"], orthographic_scale=None)
            self._scene.camera = camera

    def _look_at(self, eye: Floats, target: Floats) -> None:
        # Pinocchio's disableCameraControl sets both to the same point.
        if np.array_equal(eye, target):
            target = eye + _AHEAD
        rotation, origin = self._transform_camera_to_scene[:3, :3], self._transform_camera_to_scene[:3, 3]
        points = {"eye": rotation @ eye + origin, "target": rotation @ target + origin, "up": rotation[:, 2]}
        vectors: dict[str, Any] = {name: tuple(point.tolist()) for name, point in points.items()}
        self._scene.camera = replace(self._scene.camera, **vectors)

    def _local(self, point: npt.ArrayLike) -> Floats:
        rotation, origin = self._transform_camera_to_scene[:3, :3], self._transform_camera_to_scene[:3, 3]
        local: Floats = rotation.T @ (np.asarray(point) - origin)
        return local


def _zoom_fov(fov: float, zoom: float) -> float:
    return 2 * atan(tan(fov / 2) / zoom)


_CAMERA = "Cameras/default"
# Nodes of meshcat's own page, which this viewer lacks.
_FURNITURE = ("Lights", "Grid", "Axes")


class Command(Protocol):
    """A command of meshcat."""

    def lower(self) -> dict[str, Any]:
        """Return the command as plain values."""


class Window:
    """A window for meshcat.Visualizer and Pinocchio's MeshcatVisualizer that draws into a scene."""

    web_url = "(the scene of this program)"

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._camera = MeshcatCamera(scene)
        self.aim = self._camera.aim
        self._handlers: dict[str, Callable[[str, dict[str, Any]], None]] = {
            "set_object": lambda path, command: (
                self._camera.set_object(command["object"]["object"])
                if path.startswith(_CAMERA)
                else self.scene.set_object(path, drawable_of(command["object"]))
            ),
            "set_transform": lambda path, command: self.place(path, np.reshape(command["matrix"], (4, 4)).T),
            "set_property": self._set_property,
            "set_animation": lambda _, command: self.scene.set_animation(
                {name: command[name] for name in ("animations", "options")}
            ),
            "delete": lambda path, _: self.scene.delete(path),
        }

    def send(self, command: Command) -> None:
        """Execute a command.

        Raises:
            CourseError: The scene has no equivalent of the command.
        """
        lowered = command.lower()
        handler = self._handlers.get(lowered["type"])
        if handler is None:
            supported = ", ".join(self._handlers)
            raise CourseError(
                f"meshcat's command {lowered['type']!r} is not supported; supported commands: {supported}."
            )
        path = lowered["path"].strip("/")
        if not path.startswith(_FURNITURE):
            handler(path, lowered)

    def place(self, path: str, matrix: npt.ArrayLike) -> None:
        """Set a node's transform to its parent, shape (4, 4), in [m]."""
        if path == _CAMERA:
            self._camera.place(np.asarray(matrix, float))
        elif not path.startswith(_FURNITURE):
            self.scene.set_transform(path, matrix)

    def get_image(self, width: int | None = None, height: int | None = None) -> Image.Image:
        """Return an image of the scene with a size in pixels."""
        return Image.open(BytesIO(screenshot(self.scene, size=(width or 800, height or 600)).png))

    def get_scene(self) -> str:
        """Return a page that shows the scene, for meshcat's `static_html` and `render_static`."""
        return static_page(self.scene)

    def open(self) -> "Window":
        """Do nothing: the page that shows the scene is opened elsewhere."""
        return self

    def wait(self) -> str:
        """Do nothing: no page is needed."""
        return "ok"

    def close(self) -> None:
        """Do nothing: there is no server to stop."""

    def _set_property(self, path: str, command: dict[str, Any]) -> None:
        """Set a property that affects the picture; three.js's many other properties are ignored."""
        name, value = command["property"], command["value"]
        if path == "Background":
            if name == "top_color":
                self.scene.background = tuple(round(255 * part) for part in value)
        elif path.startswith(_CAMERA):
            self._camera.set_property(name, value)
        elif name == "visible":
            self.scene.set_visible(path, value)
        elif name in ("position", "quaternion", "scale"):
            # Imported here because meshcat is slow to load.
            from meshcat.transformations import quaternion_matrix

            # Replace this part of the transform, and keep the other two.
            node = self.scene.find(path)
            matrix, numbers = np.eye(4) if node is None else node.matrix.copy(), np.asarray(value, float)
            scale = np.linalg.norm(matrix[:3, :3], axis=0)
            if name == "position":
                matrix[:3, 3] = numbers
            elif name == "quaternion":
                # meshcat's order is w, x, y, z.
                matrix[:3, :3] = quaternion_matrix(np.roll(numbers, 1))[:3, :3] * scale
            else:
                matrix[:3, :3] = matrix[:3, :3] / np.where(scale, scale, 1) * numbers
            self.scene.set_transform(path, matrix)
        elif name == "color":
            for node in self.scene.node(path).subtree():
                if node.object is not None:
                    self.scene.set_object(node.path, recolor(node.object, value))


_CAMERA_OBJECT = "/Cameras/default/rotated/<object>"
_IDENTITY = np.eye(4)


class Visualizer(meshcat.Visualizer):  # type: ignore[misc]  # meshcat has no types
    """A meshcat.Visualizer that draws into a scene: ``MeshcatVisualizer.initViewer(viewer=...)``."""

    # The path as a string, as the scene uses it.
    __slots__ = ("scene_path",)

    def __init__(self, scene: Scene) -> None:
        super().__init__(window=Window(scene))
        self.scene_path = "/".join(self.path.entries)

    def __getitem__(self, path: str) -> "Visualizer":
        # The part has the same window, so `__init__` must not create another one.
        part = Visualizer.__new__(Visualizer)
        part.window, part.path = self.window, self.path.append(path)
        part.scene_path = "/".join(part.path.entries)
        return part

    def set_transform(self, matrix: npt.ArrayLike = _IDENTITY) -> None:
        """Set the transform from this part to its parent, shape (4, 4), in [m]."""
        self.window.place(self.scene_path, matrix)

    def set_cam_pos(self, value: npt.ArrayLike) -> None:
        """Move the camera's eye to a point (x, y, z) in [m], like meshcat 0.3.3."""
        x, y, z = np.asarray(value, float)
        self[_CAMERA_OBJECT].set_property("position", [x, z, -y])

    def set_cam_target(self, value: npt.ArrayLike) -> None:
        """Point the camera at (x, y, z), [m], like meshcat 0.3.3."""
        self.window.aim(value)

    def get_image(self, w: int | None = None, h: int | None = None) -> Image.Image:
        """Return a picture of the scene with a size in pixels."""
        image: Image.Image = self.window.get_image(w, h)
        return image

    def jupyter_cell(self, height: int = 400) -> Any:
        """Return a view with a height [px], for the last line of a cell."""
        # Imported here because it is slow to load.
        from course_lib.viewer.widget import SceneWidget

        return SceneWidget(self.window.scene, height, words=describe_scene(self.window.scene, "3D view"))
