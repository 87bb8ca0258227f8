"""Type descriptions and their hashes (REP 2016).

Two definitions of a type have different hashes.
"""

from functools import cache
from typing import TYPE_CHECKING, Any, cast

from course_lib.ros.messages.definitions import EVENT_PART, definition, event_definition, field_definitions

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

# Type ids of FieldType: a nested message, and offsets for arrays and sequences.
_NESTED, _ARRAY, _BOUNDED, _UNBOUNDED = 1, 48, 96, 144
# The field of a type without fields.
_FILLER = "structure_needs_at_least_one_member"


@cache
def type_hash(type_name: str) -> str:
    """Return the hash `RIHS01_…` of a message or service type.

    Raise a CourseError if it is unknown.
    """
    return _store_with(type_name).hash_rihs01(type_name)


def describe_type(type_name: str) -> dict[str, dict[str, Any]]:
    """Describe a type and all types that it refers to, by name, as the structs that are hashed."""
    from rosbags.interfaces import Nodetype

    store = _store_with(type_name)
    filler = [(_FILLER, (Nodetype.BASE, ("uint8", 0)))]
    descriptions: dict[str, dict[str, Any]] = {}
    waiting = [type_name]
    while waiting:
        name = waiting.pop()
        fields = [_describe_field(*field) for field in store.fielddefs[name][1] or filler]
        descriptions[name] = {"type_name": name, "fields": fields}
        nested = {field["type"]["nested_type_name"] for field in fields} - {""}
        waiting += sorted(nested - descriptions.keys())
    return descriptions


def _describe_field(name: str, form: Any) -> dict[str, Any]:
    """Describe a field with the numbers of type_description_interfaces/msg/FieldType."""
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
    string_bound = 0 if nested or detail[0] != "string" else detail[1]
    base = _NESTED if nested else TIDMAP["bounded_string" if string_bound else detail[0]]
    sizes = {"capacity": capacity, "string_capacity": string_bound, "nested_type_name": nested}
    return {"name": name, "type": {"type_id": base + more, **sizes}}


def _store_with(type_name: str) -> "Typestore":
    """Return the store used for hashing, filled with all types known so far."""
    store = _hashed_types()
    request = f"{type_name}_Request"
    is_service = "/srv/" in type_name or type_name.endswith(("_SendGoal", "_GetResult"))
    # The lookup adds the type if it is in one of the student's packages.
    definition(request if is_service and not type_name.endswith(EVENT_PART) else type_name)
    for name, (_, fields) in field_definitions().items():
        if name not in store.fielddefs:
            store.fielddefs[name] = [], [(field, _to_hashed_form(form)) for field, form in fields]
    if request in store.fielddefs:
        from rosbags.interfaces import Nodetype

        # rosidl describes a service as a struct of its request, response and event.
        definitions = cast("dict[str, Any]", store.fielddefs)
        definitions[f"{type_name}_Event"] = event_definition(type_name)
        definitions[type_name] = (
            [],
            [
                (f"{part.lower()}_message", (Nodetype.NAME, f"{type_name}_{part}"))
                for part in ("Request", "Response", "Event")
            ],
        )
    return store


def is_known(type_name: str) -> bool:
    """Return whether a message or service type has already been read."""
    definitions = field_definitions()
    return type_name in definitions or f"{type_name}_Request" in definitions


@cache
def _hashed_types() -> "Typestore":
    """Return an empty store, which is used for hashing only."""
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.EMPTY)


def _to_hashed_form(form: Any) -> Any:
    """Return a field's type as rosidl hashes it: `char` in a .msg file is uint8, not the char of IDL."""
    from rosbags.interfaces import Nodetype

    kind, detail = form
    if kind in (Nodetype.ARRAY, Nodetype.SEQUENCE):
        return kind, (_to_hashed_form(detail[0]), detail[1])
    return (kind, ("uint8", 0)) if form == (Nodetype.BASE, ("char", 0)) else form
