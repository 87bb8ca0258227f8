"""What the source of a node says of it: its name, its parameters, what it publishes."""

import ast
from collections.abc import Iterator, Mapping
from typing import Any

_DISPLAYS = {  # message -> RViz's display
    "Image": "Image",
    "LaserScan": "LaserScan",
    "Marker": "Marker",
    "MarkerArray": "MarkerArray",
    "Odometry": "Odometry",
    "Path": "Path",
    "PointCloud2": "PointCloud2",
    "PoseArray": "PoseArray",
    "PoseStamped": "Pose",
}


def node_name(node: ast.ClassDef) -> str | None:
    """Give the name in `super().__init__("name")`, if it is written there."""
    calls = (call for call in _calls(node, "__init__") if call.args)
    return next((text for call in calls if isinstance(text := _literal(call.args[0]), str)), None)


def parameters(node: ast.ClassDef) -> dict[str, Any]:
    """Give the parameters that a class declares with a default that is written there."""
    found = {}
    for call in _calls(node, "declare_parameter"):
        default = call.args[1] if len(call.args) > 1 else None
        value = None if default is None else _literal(default)
        if call.args and isinstance(name := _literal(call.args[0]), str) and value not in (None, []):
            found[name] = value
    return found


def displays(node: ast.ClassDef) -> dict[str, str]:
    """Give RViz's display for each topic that a class publishes, where RViz has one."""
    found = {}
    for call in _calls(node, "create_publisher"):
        if len(call.args) > 1 and isinstance(topic := _literal(call.args[1]), str):
            kind = call.args[0]
            name = kind.attr if isinstance(kind, ast.Attribute) else getattr(kind, "id", "")
            if name in _DISPLAYS:
                found[topic if topic.startswith("/") else f"/{topic}"] = _DISPLAYS[name]
    return found


def frames(node: ast.ClassDef) -> list[str]:
    """List the frames that a class writes into `frame_id`."""
    return [
        value
        for one in ast.walk(node)
        if isinstance(one, ast.Assign) and isinstance(value := _literal(one.value), str)
        if any(isinstance(target, ast.Attribute) and target.attr == "frame_id" for target in one.targets)
    ]


def parameters_text(by_node: Mapping[str, Mapping[str, Any]]) -> str:
    """Write parameters as the YAML that `--params-file` takes."""
    import json

    lines = []
    for name, values in by_node.items():
        lines += [f"{name}:", "  ros__parameters:"]
        lines += [f"    {key}: {json.dumps(value, ensure_ascii=False)}" for key, value in values.items()]
    return "\n".join(lines) + "\n"


def _calls(node: ast.AST, method: str) -> Iterator[ast.Call]:
    for one in ast.walk(node):
        if isinstance(one, ast.Call) and isinstance(one.func, ast.Attribute) and one.func.attr == method:
            yield one


def _literal(node: ast.expr) -> Any:
    try:
        return ast.literal_eval(node)
    except ValueError:
        return None
