"""What buffers know of carrying stamped things from frame to frame; `import tf2_geometry_msgs` teaches it."""

from collections.abc import Callable
from typing import Any, ClassVar, TypeVar

from geometry_msgs.msg import TransformStamped

Obj = TypeVar("Obj")


class TypeException(Exception):  # noqa: N818  # ROS's name
    """Nobody has said how a type is transformed."""


class TransformRegistration:
    """How types are transformed; all buffers share it."""

    _transforms: ClassVar[dict[type[Any], Callable[[Any, TransformStamped], Any]]] = {}

    def add(self, key: type[Obj], callback: Callable[[Obj, TransformStamped], Obj]) -> None:
        """Say how a type is transformed."""
        self._transforms[key] = callback

    def get(self, key: type[Any]) -> Callable[[Any, TransformStamped], Any]:
        """Give what transforms a type; raises TypeException if nobody has said how."""
        if key not in self._transforms:
            raise TypeException(f"Type {key} is not loaded or supported")
        return self._transforms[key]
