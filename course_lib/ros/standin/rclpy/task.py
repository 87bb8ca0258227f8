"""Futures, and the tasks that executors run."""

from __future__ import annotations

import inspect
import itertools
import sys
import threading
import warnings
import weakref
from collections.abc import Callable, Coroutine, Generator
from enum import Enum
from functools import partial
from typing import TYPE_CHECKING, Any, Generic, NoReturn, Protocol, TypeVar

from course_lib.ros.time.time_lock import time_lock

T = TypeVar("T")
# Numbers tasks as they are created, and entities as they become ready, across all nodes.
order = itertools.count()


async def await_or_execute(callback: Callable[..., Any], *args: Any) -> Any:
    """Call a callback, and await the result if it is a coroutine."""
    result = callback(*args)
    return await result if inspect.iscoroutine(result) else result


class TaskRunner(Protocol):
    """The part of an executor that futures use."""

    def create_task(
        self, callback: Callable[..., Any] | Coroutine[Any, Any, Any], *args: Any, **kwargs: Any
    ) -> Task:
        """Schedule a function or a coroutine."""


class FutureState(Enum):
    """The states of a future."""

    PENDING = "PENDING"
    CANCELLED = "CANCELLED"
    FINISHED = "FINISHED"


class _Awaiting(threading.local):
    """The future that a coroutine of this thread awaited last.

    `Future.__await__` yields None, as in rclpy and as asyncio requires, so a task cannot tell from
    the yielded value which future it waits for.
    """

    future: Future[Any] | None = None


_awaiting = _Awaiting()


class _UnretrievedException:
    """Prints an exception that was never retrieved when its future is deleted, as in rclpy."""

    def __init__(self, exception: BaseException) -> None:
        self.exception = exception
        self.is_retrieved = False

    def __del__(self) -> None:
        if not self.is_retrieved:
            sys.stderr.write(f"The following exception was never retrieved: {self.exception}\n")


class Future(Generic[T]):
    """A result that becomes available later. Coroutines can await it, even in asyncio.

    Args:
        executor: Runs the done-callbacks. Without one, they are called where the result is set.
    """

    def __init__(self, *, executor: TaskRunner | None = None) -> None:
        self._state = FutureState.PENDING
        self._result: T | None = None
        self._exception: BaseException | None = None
        # Describes why the future is not done, for a program that polls it until the run ends.
        self._course_unmet: Callable[[], str] | None = None
        self._exception_fetched: _UnretrievedException | None = None
        self._callbacks: list[Callable[[Future[T]], object]] = []
        self._executor: weakref.ref[TaskRunner] | None = None if executor is None else weakref.ref(executor)

    def __class_getitem__(cls, parameters: object) -> NoReturn:
        # For type checkers only: in Jazzy's rclpy the class is not generic.
        raise TypeError(f"type '{cls.__name__}' is not subscriptable")

    def __await__(self) -> Generator[None, None, T | None]:
        while self._state is FutureState.PENDING:
            _awaiting.future = self
            time_lock.set_unmet(self._course_unmet)
            yield
        return self.result()

    def done(self) -> bool:
        """Return whether a result or an exception is set.

        A program that polls it in a loop lets time advance.
        """
        if self._state is not FutureState.FINISHED:
            time_lock.poll(self._course_unmet)
        return self._state is FutureState.FINISHED

    def _pending(self) -> bool:
        """Return whether it is neither done nor cancelled.

        Unlike `done`, it does not let time advance.
        """
        return self._state is FutureState.PENDING

    def result(self) -> T | None:
        """Return the result, or None if it is not set yet. Raise the exception if one was set."""
        error = self.exception()
        if error is not None:
            raise error
        return self._result

    def exception(self) -> BaseException | None:
        """Return the exception if one was set, else None."""
        if self._exception_fetched is not None:
            self._exception_fetched.is_retrieved = True
        return self._exception

    def cancelled(self) -> bool:
        """Return whether the future was cancelled.

        A program that polls it in a loop lets time advance.
        """
        if self._state is FutureState.PENDING:
            time_lock.poll()
        return self._state is FutureState.CANCELLED

    def cancel(self) -> None:
        """Cancel the future unless it is done, and call the done-callbacks."""
        if self._state is FutureState.PENDING:
            self._state = FutureState.CANCELLED
            self._schedule_or_invoke_done_callbacks()

    def set_result(self, result: T) -> None:
        """Set the result and call the done-callbacks."""
        self._result = result
        self._state = FutureState.FINISHED
        if self._callbacks:
            self._schedule_or_invoke_done_callbacks()

    def set_exception(self, exception: BaseException) -> None:
        """Set an exception instead of the result and call the done-callbacks."""
        self._exception = exception
        self._exception_fetched = _UnretrievedException(exception)
        self._state = FutureState.FINISHED
        self._schedule_or_invoke_done_callbacks()

    def add_done_callback(self, callback: Callable[[Future[T]], object]) -> None:
        """Call `callback(future)` when the future is or becomes done or cancelled."""
        if self._state is FutureState.PENDING:
            self._callbacks.append(callback)
            return
        executor = self._executor() if self._executor else None
        if executor is not None:
            executor.create_task(callback, self)
        else:
            callback(self)

    def remove_done_callback(self, callback: Callable[[Future[T]], object]) -> bool:
        """Remove a callback. Return whether it had been added."""
        if callback not in self._callbacks:
            return False
        self._callbacks.remove(callback)
        return True

    def _set_executor(self, executor: TaskRunner | None) -> None:
        self._executor = None if executor is None else weakref.ref(executor)

    def _schedule_or_invoke_done_callbacks(self) -> None:
        callbacks, self._callbacks = self._callbacks, []
        executor = self._executor() if self._executor else None
        for callback in callbacks:
            if executor is not None:
                executor.create_task(callback, self)
                continue
            try:
                callback(self)
            # An error in one callback must not prevent the others from being called.
            except Exception as error:
                warnings.warn(f"Unhandled exception in done callback: {error}", stacklevel=3)


