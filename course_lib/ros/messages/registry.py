"""The classes of all message types, made when first asked for, and the modules they are imported from."""

import sys
from functools import cache
from types import ModuleType
from typing import Any

from course_lib.errors import CourseError
from course_lib.ros.messages.definitions import SERVICE_PARTS, definition, type_names
from course_lib.ros.messages.message import Message, home_of, make_class


@cache
def message_class(type_name: str) -> type[Message]:
    """Give the class of a type written ``visualization_msgs/msg/Marker``.

    Raises:
        CourseError: No such type; names the closest ones.
    """
    return make_class(definition(type_name), message_class)


def type_name(message: Message | type[Message]) -> str:
    """Give a message's, or a message class's, type name, ``visualization_msgs/msg/Marker``.

    Raises:
        CourseError: It is neither.
    """
    name = getattr(message, "_TYPE_NAME", None)
    if not isinstance(name, str):
        raise CourseError(f"{message!r} is no ROS message type: import one, like std_msgs.msg.String")
    return name


class _ServiceType(type):
    """The type of services' classes."""

    def __call__(cls) -> None:
        raise NotImplementedError("Service classes can not be instantiated")


@cache
def service_class(type_name: str) -> type:
    """Give the class of a service written ``std_srvs/srv/Trigger``: it holds `Request` and `Response`.

    Raises:
        CourseError: No such service; names the closest types.
    """
    request, response = (message_class(type_name + part) for part in SERVICE_PARTS)
    names = {"Request": request, "Response": response, "_TYPE_NAME": type_name}
    return _ServiceType(type_name.rsplit("/", 1)[1], (), {"__module__": home_of(type_name), **names})


def import_types(module: str) -> dict[str, Any]:
    """Give what a package's ``msg`` or ``srv`` module, like ``std_msgs.msg``, holds by name.

    Each class also gets the private module that rosidl keeps it in, ``std_msgs.msg._string``: pickled
    messages and some programs name it.
    """
    prefix = module.replace(".", "/") + "/"
    names: dict[str, Any] = {}
    for name in (name for name in type_names() if name.startswith(prefix)):
        message = message_class(name)
        home = sys.modules.setdefault(message.__module__, ModuleType(message.__module__))
        setattr(home, message.__name__, message)
        service = name.removesuffix(SERVICE_PARTS[0])
        public = message if "/msg/" in name else service_class(service) if service != name else None
        if public is not None:
            setattr(home, public.__name__, public)
            names |= {public.__name__: public, home.__name__.rsplit(".", 1)[1]: home}
    return names
