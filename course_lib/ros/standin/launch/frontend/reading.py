"""Readers of XML and YAML launch files: the entity of a file, with the line of each element."""

from pathlib import Path
from typing import Any
from xml.parsers import expat

import yaml  # type: ignore[import-untyped]  # it ships no types

from launch.frontend.entity import Entity, EntityError, XmlEntity, YamlEntity

_LARGEST = 4 * 2**20  # [bytes] of a file
_DEEPEST = 50  # elements in one another
_MOST = 50_000  # values of a YAML file, counted anew for each alias


def read_entity(file: Path) -> Entity:
    """Return the root of a launch file; raises an EntityError, or OSError where the file is not there."""
    data = file.read_bytes()
    if len(data) > _LARGEST:
        raise EntityError(1, f"it has {len(data)} bytes, more than a launch file can have ({_LARGEST})")
    is_yaml = file.suffix in (".yaml", ".yml") or (file.suffix != ".xml" and data.lstrip()[:1] != b"<")
    return _yaml_root(data) if is_yaml else _XmlReader().root_of(data)


class _XmlReader:
    """Builds entities from what expat reads."""

    def __init__(self) -> None:
        self._open: list[XmlEntity] = []
        self._root: XmlEntity | None = None
        self._parser = expat.ParserCreate()
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.EntityDeclHandler = self._refuse_entity

    def root_of(self, data: bytes) -> Entity:
        """Return the root element."""
        try:
            self._parser.Parse(data, True)
        except expat.ExpatError as error:
            raise EntityError(error.lineno, f"not XML: {expat.ErrorString(error.code)}") from error
        assert self._root is not None  # expat raises an error where there is no element
        return self._root

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        element = XmlEntity(name, self._parser.CurrentLineNumber, attributes)
        if self._open:
            self._open[-1].elements.append(element)
        else:
            self._root = element
        self._open.append(element)
        if len(self._open) > _DEEPEST:
            raise element.error(f"more than {_DEEPEST} elements are nested")

    def _end(self, name: str) -> None:
        self._open.pop()

    def _refuse_entity(self, name: str, *rest: object) -> None:
        line = self._parser.CurrentLineNumber
        raise EntityError(line, f"the file declares the entity '{name}', which launch files do not need")


class _Loader(yaml.SafeLoader):  # type: ignore[misc]  # it ships no types
    """Notes the line of each mapping."""

    def __init__(self, data: bytes) -> None:
        super().__init__(data)
        self.lines: dict[int, int] = {}  # by the identity of the mapping

    def construct_object(self, node: Any, deep: bool = False) -> Any:
        """Return the value of a node."""
        value = super().construct_object(node, deep)
        if isinstance(node, yaml.MappingNode):
            self.lines[id(value)] = node.start_mark.line + 1
        return value


def _yaml_root(data: bytes) -> Entity:
    try:
        loader = _Loader(data)
        node = loader.get_single_node()
        if node is None or not isinstance(node, yaml.MappingNode) or len(node.value) != 1:
            raise EntityError(1, "expected one key, `launch:`, with a list of elements")
        _check_size(node)
        [(name, value)] = loader.construct_document(node).items()
    except yaml.YAMLError as error:
        raise _yaml_error(error, data) from error
    except RecursionError as error:
        raise EntityError(1, f"more than {_DEEPEST} elements are nested") from error
    return YamlEntity(str(name), node.start_mark.line + 1, value, loader.lines)


def _yaml_error(error: Any, data: bytes) -> EntityError:
    mark = getattr(error, "problem_mark", None) or getattr(error, "context_mark", None)
    before = data[: getattr(error, "position", 0)]  # of a character that YAML does not have
    problem = getattr(error, "problem", None) or str(error).splitlines()[0]
    return EntityError(mark.line + 1 if mark else before.count(b"\n") + 1, f"not YAML: {problem}")


def _check_size(root: Any) -> None:
    """Raise an EntityError for nodes that are too many or too deep once their aliases are followed."""
    waiting, count = [(root, 1)], 0
    while waiting:
        node, depth = waiting.pop()
        count += 1
        if depth > 2 * _DEEPEST or count > _MOST:
            what = f"more than {_MOST} values" if count > _MOST else f"more than {_DEEPEST} nested elements"
            raise EntityError(node.start_mark.line + 1, f"{what}, with all aliases followed")
        if isinstance(node, yaml.SequenceNode):
            waiting += [(one, depth + 1) for one in node.value]
        elif isinstance(node, yaml.MappingNode):
            waiting += [(one, depth + 1) for pair in node.value for one in pair]