if TYPE_CHECKING:
    _AnyFuture = Future[Any]
else:
    _AnyFuture = Future


class Task(_AnyFuture):
    """A function or coroutine that an executor runs, from `Executor.create_task`, and its result."""

    def __init__(
        self,
        handler: Any,
        args: tuple[Any, ...] | None = None,
        kwargs: dict[str, Any] | None = None,
        executor: TaskRunner | None = None,
    ) -> None:
        super().__init__(executor=executor)
        args = args or ()
        self._handler: Any = handler
        if inspect.iscoroutinefunction(handler):
            self._handler = handler(*args, **(kwargs or {}))
        elif not inspect.iscoroutine(handler):
            self._handler = partial(_call, handler, args, kwargs or {})
        self._course_awaited: Future[Any] | None = None
        # The position among the tasks of its executor, sorted by creation.
        self._course_number = next(order)
        self._executing = False

    def __call__(self) -> None:
        """Run the function, or run the coroutine until it has to wait."""
        if self._state is not FutureState.PENDING or self._executing:
            return
        self._executing = True
        try:
            if isinstance(self._handler, partial):
                try:
                    self.set_result(self._handler())
                # The function itself raised it: here it does not mark the end of a coroutine.
                except StopIteration as error:
                    self.set_exception(error)
            else:
                _awaiting.future = None
                self._handler.send(None)
                self._course_awaited = _awaiting.future
                if self._course_awaited is None:
                    # The task awaits something other than an rclpy future. The executor polls such
                    # a task repeatedly, so robot time must be able to advance.
                    time_lock.poll()
        except StopIteration as end:
            self.set_result(end.value)
        # `result` raises the error later.
        except Exception as error:
            self.set_exception(error)
        finally:
            self._executing = False

    def executing(self) -> bool:
        """Return whether the task is running at this moment."""
        return self._executing

    def cancel(self) -> None:
        """Cancel the task, so that it does not run or continue."""
        if self._pending() and inspect.iscoroutine(self._handler):
            self._handler.close()
        super().cancel()

    def _course_can_go_on(self) -> bool:
        """Return whether the task has not started, or the future that it awaits is done."""
        if self._state is not FutureState.PENDING or self._executing:
            return False
        return self._course_awaited is None or not self._course_awaited._pending()


def _call(function: Callable[..., Any], args: tuple[Any, ...], kwargs: dict[str, Any]) -> Any:
    """Call a function.

    An error of the call itself, such as wrong arguments, belongs to the task, as in rclpy.
    """
    return function(*args, **kwargs)
