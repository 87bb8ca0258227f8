"""Stand-in for rclpy, the ROS 2 client library for Python.

It runs in one process, on robot time.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Any

from course_lib.ros.notices import print_notice
from rclpy import utilities
from rclpy.context import NOT_INITIALIZED
from rclpy.context import Context as Context
from rclpy.executors import get_global_executor as get_global_executor
from rclpy.impl.implementation_singleton import RCLError as _RCLError
from rclpy.logging import get_logger as _get_logger
from rclpy.parameter import Parameter as Parameter
from rclpy.signals import SignalHandlerOptions as SignalHandlerOptions
from rclpy.signals import install_signal_handlers, uninstall_signal_handlers
from rclpy.task import Future as Future
from rclpy.utilities import get_default_context as get_default_context
from rclpy.utilities import get_rmw_implementation_identifier as get_rmw_implementation_identifier
from rclpy.utilities import ok as ok

if TYPE_CHECKING:
    from rclpy.executors import Executor
    from rclpy.node import Node


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
        print_notice("rclpy.init() was already called; everything keeps running.")
        return InitContextManager(used_context)
    try:
        try:
            used_context.init(args, domain_id=domain_id)
        finally:
            # rcl logs them even if a later argument is invalid.
            if isinstance(used_context, Context):
                used_context.arguments.log_warnings(_get_logger("rcl").warning)
    except _RCLError as error:
        if str(error).startswith(NOT_INITIALIZED):
            _get_logger("rcl").error("Failed to parse global arguments")
        raise
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
    utilities.shutdown(context=context)
    _uninstall(context, uninstall_handlers)


def try_shutdown(*, context: Context | None = None) -> None:
    """Shut a context down if it is valid."""
    utilities.try_shutdown(context=context)
    _uninstall(context, None)


def create_node(
    node_name: str,
    *,
    context: Context | None = None,
    cli_args: list[str] | None = None,
    namespace: str | None = None,
    use_global_arguments: bool = True,
    enable_rosout: bool = True,
    start_parameter_services: bool = True,
    parameter_overrides: list[Parameter] | None = None,
    allow_undeclared_parameters: bool = False,
    automatically_declare_parameters_from_overrides: bool = False,
    enable_logger_service: bool = False,
) -> Node:
    """Create a node with the arguments of `Node`."""
    from rclpy.node import Node

    return Node(
        node_name,
        context=context,
        cli_args=cli_args,
        namespace=namespace,
        use_global_arguments=use_global_arguments,
        enable_rosout=enable_rosout,
        start_parameter_services=start_parameter_services,
        parameter_overrides=parameter_overrides,
        allow_undeclared_parameters=allow_undeclared_parameters,
        automatically_declare_parameters_from_overrides=automatically_declare_parameters_from_overrides,
        enable_logger_service=enable_logger_service,
    )


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
    with _with_node(executor, node, keep=True) as used_executor, used_executor._course_with_live_nodes():
        used_executor.spin_once(timeout_sec=timeout_sec)


def spin_until_future_complete(
    node: Node,
    future: Future[Any],
    executor: Executor | None = None,
    timeout_sec: float | None = None,
) -> None:
    """Run the node's callbacks until a future is done or `timeout_sec` [s] have passed."""
    with _with_node(executor, node, keep=True) as used_executor, used_executor._course_with_live_nodes():
        used_executor.spin_until_future_complete(future, timeout_sec)


@contextmanager
def _with_node(executor: Executor | None, node: Node, *, keep: bool = False) -> Iterator[Executor]:
    """Add a node to an executor for the length of the block.

    With `keep`, a node that was added before remains.
    """
    used_executor = get_global_executor() if executor is None else executor
    is_new = False
    # As in rclpy, a node in place of the executor fails in remove_node as well.
    try:
        is_new = used_executor.add_node(node)
        yield used_executor
    finally:
        if is_new or not keep:
            used_executor.remove_node(node)


def _uninstall(context: Context | None, uninstall_handlers: bool | None) -> None:
    is_default = context is None or context is get_default_context()
    if uninstall_handlers or (uninstall_handlers is None and is_default):
        uninstall_signal_handlers()
