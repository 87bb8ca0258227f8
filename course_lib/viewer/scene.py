"""The scene: a tree of named nodes that keeps the last value of everything set on it."""

import threading
from collections.abc import Callable, Iterator, Mapping
from difflib import get_close_matches
from typing import Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from course_lib.arrays import Matrix, Reals
from course_lib.errors import CourseError
from course_lib.viewer.camera import Camera
from course_lib.viewer.drawables import Drawable, Lines, Mesh, Points, Sheet, Solids, Text, checked

What: TypeAlias = Literal["object", "transform", "visible", "delete", "background", "camera", "animation"]
Listener: TypeAlias = Callable[[What, str], None]

_IDENTITY = np.eye(4)
_IDENTITY.setflags(write=False)


class Node:
    """One place in the tree; it moves and hides whatever is below it."""

    __slots__ = ("children", "matrix", "object", "parent", "path", "visible")

    def __init__(self, path: str, parent: "Node | None") -> None:
        self.path = path
        self.parent = parent
        self.children: dict[str, Node] = {}
        self.object: Drawable | None = None
        self.matrix: Matrix = _IDENTITY
        self.visible = True

    def subtree(self) -> Iterator["Node"]:
        """Iterate over this node and all below it, parents first."""
        yield self
        for child in list(self.children.values()):
            yield from child.subtree()

    def upwards(self) -> Iterator["Node"]:
        """Iterate over this node and all above it."""
        yield self
        if self.parent is not None:
            yield from self.parent.upwards()


class Scene:
    """A tree of drawables, shown or not.

    Paths name nodes from the root, like ``displays/Marker/basic_shapes/0``; what is set on a node that is
    not there makes it. Setters may be called from any thread. Listeners are told what changed, and where.
    """

    def __init__(self) -> None:
        self.lock = threading.RLock()
        self._root = Node("", None)
        self._nodes = {"": self._root}
        self._listeners: tuple[Listener, ...] = ()
        self._background = (48, 48, 48)
        self._camera = Camera()
        self.animation: Mapping[str, Any] | None = None

    def set_object(self, path: str, drawable: Drawable) -> None:
        """Put an object at a node, in place of the one that is there."""
        with self.lock:
            node = self._made(path)
            node.object = drawable
            self._tell("object", node.path)

    def set_transform(self, path: str, matrix: npt.ArrayLike) -> None:
        """Place a node in its parent, by the transform from the one to the other, shape (4, 4), in [m]."""
        transform_node_to_parent = np.array(matrix, np.float64)
        if transform_node_to_parent.shape != (4, 4):  # naming it at each call costs as much as the rest
            checked(f"The transform of {path!r}", matrix, np.float64, (4, 4))
        transform_node_to_parent.setflags(write=False)
        with self.lock:
            node = self._nodes.get(path) or self._made(path)
            node.matrix = transform_node_to_parent
            for listener in self._listeners:
                listener("transform", node.path)

    def set_visible(self, path: str, visible: bool) -> None:
        """Show or hide a node with all below it."""
        with self.lock:
            node = self._made(path)
            node.visible = bool(visible)
            self._tell("visible", node.path)

    def set_animation(self, animation: Mapping[str, Any] | None) -> None:
        """Play one of meshcat's animations, in its own JSON."""
        with self.lock:
            self.animation = animation
            self._tell("animation", "")

    def delete(self, path: str) -> None:
        """Remove a node with all below it; a missing node is not an error, "" empties the scene."""
        with self.lock:
            node = self.find(path)
            if node is None:
                return
            for gone in list(node.subtree()):
                del self._nodes[gone.path]
            if node.parent is None:
                self._root = self._nodes[""] = Node("", None)
            else:
                del node.parent.children[node.path]
            self._tell("delete", node.path)

    @property
    def background(self) -> tuple[int, int, int]:
        """Colour behind everything, RGB in 0..255."""
        return self._background

    @background.setter
    def background(self, rgb: tuple[int, int, int]) -> None:
        red, green, blue = (min(max(int(value), 0), 255) for value in rgb)
        with self.lock:
            self._background = (red, green, blue)
            self._tell("background", "")

    @property
    def camera(self) -> Camera:
        """The camera of views that were not turned by hand."""
        return self._camera

    @camera.setter
    def camera(self, camera: Camera) -> None:
        with self.lock:
            self._camera = camera
            self._tell("camera", "")

    def remember_camera(self, camera: Camera) -> None:
        """Set the camera for pages that come later; open ones stay as they are."""
        with self.lock:
            self._camera = camera

    def objects(self) -> dict[str, Drawable]:
        """Return what is at which path, in the order of the tree."""
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

    def visible(self, path: str) -> bool:
        """Return whether a node and all above it are shown."""
        return all(node.visible for node in self.node(path).upwards())

    def node(self, path: str) -> Node:
        """Return the node at a path.

        Raises:
            CourseError: If there is none; the message names similar ones.
        """
        node = self.find(path)
        if node is None:
            near = get_close_matches(path, self._nodes, 3) or [name for name in self._nodes if name][:5]
            raise CourseError(
                f"Nothing is at {path!r} in the scene; there is {', '.join(near) or 'nothing yet'}."
            )
        return node

    def find(self, path: str) -> Node | None:
        """Return the node at a path, or None."""
        return self._nodes.get(path) or self._nodes.get(_normal(path))

    def listen(self, listener: Listener) -> Callable[[], None]:
        """Register a callback for every change, called with its kind and the path; returns "stop"."""
        self._listeners += (listener,)

        def stop() -> None:
            self._listeners = tuple(other for other in self._listeners if other is not listener)

        return stop

    def _tell(self, what: What, path: str) -> None:
        for listener in self._listeners:
            listener(what, path)

    def _made(self, path: str) -> Node:
        node = self.find(path)
        if node is None:
            path = _normal(path)
            parent = self._made(path.rpartition("/")[0])
            node = self._nodes[path] = parent.children[path] = Node(path, parent)
        return node


