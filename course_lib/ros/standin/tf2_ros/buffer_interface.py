"""What buffers have in common: they carry stamped things from frame to frame."""

from collections.abc import Callable
from typing import Any, ClassVar, TypeVar

import builtin_interfaces.msg
from geometry_msgs.msg import TransformStamped
from rclpy.duration import Duration
from std_msgs.msg import Header
from tf2_py import AnyTime

Obj = TypeVar("Obj")
NO_WAIT = Duration()


class TypeException(Exception):  # noqa: N818  # ROS's name
    """Nobody has said how a type is transformed or converted."""

    def __init__(self, errstr: str) -> None:
        super().__init__(errstr)
        self.errstr = errstr


class NotImplementedException(Exception):  # noqa: N818  # ROS's name
    """A buffer of one's own lacks its lookups."""

    def __init__(self) -> None:
        self.errstr = "CanTransform or LookupTransform not implemented"
        super().__init__(self.errstr)


class BufferInterface:
    """The base of buffers; a subclass knows how frames lie."""

    def __init__(self) -> None:
        self.registration = TransformRegistration()

    def transform(self, object_stamped: Obj, target_frame: str, timeout: Duration = NO_WAIT) -> Obj:
        """Carry something with a header into another frame, at the time of its stamp.

        Args:
            object_stamped: What is carried; `import tf2_geometry_msgs` teaches the types of geometry_msgs.
            target_frame: Frame to express it in.
            timeout: How long to wait for the transform.

        Raises:
            TypeException: The type is not known.
            TransformException: The transform is not known.
        """
        do_transform = self.registration.get(type(object_stamped))
        header: Header = getattr(object_stamped, "header")  # noqa: B009  # Obj is any type with a header
        found = self.lookup_transform(target_frame, header.frame_id, header.stamp, timeout)
        result: Obj = do_transform(object_stamped, found)
        return result

    def transform_full(
        self,
        object_stamped: Obj,
        target_frame: str,
        target_time: AnyTime,
        fixed_frame: str,
        timeout: Duration = NO_WAIT,
    ) -> Obj:
        """Carry something with a header into another frame at another time, by way of a frame at rest."""
        do_transform = self.registration.get(type(object_stamped))
        header: Header = getattr(object_stamped, "header")  # noqa: B009  # as above
        found = self.lookup_transform_full(
            target_frame, target_time, header.frame_id, header.stamp, fixed_frame, timeout
        )
        result: Obj = do_transform(object_stamped, found)
        return result

    def lookup_transform(
        self, target_frame: str, source_frame: str, time: AnyTime, timeout: Duration = NO_WAIT
    ) -> TransformStamped:
        """Return the transform from the source frame to the target frame; for subclasses to say."""
        raise NotImplementedException

    def lookup_transform_full(
        self,
        target_frame: str,
        target_time: AnyTime,
        source_frame: str,
        source_time: AnyTime,
        fixed_frame: str,
        timeout: Duration = NO_WAIT,
    ) -> TransformStamped:
        """Return the transform between two frames at two times; for subclasses to say."""
        raise NotImplementedException


def Stamped(obj: Obj, stamp: builtin_interfaces.msg.Time, frame_id: str) -> Obj:  # noqa: N802  # ROS's name
    """Give something a header."""
    setattr(obj, "header", Header(frame_id=frame_id, stamp=stamp))  # noqa: B010  # Obj is any type
    return obj


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
