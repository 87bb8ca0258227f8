# mypy: disable-error-code="import-not-found, untyped-decorator"
"""The public names that rclpy's modules define, with the methods and constants of their classes."""

import importlib
import inspect
import pkgutil
import typing

import rclpy
from probing import main, probe
from rclpy.waitable import Waitable


def _origin(value: object, module: str) -> str:
    """Return the module that defines a value. Constants count as defined where they are found."""
    origin = getattr(value, "__module__", None)
    return origin if isinstance(origin, str) else module


def _names(path: str) -> list[str]:
    """List the names of a module and of its classes. A package also exports names of its modules."""
    module = importlib.import_module(path)
    found = [path]
    for name, value in vars(module).items():
        origin = _origin(value, path)
        is_exported = origin.split(".")[0] == "rclpy" if hasattr(module, "__path__") else origin == path
        is_of_types = isinstance(value, typing.TypeVar) or hasattr(typing, name)
        if name.startswith("_") or inspect.ismodule(value) or is_of_types or not is_exported:
            continue
        found.append(f"{path}.{name}")
        if inspect.isclass(value) and origin == path:
            # Properties are instance attributes in the stand-in, and waitables are left out
            # completely.
            common = {*dir(Exception), *dir(int), *(dir(Waitable) if value is not Waitable else ())}
            found += [
                f"{path}.{name}.{attribute}"
                for attribute in set(dir(value)) - common
                if attribute[0] != "_" and not isinstance(getattr(value, attribute), property)
            ]
    return found


@probe
def modules() -> list[str]:
    paths = ["rclpy", *(one.name for one in pkgutil.walk_packages(rclpy.__path__, "rclpy."))]
    public = [path for path in paths if "._" not in path and not path.startswith("rclpy.impl")]
    return sorted(name for path in public for name in _names(path))


if __name__ == "__main__":
    main()
