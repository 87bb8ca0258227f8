"""`course export`: convert a notebook or a Python file to a ROS 2 package."""

import ast
import os
import re
import shutil
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from course_lib.course.exercise import code_cells, read_notebook
from course_lib.errors import CourseError
from course_lib.export.module import (
    Main,
    NodeModule,
    dependencies,
    imported_modules,
    node_modules,
    parameters_text,
)
from course_lib.files import draft_folder
from course_lib.host import user_name
from course_lib.ros.package_template import PackageText, check_package_name, fill_template, package_files
from course_lib.ros.programs.build_files import build_faults, executables_of
from course_lib.third_party import parse_python, read_bytes, read_text

_FOLDERS = {".rviz": "rviz", ".yaml": "config", ".yml": "config", ".urdf": "urdf", ".py": "launch"}
# Packages that the launch file needs.
_STARTED = ("launch", "launch_ros", "rviz2")


@dataclass(frozen=True, repr=False)
class ExportedPackage:
    """An exported package; iterating over it yields its files.

    Args:
        folder: The package's folder.
        files: The written files, sorted.
        notes: A sentence for each class that did not become an executable.
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
) -> ExportedPackage:
    """Write a package.

    Args:
        file: A .py file, or a notebook. If a notebook has cells marked with `# export`, only these
            are exported.
        package: The package's name.
        out: The folder in which the package's folder is created.
        nodes: The classes that become executables; default: all subclasses of Node, except base
            classes of others and classes that need arguments, which are exported as code only.
        extra: Files to include: a layout, parameters, a launch file, a URDF.
        force: Whether existing files may be overwritten. Files with other names are kept.

    Returns:
        The package.

    Raises:
        CourseError: The code or the arguments are invalid. In this case nothing is written.
    """
    check_package_name(package)
    if (out / package).exists() and not force:
        raise CourseError(f"{out / package} already exists. Use --force to overwrite the exported files.")
    modules, only_code = node_modules(file, nodes)
    files = {path: text.encode() for path, text in _file_texts(file, package, modules, extra).items()}
    for path in extra:
        if path.suffix not in _FOLDERS or not path.is_file():
            raise CourseError(f"{path} cannot be included; pass files that end in {', '.join(_FOLDERS)}.")
        files[f"{_FOLDERS[path.suffix]}/{path.name}"] = read_bytes(path)
    # Write into a temporary folder, then rename it. Other existing files are kept.
    target = out / package
    with draft_folder(target) as folder:
        draft = folder / "new"
        if target.exists():
            shutil.copytree(target, draft)
        for place, data in files.items():
            (draft / place).parent.mkdir(parents=True, exist_ok=True)
            (draft / place).write_bytes(data)
        if target.exists():
            os.rename(target, folder / "old")
        os.rename(draft, target)
    notes = list(_copy_note(file))
    for name, why in only_code.items():
        places = [f"{m.name}.py" for m in modules if any(name in part.bindings for part in m.statements)]
        notes.append(f"{name} is not an executable, because it {why}. Its code is in {', '.join(places)}.")
    return ExportedPackage(out / package, tuple(out / package / path for path in sorted(files)), tuple(notes))


def _copy_note(file: Path) -> Iterator[str]:
    """Yield a note if the running notebook is a copy of the exported one, with most of its cells."""
    running = Path(os.environ.get("JPY_SESSION_NAME", ""))
    if not (file.suffix == running.suffix == ".ipynb" and running.is_file()) or running.samefile(file):
        return
    notebooks = (code_cells(read_notebook(path)) for path in (file, running))
    ids, running_ids = ({cell["id"] for _, cell in cells if "id" in cell} for cells in notebooks)
    if len(ids & running_ids) > len(ids) / 2:
        note = f"The code is from {file.name}. This notebook is {running.name}: write its name to export it."
        print(note)  # noqa: T201  the cell's output, which need not show the package
        yield note


def _file_texts(
    file: Path, package: str, modules: Sequence[NodeModule], extra: Sequence[Path]
) -> dict[str, str]:
    """Return the contents of all files by path, except the extra files."""
    imports = set[str]().union(*(imported_modules(ast.parse(module.text())) for module in modules))
    started = [module for module in modules if module.main is not Main.NONE]
    depends, exec_depends = dependencies(imports, package)
    user = user_name()
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
        files[f"test/test_{module.name}.py"] = fill_template("test_node.py", **names)
    return files | _launch_files(package, started, {_FOLDERS.get(p.suffix, ""): p.name for p in extra})


def _launch_files(
    package: str,
    modules: Sequence[NodeModule],
    given: dict[str, str],
) -> dict[str, str]:
    """Return the launch file, the parameters and the layout by path, without the files in `given`.

    Args:
        package: The package's name.
        modules: The executables.
        given: The names of the extra files by folder.
    """
    files: dict[str, str] = {}
    values = {name: found for m in modules if (name := m.node_name) and (found := m.parameters())}
    config = given.get("config", f"{package}.yaml" if values else "")
    layout = given.get("rviz", f"{package}.rviz")
    if values and "config" not in given:
        files[f"config/{config}"] = parameters_text(values)
    if "rviz" not in given:
        displays_by_topic = {
            topic: kind for module in modules for topic, kind in module.display_classes().items()
        }
        frame_counts = Counter(frame for module in modules for frame in module.frames())
        fixed_frame = frame_counts.most_common(1)[0][0] if frame_counts else "map"
        files[f"rviz/{layout}"] = fill_template(
            "layout.rviz", fixed_frame=fixed_frame, displays=displays_by_topic
        )
    if "launch" not in given:
        names = {"package": package, "parameters": config, "layout": layout}
        executables = [module.name for module in modules]
        files[f"launch/{package}.launch.py"] = fill_template("launch.py", executables=executables, **names)
    return files


_REQUIRED = ("package.xml", "setup.py", "setup.cfg", "resource/{}", "{}/__init__.py")
_RECOMMENDED = ("launch/*.py", "config/*.yaml", "rviz/*.rviz", "test/test_*.py", "README.md")
_TESTED_BY = ("ament_copyright", "ament_flake8", "ament_pep257", "python3-pytest")


@dataclass(frozen=True)
class Report:
    """The missing parts of a package: those required to build and start it, and advised ones.

    `faults` are sentences on parts with which the build or the start fails on a robot.
    """

    name: str
    missing: tuple[str, ...]
    advice: tuple[str, ...]
    faults: tuple[str, ...] = ()

    @property
    def is_complete(self) -> bool:
        """True if the package can be built and started."""
        return not self.missing and not self.faults

    def lines(self) -> list[str]:
        """Return a line for each missing part."""
        lines = [f"lacks: {text}" for text in self.missing] + [f"fails: {text}" for text in self.faults]
        lines += [f"advised: {text}" for text in self.advice]
        return lines or [f"{self.name} has everything that a package needs."]


def check_package(folder: Path) -> Report:
    """Check the folder of a package for missing files and entries.

    Args:
        folder: The package's folder, which contains package.xml.

    Returns:
        The missing parts, and advice on recommended files.

    Raises:
        CourseError: The folder does not exist.
    """
    if not folder.is_dir():
        raise CourseError(f"There is no folder {folder}. Pass the folder that contains package.xml.")
    name = folder.resolve().name
    required = [path.format(name) for path in _REQUIRED]
    missing = [f"the file {path}" for path in required if not (folder / path).is_file()]
    faults: list[str] = []
    advice = [f"a file {path}" for path in _RECOMMENDED if not any(folder.glob(path))]
    for file, check in (
        ("package.xml", _check_manifest),
        ("setup.py", _check_setup),
        ("setup.cfg", _check_setup_cfg),
    ):
        if (folder / file).is_file():
            missing += check(folder / file, name)
    if (folder / "package.xml").is_file():
        text = read_text(folder / "package.xml")
        for tester in _TESTED_BY:
            if f"<test_depend>{tester}<" not in text:
                advice.append(f"package.xml: <test_depend>{tester}</test_depend>")
        if "TODO" in text:
            advice.append("package.xml: text in place of each TODO")
        if "@todo" in text or "example.com" in text:
            advice.append("package.xml: your name and address as maintainer")
        faults = build_faults(name, folder)
    # A line on a missing part of a file says the same in fewer words.
    told = [file for file in _REQUIRED[:3] if any(file in line for line in missing)]
    faults = [fault for fault in faults if Path(fault.partition(":")[0].partition(",")[0]).name not in told]
    return Report(name, tuple(missing), tuple(advice), tuple(faults))


def _check_manifest(file: Path, name: str) -> Iterator[str]:
    try:
        root = ET.fromstring(read_bytes(file))
    except ET.ParseError as error:
        yield f"a package.xml that is valid XML: {error}"
        return
    if root.get("format") != "3":
        yield 'package.xml: <package format="3">'
    if (root.findtext("name") or "").strip() != name:
        yield f"package.xml: <name>{name}</name>, the name of its folder"
    for tag in ("version", "description", "maintainer", "license"):
        if not (root.findtext(tag) or "").strip():
            yield f"package.xml: <{tag}>"
    if (root.findtext("export/build_type") or "").strip() != "ament_python":
        yield "package.xml: <export><build_type>ament_python</build_type></export>"
    declared = {(element.text or "").strip() for element in root if element.tag.endswith("depend")}
    imported = set[str]()
    for module in (file.parent / name).rglob("*.py"):
        try:
            tree = parse_python(read_text(module))
        except SyntaxError as error:
            raise CourseError(f"{module}, line {error.lineno}: {error.msg}. Correct it first.") from error
        imported |= imported_modules(tree)
    ros, python_packages = dependencies(imported, name)
    for tag, names in (("depend", ros), ("exec_depend", python_packages)):
        yield from (f"package.xml: <{tag}>{name}</{tag}>" for name in names if name not in declared)


def _check_setup(file: Path, name: str) -> Iterator[str]:
    text = read_text(file)
    if f"'{name}'" not in text.replace('"', "'"):
        yield f"setup.py: name='{name}'"
    executables = executables_of(file)
    if not executables:
        yield "setup.py: an executable in console_scripts"
    for executable, (module, function) in executables.items():
        source = file.parent / (module.replace(".", "/") + ".py")
        if not source.is_file():
            yield f"setup.py: {executable} starts {module}, and there is no {source.relative_to(file.parent)}"
        elif f"\ndef {function}(" not in read_text(source):
            yield f"{source.relative_to(file.parent)}: the function {function}, which {executable} starts"
    for folder in ("launch", "config", "rviz", "urdf"):
        if any((file.parent / folder).glob("*")) and folder not in text:
            yield f"setup.py: {folder}/ in data_files"
    if "resource_index/packages" not in text:
        yield "setup.py: the marker resource/ in data_files"


def _check_setup_cfg(file: Path, name: str) -> Iterator[str]:
    text = re.sub(r"\s*=\s*", "=", read_text(file).replace("-", "_"))
    yield from (
        f"setup.cfg: {line}"
        for line in (f"script_dir=$base/lib/{name}", f"install_scripts=$base/lib/{name}")
        if line not in text
    )
