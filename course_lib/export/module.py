"""The code of an exported package: a module for each node class of a notebook or Python file."""

import ast
import builtins
import io
import re
import symtable
import sys
import tokenize
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from pathlib import Path
from typing import Any

from course_lib.course.exercise import code_cells, read_notebook, source
from course_lib.errors import CourseError
from course_lib.ros.programs.import_path import provided_packages
from course_lib.third_party import parse_python, parse_scopes, read_text

_MARK = re.compile(r"\s*#\s*\|?\s*export\s*$", re.MULTILINE)


@dataclass(frozen=True)
class Cell:
    """The Python code of a cell, its number in JupyterLab, and whether it is marked for export."""

    number: int
    source: str
    is_marked: bool


def read_cells(file: Path) -> list[Cell]:
    """Read a .py file as a single cell, or the code cells of a notebook, with its local modules.

    Raises:
        CourseError: The file cannot be read, or is not a notebook.
    """
    if file.suffix == ".ipynb":
        cells: list[Cell] = []
        for number, cell in code_cells(read_notebook(file)):
            code, tags = source(cell), cell.get("metadata", {}).get("tags", ())
            is_marked = bool(_MARK.match(code)) or "export" in tags
            cells += _split_off_modules(Cell(number, without_magics(code), is_marked), file.parent)
        return cells
    return [Cell(1, _text(file), is_marked=True)]


def _text(file: Path) -> str:
    try:
        return read_text(file)
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not UTF-8 text"
        raise CourseError(
            f"{file} cannot be read: {reason}. Pass the path of an .ipynb or .py file."
        ) from error


def _split_off_modules(cell: Cell, folder: Path) -> Iterator[Cell]:
    """Yield the local modules that a cell imports from, then the cell without these imports."""
    lines = cell.source.splitlines()
    modules = {name: folder / f"{name}.py" for name in re.findall(r"^from (\w+) import", cell.source, re.M)}
    for name, module in modules.items():
        if module.is_file():
            yield Cell(cell.number, _text(module), cell.is_marked)
            for node in parse_python(cell.source).body:
                if isinstance(node, ast.ImportFrom) and node.module == name:
                    first, last = node.lineno - 1, node.end_lineno or node.lineno
                    lines[first:last] = [""] * (last - first)
    yield Cell(cell.number, "\n".join(lines), cell.is_marked)


def without_magics(source: str) -> str:
    """Convert a cell to Python: its magics become calls, and its `# export` comment is removed."""
    from IPython.core.inputtransformer2 import TransformerManager

    manager = TransformerManager()
    return _MARK.sub("", manager.transform_cell(source), count=1)


@dataclass(frozen=True)
class Statement:
    """A statement of a cell.

    Attributes:
        order: Its index among all statements.
        text: Its source, with the comments above it. Imports have a single name.
        bindings: The names that it binds.
        changes: The names of objects that it mutates, as in `COLORS["car"] = RED`.
        now: The names that it needs when it runs.
        later: The names that its functions need when they are called.
    """

    order: int
    cell: Cell
    node: ast.stmt = field(repr=False)
    text: str
    bindings: frozenset[str]
    changes: frozenset[str]
    now: frozenset[str]
    later: frozenset[str]

    @property
    def is_import(self) -> bool:
        """Whether it is an import."""
        return isinstance(self.node, ast.Import | ast.ImportFrom)


def statements(cells: Sequence[Cell]) -> list[Statement]:
    """Split cells into statements.

    Raises:
        CourseError: A cell is not valid Python.
    """
    collected: list[Statement] = []
    for cell in cells:
        try:
            nodes = parse_python(cell.source).body
        except SyntaxError as error:
            raise CourseError(
                f"Cell {cell.number}, line {error.lineno}: {error.msg}. Correct it first."
            ) from error
        for node, text in _split_imports(cell.source, nodes):
            now, later = _required_names(text)
            bindings, changes = frozenset(bound_names(node)), frozenset(mutated_names(node))
            if isinstance(node, ast.AugAssign):
                now |= bindings
            # An assignment like X = X + 1 needs the previous X.
            elif not isinstance(node, ast.Assign):
                now -= bindings
            collected.append(Statement(len(collected), cell, node, text, bindings, changes, now, later))
    return collected


