"""The scene: a tree of named nodes that keeps the last value of everything set on it."""

import threading
from collections.abc import Callable, Iterator, Mapping
from difflib import get_close_matches
from typing import Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from course_lib.arrays import Matrix
from course_lib.errors import CourseError
from course_lib.viewer.arrays import checked
from course_lib.viewer.camera import Camera
from course_lib.viewer.drawables import Drawable

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
    """What is to be seen, whether or not anybody looks.

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
        """Remove a node with all below it; a node that is not there is no error, "" empties the scene."""
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
        """Where the scene is seen from, until somebody turns a view by hand."""
        return self._camera

    @camera.setter
    def camera(self, camera: Camera) -> None:
        with self.lock:
            self._camera = camera
            self._tell("camera", "")

    def remember_camera(self, camera: Camera) -> None:
        """Have pages that come later look from where a view was turned to; others stay as they are."""
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
        """Say whether a node and all above it are shown."""
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
        """Have a function called at every change, with what changed and the path; returns "stop"."""
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
