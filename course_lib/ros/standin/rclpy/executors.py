"""Executors: the order of callbacks, waiting and spinning, in programs and notebook cells."""

from __future__ import annotations

import os
import threading
import time
import warnings
from collections import deque
from collections.abc import Callable, Coroutine, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass, field
from inspect import iscoroutine
from typing import Any

from course_lib.ros.graph.graph import Graph, current_graph
from course_lib.ros.mistakes import Mistake, mark, marked
from course_lib.ros.notices import print_notice
from course_lib.ros.time import pace
from course_lib.ros.time.interrupts import until_interrupted, watch
from course_lib.ros.time.time_lock import EndBehavior, ShutDown, never, time_lock
from course_lib.ros.tracebacks import describe_interruption, explain_interrupts, line_of_traceback
from rclpy.context import Context, Contexts, get_default_context, require_context
from rclpy.exceptions import InvalidHandle, NotInitializedException
from rclpy.impl import private_names
from rclpy.impl.implementation_singleton import INVALID_CONTEXT, RCLError
from rclpy.impl.node_handle import Entity, HandledNode, NodeHandle, Turn
from rclpy.task import Future, Task, TaskRunner, order
from rclpy.task import await_or_execute as await_or_execute
from rclpy.utilities import timeout_sec_to_nsec

FOR_EVER_NS = 2**62  # [ns]
# A callback that has not returned after this time is reported when the run ends, [ns].
_LONG_NS = 10**9
_LONG_CALLBACK = (
    "this callback has not returned, and no other callback of the program runs until it does. "
    "Return from it, and continue in a later call."
)
_NESTED_SPIN_ONCE = (
    "a callback that spins waits for another callback, which may never run. Leave this call out: "
    "the spin that called this callback runs the others, too."
)
_NESTED_SPIN = (
    "it waited inside of a callback, until whose end the other callbacks of its group do not run. "
    "Use future.add_done_callback(f), or write async def and await future."
)
_ONE_THREAD = "MultiThreadedExecutor is used with a single thread.\nUse the SingleThreadedExecutor instead."


class TimeoutException(Exception):  # noqa: N818 - the name is ROS's
    """No callback became ready before the timeout."""


class ExternalShutdownException(ShutDown):
    """The context was shut down while an executor waited."""


class ShutdownException(Exception):  # noqa: N818 - the name is ROS's
    """An executor was shut down while it was waiting."""


class ConditionReachedException(Exception):  # noqa: N818 - the name is ROS's
    """The awaited condition became true before a callback was ready."""


class CallbackTask(Task):
    """A task that runs the callback of a ready entity.

    One is created for each callback, so it skips the inspection that `Task` does for arbitrary
    functions.
    """

    def __init__(
        self,
        turn: Turn,
        call: Callable[[], object],
        graph: Graph,
        executor: TaskRunner,
    ) -> None:
        Future.__init__(self, executor=executor)
        self.entity = turn.entity
        self._handler, self._course_awaited, self._executing = _run_callback(turn, call, graph), None, False
        self._course_number = next(order)


async def _run_callback(turn: Turn, call: Callable[[], object], graph: Graph) -> None:
    entity, start_ns = turn.entity, graph.now_ns
    # CPU time is measured for listeners only, because reading it takes a microsecond.
    start = time.thread_time() if graph.callback_listeners else 0.0
    try:
        result = call()
        if iscoroutine(result):
            await result
    except TypeError as error:
        if entity._course_mistake is not None:
            mark(error, entity._course_mistake, depth=1)
        raise
    finally:
        entity.callback_group.ending_execution(entity)
        if graph.now_ns > start_ns and graph.notebook:
            entity._course_record_time_taken(graph.now_ns - start_ns)
        for listener in graph.callback_listeners:
            listener(entity, turn.since_ns, start_ns, time.thread_time() - start)


@dataclass(frozen=True)
class _Completion:
    """The condition that a future is done or cancelled. Equal for equal futures."""

    future: Future[Any]

    def __call__(self) -> bool:
        return not self.future._pending()


