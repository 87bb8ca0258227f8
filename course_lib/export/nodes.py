"""Node classes in exported code: what each needs, publishes and declares, and which can be started."""

import ast
import builtins
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from course_lib.errors import CourseError
from course_lib.export.module import Main, NodeModule
from course_lib.export.statements import Statement

_ALWAYS_THERE = {*dir(builtins), "__name__", "__file__", "__doc__", "__class__"}
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


def node_classes(code: Sequence[Statement], names: Sequence[str]) -> list[Statement]:
    """Find the classes to export: those named, or else all that derive from Node.

    Raises:
        CourseError: There is none, or none of a name.
    """
    classes = {name: one for one in code if isinstance(one.node, ast.ClassDef) for name in one.gives}
    for name in names:
        if name not in classes:
            raise CourseError(
                f"There is no class {name!r} to export; there is: {', '.join(classes) or 'none'}."
            )
    chosen = [classes[name] for name in names or classes if names or _is_node(classes[name], classes)]
    if not chosen:
        raise CourseError("There is no class that derives from rclpy's Node. Name one: --node MyClass")
    return sorted(chosen, key=lambda one: one.order)


def needed(root: Statement, code: Sequence[Statement], left_out: Sequence[Statement]) -> list[Statement]:
    """Collect a class and all that it needs, in the order of the source.

    Args:
        root: The class.
        code: The statements that may be exported.
        left_out: Those of cells that are not marked; for the error.

    Raises:
        CourseError: A name is defined in a cell that is left out, or nowhere.
    """
    chosen = {root.order: root} | {one.order: one for one in code if one.text.startswith("from __future__")}
    to_do, last = [root], len(code) + len(left_out)
    while to_do:
        one = to_do.pop()
        found = [_giver(name, one, code, left_out, at=one.order) for name in sorted(one.now)]
        found += [_giver(name, one, code, left_out, at=last) for name in sorted(one.later)]
        if not one.is_import:
            found += [s for s in code if s.changes & one.gives and not isinstance(one.node, ast.ClassDef)]
        for giver in found:
            if giver is not None and giver.order not in chosen:
                chosen[giver.order] = giver
                to_do.append(giver)
    return [chosen[order] for order in sorted(chosen)]


def _is_node(one: Statement, classes: dict[str, Statement]) -> bool:
    assert isinstance(one.node, ast.ClassDef)
    for base in one.node.bases:
        name = base.attr if isinstance(base, ast.Attribute) else getattr(base, "id", "")
        if name in ("Node", "LifecycleNode"):
            return True
        if name in classes and classes[name] is not one and _is_node(classes[name], classes):
            return True
    return False


def _giver(
    name: str, user: Statement, code: Sequence[Statement], left_out: Sequence[Statement], *, at: int
) -> Statement | None:
    """Find the last statement before `at` that gives a name, else the first after it."""
    givers = [one for one in code if name in one.gives or "*" in one.gives]
    before = [one for one in givers if one.order < at]
    if givers:
        return before[-1] if before else givers[0]
    if name in _ALWAYS_THERE or name in user.gives:
        return None
    who = f"{', '.join(sorted(user.gives)) or 'a statement'} (cell {user.cell.number}) uses {name!r}"
    elsewhere = next((one for one in left_out if name in one.gives), None)
    if elsewhere is not None:
        raise CourseError(
            f"{who}, which cell {elsewhere.cell.number} gives, and that cell is left out. Mark it: # export "
            "in its first line."
        )
    raise CourseError(f"{who}, which is defined nowhere. Define or import it in a cell that is exported.")


def node_name(node: ast.ClassDef) -> str | None:
    """Return the name in `super().__init__("name")`, if it is a literal."""
    calls = (call for call in _calls(node, "__init__") if call.args)
    return next((text for call in calls if isinstance(text := _literal(call.args[0]), str)), None)


def parameters(node: ast.ClassDef) -> dict[str, Any]:
    """Return the parameters that a class declares with a literal default."""
    found = {}
    for call in _calls(node, "declare_parameter"):
        default = call.args[1] if len(call.args) > 1 else None
        value = None if default is None else _literal(default)
        if call.args and isinstance(name := _literal(call.args[0]), str) and value not in (None, []):
            found[name] = value
    return found


def displays(node: ast.ClassDef) -> dict[str, str]:
    """Return RViz's display for each topic that a class publishes, where RViz has one."""
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


def obstacles(
    module: NodeModule, modules: Sequence[NodeModule], code: Sequence[Statement], *, named: bool
) -> str:
    """Return why a class cannot be started on its own, like "needs name"; "" if it can.

    Args:
        module: The class.
        modules: All classes that may become executables.
        code: The exported statements, in which base classes are looked up.
        named: Whether it was asked for by name, although others may inherit from it.
    """
    if module.main is Main.OWN:
        return ""
    classes = {one.node.name: one.node for one in code if isinstance(one.node, ast.ClassDef)}
    heirs = [other.class_name for other in modules if module.class_name in _direct_bases(other.node)]
    if heirs and not named:
        return f"is the base of {', '.join(heirs)}"
    constructors = (_method(one, "__init__") for one in _family(module.node, classes))
    free = next((_free(one) for one in constructors if one), [])
    if free:
        return f"needs {', '.join(free)}"
    methods = (item for item in module.node.body if isinstance(item, ast.FunctionDef))
    abstract = [method.name for method in methods if _is_abstract(method)]
    return f"leaves {', '.join(abstract)} abstract" if abstract else ""


def _direct_bases(node: ast.ClassDef) -> list[str]:
    return [base.id for base in node.bases if isinstance(base, ast.Name) and base.id != node.name]


def _family(node: ast.ClassDef, classes: Mapping[str, ast.ClassDef]) -> list[ast.ClassDef]:
    """Return a class and its direct and indirect bases among `classes`, nearest first."""
    family, to_do = [node], _direct_bases(node)
    while to_do:
        base = classes.get(to_do.pop(0))
        if base is not None and base not in family:
            family.append(base)
            to_do += _direct_bases(base)
    return family


def _method(node: ast.ClassDef, name: str) -> ast.FunctionDef | None:
    return next((one for one in node.body if isinstance(one, ast.FunctionDef) and one.name == name), None)


def _free(function: ast.FunctionDef) -> list[str]:
    """Return the arguments of a method, but self, that have no default."""
    arguments = function.args
    positional = [*arguments.posonlyargs, *arguments.args][1:]
    free = positional[: len(positional) - len(arguments.defaults)]
    pairs = zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True)
    return [one.arg for one in (*free, *(one for one, default in pairs if default is None))]


def _is_abstract(method: ast.FunctionDef) -> bool:
    return any(ast.unparse(one).endswith("abstractmethod") for one in method.decorator_list)
