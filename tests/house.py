"""Print how course_lib is cut: `python -m tests.house [FOLDER]`.

Each line counts once: as blank, comment (a line of its own), docstring, import or code. Functions
are all `def`s, methods and nested functions included; a function's length runs from its `def` to
its last line. The figures describe the code; no test asserts them.
"""

import ast
import statistics
import sys
from pathlib import Path

LONG = 100  # characters
KINDS = ("code", "import", "blank", "docstring", "comment")
WITH_DOCSTRING = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef


def line_kinds(text: str, tree: ast.Module) -> list[str]:
    """Return the kind of each line of a module."""
    spans: dict[int, str] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            spans |= dict.fromkeys(range(node.lineno, (node.end_lineno or 0) + 1), "import")
        elif isinstance(node, WITH_DOCSTRING) and ast.get_docstring(node, clean=False) is not None:
            docstring = node.body[0]
            spans |= dict.fromkeys(range(docstring.lineno, (docstring.end_lineno or 0) + 1), "docstring")
    kinds = []
    for number, line in enumerate(text.splitlines(), 1):
        own = "comment" if line.lstrip().startswith("#") else "code" if line.strip() else "blank"
        kinds.append(spans.get(number, own))
    return kinds


def measure(folder: Path) -> dict[str, float]:
    """Return the figures of all Python files with content below a folder."""
    texts = [text for path in sorted(folder.rglob("*.py")) if (text := path.read_text("utf-8")).strip()]
    trees = [ast.parse(text) for text in texts]
    kinds = [kind for text, tree in zip(texts, trees, strict=True) for kind in line_kinds(text, tree)]
    lengths = [
        (node.end_lineno or 0) - node.lineno + 1
        for tree in trees
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
    ]
    lines = [line for text in texts for line in text.splitlines()]
    return {
        "files": len(texts),
        "lines": len(kinds),
        "code lines": kinds.count("code"),
        "functions": len(lengths),
        "functions per 1,000 lines": round(1000 * len(lengths) / len(kinds), 1),
        "lines of a function, mean": round(statistics.mean(lengths), 1),
        "lines of a function, median": statistics.median(lengths),
        **{f"{kind} lines, %": round(100 * kinds.count(kind) / len(kinds), 2) for kind in KINDS},
        f"lines over {LONG} characters": sum(len(line) > LONG for line in lines),
        "lines of the longest file": max(len(text.splitlines()) for text in texts),
    }


if __name__ == "__main__":
    root = Path(__file__).parents[1] / "course_lib"
    for name, figure in measure(Path(sys.argv[1]) if len(sys.argv) > 1 else root).items():
        print(f"{name}: {figure}")
