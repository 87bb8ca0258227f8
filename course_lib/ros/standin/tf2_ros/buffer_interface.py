"""The types that buffers can transform; `import tf2_geometry_msgs` registers them."""

from collections.abc import Callable
from typing import Any, ClassVar, TypeVar

from geometry_msgs.msg import TransformStamped

Obj = TypeVar("Obj")


class TypeException(Exception):  # noqa: N818  # ROS's name
    """Nobody has said how a type is transformed."""


class TransformRegistration:
    """The functions that transform types; all buffers share them."""

    _transforms: ClassVar[dict[type[Any], Callable[[Any, TransformStamped], Any]]] = {}

    def add(self, key: type[Obj], callback: Callable[[Obj, TransformStamped], Obj]) -> None:
        """Register the function that transforms a type."""
        self._transforms[key] = callback

    def get(self, key: type[Any]) -> Callable[[Any, TransformStamped], Any]:
        """Return the function that transforms a type; raises TypeException if there is none."""
        if key not in self._transforms:
            raise TypeException(f"Type {key} is not loaded or supported")
        return self._transforms[key]
