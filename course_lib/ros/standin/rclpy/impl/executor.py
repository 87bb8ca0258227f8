"""The base of executors: the order of callbacks, waiting, and spinning, also in a notebook's cell."""

import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field
from typing import Any

from course_lib.ros import pace
from course_lib.ros.baton import baton
from course_lib.ros.graph import current_graph
from course_lib.ros.interrupts import until_interrupted, watch
from course_lib.ros.notices import say
from rclpy.context import Context, get_default_context
from rclpy.exceptions import (
    ConditionReachedException,
    ExternalShutdownException,
    NotInitializedException,
    ShutdownException,
    TimeoutException,
)
from rclpy.impl.callback import CallbackTask
from rclpy.impl.node_handle import Entity, HandledNode, NodeHandle, Turn
from rclpy.task import Future, Task
from rclpy.utilities import timeout_sec_to_nsec

FOR_EVER_NS = 2**62  # [ns]


@dataclass
class RunningNodes:
    """The nodes that run in every call of a notebook that waits: live ones and the kit's own."""

    nodes: list[HandledNode] = field(default_factory=list)


class Executor(AbstractContextManager["Executor"]):
    """The base of executors: takes its nodes' callbacks in the order in which they became ready."""

    def __init__(self, *, context: Context | None = None) -> None:
        self.context = context or get_default_context()  # whose shutdown ends it
        if not self.context.is_valid:
            raise NotInitializedException("cannot create executor")
        self._nodes: dict[HandledNode, NodeHandle] = {}  # in the order of their coming
        self._tasks: list[Task] = []
        self._under_way: dict[int, Task] = {}  # by thread identifier
        self._num_threads = 1
        self._is_shutdown = False
        self._what = "a callback of no node"  # it waits for

    @property
    def is_running(self) -> bool:
        """True if neither it nor its context has been shut down."""
        return self.context.is_valid and not self._is_shutdown

    def create_task(self, callback: Callable[..., Any], *args: Any, **kwargs: Any) -> Task:
        """Run a function or a coroutine soon; returns its future."""
        task = Task(callback, args, kwargs, executor=self)
        self._tasks.append(task)
        return task

    def add_node(self, node: HandledNode) -> bool:
        """Run a node's callbacks from now on; False if it does already."""
        if node in self._nodes:
            return False
        self._nodes[node] = node.handle
        self._name_nodes()
        node.handle.graph.wake(node.handle.id)
        former, node.handle.executor = node.handle.executor, self
        if former is not None and former is not self:
            former.remove_node(node)
        return True

    def remove_node(self, node: HandledNode) -> None:
        """Stop running a node's callbacks; entities that are ready wait for another executor."""
        self._nodes.pop(node, None)
        self._name_nodes()

    def get_nodes(self) -> list[HandledNode]:
        """List the nodes."""
        return list(self._nodes)

    def wake(self) -> None:
        """Do nothing: each wait looks at everything again whenever something has happened."""

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Stop running callbacks; returns whether all of them have ended within the time."""
        self._is_shutdown = True
        self._nodes.clear()
        return True

    def spin(self) -> None:
        """Run callbacks until the shutdown or the end of the run; in a notebook's cell until ■.

        A callback that spins its own executor gets Python's ValueError, as in rclpy, where it is a generator.
        """
        if self._num_threads == 1 and threading.get_ident() in self._under_way:
            raise ValueError("generator already executing")
        if self.context.graph.notebook and threading.current_thread() is threading.main_thread():
            self._spin_cell()
            return
        with baton.known():
            while self.is_running and self.context.ok():
                self.spin_once()

    def _spin_cell(self) -> None:
        """Run until ■; without a page stop after a while and print that."""
        graph, limit_ns = current_graph(), FOR_EVER_NS
        if pace.wanted() == "fast":
            limit_ns = graph.now_ns + round(pace.SECONDS_WITHOUT_A_PAGE * 1e9)
        with until_interrupted(), self.beside_live():
            self.spin_until(limit_ns, lambda: not self.is_running)
        if graph.now_ns == limit_ns:
            say(f"No page is watching: spin() stopped after {pace.SECONDS_WITHOUT_A_PAGE:g} s of robot time.")

    def spin_until(self, until_ns: int | None, ready: Callable[[], bool] = lambda: False) -> None:
        """Run callbacks until `ready()` or robot time `until_ns`, events due then included.

        Callbacks that take robot time may end later; then none is begun any more.
        """
        graph = current_graph()

        def something_to_do() -> bool:
            return self.can_work() or ready()

        while not ready() and (until_ns is None or graph.now_ns <= until_ns):
            if not baton.wait(something_to_do, until_ns=until_ns, what="a timer or a message"):
                return
            self._spin_once(0, lambda: False)

    @contextmanager
    def joined_by(self, nodes: Sequence[HandledNode]) -> Iterator[None]:
        """Run the callbacks of further nodes for a while, in a thread that belongs to the program."""
        with baton.known():
            added = [node for node in nodes if self.add_node(node)]
            try:
                yield
            finally:
                for node in added:
                    self.remove_node(node)

    @contextmanager
    def beside_live(self) -> Iterator[None]:
        """Run the live nodes as well, at the wanted pace, for the length of a `with` block."""
        running = current_graph().part(RunningNodes).nodes
        with self.joined_by(running), pace.kept(self.context.graph):
            yield

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Run one callback; wait for it at most so long [s], without limit if that is None or negative."""
        if timeout_sec == 0:
            baton.poll()
        self._spin_once(timeout_sec_to_nsec(timeout_sec), lambda: False)

    def spin_until_future_complete(self, future: Future[Any], timeout_sec: float | None = None) -> None:
        """Run callbacks until a future is done, or the time [s] is over."""
        graph, limit_ns = self.context.graph, timeout_sec_to_nsec(timeout_sec)
        end_ns = None if limit_ns < 0 else graph.now_ns + limit_ns
        with baton.known():
            while self.is_running and self.context.ok() and not future.arrived():
                self._spin_once(-1 if end_ns is None else end_ns - graph.now_ns, future.arrived)
                if end_ns is not None and graph.now_ns >= end_ns:
                    return

    def spin_once_until_future_complete(self, future: Future[Any], timeout_sec: float | None = None) -> None:
        """Wait for a callback and run it, unless the future is done before."""
        self._spin_once(timeout_sec_to_nsec(timeout_sec), future.arrived)

    def _spin_once(self, limit_ns: int, condition: Callable[[], bool]) -> None:
        with baton.known():
            task = self._wait_for_task(limit_ns, condition)
            if task is not None:
                self._execute(task)

    def _wait_for_task(self, limit_ns: int, condition: Callable[[], bool]) -> Task | None:
        def stops() -> bool:
            return not self.is_running or condition()

        until_ns = None if limit_ns < 0 else self.context.graph.now_ns + limit_ns
        while not stops():
            task = self._next_task()
            if task is not None or limit_ns == 0:
                return task
            if not baton.wait(lambda: self.can_work() or stops(), until_ns=until_ns, what=self._what):
                break
        over = not self.context.is_valid or baton.is_shut_down()
        if over and not self._is_shutdown:
            raise ExternalShutdownException
        return None

    def wait_for_ready_callbacks(
        self,
        timeout_sec: float | None = None,
        nodes: Sequence[HandledNode] | None = None,
        condition: Callable[[], bool] = lambda: False,
    ) -> "tuple[Task, Entity | None, HandledNode | None]":
        """Wait for a callback, at most so long [s]; return (task, its entity, its node); the caller runs it.

        As in rclpy raises TimeoutException, ShutdownException, ConditionReachedException or
        ExternalShutdownException if none came; the task is forgotten if the caller does not call it.
        """
        with baton.known():
            task = self._wait_for_task(timeout_sec_to_nsec(timeout_sec), condition)
        if task is None and condition():
            raise ConditionReachedException
        if task is None:
            raise ShutdownException if self._is_shutdown else TimeoutException
        entity = task.entity if isinstance(task, CallbackTask) else None
        owners = [node for node in self._nodes if entity is not None and node.handle is entity.node_handle]
        return task, entity, owners[0] if owners else None

    def can_work(self) -> bool:
        """Return whether a callback is ready to be run."""
        for task in self._tasks:
            if task.can_go_on():
                return True
        for handle in self._nodes.values():  # noqa: SIM110  any() takes twice the time
            if handle.first_ready() is not None:
                return True
        return False

    def _name_nodes(self) -> None:
        """Note what it waits for, for the message about a deadlock: each wait says it, few need it."""
        names = ", ".join(handle.full_name for handle in self._nodes.values())
        self._what = f"a callback of {names or 'no node'}"

    def is_held_up(self, entity: Entity) -> bool:
        """Return whether an entity's callback cannot run before the calling one has ended."""
        task = self._under_way.get(threading.get_ident())
        if task is None or self._num_threads == 1:
            return task is not None
        group = entity.callback_group
        same_group = isinstance(task, CallbackTask) and task.entity.callback_group is group
        return same_group and not group.can_execute(entity)

    def _next_task(self) -> Task | None:
        """Remove and return the next task: one that can go on, else the callback that became ready first."""
        for task in self._tasks:
            if task.can_go_on():
                self._tasks.remove(task)
                return task
        while True:
            first: Turn | None = None
            for handle in self._nodes.values():
                turn = handle.first_ready()
                if turn is not None and (first is None or turn.order < first.order):
                    first = turn
            if first is None:
                return None
            call = first.entity.node_handle.take(first)
            if call is not None:
                return self._begin(first, call)

    def _begin(self, turn: Turn, call: Callable[[], object]) -> Task:
        turn.entity.callback_group.beginning_execution(turn.entity)
        return CallbackTask(turn, call, self.context.graph, self)

    def _execute(self, task: Task) -> None:
        """Run a task; its error is raised, and a task that waits is kept."""
        ident = threading.get_ident()
        outer = self._under_way.get(ident)
        self._under_way[ident] = task
        outer_callback = watch.under_way
        if self.context.graph.notebook and isinstance(task, CallbackTask):
            watch.begin(task.entity.node_handle.full_name)
        try:
            task()
        finally:
            watch.under_way = outer_callback
            if outer is None:
                del self._under_way[ident]
            else:
                self._under_way[ident] = outer
        if not task.arrived():
            self._tasks.append(task)
        error = task.exception()
        if error is not None:
            raise error

    def __enter__(self) -> "Executor":
        return self

    def __exit__(self, *_: object) -> None:
        self.shutdown()
