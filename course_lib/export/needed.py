"""What a class needs of the code around it."""

import ast
import builtins
from collections.abc import Sequence

from course_lib.errors import CourseError
from course_lib.export.statements import Statement

_ALWAYS_THERE = {*dir(builtins), "__name__", "__file__", "__doc__", "__class__"}


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
