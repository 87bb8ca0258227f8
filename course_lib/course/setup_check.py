"""Whether this Python has what the kit needs, in lines that say what to do."""

import platform
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import metadata

DISTRIBUTION = "course-lib"
REPAIR = "pip install -e ."


@dataclass(frozen=True)
class Finding:
    """One package: what is wanted, what is there."""

    name: str
    wanted: str
    installed: str | None
    fits: bool

    @property
    def line(self) -> str:
        """One line for people."""
        if self.fits:
            return f"✔ {self.name} {self.installed}"
        came = f"version {self.installed} is installed" if self.installed else "not installed"
        return f"✘ {self.name}: {came}, wanted {self.wanted or 'any version'}. In a terminal: {REPAIR}"


def find_versions() -> Iterator[Finding]:
    """Yield each package that the kit itself needs on this platform."""
    from packaging.requirements import Requirement

    for text in metadata.requires(DISTRIBUTION) or []:
        need = Requirement(text)
        if need.marker and not need.marker.evaluate({"extra": ""}):
            continue  # of another platform, or of an extra
        try:
            installed = metadata.version(need.name)
        except metadata.PackageNotFoundError:
            yield Finding(need.name, str(need.specifier), None, False)
        else:
            yield Finding(need.name, str(need.specifier), installed, need.specifier.contains(installed))


def check_versions() -> None:
    """Print Python and every package with ✔ or ✘, and what to do about the latter."""
    findings = list(find_versions())
    bad = [finding for finding in findings if not finding.fits]
    print(f"✔ Python {platform.python_version()} on {platform.system()} ({sys.prefix})")  # noqa: T201  output
    print("\n".join(finding.line for finding in findings))  # noqa: T201  the cell's output
    verdict = f"{len(bad)} of {len(findings)} need a hand" if bad else "All of it is fine."
    print(verdict)  # noqa: T201  the cell's output