def _split_imports(source: str, nodes: Sequence[ast.stmt]) -> Iterator[tuple[ast.stmt, str]]:
    """Yield each statement with its text.

    An import of several names is split into several imports.
    """
    lines, end = source.splitlines(), 0
    for node in nodes:
        first = min([node.lineno, *(d.lineno for d in getattr(node, "decorator_list", ()))]) - 1
        begin, end_before = first, end
        while begin > end_before and lines[begin - 1].startswith("#"):
            begin -= 1
        end = node.end_lineno or node.lineno
        if isinstance(node, ast.Import):
            for name in node.names:
                yield (statement := ast.Import([name])), ast.unparse(statement)
        elif isinstance(node, ast.ImportFrom):
            for name in node.names:
                yield (part := ast.ImportFrom(node.module, [name], node.level)), ast.unparse(part)
        # The statement follows a semicolon.
        elif first < end_before:
            yield node, ast.unparse(node)
        else:
            yield node, "\n".join(line.rstrip() for line in lines[begin:end])


def bound_names(node: ast.AST) -> Iterator[str]:
    """Yield the names that a statement binds in its module."""
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        yield node.name
        return
    if isinstance(node, ast.alias):
        yield (node.asname or node.name).partition(".")[0]
    elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
        yield node.id
    if not isinstance(node, ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp | ast.Lambda):
        for child in ast.iter_child_nodes(node):
            yield from bound_names(child)


def imported_modules(tree: ast.AST) -> frozenset[str]:
    """Return the top-level names of imported modules, including imports in functions and classes."""
    names = set[str]()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and not node.level:
            names.add(node.module or "")
    return frozenset(name.partition(".")[0] for name in names)


def mutated_names(node: ast.stmt) -> Iterator[str]:
    """Yield the names of objects that a statement mutates: a subscript, attribute or method call."""
    targets: list[ast.expr] = []
    if isinstance(node, ast.Assign | ast.Delete):
        targets = node.targets
    elif isinstance(node, ast.AugAssign):
        targets = [node.target]
    elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
        targets = [node.value.func]
    for target in targets:
        inner: ast.expr = target
        while isinstance(inner, ast.Subscript | ast.Attribute):
            inner = inner.value
        if isinstance(inner, ast.Name) and inner is not target:
            yield inner.id


def _required_names(text: str) -> tuple[frozenset[str], frozenset[str]]:
    """Return the names that code requires when it runs, and when its functions are called."""
    now, later = set[str](), set[str]()

    def collect(table: symtable.SymbolTable, names: set[str]) -> None:
        top = table.get_type() == "module"
        names |= {s.get_name() for s in table.get_symbols() if s.is_referenced() and (top or s.is_global())}
        for child in table.get_children():
            # Classes and comprehensions run immediately, unlike functions.
            is_immediate = child.get_type() == "class" or child.get_name() == "genexpr"
            collect(child, names if is_immediate else later)

    collect(parse_scopes(text), now)
    return frozenset(now), frozenset(later)


