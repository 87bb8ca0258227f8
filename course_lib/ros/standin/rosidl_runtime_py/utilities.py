"""Lookup of interface classes, by name or by the type of a field."""

from importlib import import_module
from typing import Any

from course_lib.ros.messages.idl import NamespacedType


def get_interface(identifier: str) -> Any:
    """Return the class for a full type name such as std_msgs/msg/String."""
    return _import_class(identifier, None)


def get_message(identifier: str) -> Any:
    """Return the class of a message type such as std_msgs/msg/String or std_msgs/String."""
    return _import_checked(identifier, "msg", is_message, "a message")


def get_service(identifier: str) -> Any:
    """Return the class of a service type such as std_srvs/srv/Trigger."""
    return _import_checked(identifier, "srv", is_service, "a service")


def get_action(identifier: str) -> Any:
    """Return the class of an action type such as example_interfaces/action/Fibonacci."""
    return _import_checked(identifier, "action", is_action, "an action")


def is_message(interface: Any) -> bool:
    """Return whether an object is a message or a message class."""
    return hasattr(interface, "get_fields_and_field_types")


def is_service(interface: Any) -> bool:
    """Return whether an object is a service class."""
    return hasattr(interface, "Request") and hasattr(interface, "Response")


def is_action(interface: Any) -> bool:
    """Return whether an object is an action class."""
    return all(hasattr(interface, part) for part in ("Goal", "Result", "Feedback"))


def _import_checked(identifier: str, folder: str, fits: Any, what: str) -> Any:
    interface = _import_class(identifier, folder)
    if not fits(interface):
        raise ValueError(f"Expected the full name of {what}, got '{identifier}'")
    return interface


def _import_class(identifier: str, folder: str | None) -> Any:
    """Return the class of a type name. `folder` completes a name like std_msgs/String."""
    *spaces, name = identifier.split("/")
    if len(spaces) == 1 and folder is not None:
        spaces.append(folder)
    module = import_module(".".join(spaces))
    if name.endswith("_FeedbackMessage"):
        return getattr(module, name.removesuffix("_FeedbackMessage")).Impl.FeedbackMessage
    return getattr(module, name)


def import_message_from_namespaced_type(message_type: NamespacedType) -> Any:
    """Return the class of the messages in a field, by its type in `SLOT_TYPES`."""
    return _import_class("/".join([*message_type.namespaces, message_type.name]), None)
