"""Programs from public repositories, run as they are: `python -m tests.benchmarks.wild_programs FOLDER`.

FOLDER holds clones, named `owner+name`. The rows of tests/data/wild_programs.toml are run for five
seconds of robot time and compared with their results; `--find` runs all programs of the clones and
writes their rows. `--what launch` and `--what layout` do the same with launch files, which are
described, and with layouts, which are loaded, saved and loaded again:
tests/benchmarks/wild_files.py. `--what launch --find --start` starts the launch files for two
seconds instead.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
import tomllib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from tests.benchmarks.wild_files import AT_THE_END, COMMON, files_of, judgement, started

_DATA = Path(__file__).parents[1] / "data"
ROWS = _DATA / "wild_programs.toml"
TABLES = {
    "program": ROWS,
    "launch": _DATA / "wild_launch_files.toml",
    "layout": _DATA / "wild_layouts.toml",
}
SECONDS, LIMIT = "5", 90.0  # [s] of robot time, and of the wall clock
IMPORTS = re.compile(r"^\s*(import|from) rclpy", re.MULTILINE)
NO_PROGRAM = ("test", "tests", "setup.py", "conftest.py", "__init__.py", "build", "install")
LACKS = re.compile(r"No module named '([^'.]+)")
# Requirements of a program that are missing here and would be missing in ROS: not counted.
_NEEDS = (
    (re.compile(r"EOFError: EOF when reading"), "keyboard input"),
    (re.compile(r"ParameterUninitializedException: The parameter '([\w.]+)'"), "parameter {}"),
    (re.compile(r"PackageNotFoundError: package '([\w-]+)' not found"), "{}"),
    (re.compile(r"\busage:|error: (?:the following|one of the) arguments", re.IGNORECASE), "arguments"),
    (re.compile(r"hint: in (Python 3\.1\d)"), "{}"),
    (re.compile(r"termios\.error"), "a terminal"),
)


@dataclass(frozen=True)
class Row:
    """A program, launch file or layout: location, arguments, result and reason.

    `beside` are other programs of its folder that run with it, a server for a client. `result` is
    `runs` (of a launch file `described`, of a layout `kept`), `needs` (a module or package that is
    not there, `reason`), or `fails`; `theirs`: a mistake in the file is the reason, it fails in
    ROS, too.
    """

    repository: str
    commit: str
    path: str
    beside: str = ""
    args: str = ""
    input: str = ""
    result: str = ""
    reason: str = ""
    theirs: bool = False

    def text(self, what: str = "program") -> str:
        """Return the row as TOML."""
        fields = {name: value for name, value in vars(self).items() if value}
        lines = [f"{name} = {json.dumps(value, ensure_ascii=False)}" for name, value in fields.items()]
        return "\n".join([f"[[{what}]]", *lines, ""])


def main() -> int:
    """Run the programs; return how many results differ from the rows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--what", choices=TABLES, default="program")
    parser.add_argument("--find", action="store_true", help="print a row for each program of the clones")
    parser.add_argument("--most", type=int, default=10**6, help="how many of a clone `--find` runs")
    parser.add_argument("--start", action="store_true", help="start the launch files instead")
    arguments = parser.parse_args()
    what, counts, changed = arguments.what, Counter[str](), 0
    for row in found(arguments.folder, arguments.most, what) if arguments.find else table(what):
        clone = arguments.folder / row.repository.replace("/", "+")
        if what == "program":
            result, reason = outcome(clone / row.path, row)
        else:
            result, reason = started(clone, row) if arguments.start else judgement(clone, row, what)
        counts["fails in ROS, too" if result == "fails" and row.theirs else result] += 1
        if arguments.find:
            print(replace(row, result=result, reason=reason).text(what), flush=True)
        else:
            changed += result != row.result
            note = "" if result == row.result else f"   (was: {row.result})"
            print(f"{result:8} {row.repository}/{row.path}   {reason}{note}", flush=True)
    print(", ".join(f"{count} {result}" for result, count in sorted(counts.items())), file=sys.stderr)
    return changed


def table(what: str) -> list[Row]:
    """Return the rows of programs, launch files or layouts."""
    return [Row(**row) for row in tomllib.loads(TABLES[what].read_text())[what]]


def found(folder: Path, most: int, what: str) -> Iterator[Row]:
    """List the files of the clones, evenly chosen where a clone has more."""
    for clone in sorted(path for path in folder.iterdir() if (path / ".git").exists()):
        command = ["git", "-C", str(clone), "rev-parse", "HEAD"]
        commit = subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
        programs = (file for file in sorted(clone.rglob("*.py")) if is_program(clone, file))
        files = programs if what == "program" else files_of(clone, what)
        paths = [file.relative_to(clone) for file in files]
        for path in paths[:: max(1, -(-len(paths) // most))]:
            yield Row(clone.name.replace("+", "/"), commit, str(path))


def is_program(clone: Path, file: Path) -> bool:
    """Return whether a file imports rclpy and runs something."""
    if set(file.relative_to(clone).parts) & set(NO_PROGRAM):
        return False
    source = file.read_text(errors="replace")
    return bool(IMPORTS.search(source)) and ("def main(" in source or "rclpy.init(" in source)


def outcome(file: Path, row: Row) -> tuple[str, str]:
    """Run a program alone; return its result and the reason."""
    if not file.is_file():
        return "missing", "no such clone"
    files = [str(file.resolve().parent / name) for name in (file.name, *row.beside.split())]
    words = [*files, "--seconds", SECONDS, "--", *row.args.split()]
    command = [sys.executable, "-m", "course_lib", "run", *words]
    with tempfile.TemporaryDirectory() as folder:
        try:
            done = subprocess.run(
                command,
                cwd=folder,
                env=os.environ | {"HOME": folder, **COMMON},
                input=row.input,
                capture_output=True,
                text=True,
                errors="replace",
                timeout=LIMIT,
            )
        except subprocess.TimeoutExpired:
            return "fails", f"did not end within {LIMIT:g} s"
    return judged(done.returncode, done.stderr)


def judged(code: int, err: str) -> tuple[str, str]:
    """Return the result and the reason for the output of a program."""
    lacking = LACKS.findall(err)
    lines = [line for line in err.splitlines() if line.strip() and not line.startswith("hint:")]
    last = lines[-1].strip()[:160] if lines else ""
    if code and any(text in last for text in AT_THE_END):
        # The end of the run acts like Ctrl+C: rclpy on a robot ends such a program in the same way.
        return "runs", ""
    if code and lacking:
        return "needs", lacking[-1]
    for pattern, reason in _NEEDS if code else ():
        if found := pattern.search(err):
            return "needs", reason.format(*found.groups())
    if code:
        return "fails", last or f"exit code {code}"
    if "was still waiting" in err:
        return "fails", "was still waiting after the end"
    return "runs", ""


if __name__ == "__main__":
    sys.exit(main())
