"""Compare the kit with similar libraries in one table: `python -m tests.benchmarks`, with the extra `bench`.

meshcat, Pinocchio's viewer, viser, pytransform3d and rosbags run in this Python. nbgrader and Otter
need packages that fight with the kit's: they get an environment of their own, or `--peers` names a
Python that has them.
"""

import argparse
import subprocess
import tempfile
import venv
from collections.abc import Iterator
from pathlib import Path

import psutil

from tests.benchmarks import bench_grading, bench_start, bench_tf2, bench_viewer, bench_wire
from tests.benchmarks.table import Row, installed, markdown, page, refreshed

ROOT = Path(__file__).parents[2]
DOCS, README = ROOT / "docs" / "benchmarks.md", ROOT / "README.md"
HERE = ("course-lib", "meshcat", "pin", "viser", "rerun-sdk", "pytransform3d", "rosbags")
THERE = ("nbgrader", "otter-grader")


def main() -> None:
    """Print the table as it grows, and write the documents if that was asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--peers", help="a Python that has nbgrader and otter-grader")
    parser.add_argument("--repeats", type=int, default=3, help="the best of so many runs counts")
    parser.add_argument(
        "--write",
        action="store_true",
        help="write docs/benchmarks.md, and the lines of it that README.md shows",
    )
    options = parser.parse_args()
    load = psutil.getloadavg()[0]
    with tempfile.TemporaryDirectory() as folder:
        top = Path(folder)
        peers = options.peers or environment(top / "peers")
        rows = []
        for row in measured(top, peers, options.repeats):
            rows.append(row)
            print(markdown([row]).partition("\n")[2].partition("\n")[2], flush=True)
        versions = installed(HERE) | versions_of(peers)
    print("\n" + markdown(rows))
    if options.write:
        # The text below the table is written manually.
        _, heading, sections = DOCS.read_text(encoding="utf-8").partition("\n## ")
        DOCS.write_text(page(rows, versions, load) + heading + sections, encoding="utf-8")
        README.write_text(refreshed(README.read_text(encoding="utf-8"), rows), encoding="utf-8")


def environment(folder: Path) -> str:
    """Create an environment with nbgrader and Otter; return its Python."""
    venv.create(folder, with_pip=True)
    python = str(next(folder.glob("bin/python")))
    subprocess.run([python, "-m", "pip", "install", "-q", *THERE, "ipykernel"], check=True)
    return python


def versions_of(python: str) -> dict[str, str]:
    """Return the versions of nbgrader and Otter in another environment."""
    code = "import sys; from importlib.metadata import version; print(*map(version, sys.argv[1:]))"
    done = subprocess.run([python, "-c", code, *THERE], check=True, capture_output=True, text=True)
    return dict(zip(THERE, done.stdout.split(), strict=True))


def measured(top: Path, peers: str, repeats: int) -> Iterator[Row]:
    """Yield the rows of all benchmarks that have a peer."""
    yield from bench_start.rows()
    yield from bench_wire.rows()
    yield from bench_tf2.rows()
    yield from bench_grading.peer_rows(top, peers)
    yield from bench_viewer.rows(repeats=repeats)


if __name__ == "__main__":
    main()
