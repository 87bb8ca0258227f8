"""The scene: a tree of named nodes that stores the last values, and bounding boxes."""

import threading
from collections.abc import Callable, Iterable, Iterator, Mapping
from difflib import get_close_matches
from typing import Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from course_lib.arrays import Floats, Matrix, Reals
from course_lib.errors import CourseError
from course_lib.viewer import drawables

ChangeKind: TypeAlias = Literal[
    "object", "transform", "visible", "delete", "background", "look", "camera", "animation"
]
Look: TypeAlias = Literal["RViz", "Studio"]
Listener: TypeAlias = Callable[[ChangeKind, str], None]

_IDENTITY = np.eye(4)
_IDENTITY.setflags(write=False)


class Node:
    """A node of the tree; its transform and visibility apply to all nodes below it."""

    __slots__ = ("children", "is_visible", "matrix", "object", "parent", "path")

    def __init__(self, path: str, parent: "Node | None") -> None:
        self.path = path
        self.parent = parent
        self.children: dict[str, Node] = {}
        self.object: drawables.Drawable | None = None
        self.matrix: Matrix = _IDENTITY
        self.is_visible = True

    def subtree(self) -> Iterator["Node"]:
        """Iterate over this node and all nodes below it, parents first."""
        yield self
        for child in list(self.children.values()):
            yield from child.subtree()

    def upwards(self) -> Iterator["Node"]:
        """Iterate over this node and all nodes above it."""
        yield self
        if self.parent is not None:
            yield from self.parent.upwards()


class Scene:
    """A tree of drawables.

    Paths identify nodes from the root, like ``displays/Marker/basic_shapes/0``; setting a value on
    a missing node creates it. Setters may be called from any thread. Listeners are called with the
    kind and the path of each change.
    """

    def __init__(self) -> None:
        self.lock = threading.RLock()
        self._root = Node("", None)
        self._nodes = {"": self._root}
        self._listeners: tuple[Listener, ...] = ()
        self._background = (48, 48, 48)
        self._look: Look = "RViz"
        self._camera = drawables.Camera()
        self.animation: Mapping[str, Any] | None = None

    def set_object(self, path: str, drawable: drawables.Drawable) -> None:
        """Set the object of a node, replacing the current one.

        An equal object is not a change: nodes often publish the same lines or points repeatedly.
        """
        with self.lock:
            node = self._ensure_node(path)
            if node.object is not None and drawables.are_equal(node.object, drawable):
                return
            node.object = drawable
            self._notify("object", node.path)

    def set_transform(self, path: str, matrix: npt.ArrayLike) -> None:
        """Set the transform from a node to its parent, shape (4, 4), in [m].

        An equal transform is not a change, because pages draw a moving scene with a lower quality.
        """
        transform_node_to_parent = np.array(matrix, np.float64)
        # `checked` would double the time of this call.
        if transform_node_to_parent.shape != (4, 4):
            drawables.checked_array(f"The transform of {path!r}", matrix, np.float64, (4, 4))
        transform_node_to_parent.setflags(write=False)
        with self.lock:
            node = self._nodes.get(path) or self._ensure_node(path)
            # An animation moves nodes in the pages only. The bytes are compared, because
            # np.array_equal is slower.
            if self.animation is None and transform_node_to_parent.tobytes() == node.matrix.tobytes():
                return
            node.matrix = transform_node_to_parent
            for listener in self._listeners:
                listener("transform", node.path)

    def set_visible(self, path: str, visible: bool) -> None:
        """Show or hide a node and all nodes below it."""
        with self.lock:
            node = self._ensure_node(path)
            if node.is_visible is not bool(visible):
                node.is_visible = bool(visible)
                self._notify("visible", node.path)

    def set_animation(self, animation: Mapping[str, Any] | None) -> None:
        """Play an animation in meshcat's JSON."""
        with self.lock:
            self.animation = animation
            self._notify("animation", "")

    def delete(self, path: str) -> None:
        """Remove a node and all nodes below it, if it exists; "" empties the scene."""
        with self.lock:
            node = self.find(path)
            if node is None:
                return
            for inner in list(node.subtree()):
                del self._nodes[inner.path]
            if node.parent is None:
                self._root = self._nodes[""] = Node("", None)
            else:
                del node.parent.children[node.path]
            self._notify("delete", node.path)

    @property
    def background(self) -> tuple[int, int, int]:
        """Background color, RGB in 0..255."""
        return self._background

    @background.setter
    def background(self, rgb: tuple[int, int, int]) -> None:
        red, green, blue = (min(max(int(value), 0), 255) for value in rgb)
        with self.lock:
            self._background = (red, green, blue)
            self._notify("background", "")

    @property
    def look(self) -> Look:
        """The look of the scene in pages.

        As in RViz, or as in a studio, with a light background and shadows.
        """
        return self._look

    @look.setter
    def look(self, look: Look) -> None:
        with self.lock:
            self._look = look
            self._notify("look", "")

    @property
    def camera(self) -> drawables.Camera:
        """The camera of views that the user has not moved."""
        return self._camera

    @camera.setter
    def camera(self, camera: drawables.Camera) -> None:
        with self.lock:
            self._camera = camera
            self._notify("camera", "")

    def remember_camera(self, camera: drawables.Camera) -> None:
        """Set the camera for pages that load later; open pages keep theirs."""
        with self.lock:
            self._camera = camera

    def objects(self) -> dict[str, drawables.Drawable]:
        """Return all objects by path, in the order of the tree."""
        with self.lock:
            return {node.path: node.object for node in self.nodes() if node.object is not None}

    def nodes(self) -> list[Node]:
        """Return all nodes, parents first."""
        with self.lock:
            return list(self._root.subtree())

    def transform(self, path: str) -> Matrix:
        """Return the transform from a node to its parent, shape (4, 4)."""
        return self.node(path).matrix

    def world_transform(self, path: str) -> Matrix:
        """Return the transform from a node to the scene, shape (4, 4)."""
        transform = _IDENTITY
        for node in self.node(path).upwards():
            transform = node.matrix @ transform
        return transform

    def is_visible(self, path: str) -> bool:
        """Return whether a node and all nodes above it are visible."""
        return all(node.is_visible for node in self.node(path).upwards())

    def node(self, path: str) -> Node:
        """Return the node at a path.

        Raises:
            CourseError: It does not exist; the message has similar paths.
        """
        node = self.find(path)
        if node is None:
            similar = get_close_matches(path, self._nodes, 3) or [name for name in self._nodes if name][:5]
            raise CourseError(
                f"There is no node {path!r} in the scene; similar nodes: {', '.join(similar) or 'none'}."
            )
        return node

    def find(self, path: str) -> Node | None:
        """Return the node at a path, or None."""
        return self._nodes.get(path) or self._nodes.get(_normal(path))

    def listen(self, listener: Listener) -> Callable[[], None]:
        """Call a function with kind and path of every change; return a function that removes it."""
        self._listeners += (listener,)

        def stop() -> None:
            self._listeners = tuple(other for other in self._listeners if other is not listener)

        return stop

    def _notify(self, kind: ChangeKind, path: str) -> None:
        for listener in self._listeners:
            listener(kind, path)

    def _ensure_node(self, path: str) -> Node:
        node = self.find(path)
        if node is None:
            path = _normal(path)
            parent = self._ensure_node(path.rpartition("/")[0])
            node = self._nodes[path] = parent.children[path] = Node(path, parent)
        return node


