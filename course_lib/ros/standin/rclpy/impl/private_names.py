"""Private names of rclpy's Node and Executor. A subclass that uses one breaks on a robot.

The stand-in keeps its own state under other names, so such a class would work here. Each name is a
descriptor of the class that reports assignments. Python calls a descriptor only for its own
attribute, so nothing else becomes slower.
"""

import sys
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import partial
from operator import attrgetter
from types import FrameType, FunctionType
from typing import Any

from course_lib.ros.notices import print_notice
from course_lib.ros.tracebacks import line_of_thread

_LISTS = "create_{0}(), destroy_{0}() and the executor use it as the list of the node's {0}s"
_PARAMETERS = "declare_parameter(), get_parameter() and set_parameters() use it"
_CALLED = "rclpy's own methods call it"

# What rclpy 7.1.6 (Jazzy) uses each name for. Names that a program may set to an equivalent object,
# like `self._clock = self.get_clock()`, are listed in _EQUALS below.
USES = {
    **{
        f"_{kind}s": _LISTS.format(kind)
        for kind in ("publisher", "subscription", "client", "service", "timer")
    },
    "_guards": _LISTS.format("guard_condition"),
    "_context": "create_timer() and create_rate() use it",
    "_clock": "create_timer() and get_clock() use it",
    "_logger": "get_logger() returns it",
    "_default_callback_group": "every callback without a group of its own is in it",
    "_rate_group": "create_rate() uses it",
    "_time_source": "destroy_node() uses it",
    "_type_description_service": "destroy_node() uses it",
    "_parameter_event_publisher": "set_parameters() publishes with it",
    **dict.fromkeys(
        (
            "_allow_undeclared_parameters",
            "_descriptors",
            "_on_set_parameters_callbacks",
            "_parameter_overrides",
            "_parameters",
            "_post_set_parameters_callbacks",
            "_pre_set_parameters_callbacks",
        ),
        _PARAMETERS,
    ),
}


def _list_of(entities: str, node: Any) -> list[Any]:
    return list(getattr(node, entities))


# The values that the stand-in keeps under other names, for programs that read them.
KEPT_BY_NODE: dict[str, Callable[[Any], object]] = {
    f"_{name}": partial(_list_of, name)
    for name in ("publishers", "subscriptions", "clients", "services", "timers", "guards")
}
KEPT_BY_NODE |= {name: attrgetter(f"_Node_{name}") for name in USES if name not in KEPT_BY_NODE}
KEPT_BY_NODE |= {
    name: attrgetter(f"_Node__parameter_store.{attribute}")
    for name, attribute in {
        "_parameters": "values",
        "_descriptors": "descriptors",
        "_parameter_overrides": "overrides",
        "_parameter_event_publisher": "events",
        "_pre_set_parameters_callbacks": "pre_set_callbacks",
        "_on_set_parameters_callbacks": "on_set_callbacks",
        "_post_set_parameters_callbacks": "post_set_callbacks",
    }.items()
}
KEPT_BY_NODE["_context"] = attrgetter("context")
KEPT_BY_NODE["_type_description_service"] = attrgetter("_Node__type_description_service")
METHODS = dict.fromkeys(
    (
        "_apply_descriptor",
        "_apply_descriptor_and_set",
        "_apply_descriptors",
        "_apply_floating_point_range",
        "_apply_integer_range",
        "_call_post_set_parameters_callback",
        "_call_pre_set_parameters_callback",
        "_check_undeclared_parameters",
        "_count_clients_or_servers",
        "_count_publishers_or_subscribers",
        "_declare_parameter_common",
        "_get_info_by_topic",
        "_set_parameters_atomically",
        "_set_parameters_atomically_common",
        "_validate_qos_or_depth_parameter",
        "_validate_topic_or_service_name",
        "_wake_executor",
    ),
    _CALLED,
)
OF_LIFECYCLE_NODES = {
    "_callbacks": "each transition looks its callback up in it",
    "_managed_entities": "each transition calls the entities in it",
    "_state_machine": "each transition uses it",
}
# `_nodes`, `_tasks` and `_is_shutdown` are missing because the stand-in uses them as rclpy does: a
# program that uses them for something else fails here as well.
OF_EXECUTORS = {
    "_cb_iter": "spin_once() goes on with it",
    "_clock": "timeouts are measured by it",
    "_context": "every spin asks whether it is shut down",
    "_guard": "wake() and shutdown() trigger it",
    "_last_args": "spin_once() compares its arguments with it",
    "_last_kwargs": "spin_once() compares its arguments with it",
    "_nodes_lock": "add_node() and remove_node() hold it",
    "_shutdown_lock": "shutdown() holds it",
    "_sigint_gc": "Ctrl+C triggers it",
    "_tasks_lock": "create_task() holds it",
    "_work_tracker": "shutdown() waits for it",
    **dict.fromkeys(
        (
            "_make_handler",
            "_take_client",
            "_take_guard_condition",
            "_take_service",
            "_take_subscription",
            "_take_timer",
            "_take_waitable",
            "_wait_for_ready_callbacks",
        ),
        _CALLED,
    ),
}
_EQUALS = {
    "_clock": "Clock",
    "_context": "Context",
    "_logger": "RcutilsLogger",
    "_rate_group": "CallbackGroup",
}
_EQUALS["_default_callback_group"] = "CallbackGroup"


