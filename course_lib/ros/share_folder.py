"""The share folder of a package's sources, as colcon would install it.

Sources count as their share folder. Where setup.py or CMakeLists.txt installs a file in another place than it
has in the sources, the share folder is one of links, in which it has both.
"""

import ast
import atexit
import os
import re
import shutil
import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path, PurePosixPath

_MOST = 10_000  # files of one package
_INSTALL = re.compile(
    r"install\s*\(\s*(FILES|DIRECTORY)\s+([^()]*?)\s+DESTINATION\s+\"?share/\$\{PROJECT_NAME\}([^\s\")]*)"
)


def share_folder(name: str, sources: Path) -> Path:
    """Return the folder in which the files of a package have the places that they are installed in."""
    moved = {place: file for place, file in _installed(name, sources) if not (sources / place).exists()}
    return _linked(sources, tuple(sorted(moved.items()))) if moved else sources


def _installed(name: str, sources: Path) -> Iterator[tuple[str, Path]]:
    """Yield each place in the share folder with its file or folder in the sources."""
    for destination, file in (*_of_setup(sources / "setup.py"), *_of_cmake(name, sources / "CMakeLists.txt")):
        place = PurePosixPath(os.path.normpath(destination))
        inside = (sources / file).resolve().is_relative_to(sources.resolve())
        if place.is_relative_to(f"share/{name}") and inside and (sources / file).exists():
            yield str(place.relative_to(f"share/{name}")), sources / file


def _of_setup(setup: Path) -> Iterator[tuple[str, str]]:
    """Yield what setup.py, which is not run, names in data_files: each destination, and its file."""
    try:
        tree = ast.parse(setup.read_text(encoding="utf-8"))
    except (OSError, ValueError, SyntaxError):  # finding its executables tells of mistakes
        return
    values = _Values(setup.parent)
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            values.names[node.targets[0].id] = node.value
    for node in ast.walk(tree):
        if isinstance(node, ast.keyword) and node.arg == "data_files":
            listed = values.names.get(node.value.id) if isinstance(node.value, ast.Name) else node.value
            for entry in listed.elts if isinstance(listed, ast.List | ast.Tuple) else ():
                if isinstance(entry, ast.Tuple) and len(entry.elts) == 2:
                    yield from values.pairs(*entry.elts)


class _Values:
    """The values of expressions in a setup.py, as far as they are made of text, lists, join and glob."""

    def __init__(self, folder: Path) -> None:
        self.names: dict[str, ast.expr] = {}
        self._folder = folder

    def pairs(self, destination: ast.expr, files: ast.expr) -> Iterator[tuple[str, str]]:
        """Yield the place of each file of an entry; none for an entry that is made of anything else."""
        try:
            [place] = self._of(destination)
            found = self._of(files)
        except (ValueError, RecursionError):
            return
        yield from ((os.path.join(place, os.path.basename(file)), file) for file in found[:_MOST])

    def _of(self, node: ast.expr | None) -> list[str]:
        match node:
            case ast.Constant(value=str(text)):
                return [text]
            case ast.Name(id=name):
                return self._of(self.names.get(name))
            case ast.List(elts=parts):
                return [one for part in parts for one in self._of(part)]
            case ast.BinOp(left=left, op=ast.Add(), right=right):
                first, second = self._of(left), self._of(right)
                lists = isinstance(left, ast.List | ast.Call) and isinstance(right, ast.List | ast.Call)
                return [*first, *second] if lists else ["".join([*first, *second])]
            case ast.JoinedStr(values=parts):
                texts = [part.value if isinstance(part, ast.FormattedValue) else part for part in parts]
                return ["".join(text for part in texts for text in self._of(part))]
            case ast.Call(func=ast.Attribute(attr=name) | ast.Name(id=name), args=arguments):
                return self._called(name, [text for part in arguments for text in self._of(part)])
        raise ValueError("neither text nor a list of texts")

    def _called(self, name: str, texts: list[str]) -> list[str]:
        if not texts:
            raise ValueError(f"{name} without a text")
        if name == "join":
            return [os.path.join(*texts)]
        if name in ("glob", "iglob") and not os.path.isabs(texts[0]) and ".." not in texts[0]:
            return sorted(str(path.relative_to(self._folder)) for path in self._folder.glob(texts[0]))
        raise ValueError(name)


def _of_cmake(name: str, cmake: Path) -> Iterator[tuple[str, str]]:
    """Yield what CMakeLists.txt installs in the share folder: each destination, and its file or folder."""
    text = cmake.read_text("utf-8", errors="replace") if cmake.is_file() else ""
    for kind, words, below in _INSTALL.findall(re.sub(r"#.*", "", text)):
        for word in words.split():
            source = word.strip('"')
            if kind == "DIRECTORY" and source.endswith("/") and (cmake.parent / source).is_dir():
                inner = sorted((cmake.parent / source).iterdir())[:_MOST]
                yield from ((f"share/{name}{below}/{one.name}", source + one.name) for one in inner)
            else:
                yield f"share/{name}{below}/{os.path.basename(source.rstrip('/'))}", source


@cache
def _linked(sources: Path, moved: tuple[tuple[str, Path], ...]) -> Path:
    """Create a folder of links to the sources, and to files in their installed places."""
    folder = Path(tempfile.mkdtemp(prefix="share_"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    _link_all(sources, folder)
    for place, file in moved:
        at = folder
        for part in PurePosixPath(place).parts[:-1]:
            at /= part
            if at.is_symlink():  # a folder of the sources: its files stay there
                inner = at.resolve()
                at.unlink()
                at.mkdir()
                _link_all(inner, at)
            at.mkdir(exist_ok=True)
        link = folder / place
        if not link.exists():
            link.symlink_to(file.resolve())
    return folder


def _link_all(source: Path, target: Path) -> None:
    for path in source.iterdir():
        (target / path.name).symlink_to(path.resolve())
