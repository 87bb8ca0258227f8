"""One node's module in a package: its imports, what it needs, its class, and main."""

import ast
import io
import re
import sys
import tokenize
from collections.abc import Sequence
from dataclasses import dataclass

from course_lib.errors import CourseError
from course_lib.export.statements import Statement

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


@dataclass(frozen=True)
class NodeModule:
    """A class that becomes a module of the same name in small letters."""

    node: ast.ClassDef
    parts: Sequence[Statement]
    has_main: bool

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
        """Give the top-level packages that it imports."""
        tree = ast.parse(self.text())
        found = {a.name for node in ast.walk(tree) if isinstance(node, ast.Import) for a in node.names}
        found |= {node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
        return {name.partition(".")[0] for name in found}

    def text(self) -> str:
        """Write the module."""
        imports = {part.text for part in self.parts if part.is_import}
        body = [(part.node, part.text) for part in self.parts if not part.is_import]
        if not self.has_main:
            imports |= set(_MAIN_IMPORTS)
            main = _MAIN.format(name=self.class_name)
            body.append((ast.parse(main).body[0], main))
        text = f'"""{self.summary}"""\n\n{_sorted(imports)}\n'
        was_block = True
        for node, part in body:
            is_block = isinstance(node, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef)
            text += ("\n\n" if is_block or was_block else "") + _tidy(part) + "\n"
            was_block = is_block
        return text + "\n\nif __name__ == '__main__':\n    main()\n"


def check_constructor(node: ast.ClassDef) -> None:
    """Raise a CourseError if a class cannot be made without arguments, as main does."""
    for item in node.body:
        if isinstance(item, ast.FunctionDef) and item.name == "__init__":
            positional = [*item.args.posonlyargs, *item.args.args][1:]
            free = positional[: len(positional) - len(item.args.defaults)]
            free += [a for a, d in zip(item.args.kwonlyargs, item.args.kw_defaults, strict=True) if d is None]
            if free:
                raise CourseError(
                    f"{node.name}() needs {', '.join(one.arg for one in free)}, which nobody gives when the "
                    "package starts it. Give defaults, or make them parameters: self.declare_parameter(…)."
                )


def _sorted(imports: set[str]) -> str:
    """Sort imports as ament_flake8 wants them: the standard library, then all others, each by name."""
    groups: dict[bool, list[str]] = {}
    for line in sorted(
        imports, key=lambda line: (line.split()[1].lower(), line.split()[0] == "import", line)
    ):
        groups.setdefault(line.split()[1].partition(".")[0] in sys.stdlib_module_names, []).append(line)
    return "\n\n".join("\n".join(_joined(groups[group])) for group in (True, False) if group in groups)


def _joined(lines: Sequence[str]) -> list[str]:
    """Let names from one module share a line."""
    names: dict[str, list[str]] = {}
    for line in lines:
        head, _, name = line.partition(" import ")
        names.setdefault(head, []).extend([name] if name else [])
    joined = {h: f"{h} import {', '.join(sorted(n, key=str.lower))}" if n else h for h, n in names.items()}
    short = {
        head: [line] if len(line) < MAX_LINE else [f"{head} import {n}" for n in sorted(names[head])]
        for head, line in joined.items()
    }
    return [line for lines in short.values() for line in lines]


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
