"""The task that runs the callback of an entity."""

import time
from collections.abc import Callable
from inspect import iscoroutine

from course_lib.ros.graph.graph import Graph
from course_lib.ros.mistakes import mark
from rclpy.impl.node_handle import Turn
from rclpy.task import Future, Task, TaskRunner


class CallbackTask(Task):
    """A task that runs the callback of a ready entity.

    One is created for each callback, so it skips the inspection that `Task` does for arbitrary
    functions.
    """

    def __init__(self, turn: Turn, call: Callable[[], object], graph: Graph, executor: TaskRunner) -> None:
        Future.__init__(self, executor=executor)
        self.entity = turn.entity
        self._handler, self._course_awaited, self._executing = _run(turn, call, graph), None, False
        self._course_number = turn.order


async def _run(turn: Turn, call: Callable[[], object], graph: Graph) -> None:
    entity, start_ns = turn.entity, graph.now_ns
    # Measured only for listeners, because it takes a microsecond.
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
            entity._course_note_time_taken(graph.now_ns - start_ns)
        for listener in graph.callback_listeners:
            listener(entity, turn.since_ns, start_ns, time.thread_time() - start)