@dataclass(eq=False, repr=False)
class _Waits:
    """Waits with equal arguments.

    In rclpy they share a generator, which only one thread can run at a time.
    """

    arguments: tuple[int, Callable[[], bool]]
    is_running: bool = False


@dataclass
class RunningNodes:
    """The nodes that run in each waiting call of a notebook: live nodes and the kit's own."""

    nodes: list[HandledNode] = field(default_factory=list)


class Executor(AbstractContextManager["Executor"]):
    """Base class of executors.

    Runs the callbacks of its nodes in the order in which they became ready.
    """

    def __init__(self, *, context: Context | None = None) -> None:
        context = get_default_context() if context is None else context
        require_context(context, "handle")
        # The executor stops when this context is shut down.
        self._context = context
        if not self.context.is_initialized:
            error = NotInitializedException("cannot create executor")
            was_shut_down = current_graph().state(Contexts).initialized
            raise marked(error, Mistake.SHUT_DOWN) if was_shut_down else error
        if not self.context.is_valid:
            raise RCLError(f"failed to create guard_condition: {INVALID_CONTEXT}")
        # A dict keeps the order in which the nodes were added.
        self._nodes: dict[HandledNode, NodeHandle] = {}
        # Objects that are not nodes.
        self.__others: list[Any] = []
        self._tasks: list[Task] = []
        # Entities and tasks that a call with a timeout of 0 has found ready, for the following
        # calls.
        self.__polled: deque[Task | Turn] | None = None
        # The waits with the arguments of the latest call.
        self.__waits = _Waits((-1, never))
        # The tasks of the present round that have not had their turn; None before a round. After
        # a round, the callbacks run that became ready before this number.
        self.__round: list[Task] | None = None
        self.__round_end = 0
        # The task that each thread runs, by thread identifier.
        self.__under_way: dict[int, Task] = {}
        self._course_threads = 1
        self._is_shutdown = False
        # Description of the awaited condition for a DeadlockError.
        self.__awaited = "a callback of no node"

    def __init_subclass__(cls, **kwargs: Any) -> None:
        """Report attributes of a student's class whose names are private in rclpy."""
        super().__init_subclass__(**kwargs)
        private_names.check_class("Executor", cls, private_names.OF_EXECUTORS)

    @property
    def context(self) -> Context:
        """The context whose shutdown ends the executor."""
        return self._context

    @property
    def __is_running(self) -> bool:
        """True if neither the executor nor its context has been shut down."""
        return self.context.is_valid and not self._is_shutdown

    def create_task(
        self, callback: Callable[..., Any] | Coroutine[Any, Any, Any], *args: Any, **kwargs: Any
    ) -> Task:
        """Schedule a function or a coroutine. Return its future."""
        task = Task(callback, args, kwargs, executor=self)
        self.__require_guard()
        self._tasks.append(task)
        return task

    def add_node(self, node: HandledNode) -> bool:
        """Run a node's callbacks from now on. Return False if the executor does so already."""
        if node in self._nodes:
            return False
        if not isinstance(getattr(node, "handle", None), NodeHandle):
            self.__others.append(node)
            if not isinstance(node, type):
                # Python's error for most objects that are not nodes, or were not initialized.
                setattr(node, "executor", self)  # noqa: B010
            return True
        self.__require_guard()
        if node.handle.has_left:
            print_notice(
                f"hint: {node.handle.full_name} is spun and does nothing: it was destroyed, replaced by a "
                "newer node of its name, or created before rclpy.shutdown(). Create it again."
            )
        self._nodes[node] = node.handle
        self.__name_nodes()
        node.handle.graph.show_node(node.handle.id)
        former, node.handle.executor = node.handle.executor, self
        if former is not None and former is not self:
            former.remove_node(node)
        return True

    def __require_guard(self) -> None:
        """Raise rclpy's error if the executor was shut down, which destroys its guard condition."""
        if self._is_shutdown:
            raise AttributeError("'NoneType' object has no attribute 'trigger'")

    def can_execute(self, entity: Entity) -> bool:
        """Return whether the entity's callback may run now."""
        if not isinstance(entity, Entity):
            raise AttributeError(f"'{type(entity).__name__}' object has no attribute '_executor_event'")
        return entity.callback_group.can_execute(entity)

    def remove_node(self, node: HandledNode) -> None:
        """Stop running a node's callbacks.

        Its ready entities remain ready, for another executor.
        """
        self._nodes.pop(node, None)
        self.__others = [other for other in self.__others if other is not node]
        self.__name_nodes()

    def get_nodes(self) -> list[HandledNode]:
        """List the nodes."""
        return list(self._nodes)

    def wake(self) -> None:
        """Do nothing. A wait checks all entities again after each event anyway."""

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Stop running callbacks.

        Return whether all of them have ended within `timeout_sec` [s].
        """
        self._is_shutdown = True
        self._nodes.clear()
        return True

    def spin(self) -> None:
        """Run callbacks until shutdown or the end of the run; in a cell, until ■ is pressed.

        A callback that spins its own executor gets Python's ValueError, as in rclpy, where spinning
        runs a generator.
        """
        if self._course_threads == 1 and threading.get_ident() in self.__under_way:
            raise ValueError("generator already executing")
        if self.context.graph.notebook and threading.current_thread() is threading.main_thread():
            self.__spin_cell()
            return
        with time_lock.hold():
            while self.__is_running and self.context.ok():
                self.spin_once()

    def __spin_cell(self) -> None:
        """Run until ■ is pressed.

        Without a viewer page, stop after a fixed time and print a notice.
        """
        graph, limit_ns = current_graph(), FOR_EVER_NS
        if pace.mode() == "fast":
            limit_ns = graph.now_ns + round(pace.SECONDS_WITHOUT_A_PAGE * 1e9)
        with until_interrupted(), self._course_with_live_nodes():
            self._course_spin_until(limit_ns, lambda: not self.__is_running)
        if graph.now_ns == limit_ns:
            print_notice(
                f"No page is watching: spin() stopped after {pace.SECONDS_WITHOUT_A_PAGE:g} s of robot time."
            )

    def _course_spin_until(
        self,
        until_ns: int | None,
        ready: Callable[[], bool] = lambda: False,
    ) -> None:
        """Run callbacks until `ready()` or robot time is `until_ns`, including events at that time.

        A callback that takes robot time may end later. No callback is started after that.
        """
        graph = current_graph()
        self.__require_entities()
        while not ready() and (until_ns is None or graph.now_ns <= until_ns):
            if not time_lock.wait(
                lambda: self._course_can_work() or ready(),
                until_ns=until_ns,
                awaited="a timer or a message",
            ):
                return
            self._spin_once_impl(0, never)

    @contextmanager
    def _course_joined_by(self, nodes: Sequence[HandledNode]) -> Iterator[None]:
        """Run the callbacks of further nodes during the block, in a program thread.

        A live node that a newer node of its name has replaced is skipped: its run ends by itself,
        so the hint of `add_node` is not for it.
        """
        with time_lock.hold():
            live = self.context.graph.state(RunningNodes).nodes
            still_here = [node for node in nodes if not (node in live and node.handle.has_left)]
            new_nodes = [node for node in still_here if self.add_node(node)]
            try:
                yield
            finally:
                for node in new_nodes:
                    self.remove_node(node)

    @contextmanager
    def _course_with_live_nodes(self) -> Iterator[None]:
        """Also run the live nodes during the block, at the selected pace."""
        running = current_graph().state(RunningNodes).nodes
        with self._course_joined_by(running), pace.keep_pace(self.context.graph):
            yield

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Run one callback.

        Wait at most `timeout_sec` [s] for it, without limit if it is None or negative.
        """
        if timeout_sec == 0:
            time_lock.poll()
            with time_lock.hold():
                self.__round = None
                task = self.__poll()
                if task is not None:
                    self._course_execute(task)
            return
        self.__polled = None
        limit_ns = timeout_sec_to_nsec(timeout_sec)
        if limit_ns != self.__waits.arguments[0]:
            # As in rclpy, which creates a new generator for other arguments.
            self.__round = None
        with self.__explain_in_callback(limit_ns, _NESTED_SPIN_ONCE):
            self._spin_once_impl(limit_ns, never)

    def __explain_in_callback(self, limit_ns: int, reason: str) -> AbstractContextManager[None]:
        """Return a context that explains an interrupted endless wait if a callback waits."""
        is_nested = limit_ns < 0 and threading.get_ident() in self.__under_way
        return explain_interrupts(lambda: reason if is_nested else "")

    def __poll(self) -> Task | None:
        """Return the next task without waiting, as rclpy's generator does with a timeout of 0.

        It collects all ready entities and yields them call by call. The call after the last one
        reaches the generator's end and runs nothing, so a program that polls receives one message
        with every second call.
        """
        if self._is_shutdown:
            return None
        self._course_raise_failed()
        self.__require_context(0)
        if self.__polled is None:
            self.__polled = self.__ready_now()
            if not self.__polled:
                self.__polled = None
                return None
        while self.__polled:
            ready = self.__polled.popleft()
            if isinstance(ready, Task):
                if ready in self._tasks and ready._course_can_go_on():
                    self._tasks.remove(ready)
                    return ready
                continue
            can_run = ready.entity.callback_group.can_execute(ready.entity)
            task = self.__take(ready) if can_run else None
            if task is not None:
                return task
        self.__polled = None
        return None

    def __ready_now(self) -> deque[Task | Turn]:
        """List the tasks, and the first turn of each ready entity."""
        turns: dict[Entity, Turn] = {}
        for handle in self._nodes.values():
            for turn in handle.turns():
                turns.setdefault(turn.entity, turn)
        can_run = [turn for turn in turns.values() if turn.entity.callback_group.can_execute(turn.entity)]
        return deque([*reversed(self.__tasks_in_order()), *sorted(can_run)])

    def spin_until_future_complete(
        self,
        future: Future[Any],
        timeout_sec: float | None = None,
    ) -> None:
        """Run callbacks until a future is done or `timeout_sec` [s] have passed."""
        if not hasattr(future, "add_done_callback"):
            raise AttributeError(f"'{type(future).__name__}' object has no attribute 'add_done_callback'")
        graph, limit_ns = self.context.graph, timeout_sec_to_nsec(timeout_sec)
        end_ns = None if limit_ns < 0 else graph.now_ns + limit_ns
        is_over = _Completion(future)
        with self.__explain_in_callback(limit_ns, _NESTED_SPIN), time_lock.hold():
            self.__round = None
            while self.__is_running and self.context.ok() and future._pending():
                self._spin_once_impl(-1 if end_ns is None else end_ns - graph.now_ns, is_over)
                if end_ns is not None and graph.now_ns >= end_ns:
                    return
            self._course_raise_failed()

    def spin_once_until_future_complete(
        self,
        future: Future[Any],
        timeout_sec: float | None = None,
    ) -> None:
        """Wait for a callback and run it, unless the future is done first."""
        self._spin_once_impl(timeout_sec_to_nsec(timeout_sec), _Completion(future))

    def _spin_once_impl(self, limit_ns: int, condition: Callable[[], bool]) -> None:
        with time_lock.hold():
            task = self.__wait_for_task(limit_ns, condition)
            if task is not None:
                self._course_execute(task)

    def __wait_for_task(self, limit_ns: int, condition: Callable[[], bool]) -> Task | None:
        context, can_work, has_condition = self.context, self._course_can_work, condition is not never

        def stops() -> bool:
            return self._is_shutdown or context.is_shut_down or (has_condition and condition())

        def is_over() -> bool:
            return can_work() or stops()

        if not self._is_shutdown and not condition():
            self.__require_context(limit_ns)
        until_ns = None if limit_ns < 0 else context.graph.now_ns + limit_ns
        waits = self.__enter_waits(limit_ns, condition)
        try:
            while not stops():
                task = self._course_next_task()
                if task is not None or limit_ns == 0:
                    return task
                if not time_lock.wait(is_over, until_ns=until_ns, awaited=self.__awaited):
                    self.__round = None
                    break
        finally:
            waits.is_running = False
        over = not self.context.is_valid or time_lock.is_shut_down()
        if over and not self._is_shutdown and not condition():
            raise ExternalShutdownException
        return None

    def __enter_waits(self, limit_ns: int, condition: Callable[[], bool]) -> _Waits:
        """Begin a wait.

        As in rclpy, it raises if the latest wait had the same arguments and another thread is still
        waiting in it.
        """
        arguments = (limit_ns, condition)
        if self.__waits.arguments != arguments:
            self.__waits = _Waits(arguments)
        elif self.__waits.is_running:
            raise marked(ValueError("generator already executing"), Mistake.TWO_SPINNERS)
        self.__waits.is_running = True
        return self.__waits

    def __require_context(self, limit_ns: int) -> None:
        """Raise rclpy's error for starting to wait in a context that was shut down."""
        if not self.context.is_valid:
            operation = "create timer" if limit_ns > 0 else "initialize wait set"
            raise RCLError(f"failed to {operation}: {INVALID_CONTEXT}")
        self.__require_entities()

    def __require_entities(self) -> None:
        """Raise rclpy's errors for an object that is not a node, or a destroyed endpoint."""
        for other in self.__others:
            iter(other.subscriptions)
        for handle in self._nodes.values():
            if handle.destroyed_ends:
                raise marked(InvalidHandle(), Mistake.ONLY_DESTROYED)

    def wait_for_ready_callbacks(
        self,
        timeout_sec: float | None = None,
        nodes: Sequence[HandledNode] | None = None,
        condition: Callable[[], bool] = lambda: False,
    ) -> tuple[Task, Entity | None, HandledNode | None]:
        """Wait for a callback, at most `timeout_sec` [s], and return (task, entity, node).

        The caller runs the task, which is lost otherwise. Without a callback it raises
        TimeoutException, ShutdownException, ConditionReachedException or
        ExternalShutdownException, as rclpy does.
        """
        with time_lock.hold():
            task = self.__wait_for_task(timeout_sec_to_nsec(timeout_sec), condition)
        if task is None and condition():
            raise ConditionReachedException
        if task is None:
            raise ShutdownException if self._is_shutdown else TimeoutException
        entity = task.entity if isinstance(task, CallbackTask) else None
        owners = [node for node in self._nodes if entity is not None and node.handle is entity._course_node]
        return task, entity, owners[0] if owners else None

    def _course_raise_failed(self) -> None:
        """Raise the error of a callback that ran in its own thread.

        This executor has no such threads.
        """

    def _course_can_work(self) -> bool:
        """Return whether a callback is ready to run."""
        if self._tasks and any(task._course_can_go_on() for task in self._tasks):
            return True
        # any() would take twice the time.
        for handle in self._nodes.values():  # noqa: SIM110
            if handle.first_ready() is not None:
                return True
        return False

    def __name_nodes(self) -> None:
        """Update the description of a wait for a DeadlockError.

        It is built here because waits are frequent.
        """
        names = ", ".join(handle.full_name for handle in self._nodes.values())
        self.__awaited = f"a callback of {names or 'no node'}"

    def _course_holds_up(self, entity: Entity) -> bool:
        """Return whether an entity's callback cannot run before the calling callback has ended."""
        task = self.__under_way.get(threading.get_ident())
        if task is None or self._course_threads == 1:
            return task is not None
        group = entity.callback_group
        same_group = isinstance(task, CallbackTask) and task.entity.callback_group is group
        return same_group and not group.can_execute(entity)

    def _course_runs(self, node: NodeHandle) -> bool:
        """Return whether a thread runs the callbacks of a node at this moment."""
        is_spun = self.__waits.is_running or bool(self.__under_way) or self.context.graph.notebook
        return is_spun and node in self._nodes.values()

    def _course_next_task(self) -> Task | None:
        """Remove and return the next task.

        As in rclpy, all tasks have a turn, the latest first. Then the callbacks run that were ready
        at the end of this round, in the order in which they became ready, before the next round
        begins. So a coroutine that polls, `while not ready: await asyncio.sleep(0)`, does not
        prevent them.
        """
        if not self._tasks:
            callback = self.__next_callback()
            self.__round, self.__round_end = None if callback is None else [], next(order)
            return callback
        for _ in range(2):
            if self.__round is None:
                self.__round, self.__round_end = self.__tasks_in_order(), 0
            while self.__round:
                task = self.__round.pop()
                if task in self._tasks and task._course_can_go_on():
                    self._tasks.remove(task)
                    return task
            self.__round_end = self.__round_end or next(order)
            callback = self.__next_callback(self.__round_end)
            if callback is not None:
                return callback
            self.__round = None
        return None

    def __tasks_in_order(self) -> list[Task]:
        """List the tasks, sorted by creation.

        A task that waits now may continue after an earlier one of the list.
        """
        return sorted(self._tasks, key=lambda task: task._course_number)

    def __next_callback(self, end: int | None = None) -> Task | None:
        """Return the task for the callback that became ready first, before the number `end`."""
        while True:
            first: Turn | None = None
            for handle in self._nodes.values():
                turn = handle.first_ready()
                if turn is not None and (first is None or turn.order < first.order):
                    first = turn
            if first is None or (end is not None and first.order >= end):
                return None
            task = self.__take(first)
            if task is not None:
                return task

    def __take(self, turn: Turn) -> Task | None:
        """Return the task for an entity's turn, or None if the event is no longer valid."""
        call = turn.entity._course_node.take(turn)
        if call is None:
            return None
        turn.entity.callback_group.beginning_execution(turn.entity)
        return CallbackTask(turn, call, self.context.graph, self)

    def _course_execute(self, task: Task) -> None:
        """Run a task and raise its error. A waiting task remains scheduled."""
        ident = threading.get_ident()
        outer = self.__under_way.get(ident)
        self.__under_way[ident] = task
        outer_callback = watch.running_callback
        if self.context.graph.notebook and isinstance(task, CallbackTask):
            watch.begin(task.entity._course_node.full_name)
        start_ns = self.context.graph.now_ns
        try:
            task()
        except KeyboardInterrupt as interrupt:
            span_ns = self.context.graph.now_ns - start_ns
            if isinstance(task, CallbackTask) and self._course_threads == 1 and span_ns >= _LONG_NS:
                describe_interruption(_LONG_CALLBACK, line_of_traceback(interrupt.__traceback__))
            raise
        finally:
            watch.running_callback = outer_callback
            if outer is None:
                del self.__under_way[ident]
            else:
                self.__under_way[ident] = outer
        if task._pending():
            self._tasks.append(task)
        error = task.exception()
        if error is not None:
            raise error

    def __enter__(self) -> Executor:
        return self

    def __exit__(self, *_: object) -> None:
        self.shutdown()


