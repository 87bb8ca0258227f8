"""Reading of files, JSON and Python from third parties: students, browsers or other programs.

Files may be incomplete.
"""

import ast
import errno
import json
import os
import re
import stat
import symtable
from bisect import bisect_left
from pathlib import Path
from typing import Any
from xml.parsers.expat import errors

TOO_DEEP = "it is nested too deeply for Python: split the expression"
# Python's limit is 1,000 calls. A visitor makes two to four calls per level, from within other
# calls.
MAX_NESTING = 200
NOT_UTF8 = "it is not text in UTF-8: save it in this encoding"
NULL_BYTES = "it contains null bytes: save it as text in UTF-8"
# Maximum input size [B] for an XML or YAML parser, which uses a multiple of this memory.
MOST_TEXT = 32_000_000
# The beginning of a pointer of Git LFS, which a clone without Git LFS has in place of a file.
LFS_POINTER = b"version https://git-lfs"
NOT_FETCHED = (
    "the file holds a pointer of Git LFS instead of its data. Fetch the data in the clone: "
    "git lfs install, then git lfs pull"
)
# Maximum size [B] of any other file that is read as a whole, such as a mesh or a notebook, of which
# the reader holds several copies.
MOST_BYTES = 300_000_000
_SPECIAL_FILES = {
    stat.S_ISFIFO: "a named pipe",
    stat.S_ISSOCK: "a socket",
    stat.S_ISCHR: "a device",
    stat.S_ISBLK: "a device",
}


def read_text(path: Path, errors: str = "strict") -> str:
    """Return the content of a text file in UTF-8, without the byte order mark of Windows programs.

    Args:
        path: The file.
        errors: What to do with bytes that are not UTF-8, as for `open`.

    Raises:
        OSError: The path is not a regular file that can be read, has more than MOST_TEXT bytes, or
            is a pointer of Git LFS.
        UnicodeDecodeError: The file is not UTF-8.
    """
    check_size(path, MOST_TEXT)
    text = path.read_text(encoding="utf-8-sig", errors=errors)
    if text.startswith(LFS_POINTER.decode()):
        raise OSError(errno.EINVAL, NOT_FETCHED, str(path))
    return text


def read_bytes(path: Path) -> bytes:
    """Return the content of a file.

    Raises:
        OSError: The path is not a regular file that can be read, or has more than MOST_BYTES bytes.
    """
    check_size(path, MOST_BYTES)
    return path.read_bytes()


def check_size(path: Path, most: int) -> None:
    """Raise an OSError if a path is not a regular file, or has more bytes than a limit."""
    if check_regular(path).st_size > most:
        raise OSError(errno.EFBIG, os.strerror(errno.EFBIG), str(path))


def check_regular(path: Path) -> os.stat_result:
    """Return the status of a file or folder; raise an OSError for a named pipe, socket or device.

    Opening a pipe waits for a program that writes to it, and a device may have no end. Opening a
    folder raises the usual error.
    """
    status = path.stat()
    kind = next((name for is_kind, name in _SPECIAL_FILES.items() if is_kind(status.st_mode)), "")
    if kind:
        raise OSError(errno.EINVAL, f"It is {kind}, not a regular file", str(path))
    return status


def read_json(text: str | bytes) -> Any:
    """Return the value of a JSON string.

    Raises:
        ValueError: The text is not JSON, or is nested more deeply than Python can read.
    """
    try:
        return json.loads(text)
    except RecursionError as error:
        raise ValueError("it is nested too deeply") from error


def explain_xml_error(text: str, code_number: int, number: int, column: int) -> str:
    """Return advice for a string that is not XML, or "" for an unusual error.

    The parser names the tag and the line at which it gave up, which is often not the wrong one.

    Args:
        text: The text.
        code_number: expat's code of the error.
        number: The line of the error, from 1.
        column: The column of the error, from 0.
    """
    lines = text.splitlines()
    line = lines[number - 1].strip() if 0 < number <= len(lines) else ""
    code = errors.messages[code_number]
    if "<" not in text:
        return "It has no tags: is it a path? Pass the text of the file, open(path).read()."
    if code == errors.XML_ERROR_UNBOUND_PREFIX:
        prefix = match[1] if (match := re.search(r"<(\w+):", line)) else "xacro"
        url = "http://www.ros.org/wiki/xacro" if prefix == "xacro" else "…"
        return f'Line {number} uses {prefix}: without xmlns:{prefix}="{url}" in the first tag.'
    if code == errors.XML_ERROR_MISPLACED_XML_PI:
        return f"Nothing may be above <?xml …?>, not even an empty line: delete it, up to line {number}."
    if code == errors.XML_ERROR_JUNK_AFTER_DOC_ELEMENT:
        return f"A file has one outermost tag, and line {number} is after its end: {line:.60}"
    if code == errors.XML_ERROR_DUPLICATE_ATTRIBUTE:
        return f"A tag of line {number} has an attribute twice: {line:.80}"
    if code in (errors.XML_ERROR_TAG_MISMATCH, errors.XML_ERROR_NO_ELEMENTS):
        end = sum(len(one) + 1 for one in lines[: number - 1]) + column
        opened = _open_tags(text[:end])
        if not opened:
            return ""
        name, start = opened[-1]
        closing = re.match(r"[\w:.-]*", text[end:])
        where = f"where </{closing[0]}> comes" if closing and closing[0] else "at the end of the file"
        return f"<{name}> of line {start} is still open {where}: end it with /> or </{name}>."
    if code == errors.XML_ERROR_INVALID_TOKEN:
        if "--" in re.sub(r"<!--|-->", "", line) and "<!--" in line:
            return f"A comment cannot contain --, as in line {number}: {line:.80}"
        if re.search(r"&(?!#?\w+;)", line):
            return f"Write &amp; for & in line {number}: {line:.80}"
        if re.search(r"\w=[^\s\"'=]", line):
            return f"The value of an attribute is in quotes. See line {number}: {line:.80}"
        return f"Is a quote or a > missing in line {number}, or above? {line:.80}"
    return ""


