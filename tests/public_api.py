"""The public names, collected by griffe: `python -m tests.public_api` stores them at a release."""

import json
import sys
import tomllib
from pathlib import Path

import griffe

from tests.checkout import ROOT

PUBLIC = ("course_lib", *(f"course_lib.{n}" for n in ("displays", "export", "grading", "robots", "sensors")))
RELEASED = ROOT / "tests/data/released_api.json"


def public_api(top: Path = ROOT) -> griffe.Module:
    """Return a module with a submodule for each public module, containing the names of its stub."""
    package = griffe.load("course_lib", search_paths=[str(top)])
    api = griffe.Module("course_lib")
    for name in PUBLIC:
        file = top / Path(*name.split(".")) / "__init__.pyi"
        stub = griffe.visit(name, filepath=file, code=file.read_text(encoding="utf-8"))
        module = griffe.Module(name.rpartition(".")[2])
        for offered, member in stub.members.items():
            path = member.target_path if isinstance(member, griffe.Alias) else f"{name}.{offered}"
            found = package[path.removeprefix("course_lib.")]
            module.set_member(offered, lean(found.final_target if isinstance(found, griffe.Alias) else found))
        api.set_member(module.name, module)
    return api


def lean(found: griffe.Object) -> griffe.Object:
    """Remove what may change without breaking a program: docstrings, annotations, values, private members."""
    found.docstring, found.lineno, found.endlineno = None, 1, 1  # griffe requires line numbers
    for name, member in list(found.members.items()):
        if (name.startswith("_") and name != "__init__") or isinstance(member, griffe.Alias):
            found.del_member(name)
        else:
            lean(member)
    if isinstance(found, griffe.Attribute):
        found.annotation = found.value = None
    if isinstance(found, griffe.Function):
        found.decorators, found.returns = [], None
        for parameter in found.parameters:
            parameter.annotation, parameter.default = None, parameter.default and str(parameter.default)
    return found


def breakages(old: griffe.Module, new: griffe.Module) -> list[str]:
    """Return a line for each change that breaks a program that ran with the old names."""
    found = griffe.find_breaking_changes(old, new)
    return [f"{change.obj.path}: {change.kind.value}" for change in found]


def released() -> tuple[str, griffe.Module]:
    """Return the last release's version and names."""
    content = json.loads(RELEASED.read_text(encoding="utf-8"))
    return content["version"], griffe.Module.from_json(json.dumps(content["api"]))


def version(top: Path = ROOT) -> str:
    """Return the version of a checkout, which stands in pyproject.toml alone."""
    project = tomllib.loads((top / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return str(project["version"])


def write(top: Path = ROOT) -> None:
    """Store the names of a release and its version."""
    content = {"version": version(top), "api": public_api(top).as_dict()}
    RELEASED.write_text(json.dumps(content, cls=griffe.JSONEncoder) + "\n", encoding="utf-8")


if __name__ == "__main__":
    write(*map(Path, sys.argv[1:]))