private_names.watch_names("Executor", Executor, private_names.OF_EXECUTORS, {})


class SingleThreadedExecutor(Executor):
    """Runs callbacks one after the other, in the thread that spins."""

    def __init__(self, *, context: Context | None = None) -> None:
        super().__init__(context=context)


class MultiThreadedExecutor(Executor):
    """Runs each callback in its own thread, at most `num_threads` (default: CPUs) at a time.

    A callback that waits does not block the others.
    """

    def __init__(self, num_threads: int | None = None, *, context: Context | None = None) -> None:
        super().__init__(context=context)
        if num_threads == 1:
            warnings.warn(_ONE_THREAD, stacklevel=2)
        if num_threads is not None and num_threads <= 0:
            raise ValueError("max_workers must be greater than 0")
        self._course_threads = num_threads or os.cpu_count() or 2
        self.__running = 0
        self.__failed: list[BaseException] = []

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Start no more callbacks.

        Return whether the running ones have ended within `timeout_sec` [s].
        """
        super().shutdown(timeout_sec)
        limit_ns = timeout_sec_to_nsec(timeout_sec)
        until_ns = None if limit_ns < 0 else self.context.graph.now_ns + limit_ns
        with time_lock.hold():
            return time_lock.wait(
                lambda: not self.__running, until_ns=until_ns, awaited="callbacks under way"
            )

    def _spin_once_impl(self, limit_ns: int, condition: Callable[[], bool]) -> None:
        # As in rclpy, where only the other executor raises it.
        with suppress(ExternalShutdownException):
            super()._spin_once_impl(limit_ns, condition)

    def _course_can_work(self) -> bool:
        """Return whether a callback is ready to be run and a thread is free for it."""
        return bool(self.__failed) or (self.__running < self._course_threads and super()._course_can_work())

    def _course_raise_failed(self) -> None:
        if self.__failed:
            raise self.__failed.pop(0)

    def _course_next_task(self) -> Task | None:
        self._course_raise_failed()
        return super()._course_next_task() if self.__running < self._course_threads else None

    def _course_execute(self, task: Task) -> None:
        self.__running += 1
        threading.Thread(target=self.__work, args=(task,), name="callback", daemon=True).start()

    def __work(self, task: Task) -> None:
        with time_lock.hold(), time_lock.at_end(EndBehavior.STOP):
            try:
                super()._course_execute(task)
            # The spinning thread raises the exception later.
            except Exception as error:
                self.__failed.append(error)
            finally:
                self.__running -= 1


class TimeoutObject:
    """A timeout that several waits share."""

    def __init__(self, timeout: float) -> None:
        self.timeout = timeout


@dataclass
class _Global:
    """The executor that `spin` uses if none is passed."""

    executor: Executor | None = None


def get_global_executor() -> Executor:
    """Return the executor that `spin` uses if none is passed."""
    holder = current_graph().state(_Global)
    if holder.executor is None or (not holder.executor.context.is_valid and get_default_context().is_valid):
        holder.executor = SingleThreadedExecutor()
        holder.executor.context.on_shutdown(_drop_global_executor)
    return holder.executor


def _drop_global_executor() -> None:
    holder = current_graph().state(_Global)
    if holder.executor is not None:
        holder.executor.shutdown()
        holder.executor = None


def wait_driving_live_nodes(ready: Callable[[], bool], *, seconds: float | None) -> bool:
    """Run the notebook's live nodes until `ready()`, at most `seconds` of robot time.

    Return `ready()`.
    """
    graph = current_graph()
    until_ns = None if seconds is None else graph.now_ns + round(seconds * 1e9)
    executor = get_global_executor()
    with executor._course_joined_by(graph.state(RunningNodes).nodes), pace.keep_pace(graph):
        executor._course_spin_until(until_ns, ready)
    return ready()


def wait_until(
    node: NodeHandle,
    ready: Callable[[], bool],
    timeout_sec: float | None,
    awaited: str,
) -> None:
    """Wait until `ready()`, at most `timeout_sec` [s].

    In a notebook, live nodes run during the wait.
    """
    if current_graph().state(RunningNodes).nodes and threading.current_thread() is threading.main_thread():
        wait_driving_live_nodes(ready, seconds=timeout_sec)
        return
    until_ns = None if timeout_sec is None else node.graph.now_ns + round(timeout_sec * 1e9)
    with time_lock.hold():
        time_lock.wait(ready, until_ns=until_ns, awaited=awaited)
