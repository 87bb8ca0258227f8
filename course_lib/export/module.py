"""One node's module in a package, and the packages it depends on."""

import ast
import io
import re
import sys
import tokenize
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import Enum

from course_lib.errors import CourseError
from course_lib.export.statements import Statement
from course_lib.ros.standin_path import provided

_ROSDEP = {  # what rosdep calls Python packages, where that is not python3-<name>
    "PIL": "python3-pil",
    "cv2": "python3-opencv",
    "pinocchio": "pinocchio",
    "skimage": "python3-skimage",
    "sklearn": "python3-sklearn",
    "yaml": "python3-yaml",
}
_MAIN = '''def main(args=None):
    """Run the node until it is stopped."""
    rclpy.init(args=args)
    node = {name}()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()'''
_PLAIN = re.compile(r"""(\w*)"([^"'\\\n]*)\"""")  # a string that either quotation mark may enclose
MAX_LINE = 100  # characters, as ament_flake8 has it
_MAIN_IMPORTS = ("import rclpy", "from rclpy.executors import ExternalShutdownException")


def dependencies(imported: Iterable[str], package: str) -> tuple[list[str], list[str]]:
    """Return the ROS packages, and rosdep's keys of others, among imported top-level packages.

    Raises:
        CourseError: The course's library is among them, which no robot has.
    """
    others = set(imported) - set(sys.stdlib_module_names) - {package, ""}
    if "course_lib" in others:
        raise CourseError(
            "The nodes use course_lib, which is not there on a robot. Keep Viewer, spin_for and check out of "
            "what the nodes need."
        )
    ros = others & set(provided())
    return sorted(ros), sorted(_ROSDEP.get(name, f"python3-{name.lower()}") for name in others - ros)


class Main(Enum):
    """The origin of a module's function `main`."""

    OWN = "the exported code"
    MADE = "the template"
    NONE = "nowhere: the module is not an executable"


@dataclass(frozen=True)
class NodeModule:
    """A class that becomes a module of the same name in small letters."""

    node: ast.ClassDef
    parts: Sequence[Statement]
    main: Main

    @property
    def class_name(self) -> str:
        """The class."""
        return self.node.name

    @property
    def name(self) -> str:
        """The module and its executable: TFPublisher's is tf_publisher."""
        words = re.sub(r"([A-Z]+)([A-Z][a-z])", r"\1_\2", self.class_name)
        return re.sub(r"([a-z0-9])([A-Z])", r"\1_\2", words).lower()

    @property
    def summary(self) -> str:
        """The first line of the class's docstring, or its name in words."""
        text = (ast.get_docstring(self.node) or f"The node {self.class_name}.").splitlines()[0].strip()
        return text if text.endswith((".", "!", "?")) else f"{text}."

    def imported(self) -> set[str]:
        """Return the top-level packages that the module imports."""
        tree = ast.parse(self.text())
        found = {a.name for node in ast.walk(tree) if isinstance(node, ast.Import) for a in node.names}
        found |= {node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
        return {name.partition(".")[0] for name in found}

    def text(self) -> str:
        """Write the module."""
        imports = {part.text for part in self.parts if part.is_import}
        body = [(part.node, part.text) for part in self.parts if not part.is_import]
        if self.main is Main.MADE:
            imports |= set(_MAIN_IMPORTS)
            main = _MAIN.format(name=self.class_name)
            body.append((ast.parse(main).body[0], main))
        text = f'"""{self.summary}"""\n\n{_sorted(imports)}\n'
        was_block = True
        for node, part in body:
            is_block = isinstance(node, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef)
            text += ("\n\n" if is_block or was_block else "") + _tidy(part) + "\n"
            was_block = is_block
        return text if self.main is Main.NONE else text + "\n\nif __name__ == '__main__':\n    main()\n"


def _sorted(imports: set[str]) -> str:
    """Sort imports as ament_flake8 expects them: the standard library, then all others, each by name."""
    names = defaultdict[str, list[str]](list)
    for line in imports:
        head, _, name = line.partition(" import ")
        names[head] += [name] if name else []
    groups: dict[bool, list[str]] = {True: [], False: []}
    for head in sorted(names, key=lambda head: (head.split()[1].lower(), head.startswith("import"), head)):
        is_standard = head.split()[1].partition(".")[0] in sys.stdlib_module_names
        joined = f"{head} import {', '.join(sorted(names[head], key=str.lower))}" if names[head] else head
        fits = len(joined) < MAX_LINE
        groups[is_standard] += [joined] if fits else [f"{head} import {name}" for name in sorted(names[head])]
    return "\n\n".join("\n".join(lines) for lines in groups.values() if lines)


def _tidy(text: str) -> str:
    """Write a part as ROS's linters want it: ' around strings, a full stop behind one-line docstrings."""
    lines = text.splitlines()
    for token in reversed(list(tokenize.generate_tokens(io.StringIO(text).readline))):
        plain = _PLAIN.fullmatch(token.string)
        if token.type == tokenize.STRING and plain:
            row, begin, end = token.start[0] - 1, token.start[1], token.end[1]
            lines[row] = f"{lines[row][:begin]}{plain[1]}'{plain[2]}'{lines[row][end:]}"
    text = "\n".join(lines)
    return re.sub(r'^(\s+"""[^"\n]*[^"\n.!?:\s])\s*"""$', r'\1."""', text, flags=re.MULTILINE)
