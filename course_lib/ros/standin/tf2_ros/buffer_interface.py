"""The base of buffers, and the types that they can transform; `import tf2_geometry_msgs` registers them."""

from collections.abc import Callable
from typing import Any, ClassVar, TypeAlias, TypeVar

import builtin_interfaces.msg
from geometry_msgs.msg import TransformStamped
from rclpy.duration import Duration
from rclpy.time import Time
from std_msgs.msg import Header

AnyTime: TypeAlias = Time | builtin_interfaces.msg.Time  # of any kind of clock: tf2 does not look
Obj = TypeVar("Obj")
NO_WAIT = Duration()


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


class NotImplementedException(Exception):  # noqa: N818  # ROS's name
    """A buffer of the program's own does not say how it finds transforms."""

    def __init__(self) -> None:
        super().__init__("CanTransform or LookupTransform not implemented")


class BufferInterface:
    """The base of all buffers: one that finds transforms can transform messages."""

    def lookup_transform(
        self, target_frame: str, source_frame: str, time: AnyTime, timeout: Duration = NO_WAIT
    ) -> TransformStamped:
        """Return the transform from the source frame to the target frame; for buffers to define."""
        raise NotImplementedException

    def can_transform(
        self, target_frame: str, source_frame: str, time: AnyTime, timeout: Duration = NO_WAIT
    ) -> Any:
        """Return whether a lookup would succeed; for buffers to define."""
        raise NotImplementedException

    def transform(self, object_stamped: Obj, target_frame: str, timeout: Duration = NO_WAIT) -> Obj:
        """Transform a message with a header into another frame, at the time of its stamp.

        Raises a TypeException for an unknown type; `import tf2_geometry_msgs` registers its types.
        """
        do_transform = TransformRegistration().get(type(object_stamped))
        header: Header = getattr(object_stamped, "header")  # noqa: B009  # Obj is any type with a header
        found = self.lookup_transform(target_frame, header.frame_id, header.stamp, timeout)
        carried: Obj = do_transform(object_stamped, found)
        return carried
