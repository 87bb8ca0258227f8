"""`course export`: a notebook or a Python file becomes a ROS 2 package."""

import ast
import getpass
import os
import shutil
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from course_lib.errors import CourseError
from course_lib.export.module import Main, NodeModule, dependencies
from course_lib.export.nodes import (
    displays,
    frames,
    needed,
    node_classes,
    node_name,
    obstacles,
    parameters,
    parameters_text,
)
from course_lib.export.statements import Statement, read_cells, statements
from course_lib.ros.package_template import PackageText, check_package_name, filled, package_files

_FOLDERS = {".rviz": "rviz", ".yaml": "config", ".yml": "config", ".urdf": "urdf", ".py": "launch"}
_STARTED = ("launch", "launch_ros", "rviz2")  # by the launch file


@dataclass(frozen=True, repr=False)
class Written:
    """An exported package; iterating over it yields its files.

    Args:
        folder: The package's folder.
        files: What was written, sorted.
        notes: One sentence per class that did not become an executable.
    """

    folder: Path
    files: tuple[Path, ...]
    notes: tuple[str, ...] = ()

    def __iter__(self) -> Iterator[Path]:
        return iter(self.files)

    def __repr__(self) -> str:
        launch = next(path for path in self.files if path.parent.name == "launch")
        start = f"Wrote {len(self.files)} files into {self.folder}. Start it: course run {launch}"
        return "\n".join([start, *self.notes])


def export(
    file: Path,
    package: str,
    out: Path,
    *,
    nodes: Sequence[str] = (),
    extra: Sequence[Path] = (),
    force: bool = False,
) -> Written:
    """Write a package.

    Args:
        file: A notebook, of which the cells marked with `# export` count if there are any, or a .py file.
        package: The package's name.
        out: The folder that the package's folder is put into.
        nodes: The classes that become executables; default: all that derive from Node, but those that
            others inherit from and those that need arguments, which are exported as code only.
        extra: Files that go with them: a layout, parameters, a launch file, a URDF.
        force: Whether what is there may be overwritten; files of other names stay.

    Returns:
        The files written, and which classes are not executables.

    Raises:
        CourseError: Something is missing or wrong; nothing is written then.
    """
    check_package_name(package)
    if (out / package).exists() and not force:
        raise CourseError(f"{out / package} is there already. Write --force to overwrite what export writes.")
    modules, only_code = _modules(file, nodes)
    files = {path: text.encode() for path, text in _texts(file, package, modules, extra).items()}
    for one in extra:
        if one.suffix not in _FOLDERS or not one.is_file():
            raise CourseError(f"{one} cannot go along; give files that end in {', '.join(_FOLDERS)}.")
        files[f"{_FOLDERS[one.suffix]}/{one.name}"] = one.read_bytes()
    _write(files, out / package)
    notes = [_note(name, why, modules) for name, why in only_code.items()]
    return Written(out / package, tuple(out / package / path for path in sorted(files)), tuple(notes))


def _modules(file: Path, nodes: Sequence[str]) -> tuple[list[NodeModule], dict[str, str]]:
    """Return the modules, and by class why some of them are not executables."""
    code = statements(read_cells(file))
    if any(one.cell.marked for one in code):
        kept, left_out = [s for s in code if s.cell.marked], [s for s in code if not s.cell.marked]
    else:
        kept, left_out = code, []
    roots = node_classes(kept, nodes)
    modules = [_module(root, roots, kept, left_out) for root in roots]
    found = {m.class_name: why for m in modules if (why := obstacles(m, modules, kept, named=bool(nodes)))}
    started = [module for module in modules if module.class_name not in found]
    if not started or (found and nodes):
        told = "; ".join(f"{name}() {why}" for name, why in found.items())
        raise CourseError(
            f"Nothing can start this: {told}. Give defaults, or make them parameters: "
            "self.declare_parameter(…)."
        )
    used = {one for module in started for part in module.parts for one in part.gives}
    alone = [replace(m, main=Main.NONE) for m in modules if m.class_name in found.keys() - used]
    for name, count in Counter(module.name for module in [*started, *alone]).items():
        if count > 1:
            raise CourseError(f"{count} classes would become the module {name}.py. Rename all but one.")
    return [*started, *alone], found


