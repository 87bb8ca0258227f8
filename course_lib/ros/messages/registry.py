"""The classes of all message types, made when first asked for, and the modules they are imported from."""

import sys
from functools import cache
from types import ModuleType
from typing import Any

from course_lib.errors import CourseError
from course_lib.ros.messages.definitions import definition, type_names
from course_lib.ros.messages.message import Message, make_class, snake_case


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


def import_messages(module: str) -> dict[str, Any]:
    """Give what a package's ``msg`` module holds, by name.

    Each class also gets the private module that rosidl keeps it in, ``std_msgs.msg._string``: pickled
    messages and some programs name it.

    Args:
        module: The module's name, ``std_msgs.msg``.
    """
    prefix = module.replace(".", "/") + "/"
    names: dict[str, Any] = {}
    for name in type_names():
        if name.startswith(prefix):
            cls = message_class(name)
            home = ModuleType(cls.__module__, f"The home of {cls.__name__}.")
            setattr(home, cls.__name__, cls)
            sys.modules[home.__name__] = home
            names |= {cls.__name__: cls, f"_{snake_case(cls.__name__)}": home}
    return names
