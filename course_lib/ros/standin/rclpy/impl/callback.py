"""The task that runs the callback of an entity."""

import time
from collections.abc import Callable

from course_lib.ros.graph import Graph
from course_lib.ros.mistakes import mark
from rclpy.impl.node_handle import Turn
from rclpy.task import Future, Task, TaskRunner, await_or_execute


class CallbackTask(Task):
    """A task that runs the callback of an entity whose turn it is.

    There is one for each callback, so it does without what `Task` finds out about any function.
    """

    def __init__(self, turn: Turn, call: Callable[[], object], graph: Graph, executor: TaskRunner) -> None:
        Future.__init__(self, executor=executor)
        self.entity = turn.entity
        self._coroutine, self._awaited, self._executing = _run(turn, call, graph), None, False


async def _run(turn: Turn, call: Callable[[], object], graph: Graph) -> None:
    entity, start_ns = turn.entity, graph.now_ns
    start = time.thread_time() if graph.callback_listeners else 0.0  # it takes a microsecond
    try:
        await await_or_execute(call)
    except TypeError as error:
        if entity.mistake is not None:
            mark(error, entity.mistake, depth=2)
        raise
    finally:
        entity.callback_group.ending_execution(entity)
        if graph.now_ns > start_ns and graph.notebook:
            entity.note_time_taken(graph.now_ns - start_ns)
        for listener in graph.callback_listeners:
            listener(entity, turn.since_ns, start_ns, time.thread_time() - start)
