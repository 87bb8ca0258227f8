"""Managed entities, which follow the state transitions of their lifecycle node."""

from collections.abc import Callable
from enum import Enum
from functools import wraps
from typing import Any, Concatenate, NamedTuple, ParamSpec, TypeVar, overload

from lifecycle_msgs.msg import Transition

SelfT = TypeVar("SelfT", bound="SimpleManagedEntity")
P = ParamSpec("P")
Method = Callable[Concatenate[SelfT, P], Any]


class LifecycleState(NamedTuple):
    """A lifecycle state: its label, and its id in lifecycle_msgs/msg/State."""

    label: str
    state_id: int


class TransitionCallbackReturnType(Enum):
    """The result of a transition callback. Programs import it as TransitionCallbackReturn."""

    SUCCESS = Transition.TRANSITION_CALLBACK_SUCCESS
    FAILURE = Transition.TRANSITION_CALLBACK_FAILURE
    ERROR = Transition.TRANSITION_CALLBACK_ERROR

    def to_label(self) -> str:
        """Return the label of the transition that follows this result."""
        return f"transition_{self.name.lower()}"


TransitionCallbackReturn = TransitionCallbackReturnType


class ManagedEntity:
    """An entity with a callback for each transition. A callback receives the previous state."""

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Handle the transition to inactive."""
        return TransitionCallbackReturn.SUCCESS

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Handle the transition back to unconfigured."""
        return TransitionCallbackReturn.SUCCESS

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Handle the transition to finalized."""
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Handle the transition to active."""
        return TransitionCallbackReturn.SUCCESS

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Handle the transition back to inactive."""
        return TransitionCallbackReturn.SUCCESS

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Handle an error that another callback raised or returned."""
        return TransitionCallbackReturn.SUCCESS


class SimpleManagedEntity(ManagedEntity):
    """An entity that is enabled while its node is active."""

    def __init__(self) -> None:
        self._enabled = False

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Enable the entity."""
        self._enabled = True
        return TransitionCallbackReturn.SUCCESS

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Disable the entity."""
        self._enabled = False
        return TransitionCallbackReturn.SUCCESS

    @property
    def is_activated(self) -> bool:
        """True while the entity is enabled."""
        return self._enabled

    @overload
    @staticmethod
    def when_enabled(
        wrapped: None = None, *, when_not_enabled: Callable[[], object] | None = None
    ) -> Callable[[Method[SelfT, P]], Callable[Concatenate[SelfT, P], None]]: ...

    @overload
    @staticmethod
    def when_enabled(
        wrapped: Method[SelfT, P], *, when_not_enabled: Callable[[], object] | None = None
    ) -> Callable[Concatenate[SelfT, P], None]: ...

    @staticmethod
    def when_enabled(
        wrapped: Method[SelfT, P] | None = None,
        *,
        when_not_enabled: Callable[[], object] | None = None,
    ) -> Any:
        """Decorate a method so that it runs only while enabled; otherwise `when_not_enabled` is called."""

        def decorated(method: Method[SelfT, P]) -> Any:
            @wraps(method)
            def call(self: SelfT, *args: P.args, **kwargs: P.kwargs) -> None:
                if self._enabled:
                    method(self, *args, **kwargs)
                elif when_not_enabled is not None:
                    when_not_enabled()

            return call

        return decorated if wrapped is None else decorated(wrapped)
