# mypy: ignore-errors
"""Lifecycle nodes whose callbacks fail, raise or return something else, in several orders of transitions."""

from typing import Any

from probing import lines, main, outcome
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn

SUCCESS, FAILURE, ERROR = (
    TransitionCallbackReturn.SUCCESS,
    TransitionCallbackReturn.FAILURE,
    TransitionCallbackReturn.ERROR,
)
ORDERS = {
    "full_circle": ("configure", "activate", "deactivate", "cleanup", "shutdown"),
    "shut_down_while_active": ("configure", "activate", "shutdown"),
    "shut_down_first": ("shutdown", "configure"),
    "not_configured": ("activate", "deactivate", "cleanup"),
    "configured_twice": ("configure", "configure"),
}
RETURNS = {
    "success": {},
    **{
        f"{name}_in_{callback}": {callback: value}
        for callback in ("configure", "activate", "deactivate", "cleanup", "shutdown")
        for name, value in (("failure", FAILURE), ("error", ERROR), ("exception", ZeroDivisionError))
    },
    "error_twice": {"configure": ERROR, "error": ERROR},
    "error_and_failure": {"configure": ERROR, "error": FAILURE},
    "error_and_exception": {"configure": ERROR, "error": ZeroDivisionError},
    "nothing": {"configure": None},
    "true": {"configure": True},
    "text": {"configure": "SUCCESS"},
    "number": {"configure": 97},
}


class Life(LifecycleNode):
    """A lifecycle node whose callbacks return, or raise, what they are told."""

    def __init__(self, returns: Any) -> None:
        self.returns, self.calls = returns, []
        super().__init__("life")

    def _call(self, name: Any, state: Any) -> Any:
        self.calls.append((name, state.label))
        value = self.returns.get(name, SUCCESS)
        if isinstance(value, type) and issubclass(value, Exception):
            raise value
        return value

    def on_configure(self, state: Any) -> Any:
        return self._call("configure", state)

    def on_activate(self, state: Any) -> Any:
        return self._call("activate", state)

    def on_deactivate(self, state: Any) -> Any:
        return self._call("deactivate", state)

    def on_cleanup(self, state: Any) -> Any:
        return self._call("cleanup", state)

    def on_shutdown(self, state: Any) -> Any:
        return self._call("shutdown", state)

    def on_error(self, state: Any) -> Any:
        return self._call("error", state)


def _life(order: Any, returns: Any) -> Any:
    node = Life(returns)
    states = []
    for transition in order:
        result = outcome(getattr(node, f"trigger_{transition}"))
        states.append((transition, result, node._state_machine.current_state[1]))
    return states, node.calls


for _order, _transitions in ORDERS.items():
    for _name, _returns in RETURNS.items():
        lines(
            _order,
            **{_name: lambda order=_transitions, returns=_returns: _life(order, returns)},
        )

if __name__ == "__main__":
    main()
