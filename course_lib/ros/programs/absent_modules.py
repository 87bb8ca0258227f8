"""Placeholders for Python modules of ROS packages that cannot run here, for launch files.

A launch file that imports a helper module of MoveIt or Webots starts other programs, too.
Everything it creates with such a module is a placeholder: the action that uses it is skipped with
one line in the log, and all other actions start.
"""

import sys
from collections.abc import Iterator, Sequence
from importlib.abc import Loader
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any, NoReturn

from launch.entities import Action, LaunchContext, Substitution

from course_lib.ros.programs.packages import (
    INSTALLED,
    NotHereError,
    is_tolerant,
    missing_share_folder,
    unavailable_reason,
)


class AbsentModules(Loader):
    """Finds modules that a launch file imports and that no other finder provides.

    It is the last finder.
    """

    @classmethod
    def find_spec(
        cls, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """While a launch file is read, find a module of a package that is known not to run here."""
        package = name.partition(".")[0]
        reason = unavailable_reason(package) if is_tolerant() else ""
        if not reason:
            return None
        missing_share_folder(package, f"package '{package}' not found: {reason}")
        return ModuleSpec(name, cls(), is_package=True)

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """Return a module that has a placeholder for every name."""
        return _AbsentModule(spec.name)

    def exec_module(self, module: ModuleType) -> None:
        """Do nothing, because the module has no code."""


class _AbsentModule(ModuleType):
    def __getattr__(self, name: str) -> "Placeholder":
        if name.startswith("__"):
            raise AttributeError(name)
        return Placeholder(f"{self.__name__}.{name}")


class Placeholder(Action, Substitution):
    """An object of an absent module, or an object created with one.

    `origin` is its name in the module.
    """

    continues = True

    def __init__(self, origin: str) -> None:
        Action.__init__(self)
        self.origin = origin

    def visit(self, context: LaunchContext) -> NoReturn:
        """Raise the error that makes the launch skip the action."""
        package = self.origin.partition(".")[0]
        raise NotHereError(f"package '{package}' not found: {unavailable_reason(package)}")

    def perform(self, context: LaunchContext) -> NoReturn:
        """Raise the error that makes the launch skip the action that uses the placeholder."""
        self.visit(context)

    def __getattr__(self, name: str) -> "Placeholder":
        if name.startswith("__"):
            raise AttributeError(name)
        return Placeholder(f"{self.origin}.{name}")

    def __call__(self, *args: Any, **kwargs: Any) -> "Placeholder":
        """Return a placeholder for the result."""
        return Placeholder(self.origin)

    def __getitem__(self, key: Any) -> "Placeholder":
        return Placeholder(self.origin)

    def __setitem__(self, key: Any, value: Any) -> None:
        """Ignore the value."""

    def __iter__(self) -> Iterator["Placeholder"]:
        yield Placeholder(self.origin)

    def __add__(self, other: Any) -> "Placeholder":
        return Placeholder(self.origin)

    __radd__ = __truediv__ = __rtruediv__ = __or__ = __ror__ = __add__

    def __fspath__(self) -> str:
        return str(INSTALLED / self.origin.partition(".")[0])

    __str__ = __fspath__


def install() -> None:
    """Make the placeholders available to launch files."""
    if AbsentModules not in sys.meta_path:
        sys.meta_path.append(AbsentModules)


def unload_absent_modules() -> None:
    """Remove the placeholder modules, so that they are missing for the nodes of a launch."""
    for name in [name for name, module in sys.modules.items() if isinstance(module, _AbsentModule)]:
        del sys.modules[name]
