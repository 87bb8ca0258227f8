# mypy: disable-error-code="import-not-found, untyped-decorator"
"""The parameters of the public functions, classes and methods that rclpy's modules define.

Errors, enumerations and what Python's own classes define are left out. With names of packages as
arguments, it prints those of other packages whose sources are on Python's path.
"""

import importlib
import inspect
import json
import pkgutil
import sys
from collections.abc import Callable, Iterable, Iterator
from enum import Enum

import rclpy
from probing import main, probe

PREFIXES: dict[object, str] = {
    inspect.Parameter.VAR_POSITIONAL: "*",
    inspect.Parameter.KEYWORD_ONLY: "keyword ",
    inspect.Parameter.VAR_KEYWORD: "**",
}


def parameters(function: Callable[..., object]) -> str | None:
    """Return the names and kinds of parameters, with defaults that print equally in both worlds."""
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):
        # Functions in C.
        return None
    texts = []
    for parameter in signature.parameters.values():
        is_plain = type(parameter.default) in (int, float, str, bool, type(None))
        default = repr(parameter.default) if is_plain else "..."
        end = "" if parameter.default is parameter.empty else f"={default}"
        texts.append(f"{PREFIXES.get(parameter.kind, '')}{parameter.name}{end}")
    return ", ".join(texts)


def _callables(path: str) -> Iterator[tuple[str, Callable[..., object]]]:
    module = importlib.import_module(path)
    for name, value in vars(module).items():
        if name.startswith("_") or getattr(value, "__module__", None) != path or not callable(value):
            continue
        if not inspect.isclass(value):
            yield f"{path}.{name}", value
        elif not issubclass(value, BaseException | Enum):
            yield f"{path}.{name}", value
            for attribute in dir(value):
                method = getattr(value, attribute)
                if attribute[0] != "_" and callable(method) and not inspect.isclass(method):
                    yield f"{path}.{name}.{attribute}", method


def _exported(package: str) -> Iterator[tuple[str, Callable[..., object]]]:
    """Yield the callables that packages and the first modules below export, by their shortest name."""
    root = importlib.import_module(package)
    below = _walk(root.__path__, f"{package}.")
    modules = [package, *(one.name for one in below if one.ispkg or one.name.count(".") == 1)]
    seen: set[int] = set()
    for path in sorted(modules, key=lambda name: name.count(".")):
        for name, value in vars(importlib.import_module(path)).items():
            is_own = str(getattr(value, "__module__", "")).startswith(path) and callable(value)
            is_class = inspect.isclass(value)
            if name[0] == "_" or not is_own or id(value) in seen:
                continue
            if is_class and issubclass(value, BaseException | Enum):
                continue
            seen.add(id(value))
            yield f"{path}.{name}", value
            for attribute in dir(value) if is_class else ():
                if attribute[0] != "_" and inspect.isfunction(method := getattr(value, attribute)):
                    yield f"{path}.{name}.{attribute}", method


def _walk(folder: Iterable[str], prefix: str) -> Iterator[pkgutil.ModuleInfo]:
    # The sources of launch contain a test.
    return (one for one in pkgutil.walk_packages(folder, prefix) if not one.name.endswith("conftest"))


@probe
def signatures() -> dict[str, str]:
    paths = ["rclpy", *(one.name for one in _walk(rclpy.__path__, "rclpy."))]
    public = [path for path in paths if "._" not in path and not path.startswith("rclpy.impl")]
    found = {name: parameters(value) for path in public for name, value in _callables(path)}
    # Methods that rclpy wraps show only the wrapper's parameters.
    known = {name: text for name, text in found.items() if text is not None and "*args, **kwargs" not in text}
    return dict(sorted(known.items()))


if __name__ == "__main__":
    if sys.argv[1:]:
        found = {name: parameters(value) for package in sys.argv[1:] for name, value in _exported(package)}
        sys.stdout.write(f"{json.dumps(dict(sorted(found.items())), indent=1)}\n")
    else:
        main()
