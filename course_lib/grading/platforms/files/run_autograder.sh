#!/usr/bin/env bash
# Gradescope runs this for each submission; it writes results/results.json.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
exec "$root/venv/bin/course" gradescope WEEK --run "$root" --hidden HIDDEN NEED
