"""Type descriptions and their hashes (REP 2016): another hash means another definition of the type."""

from functools import cache
from typing import TYPE_CHECKING, Any, cast

from course_lib.ros.messages.definitions import EVENT_PART, definition, event_of, typestore

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

_NESTED, _ARRAY, _BOUNDED, _UNBOUNDED = 1, 48, 96, 144  # of FieldType's numbers: a message, what is added
_FILLER = "structure_needs_at_least_one_member"  # of a type without fields


@cache
def type_hash(type_name: str) -> str:
    """Return `RIHS01_…` of a message's or a service's type; a CourseError if it is not known here."""
    return _store_with(type_name).hash_rihs01(type_name)


def described(type_name: str) -> dict[str, dict[str, Any]]:
    """Describe a type and those that it refers to, by their names: the structs that its hash is made of."""
    from rosbags.interfaces import Nodetype

    store = _store_with(type_name)
    filler = [(_FILLER, (Nodetype.BASE, ("uint8", 0)))]
    found: dict[str, dict[str, Any]] = {}
    waiting = [type_name]
    while waiting:
        name = waiting.pop()
        fields = [_described_field(*field) for field in store.fielddefs[name][1] or filler]
        found[name] = {"type_name": name, "fields": fields}
        nested = {field["type"]["nested_type_name"] for field in fields} - {""}
        waiting += sorted(nested - found.keys())
    return found


def _described_field(name: str, form: Any) -> dict[str, Any]:
    """Describe a field by the numbers of type_description_interfaces/msg/FieldType."""
    from rosbags.interfaces import Nodetype
    from rosbags.typesys.store import TIDMAP

    capacity, more = 0, 0
    if form[0] == Nodetype.ARRAY:
        form, capacity, more = form[1][0], form[1][1], _ARRAY
    elif form[0] == Nodetype.SEQUENCE:
        form, capacity = form[1]
        more = _BOUNDED if capacity else _UNBOUNDED
    kind, detail = form
    nested = detail if kind == Nodetype.NAME else ""
    bound = 0 if nested or detail[0] != "string" else detail[1]
    base = _NESTED if nested else TIDMAP["bounded_string" if bound else detail[0]]
    sizes = {"capacity": capacity, "string_capacity": bound, "nested_type_name": nested}
    return {"name": name, "type": {"type_id": base + more, **sizes}}


def _store_with(type_name: str) -> "Typestore":
    """Return the store that is hashed with, filled with all types that are known by now."""
    store = _hashed_types()
    request = f"{type_name}_Request"
    definition(request if _is_service(type_name) else type_name)  # it may lie in a package of the student's
    for name, (_, fields) in typestore().fielddefs.items():
        if name not in store.fielddefs:
            store.fielddefs[name] = [], [(field, _hashed(form)) for field, form in fields]
    if request in store.fielddefs:
        _describe_service(store, type_name)
    return store


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
