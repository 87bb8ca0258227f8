"""Runs all node tasks of the solutions on the real ROS 2: `python -m tests.real_ros.solutions [--write]`.

REAL_ROS_PYTHON names the Python of an environment with the real rclpy, if `course ros --install`
did not make one. With --write the table in docs/real_ros.md is renewed.
"""

import sys
from collections.abc import Iterator
from pathlib import Path

from course_lib.real.check import RealResult, results_on_ros
from course_lib.real.environment import find_environment

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "real_ros.md"
BEGIN, END = "<!-- table: python -m tests.real_ros.solutions --write -->\n", "<!-- end of the table -->\n"
HEAD = (
    "| Task | Checks that pass | Messages: kit, ROS | Pairs, bit-equal | Packages of the kit |\n"
    "|---|---|---|---|---|\n"
)


def rows() -> Iterator[str]:
    """Yield a row of the table for each task that can run on the real ROS 2."""
    environment = find_environment()
    for path in sorted((ROOT / "solutions").glob("*.ipynb")):
        for result in results_on_ros(path, environment):
            if not result.skipped:
                yield row(result)


def row(result: RealResult) -> str:
    """Return the row of a task."""
    counted = [check.passed for check, is_timing in result.checks if not is_timing]
    messages = ", ".join(f"{one.kit_count} and {one.ros_count}" for one in result.comparisons)
    pairs, equal = (sum(getattr(one, name) for one in result.comparisons) for name in ("pairs", "equal"))
    packages = ", ".join(f"`{name}`" for name in result.packages) or "none"
    checks = f"{sum(counted)} of {len(counted)}"
    return f"| `{result.task.id}` | {checks} | {messages} | {pairs}, {equal} | {packages} |\n"


def main() -> None:
    """Print the table, or write it into the page."""
    found = []
    for one in rows():
        sys.stdout.write(one)
        sys.stdout.flush()
        found.append(one)
    if "--write" in sys.argv[1:]:
        text = PAGE.read_text(encoding="utf-8")
        text_before, _, rest = text.partition(BEGIN)
        _, _, text_after = rest.partition(END)
        PAGE.write_text(f"{text_before}{BEGIN}{HEAD}{''.join(found)}{END}{text_after}", encoding="utf-8")


if __name__ == "__main__":
    main()