def _normal(path: str) -> str:
    """Drop the slashes that name nothing: ``/meshcat//box/`` is ``meshcat/box``."""
    return "/".join(name for name in path.split("/") if name)


LIMIT = 20  # objects that are listed one by one


def summary(scene: Scene) -> list[str]:
    """Return a line for each object that is shown: its path, what it is, and where its middle is in [m]."""
    shown = [(path, thing) for path, thing in scene.objects().items() if scene.visible(path)]
    lines = [f"{path}: {_what(thing)} at {_middle(scene, path, thing)}" for path, thing in shown[:LIMIT]]
    return lines + ([f"and {len(shown) - LIMIT} more"] if len(shown) > LIMIT else [])


def described(scene: Scene, label: str) -> str:
    """Return in one line what a view is and what it shows, for those who cannot see it."""
    lines = summary(scene)
    return f"{label.rstrip('.')}. {'; '.join(lines)}" if lines else label


def _what(thing: Drawable) -> str:
    if isinstance(thing, Solids):
        name = {"sphere": "ellipsoid"}.get(thing.shape, thing.shape)
        return _counted(len(thing.placements), name)
    if isinstance(thing, Mesh):
        return _counted(len(thing.faces), "triangle")
    if isinstance(thing, Points):
        return _counted(len(thing.points), "point")
    if isinstance(thing, Lines):
        return _counted(len(thing.points) - 1 if thing.strip else len(thing.points) // 2, "line")
    if isinstance(thing, Sheet):
        return f"{thing.cells.shape[1]} x {thing.cells.shape[0]} cells"
    return f"the words {thing.text!r}" if isinstance(thing, Text) else "an object of meshcat"


def _counted(count: int, name: str) -> str:
    return f"{count} {name}{'es' if name == 'box' else 's'}" if count != 1 else f"1 {name}"


def _middle(scene: Scene, path: str, thing: Drawable) -> str:
    """Return the middle of what an object's points span, in the scene's frame."""
    points: Reals
    if isinstance(thing, Solids):
        points = thing.placements[:, :3, 3]
    elif isinstance(thing, Mesh):
        points = thing.vertices
    elif isinstance(thing, Sheet):
        rows, columns = thing.cells.shape
        points = np.array([(0, 0, 0), (columns * thing.width, rows * thing.width, 0)])
    else:
        points = thing.points if isinstance(thing, Lines | Points) else np.zeros((1, 3))
    transform = scene.world_transform(path)
    if not len(points):
        return "nowhere"
    placed = points @ transform[:3, :3].T + transform[:3, 3]
    x, y, z = np.round((placed.min(axis=0) + placed.max(axis=0)) / 2, 2) + 0.0  # no minus zero
    return f"({x:g}, {y:g}, {z:g})"
