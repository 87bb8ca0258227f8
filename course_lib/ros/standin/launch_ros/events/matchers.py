"""Matchers for lifecycle nodes."""

from collections.abc import Callable
from typing import Any


def matches_node_name(node_name: str) -> Callable[[Any], bool]:
    """Return a matcher for the LifecycleNode with this name, including its namespace."""
    full = node_name if node_name.startswith("/") else f"/{node_name}"

    def matches(action: Any) -> bool:
        return bool(action.node_name == full)

    return matches
