"""The ROS client library for Python: the kit's stand-in, in one process, by robot time."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Any, Unpack

from course_lib.ros.notices import say
from rclpy.context import Context as Context
from rclpy.executors import Executor
from rclpy.executors import get_global_executor as get_global_executor
from rclpy.parameter import Parameter as Parameter
from rclpy.signals import SignalHandlerOptions as SignalHandlerOptions
from rclpy.signals import install_signal_handlers, uninstall_signal_handlers
from rclpy.task import Future as Future
from rclpy.utilities import get_default_context as get_default_context
from rclpy.utilities import get_rmw_implementation_identifier as get_rmw_implementation_identifier
from rclpy.utilities import ok as ok

if TYPE_CHECKING:
    from rclpy.node import Node, NodeOptions


class InitContextManager(ExitStack):
    """The result of `init`: in a `with` statement it shuts down at the end; otherwise it may be ignored."""

    def __init__(self, context: Context) -> None:
        super().__init__()
        self.context = context
        self.callback(try_shutdown, context=None if context is get_default_context() else context)

    def _ipython_display_(self) -> None:
        """Show nothing where it is a cell's last value: in Jazzy `init` returns None."""


def init(
    *,
    args: list[str] | None = None,
    context: Context | None = None,
    domain_id: int | None = None,
    signal_handler_options: SignalHandlerOptions | None = None,
) -> InitContextManager:
    """Initialise a context; nodes can be made from now on.

    Args:
        args: The command line; default: `sys.argv`.
        context: The context; default: the default context.
        domain_id: Nodes of different domains do not hear each other in ROS; here they share one graph.
        signal_handler_options: The signals that shut down; default: all of them for the default context.

    A second time raises a RuntimeError; in a notebook, where cells are run again, that is only noted.
    """
    chosen = context or get_default_context()
    if context is None and chosen.graph.notebook and chosen.is_valid:
        say("rclpy.init() was called before, and what it began goes on.")
        return InitContextManager(chosen)
    chosen.init(args, domain_id=domain_id)
    if signal_handler_options is None:
        signal_handler_options = SignalHandlerOptions.ALL if context is None else SignalHandlerOptions.NO
    if not chosen.graph.notebook:
        install_signal_handlers(signal_handler_options)
    return InitContextManager(chosen)


def shutdown(*, context: Context | None = None, uninstall_handlers: bool | None = None) -> None:
    """Shut a context down; raises before `init` and after an earlier shutdown (`try_shutdown` does not)."""
    (context or get_default_context(shutting_down=True)).shutdown()
    _uninstall(context, uninstall_handlers)


def try_shutdown(*, context: Context | None = None, uninstall_handlers: bool | None = None) -> None:
    """Shut a context down if it is valid."""
    (context or get_default_context(shutting_down=True)).try_shutdown()
    _uninstall(context, uninstall_handlers)


def create_node(node_name: str, **options: "Unpack[NodeOptions]") -> "Node":
    """Create a node; the arguments are those of `Node`."""
    from rclpy.node import Node

    return Node(node_name, **options)


def spin(node: "Node", executor: Executor | None = None) -> None:
    """Run the node's callbacks until the shutdown or the end of the run; in a notebook's cell until ■."""
    with _with_node(executor, node) as chosen:
        chosen.spin()


def spin_once(node: "Node", *, executor: Executor | None = None, timeout_sec: float | None = None) -> None:
    """Run one callback; wait for it at most `timeout_sec` [s], without limit if that is None."""
    with _with_node(executor, node) as chosen, chosen.beside_live():
        chosen.spin_once(timeout_sec=timeout_sec)


def spin_until_future_complete(
    node: "Node", future: Future[Any], executor: Executor | None = None, timeout_sec: float | None = None
) -> None:
    """Run the node's callbacks until a future is done, or `timeout_sec` [s] are over."""
    with _with_node(executor, node, keep=True) as chosen, chosen.beside_live():
        chosen.spin_until_future_complete(future, timeout_sec)


@contextmanager
def _with_node(executor: Executor | None, node: "Node", *, keep: bool = False) -> Iterator[Executor]:
    """Add a node to an executor for a while; `keep` it there if it was before."""
    chosen = executor or get_global_executor()
    added = chosen.add_node(node)
    try:
        yield chosen
    finally:
        if added or not keep:
            chosen.remove_node(node)


def _uninstall(context: Context | None, uninstall_handlers: bool | None) -> None:
    is_default = context is None or context is get_default_context()
    if uninstall_handlers or (uninstall_handlers is None and is_default):
        uninstall_signal_handlers()
