"""The classes of all message types, made when first asked for, and the modules they are imported from."""

import sys
from functools import cache
from types import ModuleType
from typing import Any

from course_lib.errors import CourseError
from course_lib.ros.messages.definitions import EVENT_PART, definition, type_names
from course_lib.ros.messages.interface_files import ACTION_PARTS, SERVICE_PARTS
from course_lib.ros.messages.message import RosMessage, home_of, make_class

loaded = set[str]()  # packages of which a class has been made


@cache
def message_class(type_name: str) -> type[RosMessage]:
    """Return the class of a type written ``std_msgs/msg/String``; a CourseError names the closest ones."""
    loaded.add(type_name.partition("/")[0])
    return make_class(definition(type_name), message_class)


def type_name(message: RosMessage | type[RosMessage]) -> str:
    """Return the type, ``std_msgs/msg/String``, of a message or its class; a CourseError for others."""
    name = getattr(message, "_TYPE_NAME", None)
    if not isinstance(name, str):
        raise CourseError(f"{message!r} is no ROS message type: import one, like std_msgs.msg.String")
    return name


class _WholeType(type):
    """The type of services' and actions' classes."""

    def __call__(cls) -> None:
        kind = "Action" if hasattr(cls, "Goal") else "Service"
        raise NotImplementedError(f"{kind} classes can not be instantiated")

    def __getattr__(cls, name: str) -> type[RosMessage]:
        """Return a service's `Event`, which few programs need, when it is asked for."""
        if name != "Event" or "Request" not in vars(cls):
            raise AttributeError(f"type object {cls.__name__!r} has no attribute {name!r}")
        return message_class(f"{vars(cls)['_TYPE_NAME']}{EVENT_PART}")


@cache
def service_class(type_name: str) -> type:
    """Return the class of a service written ``std_srvs/srv/Trigger``; it holds `Request` and so on."""
    return _WholeType(*_of_parts(type_name, SERVICE_PARTS))


@cache
def action_class(type_name: str) -> type:
    """Return the class of an action written ``example_interfaces/action/Fibonacci``.

    It holds `Goal`, `Result` and `Feedback`, and as `Impl` the types of the services and topics that it uses.
    """
    name, bases, parts = _of_parts(type_name, ACTION_PARTS)
    transport = {
        "SendGoalService": service_class(f"{type_name}_SendGoal"),
        "GetResultService": service_class(f"{type_name}_GetResult"),
        "FeedbackMessage": message_class(f"{type_name}_FeedbackMessage"),
        "CancelGoalService": service_class("action_msgs/srv/CancelGoal"),
        "GoalStatusMessage": message_class("action_msgs/msg/GoalStatusArray"),
    }
    return _WholeType(name, bases, {**parts, "Impl": type("Impl", (), transport)})


def _of_parts(type_name: str, parts: tuple[str, ...]) -> tuple[str, tuple[type, ...], dict[str, Any]]:
    """Return the name, the bases and the namespace of a class that holds other types."""
    names = {part[1:]: message_class(type_name + part) for part in parts}
    home = {"__module__": home_of(type_name), "_TYPE_NAME": type_name}
    return type_name.rsplit("/", 1)[1], (), {**home, **names}


def import_types(module: str) -> dict[str, Any]:
    """Return the contents of a package's ``msg``, ``srv`` or ``action`` module, like ``std_msgs.msg``.

    Each class also gets the private module that rosidl keeps it in, ``std_msgs.msg._string``: pickled
    messages and some programs name it.
    """
    prefix = module.replace(".", "/") + "/"
    names: dict[str, Any] = {}
    for name in (name for name in type_names() if name.startswith(prefix)):
        message = message_class(name)
        home = sys.modules.setdefault(message.__module__, ModuleType(message.__module__))
        setattr(home, message.__name__, message)
        public = _public(name, message)
        if public is not None:
            setattr(home, public.__name__, public)
            names |= {public.__name__: public, home.__name__.rsplit(".", 1)[1]: home}
    return names


def _public(name: str, message: type[RosMessage]) -> type | None:
    """Return the class that a program imports for a type: for the first part of a service, the service."""
    if "/msg/" in name:
        return message
    for part, whole in ((SERVICE_PARTS[0], service_class), (ACTION_PARTS[0], action_class)):
        if name.endswith(part):
            return whole(name.removesuffix(part))
    return None
