"""The life between init and shutdown."""

import sys
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass, field

from course_lib.ros.baton import baton
from course_lib.ros.graph import current_graph
from rclpy.exceptions import RCLError
from rclpy.impl.arguments import Arguments, parse
from rclpy.impl.logging_severity import LogLevels


class Context(AbstractContextManager["Context"]):
    """The span from `init` to `shutdown`; it cannot be initialised a second time."""

    def __init__(self) -> None:
        self.graph = current_graph()
        self.arguments = Arguments()  # of the command line, for all nodes
        self._initialized = False
        self._shut_down = False
        self._callbacks: list[Callable[[], object]] = []

    def init(
        self, args: list[str] | None = None, *, initialize_logging: bool = True, domain_id: int | None = None
    ) -> None:
        """Initialise the context; `args` are the command line's, by default `sys.argv`."""
        if domain_id is not None and domain_id < 0:
            raise RuntimeError(f"Domain id ({domain_id}) should not be lower than zero.")
        if self._initialized:
            raise RuntimeError("Context.init() must only be called once")
        self.arguments = parse(sys.argv if args is None else args)
        current_graph().part(LogLevels).by_logger |= self.arguments.log_levels
        self._initialized = True
        current_graph().part(Contexts).initialized.append(self)

    @property
    def is_valid(self) -> bool:
        """True if it is initialised and not shut down; the end of the run does not change that."""
        return self._initialized and not self._shut_down

    def ok(self) -> bool:
        """Return whether the program may go on: neither shut down nor at the end of the run."""
        baton.poll()
        return self.is_valid and not self.graph.ended

    def shutdown(self) -> None:
        """Shut down; raises a RuntimeError before `init`, an RCLError after an earlier shutdown."""
        if not self._initialized:
            raise RuntimeError("Context must be initialized before it can be shutdown")
        if self._shut_down:
            raise RCLError("failed to shutdown: rcl_shutdown already called on the given context")
        self.try_shutdown()

    def try_shutdown(self) -> None:
        """Shut down if the context is valid."""
        if self.is_valid:
            self.invalidate()
            callbacks, self._callbacks = self._callbacks, []
            for callback in callbacks:
                callback()

    def invalidate(self) -> None:
        """Shut down without calling the callbacks: all that a signal handler may do."""
        self._shut_down = True

    def on_shutdown(self, callback: Callable[[], object]) -> None:
        """Call `callback()` at the shutdown, or now if that has been."""
        if self._shut_down:
            callback()
        else:
            self._callbacks.append(callback)

    def __enter__(self) -> "Context":
        self.init()
        return self

    def __exit__(self, *_: object) -> None:
        self.try_shutdown()


@dataclass
class Contexts:
    """The contexts of one program in a run."""

    default: Context | None = None  # of `rclpy.init()` without a context
    initialized: list[Context] = field(default_factory=list)


def get_default_context(*, shutting_down: bool = False) -> Context:
    """Return the context that holds where none is passed; after `shutting_down` the next call makes one."""
    contexts = current_graph().part(Contexts)
    context = contexts.default or Context()
    contexts.default = None if shutting_down else context
    return context
