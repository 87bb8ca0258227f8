"""Lifecycle nodes, which have managed states."""

from rclpy.lifecycle.node import LifecycleNode as LifecycleNode
from rclpy.lifecycle.node import LifecycleNodeMixin as LifecycleNodeMixin
from rclpy.lifecycle.node import LifecyclePublisher as LifecyclePublisher
from rclpy.lifecycle.node import LifecycleState as LifecycleState
from rclpy.lifecycle.node import ManagedEntity as ManagedEntity
from rclpy.lifecycle.node import SimpleManagedEntity as SimpleManagedEntity
from rclpy.lifecycle.node import TransitionCallbackReturn as TransitionCallbackReturn

Node = LifecycleNode
NodeMixin = LifecycleNodeMixin
State = LifecycleState
Publisher = LifecyclePublisher

__all__ = [
    "LifecycleNode",
    "LifecycleNodeMixin",
    "LifecyclePublisher",
    "LifecycleState",
    "ManagedEntity",
    "SimpleManagedEntity",
]
