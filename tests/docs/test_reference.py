"""The reference in docs/ contains every public name, with the meaning, shape and unit of each argument."""

import doctest
import importlib
import inspect
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from course_lib.grading import Check, expect_drawn
from course_lib.ros.graph.graph import Graph, use_graph

DOCS = Path(__file__).parents[2] / "docs"
ROOMS = ("displays", "robots", "sensors", "grading", "export")
MODULES = ["course_lib", *(f"course_lib.{room}" for room in ROOMS)]
UNIT = re.compile(r"\[(m|rad|s|Hz|px|m/s|ns)\]|0 to 1|by index|[Uu]nit normals")
MADE_BY_THE_KIT = {"course_lib.displays.OwnDisplay"}  # Viewer.add calls it


def page_of(module: str) -> str:
    return (DOCS / "reference" / f"{module.rpartition('.')[2]}.md").read_text("utf-8")


def public(module: str) -> list[tuple[str, Any]]:
    """Return the public names and objects of a module."""
    found = importlib.import_module(module)
    return [(name, getattr(found, name)) for name in found.__all__]


def own_docstring(found: Any) -> str:
    """Return the object's own docstring, not an inherited one."""
    text = found.__dict__.get("__doc__") if inspect.isclass(found) else inspect.getdoc(found)
    return inspect.cleandoc(text or "")


def arguments(module: str) -> Iterator[tuple[str, str, inspect.Parameter]]:
    """Yield the name and docstring of each callable, with each argument."""
    for name, found in public(module):
        made_elsewhere = inspect.isclass(found) and issubclass(found, Exception)
        if callable(found) and not made_elsewhere and f"{module}.{name}" not in MADE_BY_THE_KIT:
            for argument in inspect.signature(found).parameters.values():
                # Python 3.13 and newer have removed the indentation already.
                yield name, inspect.cleandoc(own_docstring(found)), argument


@pytest.mark.parametrize("module", MODULES)
def test_every_public_name_is_in_the_reference(module: str) -> None:
    page = page_of(module)
    [left_out] = re.findall(
        rf"^```{{eval-rst}}\n.. automodule:: {module}\n(?:   :exclude-members: (.*)\n)?```",
        page,
        re.MULTILINE,
    )
    elsewhere = dict(public("course_lib")) if module != "course_lib" else {}
    for name, found in public(module):
        if inspect.ismodule(found):
            assert f"automodule:: {module}.{name}\n" in page
        elif not callable(found):
            assert f"{{py:data}} {module}.{name}\n" in page
        elif name in re.split(", *", left_out):
            assert elsewhere[name] is found
        else:
            assert own_docstring(found), name


def test_reference_pages_match_the_public_modules() -> None:
    pages = {path.stem for path in (DOCS / "reference").glob("*.md")}
    listed = re.findall(r"^reference/(\w+)$", (DOCS / "reference.md").read_text("utf-8"), re.MULTILINE)
    assert pages == set(listed) == {module.rpartition(".")[2] for module in MODULES}


@pytest.mark.parametrize("module", MODULES)
def test_every_argument_is_documented(module: str) -> None:
    shared = " ".join(re.findall(r"^\| (`.*?) \|", page_of(module), re.MULTILINE))  # in a table of the page
    silent = [
        f"{name}: {argument.name}"
        for name, text, argument in arguments(module)
        if not re.search(rf"\b{argument.name}\b", f"{text} {shared}".replace("-", "_"), re.IGNORECASE)
    ]
    assert silent == []


@pytest.mark.parametrize("module", ["course_lib.displays", "course_lib.robots", "course_lib.sensors"])
def test_every_array_argument_has_a_documented_shape_and_unit(module: str) -> None:
    arrays = [
        (
            f"{name}: {argument.name}",
            re.search(rf"^    {argument.name}: (.*(?:\n        .*)*)", text, re.MULTILINE),
        )
        for name, text, argument in arguments(module)
        if re.search("numpy|ArrayLike", repr(argument.annotation))
    ]
    assert arrays
    for where, entry in arrays:
        assert entry, where
        assert re.search(r"[Ss]hape \(", entry[1]), where
        assert UNIT.search(entry[1]), where


def test_help_of_an_expect_function_shows_the_signature_for_authors() -> None:
    signature = inspect.signature(expect_drawn)
    assert list(signature.parameters) == ["class_name", "messages", "best_effort", "call"]
    assert signature.return_annotation is Check
    assert "evidence" not in own_docstring(expect_drawn)


@pytest.mark.parametrize("module", MODULES)
def test_examples_of_public_docstrings_print_the_documented_output(module: str) -> None:
    for name, found in public(module):
        text = own_docstring(found) if callable(found) else ""
        globs = dict(vars(inspect.getmodule(found) or doctest))
        example = doctest.DocTestParser().get_doctest(text, globs, name, None, 0)
        with use_graph(Graph()):
            assert doctest.DocTestRunner().run(example).failed == 0, name


def test_student_functions_with_several_steps_have_an_example() -> None:
    names = ["spin_for", "link_poses", "joints_for", "straight_line", "Wall", "World", "OwnDisplay"]
    texts = {name: own_docstring(found) for module in MODULES for name, found in public(module)}
    assert [name for name in names if "Example:" not in texts[name]] == []