# rosdep's keys of Python packages that differ from python3-<name>.
_ROSDEP = {
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
# A string literal whose double quotes can be replaced by single quotes.
_DOUBLE_QUOTED = re.compile(r"""(\w*)"([^"'\\\n]*)\"""")
# Maximum line length of ament_flake8.
MAX_LINE = 100
_MAIN_IMPORTS = ("import rclpy", "from rclpy.executors import ExternalShutdownException")


def dependencies(imported: Iterable[str], package: str) -> tuple[list[str], list[str]]:
    """Split imported top-level packages into ROS packages and the rosdep keys of all others.

    Raises:
        CourseError: The code imports course_lib, which is not installed on robots.
    """
    third_party = set(imported) - set(sys.stdlib_module_names) - {package, ""}
    if "course_lib" in third_party:
        raise CourseError(
            "The nodes use course_lib, which robots do not have. Remove Viewer, spin_for and "
            "check from the code that the nodes use."
        )
    ros = third_party & set(provided_packages())
    return sorted(ros), sorted(_ROSDEP.get(name, f"python3-{name.lower()}") for name in third_party - ros)


# RViz's display class by message type.
_DISPLAYS = {
    "Image": "Image",
    "LaserScan": "LaserScan",
    "Marker": "Marker",
    "MarkerArray": "MarkerArray",
    "Odometry": "Odometry",
    "Path": "Path",
    "PointCloud2": "PointCloud2",
    "PoseArray": "PoseArray",
    "PoseStamped": "Pose",
}


class Main(Enum):
    """The origin of a module's function `main`."""

    OWN = "the exported code"
    TEMPLATE = "the template"
    NONE = "nowhere: the module is not an executable"


@dataclass(frozen=True)
class NodeModule:
    """A node class and the statements of the module that it is exported to."""

    node: ast.ClassDef
    statements: Sequence[Statement]
    main: Main

    @property
    def class_name(self) -> str:
        """The name of the class."""
        return self.node.name

    @property
    def name(self) -> str:
        """The name of the module and its executable, like tf_publisher for TFPublisher."""
        split_name = re.sub(r"([A-Z]+)([A-Z][a-z])", r"\1_\2", self.class_name)
        return re.sub(r"([a-z0-9])([A-Z])", r"\1_\2", split_name).lower()

    @property
    def summary(self) -> str:
        """The first line of the class's docstring, or a sentence with its name."""
        text = (ast.get_docstring(self.node) or f"The node {self.class_name}.").splitlines()[0].strip()
        return text if text.endswith((".", "!", "?")) else f"{text}."

    def text(self) -> str:
        """Return the source of the module."""
        imports = {part.text for part in self.statements if part.is_import}
        body = [(part.node, part.text) for part in self.statements if not part.is_import]
        if self.main is Main.TEMPLATE:
            imports |= set(_MAIN_IMPORTS)
            main = _MAIN.format(name=self.class_name)
            body.append((ast.parse(main).body[0], main))
        text = f'"""{self.summary}"""\n\n{_sort_imports(imports)}\n'
        was_block = True
        for node, part in body:
            is_block = isinstance(node, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef)
            text += ("\n\n" if is_block or was_block else "") + _tidy(part) + "\n"
            was_block = is_block
        return text if self.main is Main.NONE else text + "\n\nif __name__ == '__main__':\n    main()\n"

    @property
    def node_name(self) -> str | None:
        """The name in `super().__init__("name")`, if it is a literal."""
        calls = (call for call in self._calls("__init__") if call.args)
        return next((text for call in calls if isinstance(text := _literal(call.args[0]), str)), None)

    def parameters(self) -> dict[str, Any]:
        """Return the parameters that the class declares with a literal default."""
        values = {}
        for call in self._calls("declare_parameter"):
            default = call.args[1] if len(call.args) > 1 else None
            value = None if default is None else _literal(default)
            if call.args and isinstance(name := _literal(call.args[0]), str) and value not in (None, []):
                values[name] = value
        return values

    def display_classes(self) -> dict[str, str]:
        """Return RViz's display class for each topic that the class publishes, if RViz has one."""
        class_names = {}
        for call in self._calls("create_publisher"):
            if len(call.args) > 1 and isinstance(topic := _literal(call.args[1]), str):
                kind = call.args[0]
                name = kind.attr if isinstance(kind, ast.Attribute) else getattr(kind, "id", "")
                if name in _DISPLAYS:
                    class_names[topic if topic.startswith("/") else f"/{topic}"] = _DISPLAYS[name]
        return class_names

    def frames(self) -> list[str]:
        """Return the frames that the class assigns to `frame_id`."""
        return [
            value
            for node in ast.walk(self.node)
            if isinstance(node, ast.Assign) and isinstance(value := _literal(node.value), str)
            if any(isinstance(target, ast.Attribute) and target.attr == "frame_id" for target in node.targets)
        ]

    def obstacle(self, modules: Sequence["NodeModule"], code: Sequence[Statement], *, named: bool) -> str:
        """Return why the class cannot become an executable, like "needs name", or "" if it can.

        Args:
            modules: All classes that may become executables.
            code: The exported statements, in which base classes are looked up.
            named: Whether the user chose the class by name. Then it may be a base of other classes.
        """
        if self.main is Main.OWN:
            return ""
        classes = {s.node.name: s.node for s in code if isinstance(s.node, ast.ClassDef)}
        heirs = [other.class_name for other in modules if self.class_name in _direct_bases(other.node)]
        if heirs and not named:
            return f"is the base of {', '.join(heirs)}"
        if arguments := _required_arguments(self.node, classes):
            return f"needs {', '.join(arguments)}"
        methods = (item for item in self.node.body if isinstance(item, ast.FunctionDef))
        abstract = [
            method.name
            for method in methods
            if any(ast.unparse(d).endswith("abstractmethod") for d in method.decorator_list)
        ]
        return f"leaves {', '.join(abstract)} abstract" if abstract else ""

    def _calls(self, method: str) -> Iterator[ast.Call]:
        for node in ast.walk(self.node):
            if isinstance(node, ast.Call) and getattr(node.func, "attr", "") == method:
                yield node


def _sort_imports(imports: set[str]) -> str:
    """Sort imports by name as ament_flake8 expects, the standard library first."""
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
    """Format code for ROS's linters: single quotes, and a period after one-line docstrings."""
    lines = text.splitlines()
    for token in reversed(list(tokenize.generate_tokens(io.StringIO(text).readline))):
        plain = _DOUBLE_QUOTED.fullmatch(token.string)
        if token.type == tokenize.STRING and plain:
            row, begin, end = token.start[0] - 1, token.start[1], token.end[1]
            lines[row] = f"{lines[row][:begin]}{plain[1]}'{plain[2]}'{lines[row][end:]}"
    text = "\n".join(lines)
    return re.sub(r'^(\s+"""[^"\n]*[^"\n.!?:\s])\s*"""$', r'\1."""', text, flags=re.MULTILINE)


def node_modules(file: Path, nodes: Sequence[str]) -> tuple[list[NodeModule], dict[str, str]]:
    """Return the modules of a file's nodes, and why each other class is not an executable.

    Args:
        file: A .py file or a notebook.
        nodes: The classes to export; empty for all node classes.

    Raises:
        CourseError: The code is invalid, or no class can be started.
    """
    code = statements(read_cells(file))
    if any(s.cell.is_marked for s in code):
        exported, left_out = [s for s in code if s.cell.is_marked], [s for s in code if not s.cell.is_marked]
    else:
        exported, left_out = code, []
    roots = node_classes(exported, nodes, left_out)
    modules = [_module(root, roots, exported, left_out) for root in roots]
    reasons_by_class = {
        m.class_name: why for m in modules if (why := m.obstacle(modules, exported, named=bool(nodes)))
    }
    started = [module for module in modules if module.class_name not in reasons_by_class]
    if not started or (reasons_by_class and nodes):
        reasons = "; ".join(f"{name}() {why}" for name, why in reasons_by_class.items())
        raise CourseError(
            f"No class can be started by itself: {reasons}. Give defaults, or make them "
            "parameters: self.declare_parameter(…)."
        )
    bindings = {name for module in started for part in module.statements for name in part.bindings}
    helper_modules = [
        replace(m, main=Main.NONE) for m in modules if m.class_name in reasons_by_class.keys() - bindings
    ]
    for name, count in Counter(module.name for module in [*started, *helper_modules]).items():
        if count > 1:
            raise CourseError(f"{count} classes would become the module {name}.py. Rename all but one.")
    return [*started, *helper_modules], reasons_by_class


def _module(
    root: Statement,
    roots: Sequence[Statement],
    exported: Sequence[Statement],
    left_out: Sequence[Statement],
) -> NodeModule:
    assert isinstance(root.node, ast.ClassDef)
    parts = collect_needed_statements(root, exported, left_out)
    classes = frozenset().union(*(s.bindings for s in roots))
    main = next(
        (s for s in reversed(exported) if "main" in s.bindings and s.later & classes == root.bindings), None
    )
    if main is None:
        return NodeModule(root.node, parts, Main.TEMPLATE)
    of_main = collect_needed_statements(main, exported, left_out)
    parts = sorted({s.order: s for s in (*parts, *of_main)}.values(), key=lambda s: s.order)
    return NodeModule(root.node, parts, Main.OWN)


def parameters_text(by_node: Mapping[str, Mapping[str, Any]]) -> str:
    """Format parameters as YAML for `--params-file`."""
    import json

    lines = []
    for name, values in by_node.items():
        lines += [f"{name}:", "  ros__parameters:"]
        lines += [f"    {key}: {json.dumps(value, ensure_ascii=False)}" for key, value in values.items()]
    return "\n".join(lines) + "\n"


_ALWAYS_THERE = {*dir(builtins), "__name__", "__file__", "__doc__", "__class__"}
_REGISTERING = ("import tf2_geometry_msgs", "import tf2_sensor_msgs")


def node_classes(
    code: Sequence[Statement], names: Sequence[str], left_out: Sequence[Statement] = ()
) -> list[Statement]:
    """Find the classes to export, by name or by default all subclasses of Node.

    Args:
        code: The statements that may be exported.
        names: The names of classes, or none.
        left_out: The statements of cells that are not marked, which the error refers to.

    Raises:
        CourseError: A name is not a class, or there are no subclasses of Node.
    """
    classes = {name: s for s in code if isinstance(s.node, ast.ClassDef) for name in s.bindings}
    for name in names:
        if name not in classes:
            # A student who pastes a class over the whole cell also replaces the mark.
            cells = [str(s.cell.number) for s in left_out if name in s.bindings]
            cell = "".join(cells[-1:])
            advice = f" Cell {cell} defines {name}: write # export into its first line."
            raise CourseError(
                f"There is no class {name!r} to export; there is: {', '.join(classes) or 'none'}."
                f"{advice if cells else ''}"
            )
    selected = [classes[name] for name in names or classes if names or _is_node(classes[name], classes)]
    if not selected:
        raise CourseError("There is no class that derives from rclpy's Node. Choose a class: --node MyClass")
    return sorted(selected, key=lambda cls: cls.order)


def collect_needed_statements(
    root: Statement, code: Sequence[Statement], left_out: Sequence[Statement]
) -> list[Statement]:
    """Collect a statement and all statements that it needs, in the order of the source.

    Args:
        root: The statement.
        code: The statements that may be exported.
        left_out: The statements of cells that are not marked, which the error refers to.

    Raises:
        CourseError: A name is undefined, or only defined in a cell that is left out.
    """
    needed = {root.order: root} | {s.order: s for s in code if s.text.startswith("from __future__")}
    # These imports have a side effect: they register message types in tf2.
    needed |= {s.order: s for s in code if s.text in _REGISTERING}
    to_do, last = [root], len(code) + len(left_out)
    while to_do:
        user = to_do.pop()
        definitions = [_find_binding(name, user, code, left_out, at=user.order) for name in sorted(user.now)]
        definitions += [_find_binding(name, user, code, left_out, at=last) for name in sorted(user.later)]
        if not user.is_import:
            definitions += [
                s for s in code if s.changes & user.bindings and not isinstance(user.node, ast.ClassDef)
            ]
        for definition in definitions:
            if definition is not None and definition.order not in needed:
                needed[definition.order] = definition
                to_do.append(definition)
    return [needed[order] for order in sorted(needed)]


def _is_node(cls: Statement, classes: dict[str, Statement]) -> bool:
    assert isinstance(cls.node, ast.ClassDef)
    for base in cls.node.bases:
        name = base.attr if isinstance(base, ast.Attribute) else getattr(base, "id", "")
        if name in ("Node", "LifecycleNode"):
            return True
        if name in classes and classes[name] is not cls and _is_node(classes[name], classes):
            return True
    return False


def _find_binding(
    name: str, user: Statement, code: Sequence[Statement], left_out: Sequence[Statement], *, at: int
) -> Statement | None:
    """Find the last statement before `at` that binds a name; without one, the first after it."""
    definitions = [s for s in code if name in s.bindings or "*" in s.bindings]
    before = [s for s in definitions if s.order < at]
    if definitions:
        return before[-1] if before else definitions[0]
    if name in _ALWAYS_THERE or name in user.bindings:
        return None
    usage = f"{', '.join(sorted(user.bindings)) or 'a statement'} (cell {user.cell.number}) uses {name!r}"
    elsewhere = next((s for s in left_out if name in s.bindings), None)
    if elsewhere is not None:
        raise CourseError(
            f"{usage}, which cell {elsewhere.cell.number} defines, but that cell is not exported. "
            "Mark it with "
            "# export in its first line."
        )
    raise CourseError(f"{usage}, which is not defined. Define or import it in a cell that is exported.")


def _direct_bases(node: ast.ClassDef) -> list[str]:
    return [base.id for base in node.bases if isinstance(base, ast.Name) and base.id != node.name]


def _required_arguments(node: ast.ClassDef, classes: Mapping[str, ast.ClassDef]) -> list[str]:
    """Return the arguments without a default, except `self`, with which a class is constructed.

    The constructor is its own, or that of the nearest direct or indirect base among `classes`.
    """
    family, to_do = [node], _direct_bases(node)
    while to_do:
        base = classes.get(to_do.pop(0))
        if base is not None and base not in family:
            family.append(base)
            to_do += _direct_bases(base)
    for item in (item for cls in family for item in cls.body):
        if isinstance(item, ast.FunctionDef) and item.name == "__init__":
            positional = [*item.args.posonlyargs, *item.args.args][1:]
            free = positional[: len(positional) - len(item.args.defaults)]
            pairs = zip(item.args.kwonlyargs, item.args.kw_defaults, strict=True)
            return [a.arg for a in (*free, *(a for a, default in pairs if default is None))]
    return []


def _literal(node: ast.expr) -> Any:
    try:
        return ast.literal_eval(node)
    except ValueError:
        return None
