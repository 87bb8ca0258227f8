"""The registry of converters by message type."""

from collections.abc import Callable, Sequence
from typing import Any

Converter = Callable[..., Any]
_Key = tuple[type[Any], bool]
_to_numpy: dict[_Key, Converter] = {}
_from_numpy: dict[_Key, Converter] = {}


def converts_to_numpy(msgtype: type[Any], plural: bool = False) -> Callable[[Converter], Converter]:
    """Register the decorated function with `numpify` for a type, or for lists of it if `plural`."""
    return lambda function: _to_numpy.setdefault((msgtype, plural), function)


def converts_from_numpy(
    msgtype: type[Any],
    plural: bool = False,
) -> Callable[[Converter], Converter]:
    """Register the decorated function with `msgify` for a type, or for lists of it if `plural`."""
    return lambda function: _from_numpy.setdefault((msgtype, plural), function)


def numpify(msg: Any, *args: Any, **kwargs: Any) -> Any:
    """Convert a message to an array. Further arguments are passed to the converter of its type.

    Raises:
        ValueError: There is no converter for the type, or the list is empty.
    """
    if msg is None:
        return None
    key: _Key = (type(msg), False)
    if key not in _to_numpy and isinstance(msg, Sequence):
        if not msg:
            raise ValueError("Cannot determine the type of an empty Collection")
        key = (type(msg[0]), True)
    if key not in _to_numpy:
        raise ValueError(
            f"Unable to convert message {key[0].__name__} - only supports {_list_names(_to_numpy)}"
        )
    return _to_numpy[key](msg, *args, **kwargs)


def msgify(
    msg_type: type[Any],
    numpy_obj: Any,
    *args: Any,
    plural: bool = False,
    **kwargs: Any,
) -> Any:
    """Convert an array to a message. Further arguments are passed to the converter of the type.

    Raises:
        ValueError: There is no converter for the type.
    """
    key = (msg_type, plural)
    if key not in _from_numpy:
        raise ValueError(
            f"Unable to build message {msg_type.__name__} - only supports {_list_names(_from_numpy)}"
        )
    return _from_numpy[key](numpy_obj, *args, **kwargs)


def _list_names(converters: dict[_Key, Converter]) -> str:
    return ", ".join(cls.__name__ + ("[]" if plural else "") for cls, plural in converters)
