#!/usr/bin/env bash
# Gradescope runs this once, as root, when it makes the image: Python 3.11 or newer, the kit, and the course.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
python=""
apt-get update
apt-get install -y bubblewrap || true
for version in 3.13 3.12 3.11; do
  if apt-get install -y "python$version" "python$version-venv" || "python$version" -c "import ensurepip"; then
    python="python$version"
    break
  fi
done
if [ -z "$python" ]; then
  echo "This image has no Python 3.11 or newer: choose Ubuntu 22.04 or newer as the base image." >&2
  exit 1
fi
"$python" -m venv "$root/venv"
"$root/venv/bin/python" -m pip install KIT -e "$root/source/course"
