"""`course export --check`: what a package lacks."""

import ast
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from course_lib.errors import CourseError
from course_lib.export.module import dependencies
from course_lib.ros.packages import executables_of

_REQUIRED = ("package.xml", "setup.py", "setup.cfg", "resource/{}", "{}/__init__.py")
_RECOMMENDED = ("launch/*.py", "config/*.yaml", "rviz/*.rviz", "test/test_*.py", "README.md")
_TESTED_BY = ("ament_copyright", "ament_flake8", "ament_pep257", "python3-pytest")


@dataclass(frozen=True)
class Report:
    """The parts that a package lacks: those required to build and start it, and those advised."""

    name: str
    missing: tuple[str, ...]
    advised: tuple[str, ...]

    @property
    def complete(self) -> bool:
        """True if the package can be built and started."""
        return not self.missing

    def lines(self) -> list[str]:
        """Return a line for each missing part."""
        told = [f"lacks: {text}" for text in self.missing] + [f"advised: {text}" for text in self.advised]
        return told or [f"{self.name} has all that a package needs."]


def lacks(folder: Path) -> Report:
    """Look a package's folder through; raises a CourseError if there is none."""
    if not folder.is_dir():
        raise CourseError(f"There is no folder {folder}. Name the one that holds package.xml.")
    name = folder.resolve().name
    required = [path.format(name) for path in _REQUIRED]
    missing = [f"the file {path}" for path in required if not (folder / path).is_file()]
    advised = [f"a file {path}" for path in _RECOMMENDED if not any(folder.glob(path))]
    for file, check in (("package.xml", _manifest), ("setup.py", _setup), ("setup.cfg", _cfg)):
        if (folder / file).is_file():
            missing += check(folder / file, name)
    if (folder / "package.xml").is_file():
        advised += _advice((folder / "package.xml").read_text(encoding="utf-8"))
    return Report(name, tuple(missing), tuple(advised))


def _manifest(file: Path, name: str) -> Iterator[str]:
    try:
        root = ET.fromstring(file.read_bytes())
    except ET.ParseError as error:
        yield f"a package.xml that is XML: {error}"
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
    named = {(one.text or "").strip() for one in root if one.tag.endswith("depend")}
    ros, others = dependencies(_imports(file.parent / name), name)
    for tag, names in (("depend", ros), ("exec_depend", others)):
        yield from (f"package.xml: <{tag}>{one}</{tag}>" for one in names if one not in named)


def _setup(file: Path, name: str) -> Iterator[str]:
    text = file.read_text(encoding="utf-8")
    if f"'{name}'" not in text.replace('"', "'"):
        yield f"setup.py: name='{name}'"
    executables = executables_of(file)
    if not executables:
        yield "setup.py: an executable in console_scripts"
    for executable, (module, function) in executables.items():
        source = file.parent / (module.replace(".", "/") + ".py")
        if not source.is_file():
            yield f"setup.py: {executable} starts {module}, and there is no {source.relative_to(file.parent)}"
        elif f"\ndef {function}(" not in source.read_text(encoding="utf-8"):
            yield f"{source.relative_to(file.parent)}: the function {function}, which {executable} starts"
    for folder in ("launch", "config", "rviz", "urdf"):
        if any((file.parent / folder).glob("*")) and folder not in text:
            yield f"setup.py: {folder}/ in data_files"
    if "resource_index/packages" not in text:
        yield "setup.py: the marker resource/ in data_files"


def _cfg(file: Path, name: str) -> Iterator[str]:
    text = re.sub(r"\s*=\s*", "=", file.read_text(encoding="utf-8").replace("-", "_"))
    yield from (
        f"setup.cfg: {line}"
        for line in (f"script_dir=$base/lib/{name}", f"install_scripts=$base/lib/{name}")
        if line not in text
    )


def _advice(text: str) -> Iterator[str]:
    for name in _TESTED_BY:
        if f"<test_depend>{name}<" not in text:
            yield f"package.xml: <test_depend>{name}</test_depend>"
    if "TODO" in text:
        yield "package.xml: words in the place of each TODO"
    if "@todo" in text or "example.com" in text:
        yield "package.xml: your name and address as maintainer"


def _imports(folder: Path) -> set[str]:
    found = set[str]()
    for file in folder.rglob("*.py"):
        try:
            tree = ast.parse(file.read_text(encoding="utf-8"))
        except SyntaxError as error:
            raise CourseError(f"{file}, line {error.lineno}: {error.msg}. Correct it first.") from error
        for node in ast.walk(tree):
            if isinstance(node, ast.Import):
                found |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and not node.level:
                found.add((node.module or "").partition(".")[0])
    return found
