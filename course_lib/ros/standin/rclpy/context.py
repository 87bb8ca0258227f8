"""Contexts, which hold the state between `rclpy.init` and shutdown."""

import os
import signal
import sys
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from inspect import ismethod
from typing import Any
from weakref import WeakMethod

from course_lib.ros.graph.graph import ProgramNodes, current_graph, program
from course_lib.ros.time.time_lock import time_lock
from rclpy.impl.arguments import INVALID_ARGUMENTS, Arguments, LogLevels, parse
from rclpy.impl.implementation_singleton import RCLError, RCLInvalidROSArgsError

NOT_INITIALIZED = "failed to initialize rcl: "


class Context(AbstractContextManager["Context"]):
    """The state between `init` and `shutdown`. A context cannot be initialized a second time."""

    def __init__(self) -> None:
        self.graph = current_graph()
        # Command-line arguments that apply to all nodes of the context.
        self.arguments = Arguments()
        self.__initialized = self.__initialized_logging = False
        self.__domain_id: int | None = None
        # The signal handlers of the program that initialized the context; None if the end of the
        # run does not act like Ctrl+C on it.
        self.__program_handlers: dict[int, Any] | None = None
        self.__shut_down = False
        # Type names of the endpoints on each topic. A list holds equal names, one for each
        # endpoint.
        self.__types: dict[str, list[str]] = {}
        # Functions that return a callback of the shutdown, or None if its object is gone.
        self._callbacks: list[Callable[[], Callable[[], object] | None]] = []

    def init(
        self,
        args: list[str] | None = None,
        *,
        initialize_logging: bool = True,
        domain_id: int | None = None,
    ) -> None:
        """Initialize the context. `args` is the command line, by default `sys.argv`."""
        if domain_id is not None and domain_id < 0:
            raise RuntimeError(f"Domain id ({domain_id}) should not be lower than zero.")
        if self.__initialized:
            raise RuntimeError("Context.init() must only be called once")
        is_number = domain_id is None or (isinstance(domain_id, int) and domain_id < 2**64)
        if not isinstance(args, list | None) or not is_number:
            raise TypeError("__init__(): incompatible constructor arguments.")
        try:
            self.arguments = Arguments()
            parse(sys.argv if args is None else args, self.arguments)
            # The cells of a notebook are not a program, whose end reports them.
            if program.name or not self.graph.notebook:
                current_graph().state(ProgramNodes).find_slips.append(self.arguments.find_unused)
        except RCLInvalidROSArgsError as error:
            raise RCLError(f"{NOT_INITIALIZED}{str(error).removeprefix(INVALID_ARGUMENTS)}") from None
        self.__domain_id = None if domain_id is None else int(domain_id)
        if initialize_logging:
            levels = current_graph().state(LogLevels)
            if levels.contexts == 0:
                given = self.arguments.log_levels.items()
                # rcl does not change the default level to UNSET.
                levels.by_logger |= {name: level for name, level in given if name or level}
            levels.contexts += 1
            self.__initialized_logging = True
        self.__initialized = True
        if time_lock.is_interrupted_by_end() and not self.graph.ended:
            handlers = time_lock.handlers()
            self.__program_handlers = {} if handlers is None else handlers
        contexts = current_graph().state(Contexts)
        running = [context for context in contexts.initialized if not context.is_shut_down]
        contexts.initialized = [*running, self]

    @property
    def is_valid(self) -> bool:
        """True between initialization and shutdown.

        The end of the run shuts down, as Ctrl+C does.
        """
        if self.__shut_down or not self.__initialized:
            return False
        return not (self.graph.ended and self.__is_interrupted_by_end())

    @property
    def is_initialized(self) -> bool:
        """True if the context was initialized, even if it has been shut down since then."""
        return self.__initialized

    @property
    def is_shut_down(self) -> bool:
        """True if the program or a signal shut down the context. A run's end only ends waits."""
        return self.__shut_down

    def ok(self) -> bool:
        """Return whether the context is initialized and not shut down.

        Command-line tools also stop at the end of a run.
        """
        time_lock.poll()
        return self.is_valid and not (self.graph.ended and self.__program_handlers is None)

    def get_domain_id(self) -> int:
        """Return the domain ID: the argument of `init`, else the variable ROS_DOMAIN_ID, else 0."""
        if not self.__initialized:
            raise RuntimeError("Context must be initialized before it can have a domain id")
        if not self.is_valid:
            raise RCLError("Failed to get domain id: error not set")
        return int(os.environ.get("ROS_DOMAIN_ID") or 0) if self.__domain_id is None else self.__domain_id

    def shutdown(self) -> None:
        """Shut down.

        Raises:
            RuntimeError: The context is not initialized.
            RCLError: The context is already shut down.
        """
        if not self.__initialized:
            raise RuntimeError("Context must be initialized before it can be shutdown")
        if not self.is_valid:
            self.__shut_down = True
            raise RCLError("failed to shutdown: rcl_shutdown already called on the given context")
        self.try_shutdown()

    def try_shutdown(self) -> None:
        """Shut down if the context is valid."""
        if self.is_valid:
            self.invalidate()
            if self.__initialized_logging:
                self.graph.state(LogLevels).contexts -= 1
            callbacks, self._callbacks = self._callbacks, []
            for find_callback in callbacks:
                callback = find_callback()
                if callback is not None:
                    callback()

    def invalidate(self) -> None:
        """Shut down without the shutdown callbacks, which a signal handler must not run."""
        self.__shut_down = True

    def __is_interrupted_by_end(self) -> bool:
        """Return whether Ctrl+C would reach rclpy's handler, which shuts contexts down.

        It does not if `rclpy.init` installed no handler, or if the program has installed its own
        since then. rclpy's handler calls one that the program has installed before.
        """
        contexts = self.graph.state(Contexts)
        if self.__program_handlers is None or not contexts.handles_interrupts:
            return False
        return self.__program_handlers.get(signal.SIGINT) is contexts.replaced_handler

    def claim_type(self, topic: str, type_name: str, failed: str) -> None:
        """Register an endpoint's type on a topic.

        Raises an RCLError if other endpoints on the topic have another type.
        Fast DDS rejects a second type within one context. `failed` is the message of the error.
        """
        types = self.__types.setdefault(topic, [])
        if types and types[0] != type_name:
            raise RCLError(failed)
        types.append(type_name)

    def release_type(self, topic: str) -> None:
        """Unregister an endpoint on a topic."""
        self.__types[topic].pop()

    def on_shutdown(self, callback: Callable[[], object]) -> None:
        """Call `callback()` at the shutdown, or immediately if the context is already shut down.

        As in rclpy, a method is not called if its object does not exist any more.
        """
        if not callable(callback):
            # rclpy passes the placeholder unfilled as well.
            raise TypeError("callback should be a callable, got {}", type(callback))
        if self.__shut_down:
            callback()
        else:
            self._callbacks.append(WeakMethod(callback) if ismethod(callback) else lambda: callback)

    def __enter__(self) -> "Context":
        self.init()
        return self

    def __exit__(self, *_: object) -> None:
        self.try_shutdown()


def require_context(given: object, first_read: str) -> None:
    """Raise the error of rclpy for an object that is not a context.

    `first_read` is the attribute that rclpy reads before it passes the object to its C code.
    """
    if not isinstance(given, Context):
        getattr(given, first_read)
        raise TypeError("__init__(): incompatible constructor arguments.")


@dataclass
class Contexts:
    """The contexts of one program in a run."""

    # The context of `rclpy.init()` without a `context`.
    default: Context | None = None
    # The contexts that run, and at least the last one that was initialized.
    initialized: list[Context] = field(default_factory=list)
    # Whether `rclpy.init` has installed a handler of Ctrl+C, and the program's handler before that.
    handles_interrupts: bool = False
    replaced_handler: Any = None


def get_default_context(*, shutting_down: bool = False) -> Context:
    """Return the default context.

    After a call with `shutting_down`, the next call creates a new one.
    """
    contexts = current_graph().state(Contexts)
    context = contexts.default or Context()
    contexts.default = None if shutting_down else context
    return context
