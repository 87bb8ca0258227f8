"""Import of the message class to which a field's type refers."""

from importlib import import_module
from typing import Any

from rosidl_parser.definition import NamespacedType


def import_message_from_namespaced_type(message_type: NamespacedType) -> Any:
    """Return the class of the messages in a field, by its type in `SLOT_TYPES`."""
    module = import_module(".".join(message_type.namespaces))
    if message_type.name.endswith("_FeedbackMessage"):
        action = message_type.name.removesuffix("_FeedbackMessage")
        return getattr(module, action).Impl.FeedbackMessage
    return getattr(module, message_type.name)