def _normal(path: str) -> str:
    """Remove redundant slashes: ``/meshcat//box/`` is ``meshcat/box``."""
    return "/".join(name for name in path.split("/") if name)


# Objects that are listed individually.
LIMIT = 20


def summary(scene: Scene) -> list[str]:
    """Return a line for each visible object: its path, a description, and its center in [m]."""
    visible = [(path, drawable) for path, drawable in scene.objects().items() if scene.is_visible(path)]
    # Overflowing numbers appear as inf in the text.
    with np.errstate(all="ignore"):
        lines = [
            f"{path}: {_description(drawable)} at {_middle(scene, path, drawable)}"
            for path, drawable in visible[:LIMIT]
        ]
    return lines + ([f"and {len(visible) - LIMIT} more"] if len(visible) > LIMIT else [])


def describe_scene(scene: Scene, label: str) -> str:
    """Describe a view and its contents on a single line, for screen readers."""
    lines = summary(scene)
    return f"{label.rstrip('.')}. {'; '.join(lines)}" if lines else label


def _description(drawable: drawables.Drawable) -> str:
    if isinstance(drawable, drawables.Solids):
        name = {"sphere": "ellipsoid"}.get(drawable.shape, drawable.shape)
        return _plural(len(drawable.placements), name)
    if isinstance(drawable, drawables.Mesh):
        return _plural(len(drawable.faces), "triangle")
    if isinstance(drawable, drawables.Points):
        return _plural(len(drawable.points), "point")
    if isinstance(drawable, drawables.Lines):
        return _plural(len(drawable.points) - 1 if drawable.strip else len(drawable.points) // 2, "line")
    if isinstance(drawable, drawables.Sheet):
        return f"{drawable.cells.shape[1]} x {drawable.cells.shape[0]} cells"
    return f"the text {drawable.text!r}" if isinstance(drawable, drawables.Text) else "an object of meshcat"


def _plural(count: int, name: str) -> str:
    return f"{count} {name}{'es' if name == 'box' else 's'}" if count != 1 else f"1 {name}"


def _middle(scene: Scene, path: str, drawable: drawables.Drawable) -> str:
    """Return the center of an object's bounding box, in the scene's frame."""
    points: Reals
    if isinstance(drawable, drawables.Solids):
        points = drawable.placements[:, :3, 3]
    elif isinstance(drawable, drawables.Mesh):
        # Robots have 100,000 vertices, and panels are updated while they move.
        points = drawable.corners
    elif isinstance(drawable, drawables.Sheet):
        rows, columns = drawable.cells.shape
        points = np.array([(0, 0, 0), (columns * drawable.width, rows * drawable.width, 0)])
    else:
        points = (
            drawable.points if isinstance(drawable, drawables.Lines | drawables.Points) else np.zeros((1, 3))
        )
    transform = scene.world_transform(path)
    if not len(points):
        return "nowhere"
    transformed = points @ transform[:3, :3].T + transform[:3, 3]
    # Adding 0 turns minus zero into zero.
    x, y, z = np.round((transformed.min(axis=0) + transformed.max(axis=0)) / 2, 2) + 0.0
    return f"({x:g}, {y:g}, {z:g})"


# Clouds with more points than this may have a few far outliers, as of a laser scanner, which are
# ignored.
_MANY = 50
# Percentiles of each coordinate that bound many points.
_MOST = (2.0, 98.0)
# In larger clouds, percentiles are computed from every n-th point.
_SAMPLED = 20_000


def bounds_of(scene: Scene, paths: Iterable[str]) -> Floats | None:
    """Return the lowest and highest corner of objects, in the scene's frame, shape (2, 3).

    Of many points, the farthest 2 % on each side are ignored.

    Returns:
        None if no object has a position: there is none, all are pictures in a corner, or no number
        is finite.
    """
    boxes: list[Floats] = []
    for path in paths:
        if (drawable := scene.node(path).object) is None:
            continue
        points, reach = _points_and_extent(drawable)
        transform = scene.world_transform(path)
        # Distant points may overflow; such boxes are left out.
        with np.errstate(all="ignore"):
            transformed = points @ transform[:3, :3].T + transform[:3, 3]
            half = reach @ np.abs(transform[:3, :3]).T
            is_finite = np.isfinite(transformed).all(axis=1)
            if not is_finite.any():
                continue
            low, high = (transformed - half)[is_finite], (transformed + half)[is_finite]
            if len(low) >= _MANY and isinstance(drawable, drawables.Points):
                corners = [np.percentile(low, _MOST[0], axis=0), np.percentile(high, _MOST[1], axis=0)]
            else:
                corners = [low.min(axis=0), high.max(axis=0)]
        if np.isfinite(corners).all():
            boxes.append(np.stack(corners))
    if not boxes:
        return None
    lows, highs = np.stack(boxes, axis=1)
    bounds: Floats = np.stack([lows.min(axis=0), highs.max(axis=0)])
    return bounds


def _points_and_extent(drawable: drawables.Drawable) -> tuple[Reals, Reals]:
    """Return an object's points, shape (N, 3), and its extent beyond them, shape (N or 1, 3)."""
    nothing = np.zeros((1, 3))
    if isinstance(drawable, drawables.Solids):
        return drawable.placements[:, :3, 3], np.abs(drawable.placements[:, :3, :3]).sum(axis=2) / 2
    if isinstance(drawable, drawables.Mesh):
        return drawable.vertices, nothing
    if isinstance(drawable, drawables.Points):
        return drawable.points[:: len(drawable.points) // _SAMPLED + 1], nothing
    if isinstance(drawable, drawables.Lines):
        return drawable.points, nothing
    if isinstance(drawable, drawables.Sheet):
        rows, columns = drawable.cells.shape
        return np.array([(0, 0, 0), (columns * drawable.width, rows * drawable.width, 0)]), nothing
    if isinstance(drawable, drawables.MeshcatObject):
        return (np.empty((0, 3)) if drawable.stand_in is None else drawable.stand_in.vertices), nothing
    return (np.empty((0, 3)) if isinstance(drawable, drawables.Inset) else nothing), nothing