class PrivateName:
    """A descriptor for one of rclpy's private names.

    It reports an assignment to it in a student's class.
    """

    def __init__(
        self,
        base: str,
        name: str,
        use: str,
        read: Callable[[Any], object] | None,
    ) -> None:
        self._base, self._name, self._use, self._read = base, name, use, read

    def __get__(self, node: Any, owner: type) -> Any:
        if node is None:
            return self
        try:
            return node.__dict__[self._name]
        except KeyError:
            # Without `super().__init__()` there is no value to read.
            with suppress(AttributeError):
                if self._read is not None:
                    return self._read(node)
            raise AttributeError(
                f"'{owner.__name__}' object has no attribute '{self._name}'", name=self._name, obj=node
            ) from None

    def __set__(self, node: Any, value: object) -> None:
        node.__dict__[self._name] = value
        equal = _EQUALS.get(self._name)
        if equal is None or equal not in (cls.__name__ for cls in type(value).__mro__):
            place = line_of_thread(threading.get_ident())
            notice(self._base, type(node).__name__, self._name, self._use, place)

    def __delete__(self, node: Any) -> None:
        node.__dict__.pop(self._name, None)


# The attribute that a method of rclpy's Node reads first, which its error names if
# `super().__init__()` has not been called.
_FIRST_READ = {
    **dict.fromkeys(("create_client", "create_service"), "_default_callback_group"),
    **dict.fromkeys(("add_waitable", "remove_waitable"), "_Node__waitables"),
    "set_parameters": "_pre_set_parameters_callbacks",
    "set_parameters_atomically": "_pre_set_parameters_callbacks",
    **dict.fromkeys(("describe_parameter", "describe_parameters"), "_descriptors"),
    **{
        f"{verb}_{time}_parameters_callback": f"_{time}_parameters_callbacks"
        for verb in ("add", "remove")
        for time in ("pre_set", "on_set", "post_set")
    },
    "declare_parameters": "_parameter_overrides",
    "destroy_node": "_publishers",
    "context": "_context",
    "executor": "_Node__executor_weakref",
}


class _SetByInit:
    """A descriptor for an attribute that `Node.__init__` sets.

    Python calls it only if the object does not have the attribute, and it raises rclpy's error.
    """

    def __init__(self, first_read: str) -> None:
        self._first_read = first_read

    def __get__(self, node: Any, owner: type) -> Any:
        if node is None:
            return self
        caller, first_read = sys._getframe(1), self._first_read
        frame: FrameType | None = caller
        while frame is not None and frame.f_globals is caller.f_globals:
            kind = frame.f_locals.get("kind")
            if isinstance(kind, type):
                # The methods for the entities of one kind read rclpy's list of them.
                first_read = f"_{kind.__name__.removesuffix('Condition').lower()}s"
                break
            if frame.f_code.co_name in _FIRST_READ:
                first_read = _FIRST_READ[frame.f_code.co_name]
                break
            frame = frame.f_back
        raise AttributeError(
            f"'{owner.__name__}' object has no attribute '{first_read}'", name=first_read, obj=node
        )


def set_by_init(first_read: str) -> Any:
    """Return a descriptor for an attribute of `__init__`. rclpy reads `first_read` instead."""
    return _SetByInit(first_read)


# (class, name) pairs reported so far in this process.
_noticed: set[tuple[str, str]] = set()


def notice(base: str, class_name: str, name: str, use: str, place: str) -> None:
    """Print a hint once per class and name: a subclass of rclpy's `base` breaks on a robot."""
    if (class_name, name) not in _noticed:
        _noticed.add((class_name, name))
        where = f" ({place})" if place else ""
        print_notice(
            f"hint: {class_name}.{name}{where} is a name of rclpy's own {base}: {use}. This breaks "
            f"the {base.lower()} on a robot, even where it works here. Choose another name, like "
            f"my{name}."
        )


def watch_names(
    base: str, cls: type, names: dict[str, str], kept: dict[str, Callable[[Any], object]]
) -> None:
    """Report assignments to these names in objects of a class.

    `kept` has functions that read the values which the stand-in keeps under other names.
    """
    for name, use in names.items():
        setattr(cls, name, PrivateName(base, name, use, kept.get(name)))


def check_class(base: str, cls: type, names: dict[str, str]) -> None:
    """Report private names of rclpy's `base` that the body of a subclass defines."""
    for name in sorted(names.keys() & vars(cls).keys()):
        notice(base, cls.__name__, name, names[name], "")


# Properties of a node that rclpy reads, and its errors if a program's class has a method of this
# name. rclpy raises some of them only when the node is spun.
_READ_BY_RCLPY: Mapping[str, tuple[type[Exception], str]] = {
    "handle": (TypeError, "'method' object does not support the context manager protocol"),
    "context": (AttributeError, "'function' object has no attribute 'handle'"),
    "executor": (AttributeError, "'function' object has no attribute 'wake'"),
    "default_callback_group": (AttributeError, "'function' object has no attribute 'add_entity'"),
    **dict.fromkeys(
        ("timers", "subscriptions", "clients", "services", "guards", "waitables"),
        (TypeError, "'method' object is not iterable"),
    ),
}


def reject_hidden_properties(kind: type) -> None:
    """Raise rclpy's error for a class with a method named like a property that rclpy reads."""
    for name, (error, text) in _READ_BY_RCLPY.items():
        if isinstance(getattr(kind, name, None), FunctionType):
            raise error(text)
