"""Components, which ROS loads into a container; here each one in Python runs as a process of its own."""

from collections.abc import Iterable
from typing import Any

from launch.entities import Action, Condition, LaunchContext, text_of
from launch.entities import SomeSubstitutionsType as Some

from launch_ros.nodes import Given, Node


class ComposableNode:
    """A component: the plugin of a package, with names and parameters for its node.

    Args:
        package: The component's package.
        plugin: Its class, as `package::Class`.
        name: Replaces the name of its node.
        namespace: Of its node.
        parameters: Dictionaries, and YAML files.
        remappings: Pairs of names (from, to).
        extra_arguments: Dictionaries for the container; they make no difference here.
        condition: The component is loaded where it is true.
    """

    def __init__(
        self,
        *,
        package: Some,
        plugin: Some,
        name: Some | None = None,
        namespace: Some | None = None,
        parameters: Iterable[Any] | None = None,
        remappings: Iterable[tuple[Some, Some]] | None = None,
        extra_arguments: Iterable[Any] | None = None,
        condition: Condition | None = None,
    ) -> None:
        self._package, self._plugin, self._condition = package, plugin, condition
        self._given = Given(name, namespace, tuple(parameters or ()), tuple(remappings or ()))

    def load(self, context: LaunchContext, action: Action) -> None:
        """Start the component, unless its condition is false."""
        if self._condition is None or self._condition.evaluate(context):
            package, plugin = text_of(context, self._package), text_of(context, self._plugin)
            words = ["--ros-args", *self._given.words(context)]
            context.runner.start_component(action, package, plugin, words)


class LoadComposableNodes(Action):
    """Loads components into a container."""

    def __init__(
        self,
        *,
        composable_node_descriptions: Iterable[ComposableNode],
        target_container: "Some | ComposableNodeContainer",
        **options: Any,
    ) -> None:
        super().__init__(self._load, **options)
        self._components = list(composable_node_descriptions)

    def _load(self, context: LaunchContext) -> None:
        for component in self._components:
            component.load(context, self)


class ComposableNodeContainer(Node):
    """Starts a container, then its components; for `options` see Node."""

    def __init__(
        self,
        *,
        name: Some,
        namespace: Some,
        composable_node_descriptions: Iterable[ComposableNode] | None = None,
        **options: Any,
    ) -> None:
        super().__init__(name=name, namespace=namespace, **options)
        self._components = list(composable_node_descriptions or ())

    def execute(self, context: LaunchContext) -> list[LoadComposableNodes]:
        """Start the container; the components are loaded next."""
        super().execute(context)
        return [LoadComposableNodes(composable_node_descriptions=self._components, target_container=self)]
