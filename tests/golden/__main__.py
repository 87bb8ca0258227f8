"""`python -m tests.golden [--write] [PART …]`: compare the kept outputs with the code, or renew them."""

import argparse
import difflib
import sys

from course_lib.ros.programs.import_path import install

install()

# ROS names can be imported only after install().
from tests.golden.parts import PARTS, kept_file, text_of  # noqa: E402
from tests.test_seed_programs import DOCUMENTS  # noqa: E402

parser = argparse.ArgumentParser(prog="python -m tests.golden", description=__doc__)
parser.add_argument("parts", nargs="*", metavar="PART", help=f"default: all of {', '.join(PARTS)}")
parser.add_argument("--write", action="store_true", help="renew the files instead of comparing them")
arguments = parser.parse_args()
if unknown := set(arguments.parts) - PARTS.keys():
    parser.error(f"no part {', '.join(sorted(unknown))}; choose from {', '.join(PARTS)}")
# The seed programs are not part of the checkout.
available = [part for part in PARTS if part != "seeds" or DOCUMENTS]
has_changed = False
for part in arguments.parts or available:
    path, now = kept_file(part), text_of(part)
    kept = path.read_text("utf-8") if path.exists() else ""
    if arguments.write:
        path.write_text(now, "utf-8")
    has_changed |= now != kept
    lines = difflib.unified_diff(kept.splitlines(True), now.splitlines(True), f"kept {part}", "now")
    sys.stdout.writelines(lines)
sys.exit(1 if has_changed and not arguments.write else 0)
