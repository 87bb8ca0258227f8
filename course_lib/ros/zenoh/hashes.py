"""Type hashes (REP 2016): the last part of every key. Another hash means another definition of the type."""

from functools import cache
from typing import TYPE_CHECKING, Any, cast

from course_lib.ros.messages.definitions import EVENT_PART, definition, event_of, typestore

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore


@cache
def type_hash(type_name: str) -> str:
    """Return `RIHS01_…` of a message's or a service's type; a CourseError if it is not known here."""
    store = _hashed_types()
    request = f"{type_name}_Request"
    definition(request if _is_service(type_name) else type_name)  # it may lie in a package of the student's
    for name, (_, fields) in typestore().fielddefs.items():
        if name not in store.fielddefs:
            store.fielddefs[name] = [], [(field, _hashed(form)) for field, form in fields]
    if request in store.fielddefs:
        _describe_service(store, type_name)
    return store.hash_rihs01(type_name)


def is_known(type_name: str) -> bool:
    """Return whether a message's or a service's type was read already."""
    known = typestore().fielddefs
    return type_name in known or f"{type_name}_Request" in known


def _is_service(type_name: str) -> bool:
    if type_name.endswith(EVENT_PART):
        return False
    return "/srv/" in type_name or type_name.endswith(("_SendGoal", "_GetResult"))


@cache
def _hashed_types() -> "Typestore":
    """Return a store that is only hashed with."""
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.EMPTY)


def _describe_service(store: "Typestore", type_name: str) -> None:
    """Add a service as rosidl describes it: a struct of its request, its response and its event."""
    from rosbags.interfaces import Nodetype

    request, response, event = (f"{type_name}_{part}" for part in ("Request", "Response", "Event"))
    whole, known = Nodetype.NAME, cast("dict[str, Any]", store.fielddefs)
    known[event] = event_of(type_name)
    parts = (("request_message", request), ("response_message", response), ("event_message", event))
    known[type_name] = [], [(field, (whole, name)) for field, name in parts]


def _hashed(form: Any) -> Any:
    """Return a field's form as rosidl hashes it: `char` of a .msg file is uint8, not IDL's char."""
    from rosbags.interfaces import Nodetype

    kind, detail = form
    if kind in (Nodetype.ARRAY, Nodetype.SEQUENCE):
        return kind, (_hashed(detail[0]), detail[1])
    return (kind, ("uint8", 0)) if form == (Nodetype.BASE, ("char", 0)) else form
