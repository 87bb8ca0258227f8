"""The isolation of submissions from the machine they run on."""

from dataclasses import dataclass
from typing import Literal

from course_lib.errors import CourseError

Need = Literal["full", "partial", "any"]  # sandbox that must be there
LAYERS = ("bubblewrap", "namespaces", "Landlock", "seccomp", "limits", "process limit")


@dataclass(frozen=True)
class Isolation:
    """The layers of the jail that work here."""

    layers: tuple[str, ...] = ()

    @property
    def is_full(self) -> bool:
        """True if no layer is missing; bubblewrap only doubles others."""
        return set(LAYERS) - {"bubblewrap"} <= set(self.layers)

    @property
    def protects(self) -> bool:
        """True if the user's files and the network are out of reach."""
        closes_files = self.hides or "Landlock" in self.layers
        cuts_off = self.hides or "seccomp" in self.layers
        return closes_files and cuts_off and "limits" in self.layers

    @property
    def hides(self) -> bool:
        """True if even the names of files are out of reach."""
        return bool({"bubblewrap", "namespaces"} & set(self.layers))

    def __str__(self) -> str:
        """For results, reports and the terminal."""
        missing = [layer for layer in LAYERS[1:] if layer not in self.layers]
        have = ", ".join(self.layers)
        if self.is_full:
            return f"full sandbox ({have})"
        kind = "partial sandbox" if self.protects else "no sandbox"
        seen = "" if self.hides or not self.protects else "; which files there are is not hidden"
        return f"{kind} ({f'has {have}; ' if have else ''}lacks {', '.join(missing)}{seen})"

    def demand(self, need: Need) -> None:
        """Refuse to run submissions in less than is needed.

        Raises:
            CourseError: Says what is missing and what to type.
        """
        if need == "full" and not self.is_full:
            raise CourseError(
                f"--require-sandbox: what works here is: {self}. "
                "Grade on another Linux machine, or leave out --require-sandbox."
            )
        if need == "partial" and not self.protects:
            raise CourseError(
                f"submissions would run with your rights, {self}: they could read and change your files. "
                "Grade on Linux or WSL2; if you trust every one of them, type --i-trust-these-submissions"
            )
