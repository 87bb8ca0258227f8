"""The life between init and shutdown."""

import sys
from collections.abc import Callable
from contextlib import AbstractContextManager

from course_lib.ros.baton import baton
from course_lib.ros.graph import current_graph
from rclpy.exceptions import RCLError
from rclpy.impl.arguments import Arguments, parse
from rclpy.impl.run import current_run


class Context(AbstractContextManager["Context"]):
    """What `init` begins and `shutdown` ends; once, then it is spent."""

    def __init__(self) -> None:
        self.graph = current_graph()
        self.arguments = Arguments()  # of the command line, for all nodes
        self._initialized = False
        self._shut_down = False
        self._callbacks: list[Callable[[], object]] = []

    def init(
        self, args: list[str] | None = None, *, initialize_logging: bool = True, domain_id: int | None = None
    ) -> None:
        """Begin; `args` are the command line's, by default `sys.argv`."""
        if domain_id is not None and domain_id < 0:
            raise RuntimeError(f"Domain id ({domain_id}) should not be lower than zero.")
        if self._initialized:
            raise RuntimeError("Context.init() must only be called once")
        self.arguments = parse(sys.argv if args is None else args)
        current_run().log_levels |= self.arguments.log_levels
        self._initialized = True
        current_run().contexts.append(self)

    @property
    def is_valid(self) -> bool:
        """Whether it is initialised and not shut down; the end of the run does not change that."""
        return self._initialized and not self._shut_down

    def ok(self) -> bool:
        """Say whether the program may go on: neither shut down nor at the end of the run."""
        baton.poll()
        return self.is_valid and not self.graph.ended

    def shutdown(self) -> None:
        """End; raises a RuntimeError if it has not begun, an RCLError if it has ended already."""
        if not self._initialized:
            raise RuntimeError("Context must be initialized before it can be shutdown")
        if self._shut_down:
            raise RCLError("failed to shutdown: rcl_shutdown already called on the given context")
        self.try_shutdown()

    def try_shutdown(self) -> None:
        """End, if it has begun and not ended yet."""
        if self.is_valid:
            self.invalidate()
            callbacks, self._callbacks = self._callbacks, []
            for callback in callbacks:
                callback()

    def invalidate(self) -> None:
        """End without a word to those who wait for it: all that a signal handler may do."""
        self._shut_down = True

    def on_shutdown(self, callback: Callable[[], object]) -> None:
        """Have `callback()` called at the shutdown; at once if that has been."""
        if self._shut_down:
            callback()
        else:
            self._callbacks.append(callback)

    def __enter__(self) -> "Context":
        self.init()
        return self

    def __exit__(self, *_: object) -> None:
        self.try_shutdown()
