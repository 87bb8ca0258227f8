"""Results that come later, and the work that brings them."""

import inspect
import warnings
import weakref
from collections.abc import Callable, Generator
from functools import partial
from typing import TYPE_CHECKING, Any, Generic, TypeVar

if TYPE_CHECKING:
    from rclpy.executors import Executor
    from rclpy.impl.node_handle import Entity

T = TypeVar("T")


class Future(Generic[T]):
    """A result that comes later; a callback that is a coroutine can await it.

    Args:
        executor: Runs the done-callbacks; without one they are called by whoever brings the result.
    """

    def __init__(self, *, executor: "Executor | None" = None) -> None:
        self._done = False
        self._cancelled = False
        self._result: T | None = None
        self._exception: BaseException | None = None
        self._callbacks: list[Callable[[Future[T]], object]] = []
        self._set_executor(executor)

    def __await__(self) -> Generator["Future[T]", None, T | None]:
        while not self._done:
            yield self
        return self.result()

    def done(self) -> bool:
        """Say whether the result, or an exception instead of it, is there."""
        return self._done

    def result(self) -> T | None:
        """Return the result, None if it is not there yet; raises the exception that came instead of it."""
        if self._exception is not None:
            raise self._exception
        return self._result

    def exception(self) -> BaseException | None:
        """Return the exception that came instead of the result, if one did."""
        return self._exception

    def cancelled(self) -> bool:
        """Say whether the future was cancelled before its result came."""
        return self._cancelled

    def cancel(self) -> None:
        """Ask for no result any more; a cancelled future is not done."""
        if not self._done:
            self._cancelled = True
        self._call_back()

    def set_result(self, result: T) -> None:
        """Bring the result."""
        self._result = result
        self._finish()

    def set_exception(self, exception: BaseException) -> None:
        """Bring an exception instead of the result."""
        self._exception = exception
        self._finish()

    def add_done_callback(self, callback: "Callable[[Future[T]], object]") -> None:
        """Have `callback(future)` called when the future is done; at once if it is."""
        self._callbacks.append(callback)
        if self._done:
            self._call_back()

    def _set_executor(self, executor: "Executor | None") -> None:
        self._executor = None if executor is None else weakref.ref(executor)

    def _finish(self) -> None:
        self._done = True
        self._cancelled = False
        self._call_back()

    def _call_back(self) -> None:
        callbacks, self._callbacks = self._callbacks, []
        executor = self._executor() if self._executor else None
        for callback in callbacks:
            if executor is not None:
                executor.create_task(callback, self)
                continue
            try:
                callback(self)
            except Exception as error:  # one callback must not keep the others from being called
                warnings.warn(f"Unhandled exception in done callback: {error}", stacklevel=3)


class Task(Future[Any]):
    """A function or a coroutine that an executor runs, and its result; made by `Executor.create_task`."""

    def __init__(
        self,
        handler: Callable[..., Any],
        args: tuple[Any, ...] = (),
        kwargs: dict[str, Any] | None = None,
        executor: "Executor | None" = None,
    ) -> None:
        super().__init__(executor=executor)
        self._call: Callable[[], Any] = partial(handler, *args, **(kwargs or {}))
        self._coroutine: Any = self._call() if inspect.iscoroutinefunction(handler) else None
        self._awaited: Future[Any] | None = None
        self._executing = False
        self.entity: Entity | None = None  # whose callback it is

    def __call__(self) -> None:
        """Run the function, or the coroutine until it has to wait."""
        if self._done or self._executing:
            return
        self._executing = True
        try:
            if self._coroutine is None:
                self.set_result(self._call())
            else:
                awaited = self._coroutine.send(None)
                self._awaited = awaited if isinstance(awaited, Future) else None
        except StopIteration as end:
            self.set_result(end.value)
        except Exception as error:  # it belongs to whoever asks for the result
            self.set_exception(error)
        finally:
            self._executing = False

    def executing(self) -> bool:
        """Say whether it is running right now."""
        return self._executing

    def can_go_on(self) -> bool:
        """Say whether there is something to run: it has not begun, or what it awaited is there."""
        return not self._done and not self._executing and (self._awaited is None or self._awaited.done())
