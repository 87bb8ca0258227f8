"""The base class of buffers, and the types that they can transform."""

from collections.abc import Callable
from copy import deepcopy
from typing import Any, ClassVar, TypeAlias, TypeVar

import builtin_interfaces.msg
from geometry_msgs.msg import TransformStamped
from rclpy.duration import Duration
from rclpy.time import Time
from std_msgs.msg import Header

# A time of any clock type, because tf2 ignores the type.
AnyTime: TypeAlias = Time | builtin_interfaces.msg.Time
Obj = TypeVar("Obj")
Function = TypeVar("Function", bound=Callable[..., Any])
NO_WAIT = Duration()


def Stamped(obj: Any, stamp: builtin_interfaces.msg.Time, frame_id: str) -> Any:  # noqa: N802  # ROS's name
    """Give an object a header with a stamp and a frame, and return the object."""
    obj.header = Header(frame_id=frame_id, stamp=stamp)
    return obj


class TypeException(Exception):  # noqa: N818  # ROS's name
    """No function is registered for transforming or converting a type."""


class TransformRegistration:
    """The functions that transform types, shared by all buffers."""

    _transforms: ClassVar[dict[type[Any], Callable[[Any, TransformStamped], Any]]] = {}

    def add(self, key: type[Obj], callback: Callable[[Obj, TransformStamped], Obj]) -> None:
        """Register the function that transforms a type."""
        self._transforms[key] = callback

    def get(self, key: type[Any]) -> Callable[[Any, TransformStamped], Any]:
        """Return the function that transforms a type. Raise TypeException if there is none."""
        return _find_function(self._transforms, key)


class ConvertRegistration:
    """The functions that convert types to and from messages, shared by all buffers."""

    _to_msg: ClassVar[dict[type[Any], Callable[[Any], Any]]] = {}
    _from_msg: ClassVar[dict[type[Any], Callable[[Any], Any]]] = {}
    _convert: ClassVar[dict[tuple[type[Any], type[Any]], Callable[[Any], Any]]] = {}

    def add_to_msg(self, key: type[Any], callback: Callable[[Any], Any]) -> None:
        """Register the function that converts a type to a message."""
        self._to_msg[key] = callback

    def add_from_msg(self, key: type[Any], callback: Callable[[Any], Any]) -> None:
        """Register the function that converts a message to a type."""
        self._from_msg[key] = callback

    def add_convert(self, key: tuple[type[Any], type[Any]], callback: Callable[[Any], Any]) -> None:
        """Register the function that converts one type to another."""
        self._convert[key] = callback

    def get_to_msg(self, key: type[Any]) -> Callable[[Any], Any]:
        """Return the function that converts a type to a message.

        Raise TypeException if there is none.
        """
        return _find_function(self._to_msg, key)

    def get_from_msg(self, key: type[Any]) -> Callable[[Any], Any]:
        """Return the function that converts a message to a type.

        Raise TypeException if there is none.
        """
        return _find_function(self._from_msg, key)

    def get_convert(self, key: tuple[type[Any], type[Any]]) -> Callable[[Any], Any]:
        """Return the function that converts one type to another.

        Raise TypeException if there is none.
        """
        return _find_function(self._convert, key)


def _find_function(functions: dict[Any, Function], key: Any) -> Function:
    if key not in functions:
        raise TypeException(f"Type {key} is not loaded or supported")
    return functions[key]


def convert(a: Any, b_type: type[Obj]) -> Obj:
    """Convert an object to another type, directly or through a message; copy one of that type."""
    registry = ConvertRegistration()
    if (type(a), b_type) in registry._convert:
        converted: Obj = registry.get_convert((type(a), b_type))(a)
    elif type(a) is b_type:
        converted = deepcopy(a)
    else:
        converted = registry.get_from_msg(b_type)(registry.get_to_msg(type(a))(a))
    return converted


class NotImplementedException(Exception):  # noqa: N818  # ROS's name
    """A subclass of BufferInterface does not implement the lookup of transforms."""

    def __init__(self) -> None:
        super().__init__("CanTransform or LookupTransform not implemented")


class BufferInterface:
    """Base class of buffers, which transforms messages.

    Subclasses implement the lookup of transforms.
    """

    def lookup_transform(
        self, target_frame: str, source_frame: str, time: AnyTime, timeout: Duration = NO_WAIT
    ) -> TransformStamped:
        """Return the transform from the source frame to the target frame.

        Subclasses must override it.
        """
        raise NotImplementedException

    def can_transform(
        self, target_frame: str, source_frame: str, time: AnyTime, timeout: Duration = NO_WAIT
    ) -> Any:
        """Return whether a lookup would succeed. Subclasses must override it."""
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
        """Return the transform between two frames at two times. Subclasses must override it."""
        raise NotImplementedException

    def can_transform_full(
        self,
        target_frame: str,
        target_time: AnyTime,
        source_frame: str,
        source_time: AnyTime,
        fixed_frame: str,
        timeout: Duration = NO_WAIT,
    ) -> Any:
        """Return whether a full lookup would succeed. Subclasses must override it."""
        raise NotImplementedException

    def transform(
        self,
        object_stamped: Obj,
        target_frame: str,
        timeout: Duration = NO_WAIT,
        new_type: type[Any] | None = None,
    ) -> Any:
        """Transform a message with a header into another frame, at the time of its stamp.

        The result is converted to `new_type`, if one is passed.

        Raises:
            TypeException: The type is not registered; `import tf2_geometry_msgs` registers its
                types.
        """
        do_transform = TransformRegistration().get(type(object_stamped))
        header: Header = getattr(object_stamped, "header")  # noqa: B009  # Obj is any type with a header
        transform = self.lookup_transform(target_frame, header.frame_id, header.stamp, timeout)
        transformed = do_transform(object_stamped, transform)
        return transformed if new_type is None else convert(transformed, new_type)

    def transform_full(
        self,
        object_stamped: Obj,
        target_frame: str,
        target_time: AnyTime,
        fixed_frame: str,
        timeout: Duration = NO_WAIT,
        new_type: type[Any] | None = None,
    ) -> Any:
        """Transform a message into another frame at another time, via a fixed frame."""
        do_transform = TransformRegistration().get(type(object_stamped))
        header: Header = getattr(object_stamped, "header")  # noqa: B009  # as above
        transform = self.lookup_transform_full(
            target_frame, target_time, header.frame_id, header.stamp, fixed_frame, timeout
        )
        transformed = do_transform(object_stamped, transform)
        return transformed if new_type is None else convert(transformed, new_type)