def _note(class_name: str, why: str, modules: Sequence[NodeModule]) -> str:
    places = [f"{m.name}.py" for m in modules if any(class_name in part.gives for part in m.parts)]
    return f"{class_name} is not an executable, because it {why}. Its code is in {', '.join(places)}."


def _module(
    root: Statement, roots: Sequence[Statement], kept: Sequence[Statement], left_out: Sequence[Statement]
) -> NodeModule:
    assert isinstance(root.node, ast.ClassDef)
    parts = needed(root, kept, left_out)
    classes = frozenset().union(*(one.gives for one in roots))
    main = next((s for s in reversed(kept) if "main" in s.gives and s.later & classes == root.gives), None)
    if main is None:
        return NodeModule(root.node, parts, Main.MADE)
    of_main = needed(main, kept, left_out)
    parts = sorted({one.order: one for one in (*parts, *of_main)}.values(), key=lambda one: one.order)
    return NodeModule(root.node, parts, Main.OWN)


def _texts(file: Path, package: str, modules: Sequence[NodeModule], extra: Sequence[Path]) -> dict[str, str]:
    """Write all files but the extra ones."""
    imported = set[str]().union(*(module.imported() for module in modules))
    started = [module for module in modules if module.main is not Main.NONE]
    depends, exec_depends = dependencies(imported, package)
    user = getpass.getuser()
    text = PackageText(
        package,
        maintainer=user,
        email=f"{user}@todo.todo",
        description=f"{', '.join(module.class_name for module in modules)}: exported from {file.name}.",
        executables={module.name: f"{module.name}:main" for module in started},
        depends=depends,
        exec_depends=[*exec_depends, *_STARTED],
        about=[f"`{module.name}`: {module.summary}" for module in modules],
    )
    files = package_files(text)
    for module in modules:
        files[f"{package}/{module.name}.py"] = module.text()
    for module in started:
        names = {"package": package, "module": module.name, "name": module.class_name}
        files[f"test/test_{module.name}.py"] = filled("test_node.py", **names)
    return files | _launch(package, started, {_FOLDERS.get(one.suffix, ""): one.name for one in extra})


def _launch(package: str, modules: Sequence[NodeModule], given: dict[str, str]) -> dict[str, str]:
    """Write launch file, parameters and layout, as far as they are not given, by folder."""
    files: dict[str, str] = {}
    values = {name: found for m in modules if (name := node_name(m.node)) and (found := parameters(m.node))}
    config = given.get("config", f"{package}.yaml" if values else "")
    layout = given.get("rviz", f"{package}.rviz")
    if values and "config" not in given:
        files[f"config/{config}"] = parameters_text(values)
    if "rviz" not in given:
        shown = {topic: kind for module in modules for topic, kind in displays(module.node).items()}
        used = Counter(frame for module in modules for frame in frames(module.node))
        fixed_frame = used.most_common(1)[0][0] if used else "map"
        files[f"rviz/{layout}"] = filled("layout.rviz", fixed_frame=fixed_frame, displays=shown)
    if "launch" not in given:
        names = {"package": package, "parameters": config, "layout": layout}
        executables = [module.name for module in modules]
        files[f"launch/{package}.launch.py"] = filled("launch.py", executables=executables, **names)
    return files


def _write(files: dict[str, bytes], target: Path) -> None:
    """Write a folder aside, then rename it; what is there already and not written stays."""
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=target.parent, prefix=f".{target.name}-") as aside:
        draft = Path(aside, "new")
        if target.exists():
            shutil.copytree(target, draft)
        for path, data in files.items():
            (draft / path).parent.mkdir(parents=True, exist_ok=True)
            (draft / path).write_bytes(data)
        if target.exists():
            os.rename(target, Path(aside, "old"))
        os.rename(draft, target)
