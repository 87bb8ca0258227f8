"""The line of the student's own code in a traceback, or in a thread that runs."""

import linecache
import sys
import sysconfig
from collections.abc import Iterable
from pathlib import Path
from traceback import walk_stack, walk_tb
from types import TracebackType

OTHERS = (str(Path(__file__).resolve().parents[1]), *sysconfig.get_paths().values())


def line_of_traceback(trace: TracebackType | None) -> str:
    """Return the innermost own line: "cell In[3], line 2: 1 / 0"; "" if there is none."""
    return _innermost((frame.f_code.co_filename, line) for frame, line in walk_tb(trace))


def line_of_thread(ident: int) -> str:
    """Return the own line that a thread is in right now; "" if there is none."""
    frame = sys._current_frames().get(ident)
    stack = [(frame.f_code.co_filename, line) for frame, line in walk_stack(frame)] if frame else []
    return _innermost(reversed(stack))


def is_own(filename: str) -> bool:
    """Return whether a file is the student's: neither the kit's nor Python's nor a library's."""
    return not filename.startswith(("<frozen", *OTHERS))


def name_line(filename: str, line: int) -> str:
    """Return the name of a line and its text; cells have the name that IPython gives them."""
    code = linecache.getline(filename, line).strip()
    return f"{_cell(filename)}line {line}{code and f': {code}'}"


def _innermost(places: Iterable[tuple[str, int | None]]) -> str:
    own = [(name, line) for name, line in places if line and is_own(name)]
    return name_line(*own[-1]) if own else ""


def _cell(filename: str) -> str:
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    named = shell.compile.format_code_name(filename) if shell is not None else None
    if named is not None:
        return f"{named[0].lower()} {named[1]}, "
    return f"{Path(filename).name}, " if filename and not filename.startswith("<") else ""
