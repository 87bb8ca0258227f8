"""Futures, and the tasks of executors."""

import inspect
import warnings
import weakref
from collections.abc import Callable, Generator
from functools import partial
from typing import Any, Generic, Protocol, TypeVar

from course_lib.ros.baton import baton

T = TypeVar("T")


async def await_or_execute(callback: Callable[..., Any], *args: Any) -> Any:
    """Call a callback, and await it if it is a coroutine."""
    result = callback(*args)
    return await result if inspect.iscoroutine(result) else result


class TaskRunner(Protocol):
    """An executor, as a future knows it."""

    def create_task(self, callback: Callable[..., Any], *args: Any, **kwargs: Any) -> "Task":
        """Run a function or a coroutine soon."""


class Future(Generic[T]):
    """A result that comes later; a callback that is a coroutine can await it.

    Args:
        executor: Runs the done-callbacks; without one they are called where the result is set.
    """

    def __init__(self, *, executor: TaskRunner | None = None) -> None:
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
        """Return whether the result, or an exception instead of it, is there; looped on, it passes time."""
        if not self._done:
            baton.poll()
        return self._done

    def arrived(self) -> bool:
        """Return the same to the kit's own waits."""
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
        """Return whether the future was cancelled before its result came."""
        return self._cancelled

    def cancel(self) -> None:
        """Cancel the future, which is not done by that."""
        if not self._done:
            self._cancelled = True
        self._call_back()

    def set_result(self, result: T) -> None:
        """Set the result and call the done-callbacks."""
        self._result = result
        self._finish()

    def set_exception(self, exception: BaseException) -> None:
        """Set an exception instead of the result and call the done-callbacks."""
        self._exception = exception
        self._finish()

    def add_done_callback(self, callback: "Callable[[Future[T]], object]") -> None:
        """Call `callback(future)` when the future is done, or now if it is."""
        self._callbacks.append(callback)
        if self._done:
            self._call_back()

    def _set_executor(self, executor: TaskRunner | None) -> None:
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
        executor: TaskRunner | None = None,
    ) -> None:
        super().__init__(executor=executor)
        self._call: Callable[[], Any] = partial(handler, *args, **(kwargs or {}))
        self._coroutine: Any = self._call() if inspect.iscoroutinefunction(handler) else None
        self._awaited: Future[Any] | None = None
        self._executing = False

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
        except Exception as error:  # `result` raises it
            self.set_exception(error)
        finally:
            self._executing = False

    def executing(self) -> bool:
        """Return whether it is running right now."""
        return self._executing

    def can_go_on(self) -> bool:
        """Return whether it can be run: it has not begun, or the future that it awaits is done."""
        return not self._done and not self._executing and (self._awaited is None or self._awaited.done())
