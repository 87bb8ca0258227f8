"""Stand-in for rclpy, the ROS 2 client library for Python.

It runs in one process, on robot time.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Any, Unpack

from course_lib.ros.notices import say
from rclpy.context import NOT_INITIALIZED
from rclpy.context import Context as Context
from rclpy.exceptions import RCLError
from rclpy.executors import Executor
from rclpy.executors import get_global_executor as get_global_executor
from rclpy.logging import get_logger
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
    """The result of `init`. As a context manager it shuts down on exit; it can also be ignored."""

    def __init__(self, context: Context) -> None:
        super().__init__()
        self.context = context
        self.callback(try_shutdown, context=None if context is get_default_context() else context)

    def _ipython_display_(self) -> None:
        """Display nothing for `rclpy.init()` at the end of a cell: in Jazzy it returns None."""


def init(
    *,
    args: list[str] | None = None,
    context: Context | None = None,
    domain_id: int | None = None,
    signal_handler_options: SignalHandlerOptions | None = None,
) -> InitContextManager:
    """Initialize a context, so that nodes can be created.

    Args:
        args: The command line; default: `sys.argv`.
        context: The context; default: the default context.
        domain_id: In ROS, nodes of different domains do not communicate. Here they share one graph.
        signal_handler_options: The signals that shut down; default: all of them for the default
            context.

    Raises:
        RuntimeError: The context is already initialized. In a notebook, where cells are run again,
            a notice is printed instead.
    """
    if not isinstance(signal_handler_options, SignalHandlerOptions | None):
        raise TypeError("install_signal_handlers(): incompatible function arguments.")
    used_context = context or get_default_context()
    if context is None and used_context.graph.notebook and used_context.is_valid:
        say("rclpy.init() was already called; everything keeps running.")
        return InitContextManager(used_context)
    try:
        used_context.init(args, domain_id=domain_id)
    except RCLError as error:
        if str(error).startswith(NOT_INITIALIZED):
            get_logger("rcl").error("Failed to parse global arguments")
        raise
    for warning in used_context.arguments.warnings:
        get_logger("rcl").warning(warning)
    if signal_handler_options is None:
        signal_handler_options = SignalHandlerOptions.ALL if context is None else SignalHandlerOptions.NO
    if not used_context.graph.notebook:
        install_signal_handlers(signal_handler_options)
    return InitContextManager(used_context)


def shutdown(*, context: Context | None = None, uninstall_handlers: bool | None = None) -> None:
    """Shut a context down.

    Raises:
        RuntimeError: The context was not initialized or is already shut down. `try_shutdown`
            ignores both.
    """
    (context or get_default_context(shutting_down=True)).shutdown()
    _uninstall(context, uninstall_handlers)


def try_shutdown(*, context: Context | None = None) -> None:
    """Shut a context down if it is valid."""
    (context or get_default_context(shutting_down=True)).try_shutdown()
    _uninstall(context, None)


def create_node(node_name: str, **options: Unpack[NodeOptions]) -> Node:
    """Create a node with the arguments of `Node`."""
    from rclpy.node import Node

    for name in options.keys() - Node.__init__.__annotations__.keys():
        raise TypeError(f"create_node() got an unexpected keyword argument '{name}'")
    return Node(node_name, **options)


def spin(node: Node, executor: Executor | None = None) -> None:
    """Run the node's callbacks until shutdown or the end of the run; in a cell, until ■ is pressed."""
    with _with_node(executor, node) as used_executor:
        used_executor.spin()


def spin_once(
    node: Node,
    *,
    executor: Executor | None = None,
    timeout_sec: float | None = None,
) -> None:
    """Run one callback. Wait for it at most `timeout_sec` [s], without limit if that is None."""
    with _with_node(executor, node, keep=True) as used_executor, used_executor._course_beside_live():
        used_executor.spin_once(timeout_sec=timeout_sec)


def spin_until_future_complete(
    node: Node,
    future: Future[Any],
    executor: Executor | None = None,
    timeout_sec: float | None = None,
) -> None:
    """Run the node's callbacks until a future is done or `timeout_sec` [s] have passed."""
    with _with_node(executor, node, keep=True) as used_executor, used_executor._course_beside_live():
        used_executor.spin_until_future_complete(future, timeout_sec)


@contextmanager
def _with_node(executor: Executor | None, node: Node, *, keep: bool = False) -> Iterator[Executor]:
    """Add a node to an executor for the length of the block.

    With `keep`, a node that was added before remains.
    """
    used_executor = get_global_executor() if executor is None else executor
    is_new = used_executor.add_node(node)
    try:
        yield used_executor
    finally:
        if is_new or not keep:
            used_executor.remove_node(node)


def _uninstall(context: Context | None, uninstall_handlers: bool | None) -> None:
    is_default = context is None or context is get_default_context()
    if uninstall_handlers or (uninstall_handlers is None and is_default):
        uninstall_signal_handlers()
