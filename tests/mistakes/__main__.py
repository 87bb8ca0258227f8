"""`python -m tests.mistakes [week01 …]` writes the tables of typical mistakes; a diff shows what changed."""

import sys

from course_lib.ros.programs.import_path import install

install()

# ROS names can be imported only after install().
from tests.mistakes.rows import ALL, path_of, table  # noqa: E402

if unknown := [name for name in sys.argv[1:] if name not in ALL]:
    sys.exit(f"there is no table of mistakes {unknown[0]!r}; pass names from: {', '.join(ALL)}")
for week in sys.argv[1:] or ALL:
    path_of(week).write_text(table(week), encoding="utf-8")
