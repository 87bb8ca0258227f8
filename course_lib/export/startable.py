"""Classes that are not executables: others inherit from them, or nobody can make one without arguments."""

import ast
from collections.abc import Mapping, Sequence

from course_lib.export.module import Main, NodeModule
from course_lib.export.statements import Statement


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