def _open_tags(text: str) -> list[tuple[str, int]]:
    """Return the names and lines of tags that are not closed, the outermost first."""
    opened: list[tuple[str, int]] = []
    # Comments keep their lines.
    text = re.sub(r"<!--.*?-->", lambda found: "\n" * found[0].count("\n"), text, flags=re.S)
    for tag in re.finditer(r"<(/?)([A-Za-z_][\w:.-]*)((?:[^<>\"']|\"[^\"]*\"|'[^']*')*)>", text):
        if tag[1]:
            # The parser has stopped at the first end that does not fit.
            opened = opened[:-1]
        elif not tag[3].endswith("/"):
            opened.append((tag[2], text.count("\n", 0, tag.start()) + 1))
    return opened


def compile_python(source: str | bytes, file: str = "<unknown>", flags: int = 0) -> Any:
    """Compile a program.

    Raises:
        ValueError: The program contains characters that cannot be encoded.
        SyntaxError: The program is not Python, contains null bytes, or is nested more deeply than
            Python can compile. Python itself would raise a MemoryError or RecursionError.
    """
    before, null, _ = source.partition("\0") if isinstance(source, str) else source.partition(b"\0")
    if null:
        # Python's own errors differ between versions, and have no line.
        raise SyntaxError(NULL_BYTES, (file, len(before.splitlines()) or 1, None, None))
    try:
        return compile(source, file, "exec", flags, dont_inherit=True)
    except (MemoryError, RecursionError) as error:
        raise SyntaxError(TOO_DEEP, (file, _first_deep_line(source, flags), None, None)) from error


def parse_python(source: str | bytes) -> ast.Module:
    """Return the syntax tree of a program, whose nodes are nested at most `MAX_NESTING` deep.

    Raises:
        ValueError: As in `compile_python`.
        SyntaxError: As in `compile_python`, or the tree is nested more deeply. Visitors of a tree
            recurse, and would raise a RecursionError.
    """
    tree: ast.Module = compile_python(source, flags=ast.PyCF_ONLY_AST)
    nodes: list[ast.AST] = [tree]
    for _ in range(MAX_NESTING):
        nodes = [child for node in nodes for child in ast.iter_child_nodes(node)]
        if not nodes:
            return tree
    line = next((node.lineno for node in nodes if isinstance(node, ast.expr | ast.stmt)), 1)
    raise SyntaxError(TOO_DEEP, ("<unknown>", line, None, None))


def parse_scopes(source: str) -> symtable.SymbolTable:
    """Return the symbol table of a program, with a scope for each comprehension in all Python versions.

    Since Python 3.12 (PEP 709) the variables of list, set and dict comprehensions are symbols of
    the enclosing scope, where they look like its own variables. Generator expressions keep a scope,
    so comprehensions are replaced by them.
    """
    tree = _ComprehensionsToGenerators().visit(parse_python(source))
    return symtable.symtable(ast.unparse(tree), "<unknown>", "exec")


class _ComprehensionsToGenerators(ast.NodeTransformer):
    """Replaces each comprehension by the generator expression with the same scope."""

    def visit_ListComp(self, node: ast.ListComp | ast.SetComp) -> ast.AST:
        return self.generic_visit(ast.GeneratorExp(node.elt, node.generators))

    visit_SetComp = visit_ListComp  # noqa: N815  # the name is of ast.NodeVisitor

    def visit_DictComp(self, node: ast.DictComp) -> ast.AST:
        item = ast.Tuple([node.key, node.value], ast.Load())
        return self.generic_visit(ast.GeneratorExp(item, node.generators))


def _first_deep_line(source: str | bytes, flags: int) -> int:
    """Return the number of the first line at which a program is nested too deeply."""
    lines = source.splitlines(keepends=True)

    def is_too_deep(count: int) -> bool:
        try:
            compile(type(source)().join(lines[:count]), "", "exec", flags, dont_inherit=True)  # type: ignore[arg-type]
        except (MemoryError, RecursionError):
            return True
        except (SyntaxError, ValueError):
            return False
        return False

    return bisect_left(range(len(lines)), True, key=is_too_deep)
